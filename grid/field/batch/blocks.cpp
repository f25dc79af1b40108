#include "grid/field/batch/blocks.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <memory>
#include <numeric>

namespace ivory {

namespace {

// Footprints are large, and little of them is written: no zeros are put in first.
std::unique_ptr<Footprint[]> new_block() { return std::make_unique_for_overwrite<Footprint[]>(points_a_block); }

// Eight points of one level, whose footprints go to `out`. Those that need help are marked.
struct Group {
  std::array<const LookupPoint*, points_at_once> at;
  std::array<Footprint*, points_at_once> out;
  std::array<bool*, points_at_once> needs_help;
  std::size_t count = 0;

  void add(const LookupPoint& point, Footprint& footprint, bool& help) {
    at[count] = &point;
    out[count] = &footprint;
    needs_help[count++] = &help;
  }
  void read(int level, float least_kept, const ReadLevel& read_level) {
    if (count == 0) return;
    const Corners corners = read_level(level, make_points({at.data(), count}));
    for (std::size_t i = 0; i < count; ++i) {
      if (corners.kept[i] < least_kept) {
        *needs_help[i] = true;
      } else {
        *out[i] = footprint_of(corners, i);
      }
    }
    count = 0;
  }
};

}  // namespace

void read_levels(const IrradianceGrid& grid, std::span<const LookupPoint> at, float least_kept,
                 const ReadLevel& read_level, const Reread& reread, std::span<Footprint> footprints) {
  assert(at.size() <= points_a_block);
  std::array<bool, points_a_block> needs_help{};
  std::array<Group, max_levels> groups;
  const auto add = [&](int level, std::size_t point, Footprint& out) {
    Group& group = groups[std::size_t(level)];
    group.add(at[point], out, needs_help[point]);
    if (group.count == points_at_once) group.read(level, least_kept, read_level);
  };
  std::array<LevelShares, points_a_block> shares;
  std::unique_ptr<Footprint[]> coarser;
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (grid.levels() > 1) shares[i] = level_shares(grid, at[i]);
    add(shares[i].level[0], i, footprints[i]);
    if (shares[i].share[1] <= 0) continue;
    if (!coarser) coarser = new_block();
    add(shares[i].level[1], i, coarser[i]);
  }
  for (int level = 0; level < grid.levels(); ++level) groups[std::size_t(level)].read(level, least_kept, read_level);
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (needs_help[i]) {
      footprints[i] = reread(i);
    } else if (shares[i].share[1] > 0) {
      footprints[i] = blend(footprints[i], coarser[i], shares[i].share[0]);
    }
  }
}

namespace {

// The points' numbers, those of a cell next to each other but for chance: what vertices and triangles they share is in
// cache then, and in a block look-ups of the same kind meet. In random order a look-up takes 1.3 to 2 times as long.
std::vector<std::uint32_t> cell_order(const IrradianceGrid& grid, std::span<const V3f> p) {
  const GridFrame& frame = grid.finest_frame();
  const double cells = double(frame.size.x) * double(frame.size.y) * double(frame.size.z);
  const std::size_t buckets = std::bit_ceil(std::min<std::size_t>(p.size(), 1U << 20U));
  const double scale = double(buckets) / cells;
  std::vector<std::uint32_t> bucket(p.size());
  std::vector<std::uint32_t> begin(buckets + 1, 0);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const V3f index = frame.to_index(p[i]);
    double cell = 0;
    for (int axis = 2; axis >= 0; --axis) {
      // Not std::clamp: what is no number comes to the first cell.
      const float along = index[axis] > 0 ? std::min(index[axis], float(frame.size[axis] - 1)) : 0.0F;
      cell = cell * double(frame.size[axis]) + std::floor(along);
    }
    bucket[i] = std::min(std::uint32_t(cell * scale), std::uint32_t(buckets - 1));
    ++begin[bucket[i] + 1];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> order(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) order[begin[bucket[i]]++] = std::uint32_t(i);
  return order;
}

// Calls use(numbers, normals, footprints) for the points block by block, whose numbers those are.
template <typename Use>
void for_each_block(const IrradianceGrid& grid, const LookupSpans& at, std::span<const V3f> n, const ReadBlock& read,
                    const Use& use) {
  assert(at.p.size() == at.ng.size() && at.p.size() == n.size());
  const std::unique_ptr<Footprint[]> block = new_block();
  std::array<V3f, points_a_block> p;
  std::array<V3f, points_a_block> ng;
  std::array<V3f, points_a_block> normals;
  const std::vector<std::uint32_t> order = cell_order(grid, at.p);
  for (std::size_t first = 0; first < order.size(); first += points_a_block) {
    const std::size_t count = std::min(points_a_block, order.size() - first);
    const std::span<const std::uint32_t> numbers = std::span(order).subspan(first, count);
    for (std::size_t i = 0; i < count; ++i) {
      p[i] = at.p[numbers[i]];
      ng[i] = at.ng[numbers[i]];
      normals[i] = n[numbers[i]];
    }
    for (const std::uint32_t next :
         std::span(order).subspan(first + count).first(std::min(count, order.size() - first - count))) {
      __builtin_prefetch(&at.p[next]);
      __builtin_prefetch(&at.ng[next]);
      __builtin_prefetch(&n[next]);
    }
    const std::span<Footprint> footprints(block.get(), count);
    read(std::span(p).first(count), std::span(ng).first(count), footprints);
    use(numbers, std::span<const V3f>(normals).first(count), footprints);
  }
}

}  // namespace

std::vector<Rgb> read_irradiance(const IrradianceGrid& grid, const LookupSpans& at, std::span<const V3f> n,
                                 Reconstruction reconstruction, const ReadBlock& read) {
  std::vector<Rgb> out(at.p.size());
  for_each_block(grid, at, n, read,
                 [&](const auto& numbers, std::span<const V3f> normals, std::span<const Footprint> footprints) {
                   std::array<Rgb, points_a_block> e;
                   irradiance(grid, footprints, normals, reconstruction, std::span(e).first(normals.size()));
                   for (std::size_t i = 0; i < numbers.size(); ++i) out[numbers[i]] = e[i];
                 });
  return out;
}

std::vector<GridReading> read_readings(const IrradianceGrid& grid, const LookupSpans& at, std::span<const V3f> n,
                                       Reconstruction reconstruction, float unmet_lux, const ReadBlock& read) {
  std::vector<GridReading> out(at.p.size());
  for_each_block(grid, at, n, read,
                 [&](const auto& numbers, std::span<const V3f> normals, std::span<const Footprint> footprints) {
                   std::array<Rgb, points_a_block> e;
                   irradiance(grid, footprints, normals, reconstruction, std::span(e).first(normals.size()));
                   for (std::size_t i = 0; i < numbers.size(); ++i) {
                     const Footprint& footprint = footprints[i];
                     out[numbers[i]] = {e[i], irradiance_standard_error(grid, footprint, unmet_lux),
                                        footprint.count > 0, !is_black(irradiance_standard_error(grid, footprint))};
                   }
                 });
  return out;
}

}  // namespace ivory
