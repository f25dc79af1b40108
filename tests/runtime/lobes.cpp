// shaders/lobes/lobe.glsl, lobes/table.glsl, lobes/sphere_set.glsl against their C++ twins, and lobe tables as GL
// objects.
#include "grid/io/lobes.h"

#include <cmath>

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "runtime/assets/lobes.h"
#include "tests/support/runtime_twin.h"

namespace ivory {
namespace {

constexpr int count = 10000;

class RuntimeLobes : public GlTest {};

const LobeTable& table() {
  static const LobeTable made = make_lobe_table();
  return made;
}

// Exponents from 0 to the largest, evenly in their logarithm, with the ends themselves.
float random_exponent(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0, 1);
  const float u = unit(random);
  if (u < 0.05F) return 0;
  if (u < 0.1F) return max_lobe_exponent;
  if (u < 0.2F) return 1;
  return std::expm1(unit(random) * std::log1p(max_lobe_exponent));
}

// A direction near a, opposite to it, at a right angle or any.
V3f random_beside(std::mt19937& random, const V3f& a) {
  std::uniform_real_distribution<float> unit(0, 1);
  const float u = unit(random);
  if (u < 0.02F) return a;
  if (u < 0.04F) return -a;
  if (u < 0.4F) return (a + random_direction(random) * std::pow(10.0F, -4 * unit(random))).normalized();
  if (u < 0.5F) return a.cross(random_direction(random)).normalized();
  return random_direction(random);
}

struct LobePairs {
  std::vector<V4f> a, b;  // axis and exponent
};
LobePairs random_pairs(std::uint32_t seed) {
  std::mt19937 random(seed);
  LobePairs pairs;
  for (int i = 0; i < count; ++i) {
    const V3f axis = random_direction(random);
    pairs.a.push_back(to_v4(axis, random_exponent(random)));
    pairs.b.push_back(to_v4(random_beside(random, axis), random_exponent(random)));
  }
  return pairs;
}

Lobe lobe_of(const V4f& v) { return {xyz(v), v.w, 1}; }

TEST_F(RuntimeLobes, ClosedForms) {
  const LobePairs in = random_pairs(1);
  const auto out = evaluate_on_gpu(R"(
#include "lobes/lobe.glsl"
vec4 evaluate(int i) {
  vec4 a = input0(i); vec4 b = input1(i);
  IvoryLobe lobe = IvoryLobe(a.xyz, a.w, 2.0);
  float height = 1.0 / (1.0 + b.w);  // 1e-5 to 1
  IvoryLobe cap = ivory_cap_lobe_from_height(a.xyz, height);
  return vec4(ivory_eval_lobe(lobe, b.xyz), ivory_lobe_integral(lobe), cap.exponent,
              cap.scale + ivory_sphere_cap_height(height, 1.0));
})",
                                   {in.a, in.b});
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Lobe lobe{xyz(in.a[i]), in.a[i].w, 2};
    const V3f w = xyz(in.b[i]);
    const float height = 1 / (1 + in.b[i].w);
    const Lobe cap = cap_lobe_from_height(lobe.axis, height);
    // A power of a cosine that is rounded to 6e-8 has the exponent times that for its error; so have small cosines.
    const float tolerance = 1e-5F + 2.5e-7F * lobe.exponent;
    const float cosine = lobe.axis.dot(w);
    const float value = cosine > 0 ? lobe.scale * std::pow(cosine, lobe.exponent) : 0.0F;
    // Around 0 a cosine is all rounding, and so are its low powers.
    if (std::abs(lobe.axis.dot(w)) > 1e-4F) {
      EXPECT_NEAR(out[i].x, value, (tolerance + 2e-3F * std::min(lobe.exponent, 1.0F)) * value + 1e-37F)
          << in.a[i] << in.b[i];
    }
    EXPECT_NEAR(out[i].y / lobe_integral(lobe), 1, 1e-6F);
    EXPECT_NEAR((out[i].z + 1) / (cap.exponent + 1), 1, 1e-6F);
    EXPECT_NEAR(out[i].w / (cap.scale + sphere_cap_height(height, 1)), 1, 2e-6F);
  }
}

BindProgram bind_table(const GpuLobes& gpu) {
  return [&gpu](gl::Program& program) {
    bind(gpu, program, 0);
    program.set("table.exponent_nodes", gpu.exponent_nodes);
    program.set("table.angle_nodes", gpu.angle_nodes);
  };
}

TEST_F(RuntimeLobes, ProductIntegrals) {
  const GpuLobes gpu = upload(table());
  const LobePairs in = random_pairs(2);
  const auto out = evaluate_on_gpu(R"(
#include "lobes/table.glsl"
uniform sampler3D ivory_lobe_integrals;
uniform IvoryLobeTable table;
vec4 evaluate(int i) {
  vec4 a = input0(i); vec4 b = input1(i);
  return vec4(ivory_lobe_product_integral(table, ivory_lobe_integrals, IvoryLobe(a.xyz, a.w, 1.0), IvoryLobe(b.xyz, b.w, 1.0)),
              ivory_log1p(a.w * b.w), ivory_asinh(b.w * a.x), 0.0);
})",
                                   {in.a, in.b}, bind_table(gpu));
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Lobe a = lobe_of(in.a[i]);
    const Lobe b = lobe_of(in.b[i]);
    const float truth = lobe_product_integral(table(), a, b);
    // What is less than 1e-12 of the largest integral of two such lobes has lost its digits in the exponential.
    const float least = 1e-12F * 2 * pi / (a.exponent + b.exponent + 1);
    EXPECT_NEAR(out[i].x, truth, 1e-3F * std::max(truth, least)) << in.a[i] << in.b[i];
    EXPECT_NEAR(out[i].y, std::log1p(a.exponent * b.exponent), 1e-6F * (1 + out[i].y));
    EXPECT_NEAR(out[i].z, std::asinh(b.exponent * a.axis.x), 2e-6F * (1 + std::abs(out[i].z)));
  }
}

TEST_F(RuntimeLobes, Products) {
  const GpuLobes gpu = upload(table());
  const LobePairs in = random_pairs(3);
  const std::string source = R"(
#include "lobes/table.glsl"
uniform sampler3D ivory_lobe_products;
uniform IvoryLobeTable table;
IvoryLobe product(int i) {
  vec4 a = input0(i); vec4 b = input1(i);
  return ivory_lobe_product(table, ivory_lobe_products, IvoryLobe(a.xyz, a.w, 1.0), IvoryLobe(b.xyz, b.w, 1.0));
}
)";
  const auto axes =
      evaluate_on_gpu(source + "vec4 evaluate(int i) { IvoryLobe p = product(i); return vec4(p.axis, p.exponent); }",
                      {in.a, in.b}, bind_table(gpu));
  const auto scales = evaluate_on_gpu(source + "vec4 evaluate(int i) { return vec4(product(i).scale); }", {in.a, in.b},
                                      bind_table(gpu));
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const Lobe truth = lobe_product(table(), lobe_of(in.a[i]), lobe_of(in.b[i]));
    EXPECT_NEAR((axes[i].w + 1) / (truth.exponent + 1), 1, 1e-3F) << in.a[i] << in.b[i];
    EXPECT_NEAR(scales[i].x, truth.scale, 1e-3F * std::max(truth.scale, 1e-12F)) << in.a[i] << in.b[i];
    // In units of the lobe's width 1/sqrt(e + 1); between opposite axes any side will do.
    const bool opposite = (xyz(in.a[i]) + xyz(in.b[i])).length() < 1e-5F;
    if (!opposite) {
      EXPECT_LT((xyz(axes[i]) - truth.axis).length() * std::sqrt(truth.exponent + 1), 1e-3F) << in.a[i] << in.b[i];
    }
  }
}

TEST_F(RuntimeLobes, ConesAndSpheres) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<V4f> spheres, cones, at;
  for (int i = 0; i < count; ++i) {
    const V3f p = random_direction(random) * (10 * unit(random));
    spheres.push_back(to_v4(p + random_direction(random) * unit(random), 0.6F * unit(random)));
    cones.push_back(to_v4(random_direction(random), 1.5F * unit(random)));
    at.push_back(to_v4(p));
  }
  const auto out = evaluate_on_gpu(R"(
#include "lobes/sphere_set.glsl"
vec4 evaluate(int i) {
  vec4 cone = input1(i);
  return vec4(ivory_power(input0(i), input2(i).xyz),
              ivory_may_hide(input0(i), input2(i).xyz, cone.xyz, cos(cone.w), sin(cone.w)) ? 1.0 : 0.0, 0.0, 0.0);
})",
                                   {spheres, cones, at});
  int different = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Sphere sphere{xyz(spheres[i]), spheres[i].w};
    const V3f p = xyz(at[i]);
    EXPECT_NEAR(out[i].x, power(sphere, p), 2e-6F);
    const float half = cones[i].w;
    const bool hides = may_hide(sphere, {p, xyz(cones[i]), std::cos(half), std::sin(half)});
    different += (out[i].y != 0) != hides ? 1 : 0;
  }
  // OpenGL's sine and cosine, rounded otherwise, decide a touch differently.
  EXPECT_LE(different, 2);
}

TEST_F(RuntimeLobes, LoadsFilesAndRefusesBadOnesWithoutLeavingObjects) {
  const std::string good = testing::TempDir() + "runtime_lobes.exr";
  const LobeTable small = make_lobe_table({5, 9});
  write_lobes(good, small, {}, true);
  const int before = live_gl_objects();
  {
    GpuLobes gpu = load_lobes(good);
    EXPECT_EQ(gpu.exponent_nodes, 5);
    EXPECT_EQ(gpu.angle_nodes, 9);
    place(gpu, std::vector<RuntimeSphereLight>{{{V3f(0, 3, 0), 1}, Rgb(1, 1, 1)}},
          std::vector<Sphere>(20, {V3f(0, 1, 0), 0.1F}));
    EXPECT_EQ(gpu.spheres, 21);
    EXPECT_EQ(gpu.groups, 3);
    // Integrals, products, 1365 blocks, and the scene: a light, three groups, 21 spheres.
    EXPECT_EQ(gpu.bytes(), 5U * 5 * 9 * (4 + 12) + 2 * 1365 * 16 + (2 + 3 + 21) * 16);
    EXPECT_EQ(live_gl_objects(), before + 6);
    place(gpu, {}, {});
    EXPECT_EQ(live_gl_objects(), before + 6);
  }
  EXPECT_EQ(live_gl_objects(), before);

  expect_damage_refused(good, load_lobes);
  LobeTable broken = small;
  broken.values.pop_back();
  EXPECT_THROW(upload(broken), Error);
  EXPECT_THROW(lobe_defines({.mask_depth = 6}), ParameterError);
  EXPECT_EQ(live_gl_objects(), before);

  // More spheres than a buffer may hold: refused, and what was there stays.
  GpuLobes gpu = upload(small);
  int limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
  if (limit < 1 << 20) {
    EXPECT_THROW(place(gpu, {}, std::vector<Sphere>(std::size_t(limit), {V3f(0, 1, 0), 0.1F})), Error);
    EXPECT_EQ(gpu.spheres, 0);
  }
}

}  // namespace
}  // namespace ivory
