// FIV occluder tables where light is hard, the receiver's plane cuts the occluder, shadows meet, or the receiver stands
// within the bounding sphere.
#include <algorithm>
#include <cmath>

#include "tools/stability/fiv_shapes.h"
#include "tools/stability/measure_fiv.h"
#include "tools/stability/scenes.h"
#include "tools/stability/stability.h"
#include "tracer/bake/fiv/gather.h"
#include "tracer/bake/fiv/inside.h"

namespace ivory {
namespace {

// A sun of half-angle `radius_rad`, the same irradiance for all; texels count by the share of 8 x 8 points within.
CubeMap sun(int size, double radius_rad) {
  const V3d towards = V3d(0.5, 0.8, 0.3).normalized();
  CubeMap map{size, {}};
  double all = 0;
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        constexpr int parts = 8;
        int within = 0;
        for (int k = 0; k < parts * parts; ++k) {
          const double s = (2 * (column + (k % parts + 0.5) / parts) - size) / size;
          const double t = (2 * (row + (k / parts + 0.5) / parts) - size) / size;
          if (cube_point(face, s, t).normalized().dot(towards) > std::cos(radius_rad)) ++within;
        }
        const auto share = float(within) / (parts * parts);
        map.texels.emplace_back(share, share, share);
        all += double(share) * cube_texel_solid_angle(size, row, column);
      }
    }
  }
  for (Rgb& texel : map.texels) texel *= float(1 / all);
  return map;
}

FivParams table_params(const V3i& samples) {
  FivParams params;
  params.samples = samples;
  params.hemispheres = 6;
  return params;
}

std::vector<StabilityPoint> fiv_hard_light(const StabilityParams& params) {
  const FivOccluder occluder = make_fiv_occluder(bracket_scene());
  constexpr int size = 32;  // a texel is 2.8 degrees wide
  FivPlane plane;
  plane.point.y = -1.02F;
  plane.resolution = params.quick ? 24 : 48;
  std::vector<StabilityPoint> points;
  for (const double degrees : {30.0, 15.0, 7.0, 3.0, 1.5}) {
    if (params.quick && (degrees == 15 || degrees == 3)) continue;
    const CubeMap light = sun(size, degrees * pi_d / 180);
    const FivReference truth = reference_by_rays(occluder, light, plane, {V3f(0, 0, 0)});
    for (const V3i& samples : {V3i(24, 13, 12), V3i(48, 25, 20)}) {
      if (params.quick && samples.x != 24 && degrees != 7) continue;
      const FivTable table = bake_fiv(occluder, light, table_params(samples));
      const auto e = irradiance_by_table(table, plane, {V3f(0, 0, 0)}, truth.unshadowed, {});
      // The publication reports 0.1 for one directional light, which a sun of a texel or less is. A table blurs its
      // light over a sample's spacing, which shows less the wider the light is of itself.
      const double spacing = 360.0 / samples.x;
      points.push_back({std::to_string(samples.x) + " x " + std::to_string(samples.y) + " x " +
                            std::to_string(samples.z) + " samples",
                        degrees, shadow_nrmse(e, truth), 0.1 / (1 + 2 * degrees / spacing)});
    }
  }
  return points;
}

FivTable ball_table(const V3i& samples) {
  FivParams params = table_params(samples);
  params.environment_size = 16;
  params.parts = 1;
  return bake_fiv(make_fiv_occluder(ball_scene(1, V3f(0, 0, 0), 32)), uniform_cube(Rgb(1, 1, 1), 32), params);
}

std::vector<StabilityPoint> fiv_straddling(const StabilityParams&) {
  const FivTable six = ball_table({24, 13, 12});
  const FivTable one = first_hemisphere(six);
  constexpr double distance = 1.5;
  // Directions in which interpolation errs differently are averaged over.
  constexpr int directions = 24;
  std::vector<StabilityPoint> points;
  for (int step = 0; step <= 16; ++step) {
    const double height = 1.2 - 2.4 * step / 16;
    const double truth = ball_irradiance(height / distance, 1 / (distance * distance));
    double errors[3] = {0, 0, 0};
    for (int i = 0; i < directions; ++i) {
      const double y = 1 - 2 * (i + 0.5) / directions;
      const double phi = i * 2.399963229728653;
      const double s = std::sqrt(1 - y * y);
      const V3d q = V3d(s * std::cos(phi), y, s * std::sin(phi)) * distance;  // of the receiver
      const V3d towards = -q / distance;
      const V3d side = towards.cross(V3d(0.36, 0.48, 0.8)).normalized();
      const double cosine = height / distance;
      const V3d n = towards * cosine + side * std::sqrt(1 - cosine * cosine);
      const auto hidden = [&](const FivTable& table, Straddling straddling) {
        return double(hidden_irradiance(table, lookup(table, V3f(q)), V3f(n), float(height), straddling).x);
      };
      const double e[3] = {hidden(one, Straddling::bound), hidden(one, Straddling::scale),
                           hidden(six, Straddling::bound)};
      for (int k = 0; k < 3; ++k) errors[k] += std::pow((e[k] - truth) * distance * distance / pi_d, 2) / directions;
    }
    points.push_back({"one vector", height, std::sqrt(errors[0]), {}});
    points.push_back({"one vector, published scale", height, std::sqrt(errors[1]), {}});
    // Six hemispheres bound what is hidden from below; a ball in even light is the bound's hardest case.
    points.push_back({"six hemispheres", height, std::sqrt(errors[2]), std::abs(height) < 1 ? 0.1 : 0.02});
  }
  return points;
}

// Two balls of half-angle alpha at the angle `apart`; the truth is a sum over a fine, even set of directions.
std::vector<StabilityPoint> fiv_overlap(const StabilityParams& params) {
  const FivTable table = ball_table({24, 13, 12});
  constexpr double distance = 2.5;
  const double alpha = std::asin(1 / distance);
  const V3f n(0, 1, 0);
  std::vector<StabilityPoint> points;
  for (int step = 0; step <= 10; ++step) {
    const double apart = 2.5 * alpha * step / 10;
    const V3d a(std::sin(apart / 2) * 0.6, std::cos(apart / 2), std::sin(apart / 2) * 0.8);
    const V3d b(-a.x, a.y, -a.z);
    double truth = 0;
    const int directions = params.quick ? 200'000 : 2'000'000;
    for (int i = 0; i < directions; ++i) {
      const double y = (i + 0.5) / directions;
      const double phi = i * 2.399963229728653;
      const double s = std::sqrt(1 - y * y);
      const V3d w(s * std::cos(phi), y, s * std::sin(phi));
      if (w.dot(a) > std::cos(alpha) || w.dot(b) > std::cos(alpha)) truth += y * 2 * pi_d / directions;
    }
    const std::vector<FivPlacement> occluders{{&table, V3f(a * distance), 1}, {&table, V3f(b * distance), 1}};
    const auto error = [&](FivOverlap overlap) {
      const Rgb e = fiv_irradiance(occluders, V3f(0, 0, 0), n, -1, Rgb(pi, pi, pi), {Straddling::bound, overlap});
      return std::abs((pi_d - double(e.x)) / truth - 1);
    };
    const double x = apart / alpha;
    points.push_back({"each hides its own", x, error(FivOverlap::none), {}});
    points.push_back({"published discs", x, error(FivOverlap::discs), {}});
    // A ball fills its disc, so that common discs are common light; 1536 lights know a cap's edge to 4 %.
    points.push_back({"covers (default)", x, error(FivOverlap::covers), 0.08});
    points.push_back({"product", x, error(FivOverlap::product), {}});
  }
  return points;
}

std::vector<StabilityPoint> fiv_inside_sphere(const StabilityParams& params) {
  const FivOccluder occluder = make_fiv_occluder(bracket_scene());
  const Intersector object(occluder.scene);
  const CubeMap light = coloured_cube(16);
  const FivDirections directions = make_fiv_directions(light);
  std::vector<StabilityPoint> points;
  for (const V3i& samples : {V3i(32, 17, 15), V3i(64, 33, 30)}) {
    FivParams bake = table_params(samples);
    bake.environment_size = 16;
    bake.parts = 1;  // the lights of the truth
    const FivTable table = bake_fiv(occluder, light, bake);
    for (const double r : {0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.5, 2.5}) {
      const int count = params.quick ? 150 : 1000;
      std::vector<V3f> positions;
      for (int i = 0; i < count; ++i) {
        const double y = 1 - 2 * (i + 0.5) / count;
        const double phi = i * 2.399963229728653;
        const double s = std::sqrt(1 - y * y);
        positions.push_back(V3f(V3d(s * std::cos(phi), y, s * std::sin(phi)) * r));
      }
      const FivSums truth = gather_fiv_by_rays(object, directions, positions, 6);
      const std::vector<char> inside = find_inside(object, positions, std::vector<double>(positions.size(), 1.0));
      double squares = 0;
      int outside = 0;
      for (std::size_t i = 0; i < positions.size(); ++i) {
        if (inside[i] != 0) continue;
        ++outside;
        const FivMoments hidden = lookup(table, positions[i]);
        for (std::size_t k = 0; k < 36; ++k)
          squares += std::pow(double(hidden[k]) - double(truth.values[36 * i + k]), 2) / 12;
      }
      // A vector of F, D_x, D_y, D_z and a channel. Close to a surface the hidden light changes within a sample's
      // spacing, which grows with r: up to a third more than such tables reach.
      const bool fine = samples.x == 64;
      points.push_back({std::to_string(samples.x) + " x " + std::to_string(samples.y) + " x " +
                            std::to_string(samples.z) + " samples",
                        r, std::sqrt(squares / outside) / pi_d, r <= 1 ? (fine ? 0.08 : 0.13) : 0.02});
    }
  }
  return points;
}

}  // namespace

std::vector<StabilityCase> stability_fiv_cases() {
  return {
      {.name = "fiv_hard_light",
       .title = "FIV shadows of an ever smaller sun",
       .sentence =
           "Shadows of a sun smaller than the spacing of a table's samples come out blurred, with an error "
           "several times that of a broad light: take more samples, or light a small sun by shadow rays instead.",
       .x_label = "half-angle of the sun, degrees",
       .y_label = "NRMSE of E on the floor",
       .log_x = true,
       .run = fiv_hard_light},
      {.name = "fiv_straddling",
       .title = "An occluder that the receiver's plane cuts",
       .sentence =
           "Where a receiver's plane cuts an occluder one vector knows only what is hidden above and below together; "
           "six hemispheres halve the error (--hemispheres 6).",
       .x_label = "height of the ball's centre over the plane, radii",
       .y_label = "error of the hidden E / E of the ball seen squarely",
       .log_y = false,
       .run = fiv_straddling},
      {.name = "fiv_overlap",
       .title = "Two occluders that hide the same light",
       .sentence =
           "Without correction light hidden by two occluders is taken off twice; common discs, published or as the "
           "default rule takes them, count it once to 5 % for balls, and the product of what each leaves open "
           "does not: keep the default.",
       .x_label = "angle between the balls / their half-angle",
       .y_label = "error of the hidden E / hidden E",
       .log_y = false,
       .run = fiv_overlap},
      {.name = "fiv_inside_sphere",
       .title = "Receivers within the bounding sphere",
       .sentence =
           "Within the bounding sphere of a hollow shape the hidden light changes faster than samples follow: "
           "errors grow several times over those outside, so raise --samples for shapes that reach around things.",
       .x_label = "distance from the centre, bounding radii",
       .y_label = "RMS error of a hidden vector / pi",
       .log_x = true,
       .run = fiv_inside_sphere},
  };
}

}  // namespace ivory
