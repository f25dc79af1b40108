// Tetrahedra of a grid of probes: they fill it, and the tree finds the one that a point lies in.
#include "grid/export/probe_tetrahedra.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace ivory {
namespace {

V3d point_of(const ProbeTetrahedra& probes, std::int32_t tetrahedron, int corner) {
  return V3d(probes.points[std::size_t(probes.tetrahedra[std::size_t(tetrahedron)][std::size_t(corner)])]);
}

double volume_of(const ProbeTetrahedra& probes, std::int32_t t) {
  const V3d a = point_of(probes, t, 0);
  return std::abs((point_of(probes, t, 1) - a).dot((point_of(probes, t, 2) - a).cross(point_of(probes, t, 3) - a))) / 6;
}

// As LightStorage::lightmap_tap_sh_light() of Godot 4.7 walks.
std::int32_t walk(const ProbeTetrahedra& probes, const V3f& p) {
  std::int32_t node = 0;
  while (node >= 0) {
    const BspNode& at = probes.nodes[std::size_t(node)];
    const std::int32_t next = at.normal.dot(p) > at.distance ? at.over : at.under;
    EXPECT_TRUE(next < 0 || next > node);  // or Godot refuses it
    node = next;
  }
  return std::abs(node) - 1;
}

TEST(ProbeTetrahedra, FillTheBoxAndAreFound) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  const V3f x = V3f(0.8F, 0, 0.6F);
  const V3f y = V3f(0, 1, 0);
  const V3f z = x.cross(y);
  for (const std::array<std::vector<float>, 3>& at :
       {std::array<std::vector<float>, 3>{{{-0.5F, 0, 1, 2, 2.5F}, {0, 1, 2, 3}, {-1, 0.5F, 2}}},
        std::array<std::vector<float>, 3>{{{0, 1}, {0, 1}, {0, 1}}}}) {
    const ProbeTetrahedra probes = probe_tetrahedra(at, V3f(3, 1, -2), {x * 0.5F, y * 0.7F, z * 0.4F});
    const auto cells = (at[0].size() - 1) * (at[1].size() - 1) * (at[2].size() - 1);
    ASSERT_EQ(probes.tetrahedra.size(), 6 * cells);
    EXPECT_EQ(probes.nodes.size(), 6 * cells - 1);  // a binary tree of that many leaves
    EXPECT_EQ(probes.points.size(), at[0].size() * at[1].size() * at[2].size());
    double volume = 0;
    for (std::size_t t = 0; t < probes.tetrahedra.size(); ++t) volume += volume_of(probes, std::int32_t(t));
    const double box = double(at[0].back() - at[0][0]) * (at[1].back() - at[1][0]) * (at[2].back() - at[2][0]);
    EXPECT_NEAR(volume, box * 0.5 * 0.7 * 0.4, 1e-5);
    for (int i = 0; i < 2000; ++i) {
      V3f p(3, 1, -2);
      p += x * 0.5F * (at[0][0] + uniform(random) * (at[0].back() - at[0][0]));
      p += y * 0.7F * (at[1][0] + uniform(random) * (at[1].back() - at[1][0]));
      p += z * 0.4F * (at[2][0] + uniform(random) * (at[2].back() - at[2][0]));
      const std::int32_t t = walk(probes, p);
      ASSERT_GE(t, 0);
      ASSERT_LT(t, std::int32_t(probes.tetrahedra.size()));
      // Within it: with p in place of each corner in turn, the volumes add up to its own.
      double sum = 0;
      for (int corner = 0; corner < 4; ++corner) {
        const V3d a = point_of(probes, t, (corner + 1) % 4) - V3d(p);
        const V3d b = point_of(probes, t, (corner + 2) % 4) - V3d(p);
        const V3d c = point_of(probes, t, (corner + 3) % 4) - V3d(p);
        sum += std::abs(a.dot(b.cross(c))) / 6;
      }
      EXPECT_NEAR(sum / volume_of(probes, t), 1, 1e-4);  // positions are floats
    }
  }
}

}  // namespace
}  // namespace ivory
