// Laying boxes out in a 3D texture.
#include "runtime/gl/boxes.h"

#include <random>

#include <gtest/gtest.h>

namespace ivory {
namespace {

bool inside(const V3i& corner, const V3i& box, const V3i& whole) {
  for (unsigned a = 0; a < 3; ++a) {
    if (corner[a] < 0 || corner[a] + box[a] > whole[a]) return false;
  }
  return true;
}

bool overlap(const V3i& a, const V3i& size_a, const V3i& b, const V3i& size_b) {
  for (unsigned i = 0; i < 3; ++i) {
    if (a[i] + size_a[i] <= b[i] || b[i] + size_b[i] <= a[i]) return false;
  }
  return true;
}

double volume(const V3i& v) { return double(v.x) * v.y * v.z; }

TEST(Boxes, LieInsideAndApart) {
  std::mt19937 random(1);
  constexpr int rounds = 200;
  double filled_share = 0;
  for (int round = 0; round < rounds; ++round) {
    std::vector<V3i> boxes;
    for (unsigned i = 0; i < 1 + random() % 40; ++i)
      boxes.push_back(V3i{int(1 + random() % 90), int(1 + random() % 60), int(1 + random() % 40)});
    const auto packed = pack_boxes(boxes, 2048);
    ASSERT_TRUE(packed);
    double filled = 0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      filled += volume(boxes[i]);
      ASSERT_TRUE(inside(packed->corners[i], boxes[i], packed->size));
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_FALSE(overlap(packed->corners[i], boxes[i], packed->corners[j], boxes[j]));
    }
    filled_share += filled / volume(packed->size) / rounds;
  }
  // No bound is known; boxes of such different shapes fill 0.55 on average, one beside the other a tenth.
  EXPECT_GT(filled_share, 0.5);
}

TEST(Boxes, EqualOnesLeaveNoGap) {
  const std::vector<V3i> boxes(8, V3i(10, 20, 30));
  const auto packed = pack_boxes(boxes, 2048);
  ASSERT_TRUE(packed);
  EXPECT_EQ(volume(packed->size), 8 * volume(boxes.front()));
}

TEST(Boxes, KeepToTheLimit) {
  const std::vector<V3i> boxes(8, V3i(60, 60, 60));
  const auto packed = pack_boxes(boxes, 120);
  ASSERT_TRUE(packed);
  EXPECT_EQ(packed->size, V3i(120, 120, 120));
  EXPECT_FALSE(pack_boxes(boxes, 119));
  EXPECT_FALSE(pack_boxes(std::vector<V3i>(9, V3i(60, 60, 60)), 120));
  EXPECT_FALSE(pack_boxes(std::vector<V3i>{V3i(121, 1, 1)}, 120));
}

}  // namespace
}  // namespace ivory
