// Light that is hard to find, or that never ends: tiny emitters, caustics, small openings, white walls.
#include <algorithm>
#include <cmath>

#include "tools/stability/scenes.h"
#include "tools/stability/stability.h"
#include "tracer/path_tracer.h"

namespace ivory {
namespace {

constexpr double pi_d = 3.14159265358979323846;

// E by paths that find light as `strategy` says, from a white Lambertian surface at the point.
double irradiance_by_paths(const StabilityWorld& world, const ProbePoint& at, int samples, DirectStrategy strategy,
                           std::uint64_t stream) {
  Surface white;
  white.p = at.p;
  white.ng = at.n;
  white.ns = at.n;
  white.diffuse_albedo = Rgb(1, 1, 1);
  white.specular_f0 = Rgb(0, 0, 0);
  white.specular_f90 = Rgb(0, 0, 0);
  PathParams params;
  params.strategy = strategy;
  RandomStream random(1, StreamPurpose::test, stream);
  double sum = 0;
  for (int i = 0; i < samples; ++i)
    sum += double(trace_scattered(*world.intersector, *world.lights, white, at.n, params, random).x);
  return sum / samples * pi_d;
}

// Middles of facets of an inward sphere, spread over the part with d.p < limit, looking inward.
std::vector<ProbePoint> sphere_points(const Mesh& mesh, const V3f& d, float limit, std::size_t count) {
  std::vector<ProbePoint> points;
  for (const auto& t : mesh.triangles) {
    const V3f& a = mesh.positions[t.x];
    const V3f middle = (a + mesh.positions[t.y] + mesh.positions[t.z]) / 3;
    if (middle.dot(d) >= limit) continue;
    points.push_back({middle, (mesh.positions[t.y] - a).cross(mesh.positions[t.z] - a).normalized()});
  }
  std::vector<ProbePoint> some;
  for (std::size_t i = 0; i < count; ++i) some.push_back(points[i * points.size() / count]);
  return some;
}

// A square lamp of pi lumen close to the wall of an integrating sphere of albedo 1/2. Direct light by Lambert's
// formula, indirect light Phi / A rho / (1 - rho), the same everywhere; lamps hide so little of the wall (0.3 % at
// most) that noise hides the difference.
std::vector<StabilityPoint> tiny_emitters(const StabilityParams& params) {
  const V3f axis = V3f(0.3F, -0.8F, 0.5F).normalized();  // towards the lamp
  const V3f side = axis.cross(V3f(0, 1, 0)).normalized();
  const V3f up = axis.cross(side);
  const int samples = params.quick ? 256 : 2048;
  std::vector<StabilityPoint> points;
  for (const double size : {0.2, 0.05, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    const auto s = float(size);
    Scene scene;
    scene.name = "tiny emitter";
    const int wall = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
    const V3f middle = axis * 0.985F;
    Mesh lamp = make_quad(middle - (side + up) * (s / 2), side * s, up * s, 0);
    if ((lamp.positions[1] - lamp.positions[0]).cross(lamp.positions[2] - lamp.positions[0]).dot(axis) > 0)
      for (auto& t : lamp.triangles) std::swap(t.y, t.z);
    // By the corners as they are in single precision: a micrometre is sixteen units in their last place.
    const double area = surface_area_m2(lamp);
    const auto radiance = float(1 / area);
    lamp.material = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F), Rgb(radiance, radiance, radiance));
    const std::vector<V3d> corners{V3d(lamp.positions[0]), V3d(lamp.positions[1]), V3d(lamp.positions[2]),
                                   V3d(lamp.positions[3])};
    add_mesh(scene, std::move(lamp));
    const Mesh sphere = make_inward_sphere(4, wall);
    const double indirect = pi_d / surface_area_m2(sphere);
    const std::vector<ProbePoint> probes = sphere_points(sphere, axis, 0.3F, 24);
    add_mesh(scene, sphere);
    const StabilityWorld world(std::move(scene));

    GridBakeParams bake;
    bake.resolution = V3i(8, 8, 8);
    bake.photons = params.quick ? 60'000 : 300'000;
    const IrradianceGrid grid = finish(bake_grid_sums(*world.intersector, *world.lights, bake));
    double path = 0;
    double chance = 0;
    double by_grid = 0;
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const ProbePoint& at = probes[i];
      const double direct = polygon_irradiance(corners, V3d(at.p), V3d(at.n)) / area;
      const double e = direct + indirect;
      path += std::pow(irradiance_by_paths(world, at, samples, DirectStrategy::mis, i) / e - 1, 2);
      chance += std::pow(irradiance_by_paths(world, at, samples, DirectStrategy::bsdf, i) / e - 1, 2);
      const Rgb read = lookup_irradiance(grid, world.intersector.get(), Guard::rays, at.p, at.n, at.n, {});
      by_grid += std::pow(double(read.x) / indirect - 1, 2);
    }
    const auto n = double(probes.size());
    // A path's indirect part varies by about itself, which is half of E: 0.5 / sqrt(256) = 3 % of noise.
    points.push_back({"path", size, std::sqrt(path / n), 0.08});
    points.push_back({"path, lamps met by chance", size, std::sqrt(chance / n), {}});
    // Noise of 60,000 photons and the flat voxels along the round wall.
    points.push_back({"grid, indirect light", size, std::sqrt(by_grid / n), 0.06});
  }
  return points;
}

// Sunlight along +x meets a mirror at 45 degrees and falls straight down on a black floor, as a bright strip of the
// mirror's width with E = 1 lux; no light reaches the floor otherwise.
std::vector<StabilityPoint> caustics(const StabilityParams& params) {
  constexpr double voxel = 0.1;
  std::vector<StabilityPoint> points;
  for (const double voxels : {0.25, 0.5, 1.0, 2.0, 3.0, 4.0, 8.0}) {
    const auto w = float(voxels * voxel);
    Scene scene;
    scene.name = "caustic";
    const int black = add_lambert(scene, Rgb(0, 0, 0));
    Material mirror;
    mirror.roughness = 0;
    scene.materials.push_back(mirror);
    add_mesh(scene, make_quad({-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, black));
    add_mesh(scene, make_quad({-w / 2, w / 2, -0.5F}, {w, -w, 0}, {0, 0, 1}, black + 1));
    scene.lights.push_back(DirectionalLight{V3f(1, 0, 0), Rgb(1, 1, 1)});
    const StabilityWorld world(std::move(scene));
    GridBakeParams bake;
    bake.voxel_size_m = float(voxel);
    bake.photons = params.quick ? 400'000 : 1'000'000;
    const IrradianceGrid grid = finish(bake_grid_sums(*world.intersector, *world.lights, bake));
    const auto read = [&](double x, double z) {
      const V3f n(0, 1, 0);
      return double(lookup_irradiance(grid, world.intersector.get(), Guard::rays, V3f(V3d(x, -1, z)), n, n, {}).x);
    };
    double middle = 0;
    double by_paths = 0;
    constexpr int places = 16;  // along the strip
    for (int i = 0; i < places; ++i) {
      const double z = 0.6 * ((i + 0.5) / places - 0.5);
      middle += read(0, z) / places;
      by_paths += irradiance_by_paths(world, {V3f(V3d(0, -1, z)), V3f(0, 1, 0)}, params.quick ? 256 : 4096,
                                      DirectStrategy::mis, std::uint64_t(i)) /
                  places;
    }
    double flux = 0;
    constexpr int lattice = 160;
    for (int i = 0; i < lattice; ++i) {
      for (int j = 0; j < lattice; ++j)
        flux += read(2 * ((i + 0.5) / lattice - 0.5), 2 * ((j + 0.5) / lattice - 0.5)) * 4 / (lattice * lattice);
    }
    // Cells of one voxel between which is interpolated see 1.5 voxels to either side: narrower strips lose their peak,
    // down to at least half of w / voxel. n photons of a disc of about 1.5 m radius hit the mirror.
    const double noise = 4 / std::sqrt(double(bake.photons) * double(w) / 7);
    points.push_back({"grid, middle of the caustic", voxels, std::abs(middle - 1),
                      std::min(1.0, (voxels < 3 ? 1 - 0.5 * std::min(1.0, voxels) : 0.0) + noise + 0.02)});
    points.push_back({"grid, all its light", voxels, std::abs(flux / double(w) - 1), noise + 0.02});
    points.push_back({"path, middle of the caustic", voxels, std::abs(by_paths - 1), {}});
  }
  return points;
}

// A black room of 2 m under a uniform sky of 1 nit, with a square hole in the ceiling, or a lamp of 1 nit in its place:
// the same light on the floor, by Lambert's formula.
Scene make_hole_room(float hole, bool lamp) {
  Scene scene;
  scene.name = "room with a hole";
  const int black = add_lambert(scene, Rgb(0, 0, 0));
  Mesh room = make_room(V3f(-1, -1, -1), V3f(1, 1, 1), black);
  room.triangles.erase(room.triangles.begin() + 6, room.triangles.begin() + 8);  // the ceiling
  add_mesh(scene, room);
  const float h = hole / 2;
  add_mesh(scene, make_quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 1 - h}, black));
  add_mesh(scene, make_quad({-1, 1, h}, {2, 0, 0}, {0, 0, 1 - h}, black));
  add_mesh(scene, make_quad({-1, 1, -h}, {1 - h, 0, 0}, {0, 0, hole}, black));
  add_mesh(scene, make_quad({h, 1, -h}, {1 - h, 0, 0}, {0, 0, hole}, black));
  if (lamp) {
    add_mesh(scene, make_quad({-h, 1, -h}, {hole, 0, 0}, {0, 0, hole}, add_lambert(scene, Rgb(0, 0, 0), Rgb(1, 1, 1))));
  } else {
    scene.environment = uniform_environment(Rgb(1, 1, 1));
  }
  return scene;
}

std::vector<StabilityPoint> nearly_closed(const StabilityParams& params) {
  const int samples = params.quick ? 256 : 4096;
  const std::uint64_t photons = params.quick ? 100'000 : 1'000'000;
  std::vector<StabilityPoint> points;
  for (const double hole : {1.0, 0.5, 0.2, 0.1, 0.05, 0.02}) {
    const double h = hole / 2;
    const std::vector<V3d> corners{{-h, 1, -h}, {h, 1, -h}, {h, 1, h}, {-h, 1, h}};
    for (const bool lamp : {false, true}) {
      const StabilityWorld world(make_hole_room(float(hole), lamp));
      GridBakeParams bake;
      bake.resolution = V3i(12, 12, 12);
      bake.photons = photons;
      const IrradianceGrid grid = bake_all_light(world, bake);
      double squares = 0;
      double read = 0;
      double true_sum = 0;
      double least = 1;
      constexpr int side = 6;
      for (int i = 0; i < side * side; ++i) {
        const V3f p(1.6F * ((float(i % side) + 0.44F) / side - 0.5F), -1,
                    1.6F * ((float(i) / side + 0.37F) / side - 0.5F));
        const V3f n(0, 1, 0);
        const double e = polygon_irradiance(corners, V3d(p), V3d(n));
        squares +=
            std::pow(irradiance_by_paths(world, {p, n}, samples, DirectStrategy::mis, std::uint64_t(i)) / e - 1, 2);
        read += double(lookup_irradiance(grid, world.intersector.get(), Guard::rays, p, n, n, {}).x);
        true_sum += e;
        least = std::min(least, e / pi_d);
      }
      const std::string light = lamp ? ", lamp in the hole" : ", sky";
      // A share f = E / (pi L) of a point's paths finds the hole: relative variance 1 / f at most. Of the photons that
      // enter through a disc of radius R a share hole^2 / (4 pi R^2) finds it, R = 0.505 times the room's diagonal.
      const double noise = lamp ? 0.1 : 3 / std::sqrt(least * samples);
      points.push_back({"path" + light, hole, std::sqrt(squares / (side * side)), noise});
      const double radius = 0.505 * std::sqrt(12.0);
      const double entered = lamp ? double(photons) : double(photons) * hole * hole / (4 * pi_d * radius * radius);
      // About a quarter of what enters falls on the floor. The lowest vertices stand half a voxel of 1/6 m nearer to
      // the hole: (2 / (2 - 1/12))^2 - 1 = 9 %.
      points.push_back(
          {"grid, mean on the floor" + light, hole, std::abs(read / true_sum - 1), 4 / std::sqrt(entered / 4) + 0.09});
    }
  }
  return points;
}

// Integrating sphere, a point light at its centre: indirect E = Phi / A rho / (1 - rho). A photon's number of bounces
// is geometric, so the sum over one photon varies by its own mean, whatever the albedo, and n photons measure to 1 /
// sqrt(n). A limit of N bounces takes rho^N away.
std::vector<StabilityPoint> albedo_to_one(const StabilityParams& params) {
  std::vector<StabilityPoint> points;
  for (const double albedo : {0.5, 0.8, 0.9, 0.95, 0.98, 0.99, 0.995, 0.999}) {
    Scene scene;
    scene.name = "white sphere";
    const auto rho = float(albedo);
    const Mesh sphere = make_inward_sphere(4, add_lambert(scene, Rgb(rho, rho, rho)));
    const std::vector<ProbePoint> probes = sphere_points(sphere, V3f(0, 1, 0), 2, 16);
    const double direct = 4 * pi_d / surface_area_m2(sphere);
    const double indirect = direct * double(rho) / (1 - double(rho));
    add_mesh(scene, sphere);
    scene.lights.push_back(PointLight{V3f(0, 0, 0), Rgb(1, 1, 1)});
    const StabilityWorld world(std::move(scene));
    for (const int bounces : {1000, 20'000}) {
      if (bounces > 1000 && albedo < 0.99) continue;
      GridBakeParams bake;
      bake.resolution = V3i(8, 8, 8);
      bake.photons = params.quick ? 1500 : 8000;
      bake.max_bounces = bounces;
      const IrradianceGrid grid = finish(bake_grid_sums(*world.intersector, *world.lights, bake));
      double mean = 0;
      for (const ProbePoint& at : probes) {
        const Rgb e = lookup_irradiance(grid, world.intersector.get(), Guard::rays, at.p, at.n, at.n, {});
        mean += double(e.x) / double(probes.size());
      }
      points.push_back({bounces == 1000 ? "grid, 1000 bounces (default)" : "grid, 20,000 bounces", 1 - albedo,
                        std::abs(mean / indirect - 1),
                        4 / std::sqrt(double(bake.photons)) + 0.02 + std::pow(albedo, bounces)});
    }
    double squares = 0;
    const int samples = params.quick ? 64 : 512;
    for (std::size_t i = 0; i < probes.size(); ++i)
      squares +=
          std::pow(irradiance_by_paths(world, probes[i], samples, DirectStrategy::mis, i) / (direct + indirect) - 1, 2);
    // A path of geometric length too, and three standard errors of a standard deviation from 16 points.
    points.push_back({"path", 1 - albedo, std::sqrt(squares / double(probes.size())),
                      1.6 / std::sqrt(double(samples)) + std::pow(albedo, 1000)});
  }
  return points;
}

}  // namespace

std::vector<StabilityCase> stability_light_cases() {
  return {
      {.name = "tiny_emitters",
       .title = "Lamps of one power and ever smaller size",
       .sentence =
           "Paths and photons that choose a point on the lamp keep their accuracy down to a lamp of a micrometre; "
           "only light that must be met by chance (a lamp's reflection in gloss) is lost: give such lamps a size.",
       .x_label = "side of the lamp, m (sphere of 1 m)",
       .y_label = "RMS error / E",
       .log_x = true,
       .run = tiny_emitters},
      {.name = "caustics",
       .title = "Light by way of a mirror",
       .sentence =
           "A grid keeps all light of a caustic and its place, but blurs it over a voxel and a half, so that strips "
           "narrower than three voxels lose their peak; the path tracer misses light of punctual lights by way of "
           "mirrors altogether and is no reference there: use smaller voxels.",
       .x_label = "width of the caustic, voxels",
       .y_label = "error / E",
       .log_x = true,
       .run = caustics},
      {.name = "nearly_closed",
       .title = "Rooms that light enters by a small hole",
       .sentence =
           "Noise of sky light through a hole grows as one over the hole's side, for photons and paths alike, as "
           "most miss it: put an emissive surface into the opening, which keeps the noise level.",
       .x_label = "side of the hole, m (room of 2 m)",
       .y_label = "error / E",
       .log_x = true,
       .run = nearly_closed},
      {.name = "albedo_to_one",
       .title = "Walls that absorb ever less",
       .sentence =
           "Neither bias nor noise grows with the albedo until light outlives the limit on bounces, which takes "
           "albedo^1000 of it away: raise --bounces where closed rooms are whiter than 0.995.",
       .x_label = "1 - albedo",
       .y_label = "error / E",
       .log_x = true,
       .run = albedo_to_one},
  };
}

}  // namespace ivory
