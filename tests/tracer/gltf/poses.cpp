// Skins and morphs: meshes as their joints and weights have them, against the same meshes made beforehand.
#include <cmath>
#include <random>

#include <ImathMatrix.h>
#include <ImathQuat.h>
#include <gtest/gtest.h>

#include "tests/support/gltf_check.h"
#include "tests/support/world_triangles.h"
#include "tracer/core/intersector.h"

namespace ivory {
namespace {

using Imath::M44d;
using nlohmann::json;

struct Trs {
  V3d translation{0, 0, 0};
  V3d axis{0, 1, 0};
  double angle_rad = 0;
  V3d scale{1, 1, 1};

  M44d matrix() const {
    M44d s, r, t;
    s.setScale(scale);
    r.setAxisAngle(axis, angle_rad);
    t.setTranslation(translation);
    return s * r * t;
  }
  json node() const {
    const V3d v = axis.normalized() * std::sin(angle_rad / 2);
    return {{"translation", {translation.x, translation.y, translation.z}},
            {"rotation", {v.x, v.y, v.z, std::cos(angle_rad / 2)}},
            {"scale", {scale.x, scale.y, scale.z}}};
  }
};

int add_matrices(GltfBuilder& builder, const std::vector<M44d>& matrices) {
  std::vector<float> floats;
  for (const M44d& m : matrices)
    for (int i = 0; i < 16; ++i) floats.push_back(float(m[i / 4][i % 4]));
  return builder.add_accessor("MAT4", 5126, matrices.size(), builder.add_view(floats.data(), floats.size() * 4));
}

int add_joints(GltfBuilder& builder, const std::vector<std::uint16_t>& joints) {
  return builder.add_accessor("VEC4", 5123, joints.size() / 4, builder.add_view(joints.data(), joints.size() * 2));
}

// A square of 2 m, facing up, on one joint.
GltfBuilder make_awning(const V4f& weights) {
  GltfBuilder builder;
  const int p = builder.add({{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}});
  const int j = add_joints(builder, std::vector<std::uint16_t>(16, 0));
  const int w = builder.add(std::vector<V4f>(4, weights));
  const int i = builder.add_indices({0, 1, 2, 0, 2, 3});
  const int mesh =
      builder.add_mesh({{"attributes", {{"POSITION", p}, {"JOINTS_0", j}, {"WEIGHTS_0", w}}}, {"indices", i}});
  const int joint = builder.add_node({{"translation", {10, 3, 0}}});
  builder.root["skins"] = {{{"joints", {joint}}}};
  builder.add_node({{"mesh", mesh}, {"skin", 0}, {"translation", {-40, 0, 0}}, {"scale", {5, 5, 5}}});
  return builder;
}

TEST(GltfSkins, ShadowsFallWhereTheJointsAre) {
  const LoadedScene loaded = load(make_awning({1, 0, 0, 0}), "awning");
  EXPECT_TRUE(loaded.warnings.empty());
  const Intersector intersector(loaded.scene);
  const auto light_at = [&](float x) {
    Ray up;
    up.origin = V3f(x, 0, 0.3F);
    up.direction = V3f(0, 1, 0);
    return intersector.transmittance(up);
  };
  EXPECT_EQ(light_at(10), 0);
  EXPECT_EQ(light_at(10.9F), 0);
  EXPECT_EQ(light_at(11.1F), 1);
  EXPECT_EQ(light_at(0), 1);
  EXPECT_EQ(light_at(-40), 1);

  LoadParams centimetres;
  centimetres.scale = 0.01;
  const Box3f small = bounds(load(make_awning({1, 0, 0, 0}).write("awning_cm"), centimetres).scene);
  EXPECT_LT((small.center() - V3f(0.1F, 0.03F, 0)).length(), 1e-6F);
  EXPECT_NEAR(small.size().x, 0.02, 1e-7);
}

// Vertices on two sets of four joints each, which turn, stretch and mirror; positions and normals by the formula.
TEST(GltfSkins, EqualTheSameMeshPosedBeforehand) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto vector = [&] { return V3d(u(random), u(random), u(random)); };
  std::vector<Trs> joints(6);
  std::vector<M44d> inverse_bind;
  for (Trs& joint : joints) {
    joint = {vector() * 5, vector(), 3 * u(random), V3d(1.2) + vector() * 0.7};
    const Trs bind{vector(), vector(), 2 * u(random), V3d(1.5) + vector()};
    inverse_bind.push_back(M44d(M44f(bind.matrix().inverse())));
  }
  joints[4].scale.x = -0.8;
  // A chain of three, and three on a turned parent beside it.
  const Trs parent{V3d(3, -1, 2), V3d(1, 1, 0), 0.7, V3d(1, 2, 0.5)};
  std::vector<M44d> to_world(6);
  for (std::size_t i = 0; i < 3; ++i) to_world[i] = joints[i].matrix() * (i == 0 ? M44d() : to_world[i - 1]);
  for (std::size_t i = 3; i < 6; ++i) to_world[i] = joints[i].matrix() * parent.matrix();

  constexpr std::size_t vertices = 60;
  std::vector<V3f> p, n;
  std::vector<std::uint16_t> joints_0, joints_1;
  std::vector<V4f> weights_0, weights_1;
  std::vector<V3d> expected_p, expected_n;
  for (std::size_t v = 0; v < vertices; ++v) {
    p.push_back(V3f(vector()));
    n.push_back(V3f(vector()).normalized());
    std::array<double, 8> w{};
    double sum = 0;
    for (double& x : w) sum += x = std::abs(u(random));
    M44d blended(0.0);
    V4f sets[2];
    for (std::size_t k = 0; k < 8; ++k) {
      const std::size_t joint = (v * 5 + k * 3) % 6;
      (k < 4 ? joints_0 : joints_1).push_back(std::uint16_t(joint));
      const float weight = sets[k / 4][int(k % 4)] = float(w[k] / sum);
      const M44d m = inverse_bind[joint] * to_world[joint];
      for (int i = 0; i < 16; ++i) blended[i / 4][i % 4] += double(weight) * m[i / 4][i % 4];
    }
    weights_0.push_back(sets[0]);
    weights_1.push_back(sets[1]);
    for (int i = 0; i < 3; ++i) blended[i][3] = 0;
    blended[3][3] = 1;
    expected_p.push_back(V3d(p.back()) * blended);
    // The inverse transpose, on the side that the turned corners give.
    V3d normal;
    blended.inverse().transposed().multDirMatrix(V3d(n.back()), normal);
    expected_n.push_back(normal.normalized() * (blended.determinant() < 0 ? -1 : 1));
  }
  GltfBuilder builder;
  std::vector<std::uint16_t> corners;
  for (std::uint16_t v = 0; v < vertices; ++v) corners.push_back(v);
  const json attributes{{"POSITION", builder.add(p)},
                        {"NORMAL", builder.add(n)},
                        {"JOINTS_0", add_joints(builder, joints_0)},
                        {"JOINTS_1", add_joints(builder, joints_1)},
                        {"WEIGHTS_0", builder.add(weights_0)},
                        {"WEIGHTS_1", builder.add(weights_1)}};
  const int mesh = builder.add_mesh({{"attributes", attributes}, {"indices", builder.add_indices(corners)}});
  for (std::size_t i = 0; i < 6; ++i) builder.add_node(joints[i].node(), i == 0);
  builder.root["nodes"][0]["children"] = {1};
  builder.root["nodes"][1]["children"] = {2};
  json beside = parent.node();
  beside["children"] = {3, 4, 5};
  builder.add_node(beside);
  builder.root["skins"] = {
      {{"joints", {0, 1, 2, 3, 4, 5}}, {"inverseBindMatrices", add_matrices(builder, inverse_bind)}}};
  builder.add_node({{"mesh", mesh}, {"skin", 0}});
  const LoadedScene loaded = load(builder, "skin_twin");
  ASSERT_EQ(loaded.scene.instances.size(), 1U);
  const Instance& instance = loaded.scene.instances[0];
  const Mesh& posed = loaded.scene.meshes[std::size_t(instance.mesh)];
  ASSERT_EQ(posed.positions.size(), vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    EXPECT_LT((V3d(posed.positions[v] * instance.to_world) - expected_p[v]).length(), 1e-5) << v;
    EXPECT_LT((V3d(posed.normals[v]) - expected_n[v]).length(), 1e-5) << v;
  }
}

// Each skin makes a mesh of its own; the same skin and weights share it, and so do nodes without.
TEST(GltfSkins, SeveralOnOneMesh) {
  GltfBuilder builder = make_awning({1, 0, 0, 0});
  builder.add_node({{"translation", {0, 7, 0}}});
  builder.root["skins"].push_back({{"joints", {2}}});
  builder.add_node({{"mesh", 0}, {"skin", 1}});
  builder.add_node({{"mesh", 0}, {"skin", 1}});
  builder.add_node({{"mesh", 0}, {"translation", {0, 0, 4}}});
  const Scene scene = load(builder, "several").scene;
  EXPECT_EQ(scene.meshes.size(), 3U);
  ASSERT_EQ(scene.instances.size(), 4U);
  EXPECT_EQ(scene.instances[1].mesh, scene.instances[2].mesh);
  std::vector<float> heights;
  for (const Instance& instance : scene.instances)
    heights.push_back((scene.meshes[std::size_t(instance.mesh)].positions[0] * instance.to_world).y);
  EXPECT_EQ(heights, (std::vector<float>{3, 7, 7, 0}));
}

// Far from the world's origin a skin keeps its shape: vertices are stored about the joint.
TEST(GltfSkins, KeepTheirShapeFarAway) {
  GltfBuilder builder = make_awning({1, 0, 0, 0});
  builder.root["nodes"][0]["translation"] = {4.0e6, 3, -5.0e6};
  builder.root["nodes"][0]["scale"] = {0.1, 0.1, 0.1};
  const Scene scene = load(builder, "far").scene;
  const std::vector<V3f>& p = scene.meshes.at(0).positions;
  EXPECT_LT((p[1] - p[0] - V3f(0.2F, 0, 0)).length(), 1e-6F);
}

TEST(GltfSkins, WeightsAreMendedWithAWord) {
  const auto height = [](const LoadedScene& loaded) { return bounds(loaded.scene).max.y; };
  const LoadedScene half = load(make_awning({0.5F, 0, 0, 0}), "half");
  EXPECT_EQ(height(half), 3);
  EXPECT_TRUE(has_warning(half, "4 vertices whose skin weights do not sum to 1"));
  const LoadedScene none = load(make_awning({0, 0, 0, 0}), "none");
  EXPECT_EQ(height(none), 3);
  EXPECT_TRUE(has_warning(none, "4 vertices without skin weights"));
  const LoadedScene below = load(make_awning({1, -0.5F, 0, 0}), "below");
  EXPECT_EQ(height(below), 3);
  EXPECT_TRUE(has_warning(below, "below 0"));
  GltfBuilder rigid = make_awning({1, 0, 0, 0});
  rigid.root["meshes"][0]["primitives"][0]["attributes"].erase("JOINTS_0");
  const LoadedScene loaded = load(rigid, "rigid");
  EXPECT_TRUE(has_warning(loaded, "has no joints"));
  EXPECT_EQ(bounds(loaded.scene).center().x, -40);
}

TEST(GltfSkins, BrokenOnesAreRefused) {
  const auto broken = [](const char* name, const std::function<void(GltfBuilder&)>& change) {
    GltfBuilder builder = make_awning({1, 0, 0, 0});
    change(builder);
    return error_of(builder, name);
  };
  const auto contains = [](const std::string& error, const char* part) {
    EXPECT_NE(error.find(part), std::string::npos) << error;
  };
  contains(broken("joint",
                  [](GltfBuilder& b) {
                    b.root["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] =
                        add_joints(b, std::vector<std::uint16_t>(16, 7));
                  }),
           "on joint 7 of skins[0], which has 1");
  contains(broken("singular",
                  [](GltfBuilder& b) {
                    M44d flat;
                    flat.setScale(V3d(1, 0, 1));
                    b.root["skins"][0]["inverseBindMatrices"] = add_matrices(b, {flat});
                  }),
           "inverse bind matrix 0, which has no inverse");
  contains(broken("projective",
                  [](GltfBuilder& b) {
                    M44d m;
                    m[0][3] = 0.1;
                    b.root["skins"][0]["inverseBindMatrices"] = add_matrices(b, {m});
                  }),
           "not affine");
  contains(broken("nan",
                  [](GltfBuilder& b) {
                    M44d m;
                    m[1][1] = std::nan("");
                    b.root["skins"][0]["inverseBindMatrices"] = add_matrices(b, {m});
                  }),
           "not finite");
  contains(broken("few",
                  [](GltfBuilder& b) {
                    b.root["skins"][0]["joints"] = {0, 1};
                    b.root["skins"][0]["inverseBindMatrices"] = add_matrices(b, {M44d()});
                  }),
           "are 1 for 2 joints");
  contains(broken("vec", [](GltfBuilder& b) { b.root["skins"][0]["inverseBindMatrices"] = 0; }), "16 components");
  contains(broken("empty", [](GltfBuilder& b) { b.root["skins"][0]["joints"] = json::array(); }), "has no joints");
  contains(broken("nowhere", [](GltfBuilder& b) { b.root["skins"][0]["joints"] = {9}; }), "nodes[9]");
  contains(broken("no_skin", [](GltfBuilder& b) { b.root["nodes"][1]["skin"] = 4; }), "skins[4]");
  contains(broken("weightless",
                  [](GltfBuilder& b) { b.root["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0"); }),
           "JOINTS_0 but no WEIGHTS_0");
  contains(broken("float_joints",
                  [](GltfBuilder& b) {
                    b.root["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = b.add(std::vector<V4f>(4));
                  }),
           "component type 5126");
  contains(broken("loop", [](GltfBuilder& b) { b.root["nodes"][0]["children"] = {0}; }), "loop");
}

// Base and displacements; nodes' weights before the mesh's, which other nodes keep.
TEST(GltfMorphs, NodesHaveWeightsOfTheirOwn) {
  GltfBuilder builder;
  const std::vector<V3f> base{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<V3f> first{{0, 0, 1}, {0, 0, 2}, {0, 3, 0}};
  const std::vector<V3f> second{{5, 0, 0}, {5, 0, 0}, {5, 0, 0}};
  const int p = builder.add(base);
  const int a = builder.add(first);
  const int b = builder.add(second);
  builder.add_mesh({{"attributes", {{"POSITION", p}}}, {"targets", {{{"POSITION", a}}, {{"POSITION", b}}}}});
  builder.root["meshes"][0]["weights"] = {0.5, 0};
  builder.add_node({{"mesh", 0}});
  builder.add_node({{"mesh", 0}, {"weights", {0.25, -0.5}}, {"translation", {0, 0, 7}}});
  builder.add_node({{"mesh", 0}, {"weights", {0.5, 0}}});
  const LoadedScene loaded = load(builder, "morphs");
  EXPECT_TRUE(loaded.warnings.empty());
  const Scene& scene = loaded.scene;
  ASSERT_EQ(scene.instances.size(), 3U);
  EXPECT_EQ(scene.instances[0].mesh, scene.instances[2].mesh);
  const auto expect = [&](const Instance& instance, float wa, float wb, const V3f& at) {
    for (std::size_t i = 0; i < 3; ++i) {
      const V3f corner = scene.meshes[std::size_t(instance.mesh)].positions[i] * instance.to_world;
      EXPECT_LT((corner - (base[i] + first[i] * wa + second[i] * wb + at)).length(), 1e-6F) << i;
    }
  };
  expect(scene.instances[0], 0.5F, 0, V3f(0));
  expect(scene.instances[1], 0.25F, -0.5F, V3f(0, 0, 7));

  builder.root["nodes"][1]["weights"] = {1e25, 0};
  EXPECT_NE(error_of(builder, "huge").find("farther out"), std::string::npos);
}

// Displaced first, then moved by the joints (glTF 2.0, 3.7.3.3).
TEST(GltfMorphs, ComeBeforeTheSkin) {
  GltfBuilder builder = make_awning({1, 0, 0, 0});
  const int up = builder.add(std::vector<V3f>(4, V3f(0, 2, 0)));
  builder.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}};
  builder.root["nodes"][0]["scale"] = {1, 3, 1};
  builder.root["nodes"][1]["weights"] = {0.5};
  EXPECT_EQ(bounds(load(builder, "both").scene).center(), V3f(10, 3 + 0.5F * 2 * 3, 0));
}

// A degenerate mesh may be spread by its pose.
TEST(GltfMorphs, MayGiveTrianglesTheirArea) {
  GltfBuilder builder;
  const int p = builder.add({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}});
  const int a = builder.add({{0, 0, 0}, {0, 0, 0}, {0, 1, 0}});
  builder.add_mesh({{"attributes", {{"POSITION", p}}}, {"targets", {{{"POSITION", a}}}}});
  builder.add_node({{"mesh", 0}, {"weights", {1}}});
  const LoadedScene loaded = load(builder, "spread");
  EXPECT_EQ(loaded.scene.instances.size(), 1U);
  EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings[0];
}

}  // namespace
}  // namespace ivory
