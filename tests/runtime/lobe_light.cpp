// shaders/lobes/visibility.glsl and lobes/light.glsl against their C++ twins: masks bit by bit, leaves, and the light.
#include <bit>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "runtime/assets/lobes.h"
#include "tests/support/runtime_twin.h"

namespace ivory {
namespace {

constexpr int count = 10000;

class RuntimeLobeLight : public GlTest {};

// A receiver, a light and two spheres that may hide some of it, hold p, touch it, lie behind it.
struct Masked {
  std::vector<V4f> p, light, first, second;
};
Masked random_masked(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  Masked m;
  for (int i = 0; i < count; ++i) {
    const V3f p = random_direction(random) * (3 * unit(random));
    const V3f d = random_direction(random);
    const float distance = 1 + 5 * unit(random);
    const float radius = distance * std::sin(0.001F + 1.4F * unit(random) * unit(random));
    const auto sphere = [&] {
      const V3f center = p + d * (distance * unit(random)) + random_direction(random) * (1.5F * radius * unit(random));
      float r = radius * unit(random);
      // One in six nearly touches p: a half space; one in twelve holds it.
      if (i % 6 == 0) r = (center - p).length() * (1 - 1e-4F * unit(random));
      if (i % 12 == 1) r = (center - p).length() * 1.01F;
      return to_v4(center, r);
    };
    m.p.push_back(to_v4(p, unit(random)));
    m.light.push_back(to_v4(p + d * distance, radius));
    m.first.push_back(sphere());
    m.second.push_back(sphere());
  }
  return m;
}

// Each input `times` times.
std::vector<V4f> repeated(const std::vector<V4f>& in, int times) {
  std::vector<V4f> out;
  out.reserve(in.size() * std::size_t(times));
  for (const V4f& v : in) out.insert(out.end(), std::size_t(times), v);
  return out;
}

Sphere sphere_of(const V4f& v) { return {xyz(v), v.w}; }

constexpr const char* make_rows = R"(
#include "lobes/visibility.glsl"
uniform float grow;
IvoryLightCap cap_of(int i) { return ivory_make_light_cap(input1(i), input0(i).xyz); }
void rows_of(int i, out uint rows[IVORY_MASK_SIZE]) {
  vec3 p = input0(i).xyz;
  IvoryLightCap cap = cap_of(i);
  float light_power = ivory_power(input1(i), p);
  for (int j = 0; j < IVORY_MASK_SIZE; ++j) rows[j] = 0u;
  ivory_splat_sphere(rows, input2(i), true, cap, p, light_power, grow);
  ivory_splat_sphere(rows, input3(i), true, cap, p, light_power, grow);
}
)";

std::string defines(int mask_depth, int leaf_depth) {
  return fmt::format("#define IVORY_MASK_DEPTH {}\n#define IVORY_LEAF_DEPTH {}\n", mask_depth, leaf_depth);
}

ShadowMask mask_of(const Masked& m, std::size_t i, int depth, MaskRule rule = MaskRule::center) {
  const Sphere light = sphere_of(m.light[i]);
  const V3f p = xyz(m.p[i]);
  const std::vector<Sphere> spheres{sphere_of(m.first[i]), sphere_of(m.second[i])};
  ShadowMask mask = make_shadow_mask(light, make_light_cap(light, p), p, spheres, depth, rule);
  if (!mask.any) mask.rows.fill(0);
  return mask;
}

TEST_F(RuntimeLobeLight, LightCaps) {
  const Masked m = random_masked(1);
  const auto frames = evaluate_on_gpu(defines(0, 0) + make_rows + R"(
vec4 evaluate(int i) { IvoryLightCap c = cap_of(i); return vec4(c.x + 2.0 * c.y + 4.0 * c.z, c.height); })",
                                      {m.p, m.light, m.first, m.second});
  const auto tangents = evaluate_on_gpu(
      defines(0, 0) + make_rows + "vec4 evaluate(int i) { IvoryLightCap c = cap_of(i); return vec4(c.z, c.tan_half); }",
      {m.p, m.light, m.first, m.second});
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const LightCap cap = make_light_cap(sphere_of(m.light[i]), xyz(m.p[i]));
    EXPECT_LT((xyz(frames[i]) - (cap.x + cap.y * 2.0F + cap.z * 4.0F)).length(), 1e-5F);
    EXPECT_LT((xyz(tangents[i]) - cap.z).length(), 1e-6F);
    EXPECT_NEAR(frames[i].w / cap.height, 1, 1e-5F);
    EXPECT_NEAR(tangents[i].w / cap.tan_half, 1, 1e-5F);
  }
}

// All bits of all rows, two rows an evaluation. A cell's centre within a few roundings of a sphere's edge may fall on
// either side: one mask of a hundred, by one bit in fifty thousand.
TEST_F(RuntimeLobeLight, MasksBitByBit) {
  const Masked m = random_masked(2);
  for (int depth = 0; depth <= max_mask_depth; ++depth) {
    for (const MaskRule rule : {MaskRule::center, MaskRule::inside, MaskRule::touched}) {
      if (rule != MaskRule::center && depth != 4) continue;
      const int pairs = std::max(1, (1 << depth) / 2);
      const float grow = rule == MaskRule::center
                             ? 0
                             : (rule == MaskRule::inside ? -1.0F : 1.0F) * std::sqrt(2.0F) / float(1 << depth);
      std::vector<V4f> light = repeated(m.light, pairs);
      std::vector<V4f> p = repeated(m.p, pairs);
      for (std::size_t i = 0; i < p.size(); ++i) p[i].w = float(int(i) % pairs);
      const auto out = evaluate_on_gpu(defines(depth, depth) + make_rows + R"(
vec4 evaluate(int i) {
  uint rows[IVORY_MASK_SIZE];
  rows_of(i, rows);
  int pair = int(input0(i).w);
  uint a = 0u; uint b = 0u;
  for (int j = 0; j < IVORY_MASK_SIZE; ++j) {
    if (j == 2 * pair) a = rows[j];
    if (j == 2 * pair + 1) b = rows[j];
  }
  return vec4(float(a & 0xffffu), float(a >> 16u), float(b & 0xffffu), float(b >> 16u));
})",
                                       {p, light, repeated(m.first, pairs), repeated(m.second, pairs)},
                                       [grow](gl::Program& program) { program.set("grow", grow); });
      int different_masks = 0;
      int different_bits = 0;
      int dark_bits = 0;
      for (std::size_t i = 0; i < m.p.size(); ++i) {
        const ShadowMask mask = mask_of(m, i, depth, rule);
        bool same = true;
        for (int j = 0; j < 1 << depth; ++j) {
          const V4f& v = out[i * std::size_t(pairs) + std::size_t(j / 2)];
          const auto low = std::uint32_t(j % 2 == 0 ? v.x : v.z);
          const auto high = std::uint32_t(j % 2 == 0 ? v.y : v.w);
          const std::uint32_t expected = mask.rows[std::size_t(j)];
          const std::uint32_t difference = expected ^ (low | high << 16U);
          different_bits += std::popcount(difference);
          dark_bits += std::popcount(expected);
          same = same && difference == 0;
        }
        different_masks += same ? 0 : 1;
      }
      const int cells = count << (2 * depth);
      EXPECT_GT(dark_bits, cells / 20);
      EXPECT_LE(different_masks, count / 100) << depth;
      EXPECT_LE(different_bits, count / 100 + cells / 50000) << depth;
      RecordProperty(fmt::format("depth{}rule{}", depth, int(rule)), fmt::format("{} of {}", different_bits, cells));
    }
  }
}

// Sums over the leaves: their number, lit and dark solid angles, spreads, and the lit ones' axes.
TEST_F(RuntimeLobeLight, Leaves) {
  const GpuLobes gpu = upload(make_lobe_table({3, 3}));
  const Masked m = random_masked(3);
  std::vector<MaskLeaf> leaves(max_mask_leaves);
  for (const auto& [mask_depth, leaf_depth] :
       {std::pair(0, 0), std::pair(0, 3), std::pair(2, 3), std::pair(4, 4), std::pair(5, 5)}) {
    const std::string source = defines(mask_depth, leaf_depth) + make_rows + R"(
uniform samplerBuffer ivory_lobe_blocks;
vec4 evaluate(int i) {
  uint rows[IVORY_MASK_SIZE];
  rows_of(i, rows);
  IvoryLightCap cap = cap_of(i);
  IvoryMaskLeaves leaves = ivory_mask_leaves(rows, int(input0(i).w * float(IVORY_LEAF_DEPTH + 1)));
  IvoryLeafWalk walk = ivory_begin_leaves(leaves);
  float number = 0.0, lit = 0.0, dark = 0.0, spread = 0.0;
  vec3 axis = vec3(0.0);
  do {
    IvoryMaskLeaf leaf = ivory_next_leaf(walk, leaves, ivory_lobe_blocks, cap);
    number += 1.0 + float(leaf.level) / 1024.0;
    if (leaf.lit) lit += leaf.height; else dark += leaf.height;
    spread += leaf.spread * leaf.height;
    axis += leaf.axis * (leaf.lit ? leaf.height : -leaf.height);
  } while (ivory_more_leaves(walk));
  return WANTED;
})";
    const auto bind_blocks = [&gpu](gl::Program& program) {
      bind(gpu, program, 0);
      program.set("grow", 0.0F);
    };
    const std::vector<std::vector<V4f>> in{m.p, m.light, m.first, m.second};
    const auto sums = evaluate_on_gpu("#define WANTED vec4(number, lit, dark, spread)\n" + source, in, bind_blocks);
    const auto axes = evaluate_on_gpu("#define WANTED vec4(axis, 0.0)\n" + source, in, bind_blocks);
    int other_masks = 0;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const LightCap cap = make_light_cap(sphere_of(m.light[i]), xyz(m.p[i]));
      const int least_level = int(m.p[i].w * float(leaf_depth + 1));
      const int n = mask_leaves(mask_of(m, i, mask_depth), cap, leaves, least_level);
      double number = 0, lit = 0, dark = 0, spread = 0;
      V3f axis(0, 0, 0);
      for (int k = 0; k < n; ++k) {
        const MaskLeaf& leaf = leaves[std::size_t(k)];
        number += 1 + leaf.level / 1024.0;
        (leaf.lit ? lit : dark) += double(leaf.height);
        spread += double(leaf.spread * leaf.height);
        axis += leaf.axis * (leaf.lit ? leaf.height : -leaf.height);
      }
      const double h = double(cap.height);
      const bool same = double(sums[i].x) == number && std::abs(double(sums[i].y) - lit) < 1e-4 * h &&
                        std::abs(double(sums[i].z) - dark) < 1e-4 * h;
      if (!same) {
        ++other_masks;
        continue;
      }
      EXPECT_NEAR(double(sums[i].w), spread, 1e-4 * spread + 1e-12);
      EXPECT_LT((xyz(axes[i]) - axis).length(), 1e-4F * cap.height);
    }
    // Of a mask that differs by a bit, see above.
    EXPECT_LE(other_masks, count / 100) << mask_depth << " " << leaf_depth;
  }
}

struct Lit {
  std::vector<RuntimeSphereLight> lights;
  std::vector<Sphere> occluders;
  std::vector<V4f> p, n, wo, material;  // material: roughness alpha
};

// Receivers among clusters of spheres, in some of them, with the lights above, in and below their horizons.
Lit random_lit() {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> unit(0, 1);
  Lit lit;
  lit.lights = {{{V3f(0.5F, 4, 0.2F), 0.7F}, Rgb(10, 5, 1)}, {{V3f(-5, 1, -1), 0.2F}, Rgb(0, 50, 90)}};
  for (int i = 0; i < 40; ++i)
    lit.occluders.push_back({random_direction(random) * (0.9F * unit(random)), 0.05F + 0.3F * unit(random)});
  for (int i = 0; i < count; ++i) {
    const V3f n = i % 2 == 0 ? random_direction(random) : (V3f(0, 1, 0) + random_direction(random) * 0.5F).normalized();
    V3f wo = random_direction(random);
    if (wo.dot(n) < 0) wo = -wo;
    V3f p = random_direction(random) * (3 * unit(random));
    if (i % 4 == 0) p.y = -1;
    if (i % 50 == 0) p = lit.lights[0].sphere.center + random_direction(random) * unit(random);
    lit.p.push_back(to_v4(p));
    lit.n.push_back(to_v4(n));
    lit.wo.push_back(to_v4(wo));
    // From an exponent of 0 to the largest.
    lit.material.push_back(V4f(std::pow(10.0F, -3 * unit(random) * float(i % 5 != 0)), 0, 0, 0));
  }
  return lit;
}

Rgb on_cpu(const LobeTable& table, const Lit& lit, const SphereGroups& groups, const V3f& p, const V3f& ns,
           const ReflectanceLobes& lobes, const LobeLightParams& params) {
  Rgb sum(0, 0, 0);
  for (const RuntimeSphereLight& light : lit.lights)
    sum += light.radiance_nits * lobe_light(table, light.sphere, groups, p, ns, lobes, params);
  return sum;
}

// Compares all receivers. A value counts as different beyond 1e-3 of it or of a twentieth of the light without shadows;
// at most one in two hundred may be so, by a cell of the mask that rounding decides.
void compare(bool glossy, const LobeLightParams& params) {
  const LobeTable table = make_lobe_table();
  GpuLobes gpu = upload(table);
  const Lit lit = random_lit();
  place(gpu, lit.lights, lit.occluders);
  std::vector<Sphere> occluders = lit.occluders;
  for (const RuntimeSphereLight& light : lit.lights) occluders.push_back(light.sphere);
  const SphereGroups groups = make_sphere_groups(occluders);
  const SphereGroups nothing;
  const Rgb albedo(0.5F, 0.3F, 0.1F);
  const Rgb f0(0.2F, 0.5F, 0.04F);
  const AmbientSource source = ambient(gpu, glossy, params);
  const auto out = evaluate_on_gpu(
      source.shader + (glossy ? "vec4 evaluate(int i) { return vec4(ivory_lobe_radiance(input0(i).xyz, input1(i).xyz,"
                                "input2(i).xyz, vec3(0.5, 0.3, 0.1), vec3(0.2, 0.5, 0.04), input3(i).x), 0.0); }"
                              : "vec4 evaluate(int i) { return vec4(ivory_ambient(input0(i).xyz, input1(i).xyz,"
                                "input1(i).xyz), 0.0); }"),
      {lit.p, lit.n, lit.wo, lit.material}, [&](gl::Program& program) { source.bind(program, 0); });
  int different = 0;
  int shadowed = 0;
  double worst = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const V3f p = xyz(lit.p[i]);
    LobeReflectance r;
    r.ns = xyz(lit.n[i]);
    if (glossy) {
      const V3f wo = xyz(lit.wo[i]);
      r.diffuse = albedo * ((1 - 0.5F) / pi);
      const float exponent = phong_exponent(lit.material[i].x);
      r.glossy[0] = {(r.ns * (2 * r.ns.dot(wo)) - wo).normalized(), exponent, f0 * ((exponent + 2) / (2 * pi))};
      r.glossy_count = 1;
    } else {
      r.diffuse = Rgb(1, 1, 1);
    }
    const ReflectanceLobes lobes = make_reflectance_lobes(table, r);
    const Rgb expected = on_cpu(table, lit, groups, p, r.ns, lobes, params);
    const Rgb unshadowed = on_cpu(table, lit, nothing, p, r.ns, lobes, params);
    shadowed += expected.y < 0.9F * unshadowed.y ? 1 : 0;
    bool same = true;
    for (int c = 0; c < 3; ++c) {
      EXPECT_TRUE(std::isfinite(out[i][c])) << p;
      const float scale = std::max({expected[c], 0.05F * unshadowed[c], 1e-20F});
      const float error = std::abs(out[i][c] - expected[c]) / scale;
      same = same && error < 1e-3F;
      if (error < 1e-3F) worst = std::max(worst, double(error));
    }
    different += same ? 0 : 1;
  }
  EXPECT_GT(shadowed, count / 20);
  EXPECT_LE(different, count / 200);
  testing::Test::RecordProperty(fmt::format("glossy{}depth{}split{}threshold{}", glossy, params.mask_depth,
                                            params.max_split_level, params.threshold),
                                fmt::format("{} different, worst of the others {:.2g}", different, worst));
}

// Few variants: a software renderer compiles for seconds.
TEST_F(RuntimeLobeLight, MattSurfaces) {
  compare(false, {});
  compare(false, {.mask_depth = 2, .mask_rule = MaskRule::touched, .threshold = 0.02F});
  compare(false, {.mask_depth = 5, .threshold = 0});
}

TEST_F(RuntimeLobeLight, GlossySurfaces) {
  compare(true, {});
  compare(true, {.mask_depth = 1, .threshold = 0, .max_split_level = 0});
  compare(true, {.mask_depth = 1, .max_split_level = 2});
}

}  // namespace
}  // namespace ivory
