// Scenes far from the world's origin, and in other units than metres.
#include <array>
#include <cmath>

#include "grid/base/anchor.h"
#include "tests/support/gltf_check.h"

namespace ivory {

namespace {

// A room of 6 x 3 x 4 units with a box in it, a lamp, a spherical light, two cameras; all below nodes of the root.
struct Room {
  GltfBuilder builder;
  nlohmann::json children = nlohmann::json::array();

  explicit Room(const V3f& move_vertices = V3f(0, 0, 0), float size = 1) {
    const auto box = [&](const V3f& low, const V3f& high) {
      std::vector<V3f> corners;
      for (int i = 0; i < 8; ++i)
        corners.push_back(
            V3f((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y, (i & 4) != 0 ? high.z : low.z) * size +
            move_vertices);
      const int position = builder.add(corners);
      const int indices = builder.add_indices(
          {0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3});
      return builder.add_mesh({{"attributes", {{"POSITION", position}}}, {"indices", indices}});
    };
    const int room = box({-3, 0, -2}, {3, 3, 2});
    const int table = box({0, 0, 0}, {1, 0.75F, 0.5F});
    builder.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 60}}};
    builder.use_extension("KHR_lights_punctual");
    builder.root["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}},
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 2}, {"znear", 0.1}, {"zfar", 9}}}}};
    const auto place = [&](nlohmann::json node, double x, double y, double z) {
      node["translation"] = {x * double(size), y * double(size), z * double(size)};
      children.push_back(builder.add_node(node, false));
    };
    place({{"mesh", room}}, 0, 0, 0);
    place({{"mesh", table}}, 0.3, 0, -0.7);
    place({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}, 0.2, 2.3, 0.1);
    place({{"extras", {{"ivory_sphere_light", {{"radius", 0.1 * double(size)}, {"radiance", {1, 1, 1}}}}}}}, -1, 2, 1);
    place({{"camera", 0}}, 1, 1.6, 1);
    place({{"camera", 1}}, 1, 1.6, 1);
  }

  std::string write(const std::string& name, const V3d& shift) {
    builder.add_node({{"children", children}, {"translation", {shift.x, shift.y, shift.z}}});
    return builder.write(name);
  }
};

void expect_same(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.instances.size(), b.instances.size());
  for (std::size_t i = 0; i < a.instances.size(); ++i) {
    EXPECT_EQ(a.instances[i].to_world, b.instances[i].to_world);
    EXPECT_EQ(a.meshes[std::size_t(a.instances[i].mesh)].positions,
              b.meshes[std::size_t(b.instances[i].mesh)].positions);
  }
  ASSERT_EQ(a.cameras.size(), b.cameras.size());
  for (std::size_t i = 0; i < a.cameras.size(); ++i) EXPECT_EQ(a.cameras[i].to_world, b.cameras[i].to_world);
  EXPECT_EQ(std::get<PointLight>(a.lights.at(0)).position, std::get<PointLight>(b.lights.at(0)).position);
  EXPECT_EQ(a.sphere_lights.at(0).center, b.sphere_lights.at(0).center);
}

}  // namespace

TEST(Anchor, IsZeroNearTheOriginAndRoundFarOut) {
  EXPECT_EQ(choose_anchor(V3d(0, 1.5, 0), 3), V3d(0, 0, 0));
  EXPECT_EQ(choose_anchor(V3d(100, 0, 0), 3), V3d(0, 0, 0));      // rays start 0.8 mm off
  EXPECT_EQ(choose_anchor(V3d(500, 0, 500), 400), V3d(0, 0, 0));  // a town: its own size asks for it
  EXPECT_EQ(choose_anchor(V3d(1, 0, 0), 2e-5), V3d(1, 0, 0));     // a speck at a metre
  EXPECT_EQ(choose_anchor(V3d(450001.2, 103, -5e6 + 2), 3), V3d(450000, 100, -5e6));
  EXPECT_EQ(choose_anchor(V3d(20000, 1.5, 0), 3), V3d(20000, 0, 0));
  EXPECT_EQ(choose_anchor(V3d(20000, 0, 0), 0), V3d(0, 0, 0));  // nothing there
}

// Moved by its root by a round distance, a scene keeps its local positions to the last bit.
TEST(GltfFar, TwinsAreTheSameButForTheirAnchor) {
  const Scene here = load(Room().write("here", V3d(0, 0, 0))).scene;
  EXPECT_EQ(here.anchor_m, V3d(0, 0, 0));
  const std::array<V3d, 3> shifts{V3d(20000, 0, -20000), V3d(-500000, 300, 500000), V3d(450000, 100, -5000000)};
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    const LoadedScene there = load(Room().write("there" + std::to_string(i), shifts[i]));
    EXPECT_EQ(there.scene.anchor_m, shifts[i]);
    EXPECT_TRUE(there.warnings.empty());
    expect_same(here, there.scene);
  }
}

// Far vertices are taken off in the mesh's own space, before its transform: turned as they are, the box stays a box.
TEST(GltfFar, VerticesFarOutAreMovedWhereFloatsHoldThem) {
  const auto turned = [](const V3f& vertices, const V3d& shift, const char* name) {
    Room room(vertices);
    const double half = std::sqrt(0.5);
    const int inner = room.builder.add_node({{"children", {room.children[0], room.children[1]}},
                                             {"rotation", {0, half, 0, half}},
                                             {"translation", {shift.x, shift.y, shift.z}}},
                                            false);
    room.children = nlohmann::json::array({inner});
    return load(room.write(name, V3d(0, 0, 0)));
  };
  // A quarter turn about +Y takes x to -z and z to x; it takes the 200 km off again.
  const float far = 200000;  // floats are 1/64 apart
  const LoadedScene there = turned({far, 0, 0}, V3d(0, 0, 200000), "far_vertices");
  const LoadedScene here = turned({0, 0, 0}, V3d(0, 0, 0), "near_vertices");
  EXPECT_TRUE(has_warning(there, "where floats are 0.016 apart")) << testing::PrintToString(there.warnings);
  const Box3f a = bounds(there.scene);
  const Box3f b = bounds(here.scene);
  for (unsigned axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(a.min[axis], b.min[axis], 0.008);
    EXPECT_NEAR(a.max[axis], b.max[axis], 0.008);
  }
  // At the coordinates of national grids a table is half a metre off.
  Room lost(V3f(0, 0, -5000000), 0.25F);
  lost.builder.add_node({{"children", lost.children}});
  EXPECT_NE(error_of(lost.builder, "lost").find("its shape is lost"), std::string::npos);
}

TEST(GltfFar, SaysWhatIsTooSmallForItsDistance) {
  Room room;
  // A cube forgotten at the origin, the house at national coordinates.
  room.builder.add_node({{"mesh", 1}});
  const LoadedScene loaded = load(room.write("forgotten", V3d(450000, 0, -5000000)));
  EXPECT_EQ(loaded.scene.anchor_m, V3d(450000, 0, -5000000));
  EXPECT_TRUE(has_warning(loaded, "small for the distance")) << testing::PrintToString(loaded.warnings);
}

// Wide ground does not keep the room on it from an anchor of its own.
TEST(GltfFar, AnchorsWhereTheTrianglesAre) {
  Room room;
  const int ground = room.builder.add_mesh(
      {{"attributes", {{"POSITION", room.builder.add({{-20000, 0, -20000}, {20000, 0, 20000}, {20000, 0, -20000}})}}}});
  room.builder.add_node({{"mesh", ground}});
  const LoadedScene loaded = load(room.write("ground", V3d(10000, 0, 0)));
  EXPECT_EQ(loaded.scene.anchor_m, V3d(10000, 0, 0));
  EXPECT_TRUE(loaded.warnings.empty()) << testing::PrintToString(loaded.warnings);
}

TEST(GltfFar, CoordinatesBeyondAMillionKilometresAreRefused) {
  Room room;
  room.builder.add_node({{"children", room.children}, {"translation", {2e9, 0, 0}}});
  EXPECT_NE(error_of(room.builder, "beyond").find("farther out than 1e+09 m"), std::string::npos);
}

// The same room in centimetres, taken at a hundredth: positions by the float's rounding, light and angles untouched.
TEST(GltfScale, CentimetresAreMetresAtAHundredth) {
  const Scene metres = load(Room().write("metres", V3d(1, 0, 2))).scene;
  const std::string path = Room({0, 0, 0}, 100).write("centimetres", V3d(100, 0, 200));
  const Scene scaled = load_gltf(path, {.scale = 0.01}).scene;
  EXPECT_EQ(find_fault(scaled), "");
  const Box3f a = bounds(metres);
  const Box3f b = bounds(scaled);
  for (unsigned axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(a.min[axis], b.min[axis], 1e-6);
    EXPECT_NEAR(a.max[axis], b.max[axis], 1e-6);
  }
  const auto& lamp = std::get<PointLight>(scaled.lights.at(0));
  EXPECT_NEAR((lamp.position - std::get<PointLight>(metres.lights.at(0)).position).length(), 0, 1e-6);
  EXPECT_EQ(lamp.intensity_cd, Rgb(60, 60, 60));
  EXPECT_NEAR(scaled.sphere_lights.at(0).radius_m, metres.sphere_lights.at(0).radius_m, 1e-7);
  EXPECT_EQ(scaled.sphere_lights.at(0).radiance_nits, Rgb(1, 1, 1));
  ASSERT_EQ(scaled.cameras.size(), 2);
  EXPECT_EQ(scaled.cameras[0].yfov_rad, metres.cameras[0].yfov_rad);
  EXPECT_NEAR(scaled.cameras[1].ymag_m, 0.02, 1e-9);  // a node's scale would not zoom; the unit does
}

}  // namespace ivory
