// Light that is hard to find, or that never ends: tiny emitters, caustics, small openings, white walls.
#include <algorithm>
#include <cmath>

#include "grid/field/resolve.h"
#include "tools/stability/scenes.h"
#include "tools/stability/stability.h"

namespace ivory {
namespace {

// E in lux by paths that find light as `strategy` says.
std::vector<double> irradiance_by_paths(const LitScene& world, const std::vector<ProbePoint>& points, int samples,
                                        DirectStrategy strategy = DirectStrategy::mis) {
  ProbeParams params;
  params.samples = samples;
  params.strategy = strategy;
  std::vector<double> e;
  for (const ProbeResult& r : probe_scene(world, points, params)) e.push_back(double(r.e.x));
  return e;
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
    const LitScene world = make_lit_scene(std::move(scene));

    GridBakeParams bake;
    bake.resolution = V3i(8, 8, 8);
    bake.photons = params.quick ? 60'000 : 300'000;
    const IrradianceGrid grid = resolve(bake_grid_sums(world, bake));
    const std::vector<double> by_paths = irradiance_by_paths(world, probes, samples);
    const std::vector<double> by_chance = irradiance_by_paths(world, probes, samples, DirectStrategy::bsdf);
    double path = 0;
    double chance = 0;
    double by_grid = 0;
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const ProbePoint& at = probes[i];
      const double direct = polygon_irradiance(corners, V3d(at.p), V3d(at.n)) / area;
      const double e = direct + indirect;
      path += std::pow(by_paths[i] / e - 1, 2);
      chance += std::pow(by_chance[i] / e - 1, 2);
      const Rgb read = lookup_irradiance(grid, &world.intersector, at.p, at.n, at.n, {.guard = Guard::rays});
      by_grid += std::pow(double(read.x) / indirect - 1, 2);
    }
    const auto n = double(probes.size());
    // A path's indirect part varies by about itself, which is half of E: 0.5 / sqrt(256) = 3 % of noise at most.
    points.push_back({"path", size, std::sqrt(path / n), 0.56 / std::sqrt(double(samples))});
    points.push_back({"path, lamps met by chance", size, std::sqrt(chance / n), {}});
    // A point reads some 4 of the 300 cells along the wall. Each sees a few per mille of the photons, which bounce
    // once on average: 4 % for 60,000. The other part of the bound is the flat cells along the round wall.
    points.push_back({"grid, indirect light", size, std::sqrt(by_grid / n),
                      0.01 + 0.05 * std::sqrt(60'000.0 / double(bake.photons))});
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
    const LitScene world = make_lit_scene(std::move(scene));
    GridBakeParams bake;
    bake.voxel_size_m = float(voxel);
    bake.photons = params.quick ? 400'000 : 1'000'000;
    const IrradianceGrid grid = resolve(bake_grid_sums(world, bake));
    const auto read = [&](double x, double z) {
      const V3f n(0, 1, 0);
      return double(lookup_irradiance(grid, &world.intersector, V3f(V3d(x, -1, z)), n, n, {.guard = Guard::rays}).x);
    };
    double middle = 0;
    std::vector<ProbePoint> probes;
    constexpr int places = 16;  // along the strip
    for (int i = 0; i < places; ++i) {
      const double z = 0.6 * ((i + 0.5) / places - 0.5);
      middle += read(0, z) / places;
      probes.push_back({V3f(V3d(0, -1, z)), V3f(0, 1, 0)});
    }
    double by_paths = 0;
    for (const double e : irradiance_by_paths(world, probes, params.quick ? 256 : 4096)) by_paths += e / places;
    double flux = 0;
    constexpr int lattice = 160;
    for (int i = 0; i < lattice; ++i) {
      for (int j = 0; j < lattice; ++j)
        flux += read(2 * ((i + 0.5) / lattice - 0.5), 2 * ((j + 0.5) / lattice - 0.5)) * 4 / (lattice * lattice);
    }
    // The middle stands between two cells of one voxel, which share what falls on both: w of two voxels' width, or all.
    // Photons come through a disc of 7 m^2, so that photons x area / 7 fall on an area: that which all light falls on
    // is w x 1 m, that of which the middle's places read is 0.7 m long and two voxels wide at most. Four deviations,
    // and 2 % for where the mirror's ends and the cells' share of them are.
    const double share = std::min(1.0, voxels / 2);
    const auto noise = [&](double area) { return 4 / std::sqrt(double(bake.photons) * area / 7) + 0.02; };
    points.push_back({"grid, middle of the caustic", voxels, std::abs(middle - 1), {}});
    points.push_back({"grid, middle beside what its two cells share", voxels, std::abs(middle / share - 1),
                      noise(0.7 * std::min(double(w), 2 * voxel))});
    points.push_back({"grid, all its light", voxels, std::abs(flux / double(w) - 1), noise(double(w))});
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

// Sky light at the same work for all sizes shows the noise that grows; at work in inverse proportion to the hole's
// area it must be right. A lamp in the hole is held to its truth at the same work for all.
std::vector<StabilityPoint> nearly_closed(const StabilityParams& params) {
  const int samples = params.quick ? 256 : 4096;
  const std::uint64_t photons = params.quick ? 100'000 : 1'000'000;
  const double smallest = params.quick ? 0.1 : 0.05;  // that the growing work is spent on
  const int hits = params.quick ? 160 : 320;          // that it leaves, of paths as of photons
  const double radius = 0.505 * std::sqrt(12.0);      // of the disc that photons enter through
  const V3f n(0, 1, 0);
  std::vector<ProbePoint> floor;
  constexpr int side = 6;
  floor.reserve(side * side);
  for (int i = 0; i < side * side; ++i) {
    floor.push_back(
        {V3f(1.6F * ((float(i % side) + 0.44F) / side - 0.5F), -1, 1.6F * ((float(i) / side + 0.37F) / side - 0.5F)),
         n});
  }

  std::vector<StabilityPoint> points;
  for (const double hole : {1.0, 0.5, 0.2, 0.1, 0.05, 0.02}) {
    const double h = hole / 2;
    const std::vector<V3d> corners{{-h, 1, -h}, {h, 1, -h}, {h, 1, h}, {-h, 1, h}};
    std::vector<double> truth;
    double mean = 0;
    for (const ProbePoint& at : floor) {
      truth.push_back(polygon_irradiance(corners, V3d(at.p), V3d(n)));
      mean += truth.back() / double(floor.size());
    }
    const auto of_paths = [&](const LitScene& world, int paths) {
      double squares = 0;
      double sum = 0;
      const std::vector<double> e = irradiance_by_paths(world, floor, paths);
      for (std::size_t i = 0; i < floor.size(); ++i) {
        squares += std::pow(e[i] / truth[i] - 1, 2) / double(floor.size());
        sum += e[i] / double(floor.size());
      }
      return std::array<double, 2>{std::sqrt(squares), std::abs(sum / mean - 1)};
    };
    const auto of_grid = [&](const LitScene& world, std::uint64_t count) {
      GridBakeParams bake;
      bake.resolution = V3i(12, 12, 12);
      bake.photons = count;
      const IrradianceGrid grid = bake_all_light(world, bake);
      double sum = 0;
      for (const ProbePoint& at : floor)
        sum += double(lookup_irradiance(grid, &world.intersector, at.p, n, n, {.guard = Guard::rays}).x);
      return std::abs(sum / double(floor.size()) / mean - 1);
    };
    // The lowest vertices stand half a voxel of 1/6 m nearer to the hole: (2 / (2 - 1/12))^2 - 1 = 9 %.
    constexpr double nearer = 0.09;

    const LitScene lamp = make_lit_scene(make_hole_room(float(hole), true));
    // Points on the lamp are chosen evenly: over its breadth `hole` cosines and distances squared, 2 m away, vary by
    // some hole / 6 about their mean, and the mean of 256 is off by a sixteenth of that.
    points.push_back({"path, lamp in the hole", hole, of_paths(lamp, samples)[0], 0.32 * hole / std::sqrt(samples)});
    // About a quarter of a lamp's photons fall on the floor.
    points.push_back({"grid, mean on the floor, lamp in the hole", hole, of_grid(lamp, photons),
                      4 / std::sqrt(double(photons) / 4) + nearer});

    const LitScene sky = make_lit_scene(make_hole_room(float(hole), false));
    points.push_back({"path, sky", hole, of_paths(sky, samples)[0], {}});
    points.push_back({"grid, mean on the floor, sky", hole, of_grid(sky, photons), {}});
    if (hole < smallest) continue;
    // A share E / (pi L) of a point's paths finds the hole. Of the photons that enter through the disc a share
    // hole^2 / (4 pi R^2) does, and a quarter of those falls on the floor. Four deviations of so many hits.
    const double noise = 4 / std::sqrt(double(hits));
    const int paths = int(hits / (mean / pi_d * double(floor.size())));
    const auto enter = std::uint64_t(4 * hits * 4 * pi_d * radius * radius / (hole * hole));
    points.push_back(
        {"path, mean on the floor, sky, the more paths the smaller", hole, of_paths(sky, paths)[1], noise});
    points.push_back(
        {"grid, mean on the floor, sky, the more photons the smaller", hole, of_grid(sky, enter), noise + nearer});
  }
  return points;
}

// Integrating sphere, a point light at its centre: indirect E = Phi / A rho / (1 - rho). A photon's number of bounces
// is geometric, so the sum over one photon varies by its own mean, whatever the albedo, and n photons measure to 1 /
// sqrt(n). A limit of N bounces takes rho^N of it away: the truth of all but the series that shows that.
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
    const LitScene world = make_lit_scene(std::move(scene));
    for (const int bounces : {1000, 20'000}) {
      if (bounces > 1000 && albedo < 0.99) continue;
      GridBakeParams bake;
      bake.resolution = V3i(8, 8, 8);
      bake.photons = params.quick ? 1500 : 8000;
      bake.max_bounces = bounces;
      const IrradianceGrid grid = resolve(bake_grid_sums(world, bake));
      double mean = 0;
      for (const ProbePoint& at : probes) {
        const Rgb e = lookup_irradiance(grid, &world.intersector, at.p, at.n, at.n, {.guard = Guard::rays});
        mean += double(e.x) / double(probes.size());
      }
      // Four deviations, and the flat cells along the round wall.
      points.push_back({bounces == 1000 ? "grid, 1000 bounces" : "grid, 20,000 bounces", 1 - albedo,
                        std::abs(mean / (indirect * (1 - std::pow(double(rho), bounces))) - 1),
                        4 / std::sqrt(double(bake.photons)) + 0.02});
      if (bounces == 1000) {
        points.push_back(
            {"grid, 1000 bounces (default) of endless ones", 1 - albedo, std::abs(mean / indirect - 1), {}});
      }
    }
    double squares = 0;
    const int samples = params.quick ? 64 : 512;
    const double truth = direct + indirect * (1 - std::pow(double(rho), 1000));
    for (const double e : irradiance_by_paths(world, probes, samples)) squares += std::pow(e / truth - 1, 2);
    // A path of geometric length too, and three standard errors of a standard deviation from 16 points.
    points.push_back({"path, 1000 bounces", 1 - albedo, std::sqrt(squares / double(probes.size())),
                      1.6 / std::sqrt(double(samples))});
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
           "narrower than two to three voxels lose their peak; the path tracer finds light of punctual lights by way "
           "of mirrors by rare bright samples only, so that most of it is missing from any picture, and is no "
           "reference there: use smaller voxels.",
       .x_label = "width of the caustic, voxels",
       .y_label = "error / E",
       .log_x = true,
       .run = caustics},
      {.name = "nearly_closed",
       .title = "Rooms that light enters by a small hole",
       .sentence =
           "Noise of sky light through a hole grows as one over the hole's side, for photons and paths alike, as "
           "most miss it, until nothing is found; work in inverse proportion to the hole's area keeps it level, and so "
           "does an emissive surface in the opening at the same work for all: put one there.",
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
