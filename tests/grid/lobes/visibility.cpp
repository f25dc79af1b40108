// Masks of spheres over a light, against the same spheres asked direction by direction.
#include "grid/lobes/visibility.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace ivory {
namespace {

// Deterministic numbers in [0, 1).
struct Numbers {
  std::uint32_t state = 12345;
  float next() {
    state = state * 1664525U + 1013904223U;
    return float(state >> 8U) * 0x1p-24F;
  }
};

// The fraction of the cap's solid angle that the mask leaves lit, by cells.
float lit_fraction(const ShadowMask& mask, const LightCap& cap) {
  if (!mask.any) return 1;
  const std::span<const MaskBlock> cells = mask_blocks().subspan(((std::size_t(1) << 2 * mask.depth) - 1) / 3);
  const int n = 1 << mask.depth;
  const float t2 = cap.tan_half * cap.tan_half;
  float lit = 0;
  float sum = 0;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const MaskBlock& cell = cells[std::size_t(j * n + i)];
      const float height = 4 * t2 * cell.area / ((1 + t2 * cell.a) * (1 + t2 * cell.b));
      sum += height;
      if ((mask.rows[std::size_t(j)] >> unsigned(i) & 1U) == 0) lit += height;
    }
  }
  return lit / sum;
}

// Fraction of the light's solid angle that the spheres leave lit: 400 x 400 directions of equal solid angle.
double brute_force(const Sphere& light, const V3f& p, const std::vector<Sphere>& spheres) {
  const LightCap cap = make_light_cap(light, p);
  constexpr int n = 400;
  int lit = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const float z = 1 - cap.height * (float(i) + 0.5F) / n;
      const float r = std::sqrt(1 - z * z);
      const float phi = 2 * pi * (float(j) + 0.5F) / n;
      const V3f w = cap.x * (r * std::cos(phi)) + cap.y * (r * std::sin(phi)) + cap.z * z;
      bool hidden = false;
      for (const Sphere& s : spheres)
        hidden = hidden || (power(s, p) > 0 && power(s, p) < power(light, p) && meets(s, p, w));
      lit += hidden ? 0 : 1;
    }
  }
  return double(lit) / (n * n);
}

double leaf_sum(const std::vector<MaskLeaf>& leaves, int count, bool lit_only) {
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    if (leaves[std::size_t(i)].lit || !lit_only) sum += double(leaves[std::size_t(i)].height);
  }
  return sum;
}

TEST(ShadowMask, AgreesWithDirectionsOneByOne) {
  Numbers u;
  std::vector<MaskLeaf> leaves(max_mask_leaves);
  double worst[max_mask_depth + 1] = {};
  for (int scene = 0; scene < 60; ++scene) {
    const V3f p(5 * u.next(), -3 * u.next(), u.next());
    // Lights from 1 to 60 degrees of half-angle, in all directions.
    const V3f d = V3f(u.next() - 0.5F, u.next() - 0.5F, u.next() - 0.5F).normalized();
    const Sphere light{p + d * 4.0F, 4 * std::sin(0.02F + u.next())};
    std::vector<Sphere> spheres;
    const int count = 1 + int(6 * u.next());
    for (int i = 0; i < count; ++i) {
      const V3f offset(u.next() - 0.5F, u.next() - 0.5F, u.next() - 0.5F);
      spheres.push_back(
          {p + d * (0.5F + 2 * u.next()) + offset * (1.5F * light.radius_m), 0.6F * light.radius_m * u.next()});
    }
    const double truth = brute_force(light, p, spheres);
    const LightCap cap = make_light_cap(light, p);
    for (int depth = 3; depth <= max_mask_depth; ++depth) {
      const ShadowMask mask = make_shadow_mask(light, cap, p, spheres, depth);
      const double lit = double(lit_fraction(mask, cap));
      worst[depth] = std::max(worst[depth], std::abs(lit - truth));
      const int leaf_count = mask_leaves(mask, cap, leaves);
      // Shares of blocks are of second order in r^2: 1 % holds for lights of 60 degrees.
      EXPECT_NEAR(leaf_sum(leaves, leaf_count, true) / double(cap.height), lit, 0.01);
    }
  }
  // Cells' centres decide: an edge's error is a fraction of a cell, averaged along it.
  EXPECT_LT(worst[3], 0.08);
  EXPECT_LT(worst[4], 0.03);
  EXPECT_LT(worst[5], 0.012);
}

TEST(ShadowMask, RulesBracketTheCenters) {
  const V3f p(0, 0, 0);
  const Sphere light{V3f(0, 0, 5), 1};
  const std::vector<Sphere> spheres{{V3f(0.2F, 0.1F, 2), 0.3F}};
  const LightCap cap = make_light_cap(light, p);
  const auto lit = [&](MaskRule rule) { return lit_fraction(make_shadow_mask(light, cap, p, spheres, 4, rule), cap); };
  const double truth = brute_force(light, p, spheres);
  EXPECT_GT(lit(MaskRule::inside), float(truth) + 0.02F);
  EXPECT_LT(lit(MaskRule::touched), float(truth) - 0.02F);
  EXPECT_NEAR(lit(MaskRule::center), truth, 0.01);
}

TEST(ShadowMask, LeavesAddUpToTheLight) {
  Numbers u;
  std::vector<MaskLeaf> leaves(max_mask_leaves);
  for (const float half : {0.001F, 0.1F, 0.5F, 1.0F}) {
    const V3f p(0, 0, 0);
    const Sphere light{V3f(0, 3, 0), 3 * std::sin(half)};
    const LightCap cap = make_light_cap(light, p);
    for (int trial = 0; trial < 20; ++trial) {
      const std::vector<Sphere> spheres{{V3f(u.next() - 0.5F, 1, u.next() - 0.5F) * half, half * u.next()}};
      const ShadowMask mask = make_shadow_mask(light, cap, p, spheres, 5);
      for (int level = 0; level <= 3; ++level) {
        const int count = mask_leaves(mask, cap, leaves, level);
        EXPECT_NEAR(leaf_sum(leaves, count, false) / double(cap.height), 1, half > 0.9F ? 6e-3 : 5e-4);
        for (int i = 0; i < count; ++i) {
          EXPECT_GE(leaves[std::size_t(i)].level, level);
          EXPECT_NEAR(leaves[std::size_t(i)].axis.length(), 1, 1e-5F);
          EXPECT_GE(leaves[std::size_t(i)].axis.dot(cap.z), 1 - cap.height - 1e-6F);
        }
      }
    }
  }
}

TEST(ShadowMask, FullyCoveredIsOneDarkLeaf) {
  std::vector<MaskLeaf> leaves(max_mask_leaves);
  const V3f p(0, 0, 0);
  const Sphere light{V3f(0, 3, 0), 0.5F};
  const LightCap cap = make_light_cap(light, p);
  // One sphere alone, and four that only do it together.
  const std::vector<std::vector<Sphere>> sets{{{V3f(0, 1, 0), 0.4F}},
                                              {{V3f(0.1F, 1, 0.1F), 0.17F},
                                               {V3f(-0.1F, 1, 0.1F), 0.17F},
                                               {V3f(0.1F, 1, -0.1F), 0.17F},
                                               {V3f(-0.1F, 1, -0.1F), 0.17F}}};
  for (const auto& set : sets) {
    for (int depth = 0; depth <= max_mask_depth; ++depth) {
      const ShadowMask mask = make_shadow_mask(light, cap, p, set, depth);
      ASSERT_EQ(mask_leaves(mask, cap, leaves), 1);
      EXPECT_FALSE(leaves[0].lit);
      EXPECT_NEAR(leaves[0].height / cap.height, 1, 1e-3F);
    }
  }
}

TEST(ShadowMask, OnlyWhatStandsBetweenCastsShadows) {
  const V3f p(0, 0, 0);
  const Sphere light{V3f(0, 3, 0), 0.5F};
  const LightCap cap = make_light_cap(light, p);
  EXPECT_FALSE(make_shadow_mask(light, cap, p, std::vector<Sphere>{{V3f(0, 5, 0), 1}}, 5).any);        // behind it
  EXPECT_FALSE(make_shadow_mask(light, cap, p, std::vector<Sphere>{{V3f(0, -1, 0), 0.5F}}, 5).any);    // behind p
  EXPECT_FALSE(make_shadow_mask(light, cap, p, std::vector<Sphere>{{V3f(0, 0.1F, 0), 0.5F}}, 5).any);  // around p
  EXPECT_FALSE(make_shadow_mask(light, cap, p, std::vector<Sphere>{{V3f(2, 1, 0), 0.5F}}, 5).any);     // beside
  EXPECT_FALSE(make_shadow_mask(light, cap, p, std::vector<Sphere>{light}, 5).any);  // the light itself
}

// A sphere that p nearly touches hides almost a half space: the direction opposite to the light may be inside its cone.
TEST(ShadowMask, HugeConesMayHoldTheOppositeDirection) {
  const V3f p(0, 0, 0);
  const Sphere light{V3f(0, 3, 0), 2.9F};
  const LightCap cap = make_light_cap(light, p);
  for (const float angle : {1.7F, 2.0F, 2.3F, 2.6F}) {
    const V3f o(std::sin(angle), std::cos(angle), 0);
    const std::vector<Sphere> spheres{{o * 1.0F, 0.99999F}};
    const ShadowMask mask = make_shadow_mask(light, cap, p, spheres, 5);
    EXPECT_NEAR(mask.any ? lit_fraction(mask, cap) : 1.0F, brute_force(light, p, spheres), 0.01) << angle;
  }
}

// Groups leave nothing out that a test sphere by sphere finds.
TEST(SphereGroups, FindWhatEachSphereAloneWouldBeFoundBy) {
  Numbers u;
  for (const int count : {0, 1, 7, 9, 300}) {
    const V3f at(100 * u.next(), -70 * u.next(), 0);
    std::vector<Sphere> spheres;
    for (int i = 0; i < count; ++i)
      spheres.push_back({at + V3f(u.next(), u.next(), u.next()), 0.001F + 0.1F * u.next()});
    const SphereGroups groups = make_sphere_groups(spheres);
    ASSERT_EQ(groups.spheres.size(), spheres.size());
    std::vector<Sphere> found;
    for (int k = 0; k < 50; ++k) {
      const V3f p = at + V3f(u.next(), u.next(), u.next()) * 3.0F - V3f(1, 1, 1);
      const float half = 1.5F * u.next();
      const Cone cone{p, V3f(u.next() - 0.5F, u.next() - 0.5F, 0.3F).normalized(), std::cos(half), std::sin(half)};
      find_hiding(groups, cone, found);
      std::size_t expected = 0;
      for (const Sphere& s : spheres) expected += power(s, p) > 0 && may_hide(s, cone) ? 1U : 0U;
      EXPECT_EQ(found.size(), expected);
      for (const Sphere& s : spheres) {
        // The definition itself: the angle to the centre against both half-angles.
        if (!(power(s, p) > 0)) continue;
        const V3f d = s.center - p;
        const float angle = std::acos(std::clamp(d.normalized().dot(cone.axis), -1.0F, 1.0F));
        const float gap = angle - half - std::asin(s.radius_m / d.length());
        if (std::abs(gap) > 1e-3F) {
          EXPECT_EQ(may_hide(s, cone), gap < 0);
        }
      }
    }
  }
}

}  // namespace
}  // namespace ivory
