#include "tracer/bake/field/vertex_visibility.h"

#include <array>
#include <bit>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "tracer/bake/field/scene_lattice.h"

namespace ivory {
namespace {

constexpr int corners = 5;  // lattice points along an axis: the corners of four subcells

// The corners are drawn in a little, so that a wall which lies on a border between subcells is on
// neither side of it.
constexpr float inset = 0.49F;

float corner_offset(int i) { return (static_cast<float>(i) / (corners - 1) * 2 - 1) * inset; }

std::uint64_t subcells_seen_whole(const std::array<bool, 125>& seen) {
  std::uint64_t mask = 0;
  for (unsigned bit = 0; bit < 64; ++bit) {
    const unsigned x = bit & 3U;
    const unsigned y = (bit >> 2U) & 3U;
    const unsigned z = bit >> 4U;
    bool whole = true;
    for (unsigned corner = 0; corner < 8; ++corner) {
      const unsigned i = x + (corner & 1U);
      const unsigned j = y + ((corner >> 1U) & 1U);
      const unsigned k = z + (corner >> 2U);
      whole = whole && seen[(k * corners + j) * corners + i];
    }
    if (whole) mask |= std::uint64_t(1) << bit;
  }
  return mask;
}

std::uint64_t cell_mask(const Intersector& intersector, const GridFrame& frame, const V3f& vertex_index) {
  const V3f eye = frame.to_world(vertex_index);
  std::array<bool, 125> seen{};
  std::array<V3f, 8> targets;
  int filled = 0;
  int first = 0;
  const auto query = [&] {
    const std::uint32_t bits = intersector.visible(eye, targets, filled);
    for (int i = 0; i < filled; ++i) seen[std::size_t(first + i)] = ((bits >> unsigned(i)) & 1U) != 0;
    first += filled;
    filled = 0;
  };
  for (int k = 0; k < corners; ++k) {
    for (int j = 0; j < corners; ++j) {
      for (int i = 0; i < corners; ++i) {
        targets[std::size_t(filled++)] =
            frame.to_world(vertex_index + V3f(corner_offset(i), corner_offset(j), corner_offset(k)));
        if (filled == 8) query();
      }
    }
  }
  query();
  return subcells_seen_whole(seen);
}

}  // namespace

std::vector<std::uint64_t> vertex_cell_masks(const Intersector& intersector, const Lattice& lattice) {
  std::vector<std::uint64_t> masks(lattice.vertex_count(), ~std::uint64_t(0));
  if (intersector.radius_m() == 0) return masks;
  // In the open, cells are seen whole.
  const std::vector<NearVertices> near = vertices_near_surfaces(intersector.scene(), lattice, 0.6F);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, masks.size(), 256), [&](const auto& range) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) {
      const VertexPlace place = lattice.place_of(std::uint32_t(v));
      if (!near[std::size_t(place.level)].holds(place.at)) continue;
      masks[v] = cell_mask(intersector, lattice.frame_of(place.level), V3f(place.at));
    }
  });
  return masks;
}

std::vector<float> visible_fractions(const std::vector<std::uint64_t>& masks) {
  std::vector<float> out;
  out.reserve(masks.size());
  for (const std::uint64_t mask : masks) out.push_back(static_cast<float>(std::popcount(mask)) / 64);
  return out;
}

}  // namespace ivory
