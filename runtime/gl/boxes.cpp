#include "runtime/gl/boxes.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>

namespace ivory {

namespace {

struct Gap {
  V3i corner{0, 0, 0};
  V3i size{0, 0, 0};
};

std::int64_t volume(const V3i& size) { return std::int64_t(size.x) * size.y * size.z; }

bool holds(const V3i& outer, const V3i& inner) {
  return inner.x <= outer.x && inner.y <= outer.y && inner.z <= outer.z;
}

// What is left of a gap beside a box in its corner: three gaps, each cut as large as the ones before allow.
void split(const Gap& gap, V3i box, std::vector<Gap>& gaps) {
  V3i left = gap.size;
  for (unsigned axis = 0; axis < 3; ++axis) {
    Gap rest{gap.corner, left};
    rest.corner[axis] += box[axis];
    rest.size[axis] -= box[axis];
    if (volume(rest.size) > 0) gaps.push_back(rest);
    left[axis] = box[axis];
  }
}

}  // namespace

std::optional<PackedBoxes> pack_boxes(std::span<const V3i> boxes, int limit) {
  PackedBoxes out;
  out.corners.resize(boxes.size());
  std::vector<std::size_t> order(boxes.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return volume(boxes[a]) > volume(boxes[b]); });
  std::vector<Gap> gaps;
  for (const std::size_t i : order) {
    const V3i& box = boxes[i];
    std::size_t best = gaps.size();
    for (std::size_t g = 0; g < gaps.size(); ++g) {
      if (holds(gaps[g].size, box) && (best == gaps.size() || volume(gaps[g].size) < volume(gaps[best].size))) best = g;
    }
    Gap into;
    if (best < gaps.size()) {
      into = gaps[best];
      gaps.erase(gaps.begin() + std::ptrdiff_t(best));
    } else {
      std::int64_t least = std::numeric_limits<std::int64_t>::max();
      V3i grown(0, 0, 0);
      for (unsigned axis = 0; axis < 3; ++axis) {
        V3i size(0, 0, 0);
        for (unsigned a = 0; a < 3; ++a) size[a] = a == axis ? out.size[a] + box[a] : std::max(out.size[a], box[a]);
        if (std::max({size.x, size.y, size.z}) > limit || volume(size) >= least) continue;
        least = volume(size);
        grown = size;
        into.corner = V3i(0, 0, 0);
        into.corner[axis] = out.size[axis];
        into.size = size;
        into.size[axis] = box[axis];
      }
      if (least == std::numeric_limits<std::int64_t>::max()) return std::nullopt;
      // Where the box is longer than the whole was, gaps open beside the old part too.
      V3i beside = grown;
      for (unsigned a = 0; a < 3; ++a) beside[a] -= into.corner[a] > 0 ? into.size[a] : 0;
      if (volume(out.size) > 0) split({V3i(0, 0, 0), beside}, out.size, gaps);
      out.size = grown;
    }
    out.corners[i] = into.corner;
    split(into, box, gaps);
  }
  return out;
}

}  // namespace ivory
