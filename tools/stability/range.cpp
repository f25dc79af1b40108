// Numbers at the ends of their range: half floats, scenes of a millimetre and of ten kilometres, geometry far from the
// origin.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "grid/base/half.h"
#include "grid/cubemap/localized.h"
#include "grid/field/resolve.h"
#include "grid/fiv/light.h"
#include "grid/lobes/light.h"
#include "tools/stability/cube_builder.h"
#include "tools/stability/fiv_shapes.h"
#include "tools/stability/scenes.h"
#include "tools/stability/stability.h"
#include "tracer/bake/fiv/baker.h"

namespace ivory {
namespace {

// The twelve functions, [function][rgb], of light of 1 lux from one side over a uniform background, scaled to E lux.
std::array<float, 36> mixed_light(double e) {
  const V3f w = V3f(0.43F, 0.61F, 0.67F).normalized();
  std::array<float, 36> moments{};
  for (std::size_t f = 0; f < 12; ++f) {
    const std::size_t row = f / 3;  // F, D_x, D_y, D_z
    const auto j = unsigned(f % 3);
    double value = 0.5 * double(w[j]);
    if (row == j + 1) value += 0.5;  // uniform light: D_jj = 2 E
    for (std::size_t c = 0; c < 3; ++c) moments[3 * f + c] = float(value * e);
  }
  return moments;
}

// Stored as halves in units of `unit` lux: the worst relative error of E(n) over normals that see at least a tenth of
// E.
double half_error(double e, float unit) {
  const std::array<float, 36> moments = mixed_light(e);
  std::array<float, 36> stored{};
  for (std::size_t i = 0; i < stored.size(); ++i) stored[i] = rounded_to_half(moments[i] / unit);
  double worst = 0;
  constexpr int normals = 500;
  for (int i = 0; i < normals; ++i) {
    const double y = 1 - 2 * (i + 0.5) / normals;
    const double phi = i * 2.399963229728653;
    const double s = std::sqrt(1 - y * y);
    const V3f n(V3d(s * std::cos(phi), y, s * std::sin(phi)));
    const auto exact = double(irradiance(Basis::vectors, Reconstruction::optimal, moments.data(), n).x);
    if (exact < 0.1 * e) continue;
    const double read = double(irradiance(Basis::vectors, Reconstruction::optimal, stored.data(), n).x) * double(unit);
    // Halves beyond 65504 are infinite: nothing is left of E.
    worst = std::max(worst, std::isfinite(read) ? std::abs(read / exact - 1) : 1.0);
  }
  return worst;
}

// Of a grid whose brightest vertex holds that light, as uploads choose it.
float upload_scale(double e) {
  float largest = 0;
  for (const float m : mixed_light(e)) largest = std::max(largest, std::abs(m));
  return half_scale(largest);
}

std::vector<StabilityPoint> float16_range(const StabilityParams&) {
  std::vector<StabilityPoint> points;
  const float daylight = upload_scale(1e5);
  // Halves round to 2^-11 = 4.9e-4 of each function; E(n) of a tenth of E is a difference of larger ones.
  constexpr double rounding = 1.2e-3;
  for (int decade = -6; decade <= 6; ++decade) {
    const double e = std::pow(10, decade);
    points.push_back({"no scale", e, half_error(e, 1), {}});
    points.push_back({"scaled to the brightest", e, half_error(e, upload_scale(e)), rounding});
    if (e > 1e5) continue;
    // Below 2^-14 units halves are multiples of 2^-24 units, each off by half of one at most. The errors of the few
    // functions that make E(n) have either sign, and E(n) may be a tenth of E: three of these steps over E.
    points.push_back({"beside 100,000 lux in one grid", e, half_error(e, daylight),
                      rounding + 3 * std::exp2(-24) * double(daylight) / e});
  }
  return points;
}

IrradianceGrid bake_chambers(const LitScene& world, const StabilityParams& params, const Chambers& chambers) {
  GridBakeParams bake;
  bake.voxel_size_m = chambers.side_m / 12;
  bake.photons = params.quick ? 30'000 : 100'000;
  return bake_all_light(world, bake);
}

// Errors of what reads the chambers, placed by to_world: grid and paths before the wall, and leaks behind it.
void add_chamber_errors(const Chambers& chambers, const StabilityParams& params, double x, std::optional<double> lit,
                        std::optional<double> leak, std::vector<StabilityPoint>& points) {
  const LitScene world = make_lit_scene(make_chambers(chambers));
  const IrradianceGrid grid = bake_chambers(world, params, chambers);
  const auto bright = lit_wall_points(chambers, 10);
  const auto dark = dark_wall_points(chambers, 10);
  const auto finite = [](double error) { return std::isfinite(error) ? error : 1.0; };
  points.push_back({"grid, rays", x, finite(std::abs(mean_share(world, grid, Guard::rays, bright) - 1)), lit});
  points.push_back({"grid, leak by rays", x, finite(mean_share(world, grid, Guard::rays, dark)), leak});
  points.push_back({"grid, leak by planes", x, finite(mean_share(world, grid, Guard::planes, dark)), leak});
  ProbeParams probe;
  probe.samples = params.quick ? 16 : 256;
  const auto mean = [&](const std::vector<ProbePoint>& at) {
    double sum = 0;
    for (const ProbeResult& r : probe_scene(world, at, probe))
      sum += double(r.e.x) / double(at.size()) / double(chamber_irradiance);
    return sum;
  };
  points.push_back({"path", x, finite(std::abs(mean(bright) - 1)), lit});
  points.push_back({"path, leak", x, finite(mean(dark)), leak});
}

// Assets of a size, about a place, against closed forms from the coordinates as single precision has them: a cube map
// whose wall at +x alone shines, a ball's light as lobes, and what an occluding ball's table hides of even light.
void add_asset_errors(const LobeTable& lobe_table, const V3d& centre, double side, double x, bool bounded,
                      std::vector<StabilityPoint>& points) {
  const auto held = [&](double bound) { return bounded ? std::optional(bound) : std::nullopt; };
  const auto add = [&](const char* series, double error, double bound) {
    points.push_back({series, x, std::isfinite(error) ? error : 1.0, held(bound)});
  };
  const auto place = [&](const V3d& p) { return V3f(centre + p * side); };
  const double h = 0.5 * side;

  const V3f origin = place({0, 0, 0});
  const LocalizedCube cube = make_cube(4, origin, box_around(V3d(-h, -h, -h), V3d(h, h, h)), [](const V3f& w) {
    return w.x > std::abs(w.y) && w.x > std::abs(w.z) ? Rgb(1, 1, 1) : Rgb(0, 0, 0);
  });
  const V3d middle(origin);
  const std::vector<V3d> wall{middle + V3d(h, -h, -h), middle + V3d(h, h, -h), middle + V3d(h, h, h),
                              middle + V3d(h, -h, h)};
  double by_cube = 0;
  double by_lobes = 0;
  double by_table = 0;
  double truly_hidden = 0;

  const Sphere ball{place({0.1, 0.6, -0.2}), float(0.2 * side)};
  LobeReflectance matt;
  matt.diffuse = Rgb(1 / pi, 1 / pi, 1 / pi);

  FivParams bake;
  bake.samples = V3i(12, 7, 3);
  bake.radii = {1.2F, 2.3F, 4.0F};  // the receivers stand at 2.33
  bake.environment_size = 16;
  bake.parts = 1;
  bake.silhouette_pixels = 32;
  const FivOccluder occluder = make_fiv_occluder(ball_scene(float(0.3 * side), origin, 16));
  const FivTable table = bake_fiv(occluder, uniform_cube(Rgb(1, 1, 1), 16), bake);
  const FivPlacement placed{&table, occluder.center_m, occluder.radius_m};

  constexpr int receivers = 64;
  for (int i = 0; i < receivers; ++i) {
    const V3f p = place({0.4 * std::sin(i * 1.3), 0.4 * std::sin(i * 2.1), 0.4 * std::sin(i * 3.7)});
    const V3d n(1, 0, 0);
    by_cube = std::max(
        by_cube,
        std::abs(double(irradiance(cube, CubeMethod::polygon, p, V3f(n)).x) / polygon_irradiance(wall, V3d(p), n) - 1));

    // The ball stands 0.8 to 1.2 sides over these, well above the horizon.
    const V3f under = place({0.3 * std::sin(i * 1.3), -0.4, 0.3 * std::sin(i * 2.1)});
    const V3d up(0, 1, 0);
    matt.ns = V3f(up);
    const V3d to_ball = V3d(ball.center) - V3d(under);
    const double e = ball_irradiance(to_ball.normalized().y, std::pow(double(ball.radius_m), 2) / to_ball.length2());
    const Rgb sent = lobe_light(lobe_table, ball, {}, under, matt.ns, make_reflectance_lobes(lobe_table, matt), {});
    by_lobes = std::max(by_lobes, std::abs(double(sent.x) * pi_d / e - 1));

    // All around the occluder and facing it; the mean, because directions in which interpolation errs differ.
    const double y = 1 - 2 * (i + 0.5) / receivers;
    const double phi = i * 2.399963229728653;
    const double s = std::sqrt(1 - y * y);
    const V3f around = place(V3d(s * std::cos(phi), y, s * std::sin(phi)) * 0.7);
    const V3d q = middle - V3d(around);
    truly_hidden += pi_d * std::pow(0.3 * side, 2) / q.length2();
    by_table +=
        pi_d - double(fiv_irradiance(std::span(&placed, 1), around, V3f(q.normalized()), -1, Rgb(pi, pi, pi), {}).x);
  }
  // A polynomial stands for atan2: 1e-6 an edge.
  add("cube map, polygons", by_cube, 1e-5);
  // Well above a matt surface's horizon lobes have the closed form.
  add("lobes, light of a ball", by_lobes, 1e-5);
  // A ball of 16 rings has up to 1 % less of a disc than a round one; the lights at its edge average out over places.
  add("FIV table, light hidden by a ball", std::abs(by_table / truly_hidden - 1), 0.02);
}

// The same scene from a millimetre to ten kilometres, and beyond.
std::vector<StabilityPoint> scene_scale(const StabilityParams& params) {
  const LobeTable lobe_table = make_lobe_table();
  std::vector<StabilityPoint> points;
  for (const double side : {1e-6, 1e-5, 1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 1e6}) {
    Chambers chambers;
    chambers.side_m = float(side);
    chambers.thickness_m = float(0.01 * side);
    // Turned, so that no coordinate is exact, and the wall passes the origin, where coordinates are small but the
    // triangles' rounding is not.
    chambers.to_world.setAxisAngle(V3f(0.3F, 1, 0.5F).normalized(), 0.5F);
    // 30,000 photons or 1600 paths at least, and vertices that share photons: 1 % each.
    add_chamber_errors(chambers, params, side, 0.04, 1e-3, points);
    add_asset_errors(lobe_table, V3d(0.1, -0.2, 0.15) * side, side, side, true, points);
  }
  return points;
}

// The room of 2 m moved away from the origin, where single precision places points 2^-24 of the distance apart.
std::vector<StabilityPoint> far_from_origin(const StabilityParams& params) {
  const LobeTable lobe_table = make_lobe_table();
  std::vector<StabilityPoint> points;
  for (const double distance : {0.0, 1.0, 10.0, 100.0, 1e3, 3e3, 1e4, 1e5, 1e6}) {
    Chambers chambers;
    chambers.thickness_m = 0.02F;
    chambers.to_world.setTranslation(V3f(V3d(0.62, 0.35, -0.7) * distance));
    const bool bounded = distance <= 1e4;
    add_chamber_errors(chambers, params, distance, bounded ? std::optional(0.04) : std::nullopt,
                       bounded ? std::optional(1e-3) : std::nullopt, points);
    add_asset_errors(lobe_table, V3d(0.62, 0.35, -0.7) * distance, 2, distance, bounded, points);
  }
  return points;
}

// A sloping ground of two triangles through the origin, whose corners are far while its points are near: where rounding
// puts a point below the ground, its rays meet the ground again. A sky of 1 nit gives E = pi on it. What
// the ground throws back of a lamp's light goes up: none may arrive below it.
std::vector<StabilityPoint> sloping_ground(const StabilityParams& params) {
  std::vector<StabilityPoint> points;
  M44f slope;
  slope.setAxisAngle(V3f(0.3F, 1, 0.5F).normalized(), 0.5F);
  V3f up;
  slope.multDirMatrix(V3f(0, 1, 0), up);
  up.normalize();
  for (const float half : {1.0F, 10.0F, 100.0F, 1e3F, 1e4F, 1e5F}) {
    const auto ground = [&] {
      Scene scene;
      scene.name = "sloping ground";
      const int grey = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
      add_mesh(scene, make_quad({-0.7F * half, 0, -1.1F * half}, {0, 0, 2 * half}, {2 * half, 0, 0}, grey), slope);
      return scene;
    };
    Scene sky = ground();
    sky.environment = uniform_environment(Rgb(1, 1, 1));
    const LitScene under_sky = make_lit_scene(std::move(sky));
    std::vector<ProbePoint> probes;
    probes.reserve(64);
    for (int i = 0; i < 64; ++i)
      probes.push_back({V3f(0.5F * std::sin(float(i) * 1.3F), 0, 0.5F * std::sin(float(i) * 2.1F)) * slope, up});
    ProbeParams probe;
    probe.samples = params.quick ? 64 : 1024;
    double e = 0;
    for (const ProbeResult& r : probe_scene(under_sky, probes, probe)) e += double(r.e.x) / double(probes.size());
    // No path may be shadowed; 4096 of them measure E to 0.1 %.
    points.push_back({"path, E of the sky", double(half), std::abs(e / pi_d - 1), 4e-3});

    Scene lamp = ground();
    lamp.lights.push_back(PointLight{up, Rgb(1, 1, 1)});
    const LitScene under_lamp = make_lit_scene(std::move(lamp));
    GridBakeParams bake;
    GridFrame frame;
    frame.size = V3i(6, 6, 6);
    frame.spacing_m = V3f(0.2F, 0.2F, 0.2F);
    frame.origin_m = V3f(-0.5F, -0.5F, -0.5F);
    bake.frame = frame;
    bake.guard = Guard::off;
    bake.photons = params.quick ? 50'000 : 500'000;
    const IrradianceGrid grid = resolve(bake_grid_sums(under_lamp, bake));
    double below = 0;
    double above = 0;
    for (std::size_t v = 0; v < frame.vertex_count(); ++v) {
      const V3f index(float(v % 6), float(v / 6 % 6), float(v / 36));
      const float height = frame.to_world(index).dot(up);
      const double light = V3d(grid.at(v)[0], grid.at(v)[3], grid.at(v)[6]).length();
      // Cells reach 0.17 m to either side of their vertex.
      if (height > 0.2F) above += light;
      if (height < -0.2F) below += light;
    }
    points.push_back({"photons, light under the ground", double(half), below / above, 1e-4});
  }
  return points;
}

}  // namespace

std::vector<StabilityCase> stability_range_cases() {
  return {
      {.name = "float16_range",
       .title = "Irradiance in half floats",
       .sentence = "Half floats as they are overflow above 65,504 lux and go coarse below 1e-4 lux; scaled by the "
                   "grid's brightest "
                   "value, as uploads do, they keep 0.1 % at every level and 1 % of 1e-4 lux beside full daylight: "
                   "never store light "
                   "as halves without a scale.",
       .x_label = "E, lux",
       .y_label = "worst error of E(n) / E(n)",
       .log_x = true,
       .run = float16_range},
      {.name = "scene_scale",
       .title = "Scenes of a millimetre and of ten kilometres",
       .sentence = "Nothing depends on the scene's scale, from a micrometre to a thousand kilometres.",
       .x_label = "side of the scene, m",
       .y_label = "error / E",
       .log_x = true,
       .run = scene_scale},
      {.name = "sloping_ground",
       .title = "Points near the origin on triangles that reach far",
       .sentence =
           "Rays leave a triangle of any size from far enough above it not to meet it again: rounding errors of "
           "its points go with its corners, not with the points.",
       .x_label = "half side of the ground, m",
       .y_label = "error / E",
       .log_x = true,
       .run = sloping_ground},
      {.name = "far_from_origin",
       .title = "Geometry far from the origin",
       .sentence = "Up to 10 km from the origin a room of 2 m is baked as at the origin; at 100 km single precision "
                   "can no longer place walls and rays, and E is wrong by tens of per cent: scenes from files are "
                   "moved there when they are loaded.",
       .x_label = "distance from the origin, m (room of 2 m, wall of 2 cm)",
       .y_label = "error / E",
       .log_x = true,
       .run = far_from_origin},
  };
}

}  // namespace ivory
