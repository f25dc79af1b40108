// Scenes at a time of their animation, against the same scenes placed there beforehand.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/gltf_check.h"

namespace ivory {
namespace {

using nlohmann::json;

int add_scalars(GltfBuilder& builder, const std::vector<float>& v) {
  return builder.add_accessor("SCALAR", 5126, v.size(), builder.add_view(v.data(), v.size() * 4));
}

// A triangle whose node one animation moves by one channel.
struct Moving {
  GltfBuilder builder;

  Moving() {
    builder.add_node({{"mesh", builder.add_triangle_mesh()}});
    builder.root["animations"] = {{{"name", "go"}, {"channels", json::array()}, {"samplers", json::array()}}};
  }
  Moving& channel(const char* path, int times, int values, const char* interpolation = "LINEAR", int animation = 0) {
    json& a = builder.root["animations"][std::size_t(animation)];
    a["channels"].push_back({{"sampler", a["samplers"].size()}, {"target", {{"node", 0}, {"path", path}}}});
    a["samplers"].push_back({{"input", times}, {"output", values}, {"interpolation", interpolation}});
    return *this;
  }
  LoadedScene at(double time_s, const std::string& animation = "") const {
    LoadParams params;
    params.time_s = time_s;
    params.animation = animation;
    return load(builder.write("moving"), params);
  }
  std::string error() const {
    LoadParams params;
    params.time_s = 0.5;
    return error_of(builder, "moving", params);
  }
};

V3f origin_of(const LoadedScene& loaded) { return V3f(0, 0, 0) * loaded.scene.instances.at(0).to_world; }

TEST(GltfAnimations, StraightAndByStepsBetweenKeys) {
  Moving moving;
  const int times = add_scalars(moving.builder, {1, 2, 4});
  const int places = moving.builder.add({{0, 0, 0}, {8, 0, 0}, {8, 4, 0}});
  moving.channel("translation", times, places);
  EXPECT_EQ(origin_of(moving.at(1.25)), V3f(2, 0, 0));
  EXPECT_EQ(origin_of(moving.at(2)), V3f(8, 0, 0));
  EXPECT_EQ(origin_of(moving.at(3)), V3f(8, 2, 0));
  EXPECT_TRUE(moving.at(3).warnings.empty());
  // Outside they hold, with a word.
  const LoadedScene before = moving.at(0.5);
  EXPECT_EQ(origin_of(before), V3f(0, 0, 0));
  EXPECT_TRUE(has_warning(before, "from 1 s to 4 s; at 0.5 s its first pose"));
  EXPECT_EQ(origin_of(moving.at(9)), V3f(8, 4, 0));
  EXPECT_TRUE(has_warning(moving.at(9), "last pose"));
  // The stored pose, with a word; another content than at a time.
  const LoadedScene stored = load(moving.builder, "moving");
  EXPECT_EQ(origin_of(stored), V3f(0, 0, 0));
  EXPECT_TRUE(has_warning(stored, "has 1 animation"));
  EXPECT_NE(stored.scene.content_hash, moving.at(1).scene.content_hash);
  EXPECT_NE(moving.at(2).scene.content_hash, moving.at(1).scene.content_hash);

  Moving steps;
  const int t = add_scalars(steps.builder, {1, 2, 4});
  const int s = steps.builder.add({{1, 1, 1}, {2, 3, 4}, {5, 5, 5}});
  steps.channel("scale", t, s, "STEP");
  const M44f m = steps.at(3.999).scene.instances.at(0).to_world;
  EXPECT_EQ(V3f(m[0][0], m[1][1], m[2][2]), V3f(2, 3, 4));
}

// A cubic through keys with its own slopes is the cubic itself.
TEST(GltfAnimations, CubicSplines) {
  const auto f = [](double t) { return V3f(float(t * t * t - 2 * t), float(t * t), float(1 - t)); };
  const auto slope = [](double t) { return V3f(float(3 * t * t - 2), float(2 * t), -1); };
  Moving moving;
  const int times = add_scalars(moving.builder, {0.5F, 1, 3});
  std::vector<V3f> values;
  for (const double t : {0.5, 1.0, 3.0}) {
    values.push_back(slope(t));
    values.push_back(f(t));
    values.push_back(slope(t));
  }
  moving.channel("translation", times, moving.builder.add(values), "CUBICSPLINE");
  for (const double t : {0.5, 0.7, 1.0, 1.9, 3.0}) EXPECT_LT((origin_of(moving.at(t)) - f(t)).length(), 1e-5F) << t;
}

// From no turn to 100 degrees about y, told by the far quaternion of the same turn: along the shorter arc, evenly.
TEST(GltfAnimations, TurnsAreEvenAndShort) {
  const double half = 50 * double(pi) / 180;
  Moving moving;
  const int times = add_scalars(moving.builder, {0, 1});
  const int turns =
      moving.builder.add(std::vector<V4f>{{0, 0, 0, 1}, {0, -float(std::sin(half)), 0, -float(std::cos(half))}});
  moving.channel("rotation", times, turns);
  for (const double t : {0.0, 0.25, 0.5, 1.0}) {
    const double angle = 2 * half * t;
    const V3f x = V3f(1, 0, 0) * moving.at(t).scene.instances.at(0).to_world;
    EXPECT_LT((x - V3f(float(std::cos(angle)), 0, -float(std::sin(angle)))).length(), 1e-6F) << t;
  }
  // In 16 bits, normalised.
  Moving quantized;
  const int t = add_scalars(quantized.builder, {0, 1});
  const std::int16_t q[] = {0, 0,
                            0, 32767,
                            0, std::int16_t(std::lround(32767 * std::sin(half))),
                            0, std::int16_t(std::lround(32767 * std::cos(half)))};
  quantized.channel("rotation", t,
                    quantized.builder.add_accessor("VEC4", 5122, 2, quantized.builder.add_view(q, sizeof q), true));
  const V3f x = V3f(1, 0, 0) * quantized.at(0.5).scene.instances.at(0).to_world;
  EXPECT_LT((x - V3f(float(std::cos(half)), 0, -float(std::sin(half)))).length(), 1e-4F);
}

TEST(GltfAnimations, MorphWeightsAndNamedAnimations) {
  Moving moving;
  GltfBuilder& b = moving.builder;
  const int out = b.add(std::vector<V3f>(3, V3f(0, 0, 4)));
  const int side = b.add(std::vector<V3f>(3, V3f(4, 0, 0)));
  b.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", out}}, {{"POSITION", side}}};
  const int times = add_scalars(b, {0, 2});
  moving.channel("weights", times, add_scalars(b, {0, 1, 1, 0}));
  b.root["animations"].push_back({{"channels", json::array()}, {"samplers", json::array()}});
  moving.channel("translation", times, b.add({{0, 0, 0}, {0, 2, 0}}), "LINEAR", 1);
  EXPECT_EQ(bounds(moving.at(0.5, "go").scene).min, V3f(3, 0, 1));
  EXPECT_EQ(bounds(moving.at(0.5).scene).min, V3f(3, 0, 1));
  EXPECT_EQ(bounds(moving.at(0.5, "1").scene).min, V3f(0, 0.5F, 0));
  EXPECT_THROW(moving.at(0.5, "stop"), ParameterError);
  EXPECT_THROW(moving.at(0.5, "2"), ParameterError);
  LoadParams no_time;
  no_time.animation = "go";
  EXPECT_THROW(load_gltf(b.write("no_time"), no_time), ParameterError);
  b.root.erase("animations");
  EXPECT_THROW(moving.at(0.5), ParameterError);
}

TEST(GltfAnimations, BrokenOnesAreRefused) {
  const auto contains = [](const std::string& error, const char* part) {
    EXPECT_NE(error.find(part), std::string::npos) << error;
  };
  const auto with = [](const std::vector<float>& times, const std::vector<V3f>& values, const char* interpolation) {
    Moving moving;
    const int t = add_scalars(moving.builder, times);
    const int v = moving.builder.add(values);
    moving.channel("translation", t, v, interpolation);
    return moving;
  };
  const V3f o(0, 0, 0);
  contains(with({0, 1}, {o, o, o}, "LINEAR").error(), "9 numbers for 2 keys instead of 6");
  contains(with({0, 1}, {o, o}, "CUBICSPLINE").error(), "instead of 18");
  contains(with({0, 1}, {o, o}, "SMOOTH").error(), "not one of");
  contains(with({1, 1}, {o, o}, "LINEAR").error(), "do not rise");
  contains(with({-1, 1}, {o, o}, "LINEAR").error(), "do not rise");
  contains(with({0, NAN}, {o, o}, "LINEAR").error(), "not finite");
  contains(with({0, 1}, {o, V3f(NAN, 0, 0)}, "LINEAR").error(), "not finite");
  Moving twice = with({0, 1}, {o, o}, "LINEAR");
  twice.channel("translation", 1, 2);
  contains(twice.error(), "a second time");
  Moving matrix = with({0, 1}, {o, o}, "LINEAR");
  matrix.builder.root["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  contains(matrix.error(), "has a matrix");
  Moving weights;
  weights.channel("weights", add_scalars(weights.builder, {0}), add_scalars(weights.builder, {0}));
  contains(weights.error(), "no morph targets");
  Moving turned;
  const int t = add_scalars(turned.builder, {0, 1});
  turned.channel("rotation", t, turned.builder.add(std::vector<V4f>{{0, 0, 0, 1}, {0, 0, 0, 2}}));
  contains(turned.error(), "length 2");
  Moving sampler = with({0, 1}, {o, o}, "LINEAR");
  sampler.builder.root["animations"][0]["channels"][0]["sampler"] = 3;
  contains(sampler.error(), "no sampler 3");
  // Not asked for, they do no harm.
  EXPECT_EQ(load(sampler.builder, "unasked").scene.instances.size(), 1U);
}

// The files of Khronos' samples that move, at one of their times; SimpleSkin's second joint has turned by a quarter
// at 1 s, which lays the strip's upper half, 1 m long, to the left.
TEST(GltfAnimations, SampleFiles) {
  const std::string folder = sample_data();
  if (folder.empty() || !std::filesystem::exists(folder + "/animated")) GTEST_SKIP() << no_sample_data;
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder + "/animated")) {
    const std::string path = entry.path().string();
    if (!path.ends_with(".gltf") && !path.ends_with(".glb")) continue;
    ++files;
    LoadParams params;
    params.time_s = 0.37;
    EXPECT_FALSE(load(path, params).scene.instances.empty()) << path;
  }
  EXPECT_GE(files, 6);
  LoadParams quarter;
  quarter.time_s = 1;
  const Box3f box = bounds(load(folder + "/animated/SimpleSkin/SimpleSkin.gltf", quarter).scene);
  EXPECT_NEAR(box.min.x, -1, 0.01);
  EXPECT_NEAR(box.max.y, 1.5, 0.01);
}

}  // namespace
}  // namespace ivory
