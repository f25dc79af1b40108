// The bundled scenes keep their promises: they are what make_scenes.py writes, they load without a
// remark, they are closed where they say so, and they hold the light and the paint that scenes/README.md states.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "grid/base/types.h"
#include "tests/support/paths.h"
#include "tracer/core/scene.h"
#include "tracer/gltf/loader.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

const fs::path scenes_folder = fs::path(source_folder) / "scenes";

struct Expected {
  const char* file;
  int open_edges;  // edges without exactly one partner running the other way
  V3f size_m;
  float surface_area_m2;
  int point_lights;
  int emissive_triangles;
  float strength;  // candela or nits of the brightest channel
  std::vector<Rgb> albedos;
  int cameras;
};
void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.file; }

const Rgb grey(0.7F), half(0.5F), white(0.75F);
const Rgb cornell_white(0.7382F, 0.7358F, 0.7401F), cornell_green(0.069F, 0.3983F, 0.0867F),
    cornell_red(0.49F, 0.0503F, 0.0511F);

// Areas by hand. Leak: 2 x 66 inside, and outside the box of 8.06 x 3.04 x 3.04 m. Rooms: 90.4 inside,
// plus what cupboard, box and table add beside the floor that they cover; outside 5.04 x 2.84 x 4.04 m.
const float leak_area = 2 * 66 + 2 * (2 * 8.06F * 3.04F + 3.04F * 3.04F);
const float furniture_area = 4 * 0.7F * 1.8F + 4 * 0.8F * 0.6F + 2 * 1.5F * 0.8F + 2 * (1.5F + 0.8F) * 0.05F +
                             4 * (4 * 0.06F * 0.70F - 2 * 0.06F * 0.06F);
const float room_area =
    2 * (5 * 2.8F + 5 * 4 + 2.8F * 4) + furniture_area + 2 * (5.04F * 2.84F + 5.04F * 4.04F + 2.84F * 4.04F);

// Turning a box by 30 degrees about Y widens its bounds.
V3f turned(const V3f& size) {
  const float c = std::cos(pi / 6);
  const float s = 0.5F;
  return {c * size.x + s * size.z, size.y, s * size.x + c * size.z};
}

const std::vector<Expected>& expectations() {
  const std::vector<Rgb> cornell{cornell_white, cornell_green, cornell_red, Rgb(0.78F)};
  // Open in the Cornell box: the rim of its front, and the blocks' feet.
  static const std::vector<Expected> all{
      {"cornell_box.gltf", 12, {0.556F, 0.5488F, 0.5592F}, 1.9206957F, 0, 2, 20.6549F, cornell, 1},
      {"two_rooms.gltf",
       0,
       {5.4F, 3.4F, 15.4F},
       0,
       0,
       2,
       60,
       {white, Rgb(0.65F, 0.12F, 0.10F), Rgb(0.12F, 0.20F, 0.65F), Rgb(0.75F, 0.45F, 0.15F)},
       2},
      {"leak_axis.gltf", 0, {8.06F, 3.04F, 3.04F}, leak_area, 1, 0, 5, {grey}, 2},
      {"leak_rotated.gltf", 0, turned({8.06F, 3.04F, 3.04F}), leak_area, 1, 0, 5, {grey}, 2},
      {"room_boxes.gltf", 0, {5.04F, 2.84F, 4.04F}, room_area, 1, 0, 6, {grey}, 1},
      {"room_boxes_rotated.gltf", 0, turned({5.04F, 2.84F, 4.04F}), room_area, 1, 0, 6, {grey}, 1},
      {"integrating_sphere.glb", 0, V3f(2), 4 * pi, 1, 0, 1, {half}, 1},
      {"furnace_box.gltf", 0, V3f(2), 24, 0, 12, 1, {half}, 1},
      {"detail_low.glb",
       0,
       {4.4F, 3.4F, 4.4F},
       0,
       0,
       2,
       20,
       {white, Rgb(0.6F, 0.15F, 0.12F), Rgb(0.15F, 0.5F, 0.18F)},
       1},
      {"detail_high.glb",
       0,
       {4.4F, 3.4F, 4.4F},
       0,
       0,
       2,
       20,
       {white, Rgb(0.6F, 0.15F, 0.12F), Rgb(0.15F, 0.5F, 0.18F)},
       1},
  };
  return all;
}

std::string read_bytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

using Position = std::array<float, 3>;
Position key(const V3f& p) { return {p.x, p.y, p.z}; }

// Edges of all the scene's triangles, welded by position within each node's mesh: how many lack
// exactly one partner that runs the other way.
int open_edges(const Scene& scene) {
  int open = 0;
  // The loader makes one mesh of each primitive: meshes placed by the same matrix belong together.
  std::map<std::pair<Position, Position>, int> edges;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    for (const auto& t : mesh.triangles) {
      const std::array<Position, 3> p{key(mesh.positions[t.x] * instance.to_world),
                                      key(mesh.positions[t.y] * instance.to_world),
                                      key(mesh.positions[t.z] * instance.to_world)};
      for (std::size_t i = 0; i < 3; ++i) ++edges[{p[i], p[(i + 1) % 3]}];
    }
  }
  for (const auto& [edge, count] : edges) {
    const auto partner = edges.find({edge.second, edge.first});
    if (count != 1 || partner == edges.end() || partner->second != 1) ++open;
  }
  return open;
}

void check_contents(const Scene& scene, const Expected& expected) {
  EXPECT_EQ(int(scene.cameras.size()), expected.cameras);
  EXPECT_TRUE(scene.images.empty());
}

void check_size(const Scene& scene, const Expected& expected) {
  const V3f size = bounds(scene).size();
  // Rounding of float positions; the sphere's facets lie up to 0.1 % off its radius.
  const float tolerance = expected.file == std::string("integrating_sphere.glb") ? 2e-3F : 1e-5F;
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(size[i], expected.size_m[i], tolerance) << "axis " << i;

  if (expected.surface_area_m2 == 0) return;
  double area = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    for (const auto& t : mesh.triangles) {
      const V3f a = mesh.positions[t.x] * instance.to_world;
      const V3f b = mesh.positions[t.y] * instance.to_world;
      const V3f c = mesh.positions[t.z] * instance.to_world;
      area += 0.5 * double((b - a).cross(c - a).length());
    }
  }
  // Thousands of float triangles, each to a few units in the last place.
  EXPECT_NEAR(area, double(expected.surface_area_m2), 1e-5 * double(expected.surface_area_m2));
}

void check_lights(const Scene& scene, const Expected& expected) {
  EXPECT_EQ(int(scene.lights.size()), expected.point_lights);
  for (const PunctualLight& light : scene.lights) {
    ASSERT_TRUE(std::holds_alternative<PointLight>(light));
    EXPECT_FLOAT_EQ(max_component(std::get<PointLight>(light).intensity_cd), expected.strength);
  }
  int emissive = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
    const Rgb emission = scene.materials[std::size_t(mesh.material)].emission;
    if (is_black(emission)) continue;
    emissive += int(mesh.triangles.size());
    EXPECT_FLOAT_EQ(max_component(emission), expected.strength);
  }
  EXPECT_EQ(emissive, expected.emissive_triangles);
}

void check_paint(const Scene& scene, const Expected& expected) {
  std::vector<bool> found(expected.albedos.size(), false);
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[std::size_t(mesh.material)];
    EXPECT_EQ(material.specular, 0) << material.name;
    EXPECT_EQ(material.metallic, 0) << material.name;
    EXPECT_FALSE(material.double_sided) << material.name;
    const auto& albedos = expected.albedos;
    const auto match =
        std::find_if(albedos.begin(), albedos.end(), [&](const Rgb& a) { return a == material.base_color; });
    if (match == albedos.end()) {
      ADD_FAILURE() << material.name << " " << material.base_color;
    } else {
      found[std::size_t(match - albedos.begin())] = true;
    }
  }
  EXPECT_TRUE(std::all_of(found.begin(), found.end(), [](bool f) { return f; }));
}

void check_winding(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.normals.empty()) continue;
    for (const auto& t : mesh.triangles) {
      const V3f ng = (mesh.positions[t.y] - mesh.positions[t.x]).cross(mesh.positions[t.z] - mesh.positions[t.x]);
      for (const std::uint32_t v : {t.x, t.y, t.z}) ASSERT_GT(ng.dot(mesh.normals[v]), 0) << mesh.name;
    }
  }
}

// One test a scene: each runs as a process of its own, and starting that takes longer than the checks.
class BundledScene : public testing::TestWithParam<Expected> {};

TEST_P(BundledScene, KeepsItsPromises) {
  const LoadedScene loaded = load_gltf((scenes_folder / GetParam().file).string());
  EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
  EXPECT_EQ(open_edges(loaded.scene), GetParam().open_edges);
  check_contents(loaded.scene, GetParam());
  check_size(loaded.scene, GetParam());
  check_lights(loaded.scene, GetParam());
  check_paint(loaded.scene, GetParam());
  check_winding(loaded.scene);
}

INSTANTIATE_TEST_SUITE_P(Scenes, BundledScene, testing::ValuesIn(expectations()), [](const auto& parameter) {
  std::string name = parameter.param.file;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

TEST(BundledScenes, AreWhatTheScriptWrites) {
  if (std::system("python3 -c 'import sys' >/dev/null 2>&1") != 0) GTEST_SKIP() << "python3 is not installed";
  const fs::path folder = fs::path(output_folder) / "make_scenes";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const std::string command = "PYTHONDONTWRITEBYTECODE=1 python3 '" + (scenes_folder / "make_scenes.py").string() +
                              "' '" + folder.string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  int written = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path committed = scenes_folder / entry.path().filename();
    EXPECT_TRUE(read_bytes(entry.path()) == read_bytes(committed)) << committed << " is not what make_scenes.py writes";
    ++written;
  }
  int kept = 0;
  for (const auto& entry : fs::directory_iterator(scenes_folder)) {
    const fs::path suffix = entry.path().extension();
    if (suffix == ".gltf" || suffix == ".glb" || suffix == ".csv" || suffix == ".hdr") {
      ++kept;
      EXPECT_LT(entry.file_size(), 1U << 20U) << entry.path();
    }
  }
  EXPECT_EQ(kept, written);
}

// Probe points float 1 mm off a surface whose normal they carry.
TEST(BundledScenes, ProbePointsLieOnTheirWalls) {
  const std::vector<std::pair<const char*, const char*>> files{
      {"leak_axis", "leak_axis_dark_points.csv"},       {"leak_axis", "leak_axis_lit_points.csv"},
      {"leak_rotated", "leak_rotated_dark_points.csv"}, {"leak_rotated", "leak_rotated_lit_points.csv"},
      {"room_boxes", "room_boxes_points.csv"},          {"room_boxes_rotated", "room_boxes_rotated_points.csv"}};
  for (const auto& [scene_name, points_name] : files) {
    const Scene scene = load_gltf((scenes_folder / (std::string(scene_name) + ".gltf")).string()).scene;
    std::ifstream in(scenes_folder / points_name);
    std::string line;
    std::getline(in, line);
    ASSERT_EQ(line, "x,y,z,nx,ny,nz");
    int points = 0;
    while (std::getline(in, line)) {
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream words(line);
      V3f p, n;
      words >> p.x >> p.y >> p.z >> n.x >> n.y >> n.z;
      ASSERT_TRUE(words) << points_name;
      ++points;
      ASSERT_NEAR(n.length(), 1, 1e-5F);
      bool on_surface = false;
      for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
        for (const auto& t : mesh.triangles) {
          const V3f a = mesh.positions[t.x] * instance.to_world;
          const V3f b = mesh.positions[t.y] * instance.to_world;
          const V3f c = mesh.positions[t.z] * instance.to_world;
          const V3f ng = (b - a).cross(c - a).normalized();
          // 10 micrometres: seven digits of CSV and float rounding at 8 m stay below 2.
          if (ng.dot(n) < 0.9999F || std::abs((p - a).dot(n) - 1e-3F) > 1e-5F) continue;
          const auto inside = [&](const V3f& u, const V3f& v) { return (v - u).cross(p - u).dot(ng) >= -1e-5F; };
          on_surface = on_surface || (inside(a, b) && inside(b, c) && inside(c, a));
        }
      }
      ASSERT_TRUE(on_surface) << points_name << ": " << line;
    }
    EXPECT_GE(points, 256) << points_name;
  }
}

// The two tessellations differ in the knot alone.
TEST(BundledScenes, DetailScenesShareTheirRoom) {
  const Scene low = load_gltf((scenes_folder / "detail_low.glb").string()).scene;
  const Scene high = load_gltf((scenes_folder / "detail_high.glb").string()).scene;
  ASSERT_EQ(low.meshes.size(), high.meshes.size());
  int knots = 0;
  for (std::size_t i = 0; i < low.meshes.size(); ++i) {
    if (low.meshes[i].triangles.size() == high.meshes[i].triangles.size()) {
      EXPECT_EQ(low.meshes[i].positions, high.meshes[i].positions);
    } else {
      ++knots;
      EXPECT_EQ(low.meshes[i].triangles.size(), 3000U);
      EXPECT_EQ(high.meshes[i].triangles.size(), 50000U);
    }
  }
  EXPECT_EQ(knots, 1);
}

}  // namespace
}  // namespace ivory
