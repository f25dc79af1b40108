// The vertices of a .vdb file: where they stand, level by level, and the values of its grids at them. Names OpenVDB's
// types: private to the readers of grid/io/vdb/.
#pragma once

#include <array>
#include <string>
#include <vector>

#include <openvdb/openvdb.h>

#include "grid/field/irradiance_grid.h"
#include "grid/io/vdb/open_file.h"

namespace ivory {

// What grids and sums have in common, and for each level the transform that all of its grids must share.
struct ReadVertices {
  GridVertices vertices;
  std::vector<openvdb::math::Transform::Ptr> transforms;
};

// Calls take(vertex, value) for every active vertex of a level.
template <typename Grid, typename Take>
void for_each_vertex(const Grid& grid, const Lattice& lattice, int level, const Take& take) {
  typename Grid::ConstAccessor accessor = grid.getConstAccessor();
  typename Grid::ValueType value;
  const std::size_t first = lattice.first_vertex_of(level);
  const std::size_t last = first + lattice.vertex_count_of(level);
  for (std::size_t vertex = first; vertex < last; ++vertex) {
    const V3i at = lattice.place_of(std::uint32_t(vertex)).at;
    if (accessor.probeValue(openvdb::Coord(at.x, at.y, at.z), value)) take(vertex, value);
  }
}

// The same of that grid of all levels.
template <typename Grid, typename Take>
void read_levels(const OpenVdbFile& in, openvdb::io::File& from, const std::string& grid_name, const ReadVertices& read,
                 const Take& take) {
  for (int level = 0; level < read.vertices.levels(); ++level) {
    const auto grid = in.grid<Grid>(from, grid_name + level_suffix(level), read.vertices.frame_of(level),
                                    read.transforms[std::size_t(level)].get());
    for_each_vertex(*grid, read.vertices, level, take);
  }
}

// Vec3f grids, each as [vertex][component], 0 where it is not active; on all threads. Throws Error for values that are
// not finite or below `least`.
std::vector<std::vector<float>> read_vectors(const OpenVdbFile& in, const std::vector<std::string>& grid_names,
                                             const ReadVertices& read, float least);

// Lattice, visible fractions, guard and metadata. `bytes_per_vertex` is what the caller needs at its peak besides them.
// Throws Error where memory does not hold that, and where levels or guard are not whole.
ReadVertices read_vertices(OpenVdbFile& in, Basis basis, std::size_t bytes_per_vertex);

}  // namespace ivory
