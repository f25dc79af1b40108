#include "grid/io/vdb/read_levels.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/io/vdb/layout.h"

namespace ivory {
namespace {

// A visible fraction, a guard record and, while a grid is read, OpenVDB's 12 bytes for a vector or 8 for a sum.
constexpr std::size_t kept_bytes_per_vertex = sizeof(float) + sizeof(GuardRecord) + 12;

std::array<double, 16> matrix_of(const OpenVdbFile& in, const openvdb::math::Transform& transform) {
  if (!transform.isLinear()) throw Error(in.path, "its transform is not linear", read_remedy);
  const openvdb::Mat4d matrix = transform.baseMap()->getAffineMap()->getMat4();
  std::array<double, 16> entries;
  std::copy_n(matrix.asPointer(), 16, entries.begin());
  return entries;
}

// The bricks of a finer level: those that a grid is active in, all of which it must be.
std::vector<V3i> active_bricks(const OpenVdbFile& in, const openvdb::FloatGrid& grid, const GridFrame& frame) {
  const V3i count = frame.size / brick_side;
  const auto index = [&](int x, int y, int z) {
    return (std::size_t(z) * std::size_t(count.y) + std::size_t(y)) * std::size_t(count.x) + std::size_t(x);
  };
  std::vector<std::uint8_t> active(index(0, 0, count.z), 0);
  for (auto at = grid.cbeginValueOn(); at; ++at) {
    // A voxel, or a tile that OpenVDB has made of equal ones.
    const openvdb::CoordBBox box = at.getBoundingBox();
    const openvdb::Coord last = box.max();
    for (int z = box.min().z(); z <= last.z(); z = (z | 3) + 1) {
      for (int y = box.min().y(); y <= last.y(); y = (y | 3) + 1) {
        for (int x = box.min().x(); x <= last.x(); x = (x | 3) + 1) {
          const auto along = [](int from, int to) { return std::min(to, from | 3) - from + 1; };
          active[index(x >> 2, y >> 2, z >> 2)] +=
              std::uint8_t(along(x, last.x()) * along(y, last.y()) * along(z, last.z()));
        }
      }
    }
  }
  std::vector<V3i> bricks;
  for (int z = 0; z < count.z; ++z) {
    for (int y = 0; y < count.y; ++y) {
      for (int x = 0; x < count.x; ++x) {
        const int vertices = active[index(x, y, z)];
        if (vertices != 0 && vertices != brick_vertices)
          throw Error(in.path, "grid " + grid.getName() + " has a brick that is not whole", read_remedy);
        if (vertices != 0) bricks.emplace_back(x, y, z);
      }
    }
  }
  return bricks;
}

// Finer levels stand where their transforms say, which must be where the coarsest one says: moved together.
void check_level(const OpenVdbFile& in, const PlacedFrame& level, const openvdb::math::Transform& transform) {
  const std::array<double, 16> is = matrix_of(in, transform);
  const std::array<double, 16> expected = transform_matrix(level);
  const double voxel_m = double(std::min({level.frame.spacing_m.x, level.frame.spacing_m.y, level.frame.spacing_m.z}));
  for (std::size_t i = 0; i < 16; ++i) {
    // Along the whole grid an error in a voxel's edge adds up.
    const double tolerance =
        i < 12 ? 1e-2 / std::max({level.frame.size.x, level.frame.size.y, level.frame.size.z}) : 1e-2;
    if (!(std::abs(is[i] - expected[i]) <= tolerance * voxel_m))
      throw Error(in.path, "its levels have transforms that disagree", "move all grids of the file together");
  }
}

// Fills in lattice and visible fractions.
void read_lattice(OpenVdbFile& in, std::size_t bytes_per_vertex, ReadVertices& read) {
  GridVertices& out = read.vertices;
  const GridFrame stored = in.stored_frame(bytes_per_vertex);
  const int levels = in.stored_levels();
  check_memory(in.path, table_bytes(stored, levels), "use a larger machine or bake at a lower resolution");
  const auto visible = in.grid<openvdb::FloatGrid>(visible_fraction_name, stored, nullptr);
  read.transforms.push_back(visible->transformPtr());
  const PlacedFrame placed =
      frame_from_transform(in.path, matrix_of(in, *read.transforms[0]), {stored, in.stored_anchor()});
  out.anchor_m = placed.anchor_m;

  std::vector<openvdb::FloatGrid::Ptr> finer;
  std::vector<std::vector<V3i>> bricks;
  GridFrame frame = placed.frame;
  double vertices = double(stored.vertex_count());
  for (int level = 1; level < levels; ++level) {
    if (std::max({frame.size.x, frame.size.y, frame.size.z}) > 1 << 19) throw in.missing(file_prefix + levels_key);
    if (level == 1 && (frame.size.x % 2 != 0 || frame.size.y % 2 != 0 || frame.size.z % 2 != 0))
      throw in.missing(file_prefix + "size");
    frame = finer_frame(frame);
    finer.push_back(in.grid<openvdb::FloatGrid>(visible_fraction_name + level_suffix(level), frame, nullptr));
    read.transforms.push_back(finer.back()->transformPtr());
    check_level(in, {frame, out.anchor_m}, *read.transforms.back());
    vertices += double(finer.back()->activeVoxelCount());
    check_memory(in.path, vertices * double(bytes_per_vertex), "use a larger machine or bake at a lower resolution");
    bricks.push_back(active_bricks(in, *finer.back(), frame));
    if (bricks.back().empty()) throw in.missing("the bricks of level " + std::to_string(level));
  }
  static_cast<Lattice&>(out) = make_lattice(placed.frame, bricks);
  // What it had to add is not in the file.
  if (double(out.vertex_count()) != vertices)
    throw Error(in.path, "its levels disagree: around a finer brick coarser ones are not there", read_remedy);

  out.visible_fraction.assign(out.vertex_count(), 0.0F);
  for (int level = 0; level < levels; ++level) {
    for_each_vertex(level == 0 ? *visible : *finer[std::size_t(level - 1)], out, level,
                    [&](std::size_t vertex, float value) {
                      if (!(value >= 0 && value <= 1))
                        throw Error(in.path, "grid visible_fraction leaves 0 to 1", read_remedy);
                      out.visible_fraction[vertex] = value;
                    });
  }
}

}  // namespace

std::vector<std::vector<float>> read_vectors(const OpenVdbFile& in, const std::vector<std::string>& grid_names,
                                             const ReadVertices& read, float least) {
  std::vector<std::vector<float>> values(grid_names.size());
  tbb::enumerable_thread_specific<std::unique_ptr<openvdb::io::File>> files;
  tbb::parallel_for(std::size_t(0), grid_names.size(), [&](std::size_t i) {
    std::unique_ptr<openvdb::io::File>& from = files.local();
    if (!from) from = in.another();
    std::vector<float>& out = values[i];
    out.resize(3 * read.vertices.vertex_count());
    read_levels<openvdb::Vec3SGrid>(
        in, *from, grid_names[i], read, [&](std::size_t vertex, const openvdb::Vec3s& value) {
          for (int k = 0; k < 3; ++k) {
            if (!std::isfinite(value[k]) || value[k] < least) {
              throw Error(in.path, "grid " + grid_names[i] + " holds a value that is not finite or negative",
                          "bake it again");
            }
            out[3 * vertex + std::size_t(k)] = value[k];
          }
        });
  });
  return values;
}

ReadVertices read_vertices(OpenVdbFile& in, Basis basis, std::size_t bytes_per_vertex) {
  ReadVertices read;
  GridVertices& out = read.vertices;
  out.basis = basis;
  out.metadata = in.caller_metadata();
  if (const auto light = out.metadata.extract(light_key)) {
    const auto stored = find_by_name<StoredLight>(std::get<std::string>(light.mapped()));
    if (!stored) throw in.missing(meta_prefix + light_key);
    out.light = *stored;
  }
  read_lattice(in, kept_bytes_per_vertex + bytes_per_vertex, read);
  if (!in.file.hasGrid(guard_name(0))) return read;
  const std::vector<std::vector<float>> halves = read_vectors(in, {guard_name(0), guard_name(1)}, read, 0);
  out.guard.resize(out.vertex_count());
  for (std::size_t vertex = 0; vertex < out.guard.size(); ++vertex) {
    std::array<float, 6> six{};
    for (std::size_t half = 0; half < 2; ++half)
      std::copy_n(halves[half].begin() + std::ptrdiff_t(3 * vertex), 3, six.begin() + std::ptrdiff_t(3 * half));
    const auto record = guard_from_floats(six);
    if (!record) throw in.missing("grid " + guard_name(0));
    out.guard[vertex] = *record;
  }
  return read;
}

}  // namespace ivory
