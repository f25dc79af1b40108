// Reading half of grid/io/vdb/vdb.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/io/vdb/layout.h"
#include "grid/io/vdb/seal.h"
#include "grid/io/vdb/vdb.h"

namespace ivory {

namespace {

using Vec3fGrid = openvdb::Vec3SGrid;

constexpr const char* read_remedy = "give a .vdb file that ivory baked";

MetaValue value_of(const openvdb::Metadata& value) {
  if (const auto* integer = dynamic_cast<const openvdb::Int64Metadata*>(&value)) return std::int64_t(integer->value());
  if (const auto* number = dynamic_cast<const openvdb::DoubleMetadata*>(&value)) return number->value();
  return value.str();
}

// An opened file and its metadata, wherever they survived.
struct OpenFile {
  OpenFile(std::string shown_path, const std::string& name) : path(std::move(shown_path)), file(name) {
    verify_vdb(name);
    openvdb::initialize();
    file.open(/*delayLoad=*/false);
    metadata = file.getMetadata();
    if ((!metadata || !(*metadata)[file_prefix + "kind"]) && file.hasGrid(visible_fraction_name))
      metadata = file.readGridMetadata(visible_fraction_name);
    if (!metadata || !(*metadata)[file_prefix + "kind"])
      throw Error(path, "was not written by ivory (no ivory_file_kind)", read_remedy);
    const auto version = get<std::int64_t>("format_version");
    if (version != vdb_format_version) {
      throw Error(path, fmt::format("has format version {}, this ivory reads {}", version, vdb_format_version),
                  "bake it again, or use the ivory that wrote it");
    }
  }

  Error missing(const std::string& what) const { return Error(path, "lacks or misstates " + what, read_remedy); }

  template <typename T>
  T get(const std::string& key) const {
    const auto typed = metadata->getMetadata<openvdb::TypedMetadata<T>>(file_prefix + key);
    if (!typed) throw missing(file_prefix + key);
    return typed->value();
  }
  V3f get_vector(const std::string& key) const {
    const auto v = get<openvdb::Vec3s>(key);
    return {v.x(), v.y(), v.z()};
  }
  template <typename Enum>
  Enum get_named(const std::string& key) const {
    if (const auto value = find_by_name<Enum>(get<std::string>(key))) return *value;
    throw missing(file_prefix + key);
  }

  void require_kind(const char* kind) const {
    const auto found = get<std::string>("kind");
    if (found == kind) return;
    if (found == vdb_accumulator_kind)
      throw Error(path, "holds the photon sums of a partial bake", "finish it first: ivory merge PART... -o OUT.vdb");
    if (found == vdb_grid_kind) throw Error(path, "is a finished grid", "give the parts of a partial bake");
    throw missing(file_prefix + "kind");
  }

  Metadata caller_metadata() const {
    Metadata result;
    for (auto entry = metadata->beginMeta(); entry != metadata->endMeta(); ++entry) {
      const std::string& key = entry->first;
      if (!key.starts_with(meta_prefix) || key.starts_with(file_prefix)) continue;
      result[key.substr(meta_prefix.size())] = value_of(*entry->second);
    }
    return result;
  }

  // The (coarsest) frame as baked; sizes checked against what memory can hold at `bytes_per_vertex`, the reader's peak.
  GridFrame stored_frame(std::size_t bytes_per_vertex) const {
    GridFrame frame;
    const auto size = get<openvdb::Vec3i>("size");
    frame.size = {size.x(), size.y(), size.z()};
    frame.origin_m = get_vector("origin_m");  // less the anchor
    frame.spacing_m = get_vector("spacing_m");
    double bytes = double(bytes_per_vertex);
    for (int axis = 0; axis < 3; ++axis) {
      const V3f row = get_vector(std::string("axis_") + "xyz"[axis]);
      for (int column = 0; column < 3; ++column) frame.local_to_world[axis][column] = row[column];
      const float spacing = frame.spacing_m[axis];
      if (frame.size[axis] < 2 || frame.size[axis] > 65536) throw missing(file_prefix + "size");
      if (!(spacing > 0) || !std::isfinite(spacing)) throw missing(file_prefix + "spacing_m");
      if (!std::isfinite(frame.origin_m[axis])) throw missing(file_prefix + "origin_m");
      if (!(std::abs(row.length() - 1) < 1e-3F)) throw missing(file_prefix + "axis_" + "xyz"[axis]);
      bytes *= frame.size[axis];
    }
    check_memory(path, bytes, "use a larger machine or bake at a lower resolution");
    return frame;
  }

  int stored_levels() const {
    if (!(*metadata)[file_prefix + levels_key]) return 1;
    const auto levels = get<std::int64_t>(levels_key);
    if (levels < 2 || levels > max_levels) throw missing(file_prefix + levels_key);
    return int(levels);
  }

  // Zero in files of grids near the world's origin, which state none.
  V3d stored_anchor() const {
    if (!(*metadata)[file_prefix + anchor_key]) return V3d(0, 0, 0);
    const auto v = get<openvdb::Vec3d>(anchor_key);
    const V3d anchor_m(v.x(), v.y(), v.z());
    if (!(std::abs(anchor_m.x) <= 1e30 && std::abs(anchor_m.y) <= 1e30 && std::abs(anchor_m.z) <= 1e30))
      throw missing(file_prefix + anchor_key);
    return anchor_m;
  }

  // Grid `grid_name` as type Grid, inside the index box and placed as the others.
  template <typename Grid>
  typename Grid::Ptr grid(const std::string& grid_name, const GridFrame& frame,
                          const openvdb::math::Transform* transform) {
    if (!file.hasGrid(grid_name)) throw missing("grid " + grid_name);
    const auto typed = openvdb::gridPtrCast<Grid>(file.readGrid(grid_name));
    if (!typed) throw Error(path, "grid " + grid_name + " has another type of value", read_remedy);
    const openvdb::CoordBBox box(openvdb::Coord(0),
                                 openvdb::Coord(frame.size.x, frame.size.y, frame.size.z).offsetBy(-1));
    const openvdb::CoordBBox used = typed->evalActiveVoxelBoundingBox();
    if (!used.empty() && !box.isInside(used))
      throw Error(path, "grid " + grid_name + " is larger than the file states", read_remedy);
    if (transform != nullptr && typed->transform() != *transform)
      throw Error(path, "its grids have different transforms", "move all grids of the file together");
    return typed;
  }

  std::string path;  // for messages
  openvdb::io::File file;
  openvdb::MetaMap::Ptr metadata;
};

// OpenVDB's exceptions, and what a damaged file that no checksum guards may cause in it, become the one line.
template <typename Read>
auto with_open_file(const std::string& path, const std::string& copy, const Read& read) {
  try {
    OpenFile in(path, copy.empty() ? path : copy);
    return read(in);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(path, fmt::format("OpenVDB reports {}", error.what()), read_remedy);
  }
}

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
void read_levels(OpenFile& in, const std::string& grid_name, const ReadVertices& read, const Take& take) {
  for (int level = 0; level < read.vertices.levels(); ++level) {
    const auto grid = in.grid<Grid>(grid_name + level_suffix(level), read.vertices.frame_of(level),
                                    read.transforms[std::size_t(level)].get());
    for_each_vertex(*grid, read.vertices, level, take);
  }
}

// Components of Vec3f grids into floats at `offset`, `stride` apart.
void read_vectors(OpenFile& in, const std::string& grid_name, const ReadVertices& read, float least,
                  const std::array<int, 3>& offset, std::size_t stride, float* values) {
  read_levels<Vec3fGrid>(in, grid_name, read, [&](std::size_t vertex, const openvdb::Vec3s& value) {
    for (int i = 0; i < 3; ++i) {
      if (!std::isfinite(value[i]) || value[i] < least)
        throw Error(in.path, "grid " + grid_name + " holds a value that is not finite or negative", "bake it again");
      values[vertex * stride + std::size_t(offset[std::size_t(i)])] = value[i];
    }
  });
}

// A visible fraction, a guard record and, while a grid is read, OpenVDB's 12 bytes for a vector or 8 for a sum.
constexpr std::size_t kept_bytes_per_vertex = sizeof(float) + sizeof(GuardRecord) + 12;

std::array<double, 16> matrix_of(const OpenFile& in, const openvdb::math::Transform& transform) {
  if (!transform.isLinear()) throw Error(in.path, "its transform is not linear", read_remedy);
  const openvdb::Mat4d matrix = transform.baseMap()->getAffineMap()->getMat4();
  std::array<double, 16> entries;
  std::copy_n(matrix.asPointer(), 16, entries.begin());
  return entries;
}

// The bricks of a finer level: those that a grid is active in, all of which it must be.
std::vector<V3i> active_bricks(const OpenFile& in, const openvdb::FloatGrid& grid, const GridFrame& frame) {
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
void check_level(const OpenFile& in, const PlacedFrame& level, const openvdb::math::Transform& transform) {
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
void read_lattice(OpenFile& in, std::size_t bytes_per_vertex, ReadVertices& read) {
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

// `bytes_per_vertex` is what the caller needs at its peak besides kept_bytes_per_vertex.
ReadVertices read_vertices(OpenFile& in, Basis basis, std::size_t bytes_per_vertex) {
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
  std::vector<float> floats(out.vertex_count() * 6);
  read_vectors(in, guard_name(0), read, 0, {0, 1, 2}, 6, floats.data());
  read_vectors(in, guard_name(1), read, 0, {3, 4, 5}, 6, floats.data());
  out.guard.resize(out.vertex_count());
  for (std::size_t vertex = 0; vertex < out.guard.size(); ++vertex) {
    std::array<float, 6> six{};
    std::copy_n(floats.begin() + std::ptrdiff_t(6 * vertex), 6, six.begin());
    const auto record = guard_from_floats(six);
    if (!record) throw in.missing("grid " + guard_name(0));
    out.guard[vertex] = *record;
  }
  return read;
}

IrradianceGrid read_grid(OpenFile& in) {
  in.require_kind(vdb_grid_kind);
  const auto basis = in.get_named<Basis>("basis");
  const auto stride = std::size_t(file_stride(basis));
  // At the peak there are the values as stored, the moments made of them, visible fraction and guard; or, the values
  // gone, the variance three times over (OpenVDB's grid, as floats, in its place), which is never more.
  ReadVertices read = read_vertices(in, basis, (std::size_t(function_count(basis)) * 3 + stride) * sizeof(float));
  const std::size_t count = read.vertices.vertex_count();

  std::vector<float> moments;
  {
    std::vector<float> values(count * stride);
    constexpr float any = -std::numeric_limits<float>::infinity();
    for (const VectorField& field : vector_fields(basis))
      read_vectors(in, field.name, read, any, field.offset, stride, values.data());
    moments = moments_from_file_values(basis, values);
  }

  std::vector<float> floats(count * 3);
  read_vectors(in, variance_name, read, 0, {0, 1, 2}, 3, floats.data());
  std::vector<Rgb> variance(count);
  for (std::size_t vertex = 0; vertex < count; ++vertex)
    variance[vertex] = Rgb(floats[3 * vertex], floats[3 * vertex + 1], floats[3 * vertex + 2]);
  return {std::move(read.vertices), std::move(moments), std::move(variance)};
}

GridAccumulator read_accumulator(OpenFile& in) {
  in.require_kind(vdb_accumulator_kind);
  const auto basis = in.get_named<Basis>("basis");
  const auto estimator = in.get_named<Estimator>("estimator");
  const auto quantum = in.get<double>("quantum");
  const auto quantum_squared = in.get<double>("quantum_squared");
  if (!(quantum > 0) || !std::isfinite(quantum)) throw in.missing(file_prefix + "quantum");
  if (!(quantum_squared > 0) || !std::isfinite(quantum_squared)) throw in.missing(file_prefix + "quantum_squared");
  const auto begin = in.get<std::int64_t>("photon_begin");
  const auto end = in.get<std::int64_t>("photon_end");
  if (begin < 0 || end < begin) throw in.missing("its photon range");
  std::map<std::string, std::int64_t> counters;
  for (auto entry = in.metadata->beginMeta(); entry != in.metadata->endMeta(); ++entry) {
    if (!entry->first.starts_with(counter_prefix)) continue;
    counters[entry->first.substr(counter_prefix.size())] =
        in.get<std::int64_t>(entry->first.substr(file_prefix.size()));
  }

  if (estimator != Estimator::track && basis != Basis::vectors) throw in.missing(file_prefix + "estimator");
  const std::vector<std::string> names = sum_field_names(sum_layout(basis, estimator));
  const std::size_t stride = names.size();
  ReadVertices read = read_vertices(in, basis, stride * sizeof(std::int64_t));
  std::vector<std::int64_t> sums(read.vertices.vertex_count() * stride, 0);
  for (std::size_t i = 0; i < stride; ++i) {
    read_levels<openvdb::Int64Grid>(in, names[i], read,
                                    [&](std::size_t vertex, std::int64_t value) { sums[vertex * stride + i] = value; });
  }
  if ((in.get<std::int64_t>("guard_stored") != 0) != !read.vertices.guard.empty()) throw in.missing("grid guard_0");
  return {std::move(read.vertices), estimator,          std::move(sums),    quantum, quantum_squared,
          std::uint64_t(begin),     std::uint64_t(end), std::move(counters)};
}

Metadata read_info(OpenFile& in) {
  Metadata info = in.caller_metadata();
  for (auto entry = in.metadata->beginMeta(); entry != in.metadata->endMeta(); ++entry) {
    if (!entry->first.starts_with(file_prefix)) continue;
    // Counters go by their bare name, as they do in a finished grid.
    const std::string key =
        entry->first.substr(entry->first.starts_with(counter_prefix) ? counter_prefix.size() : file_prefix.size());
    info[key] = value_of(*entry->second);
  }
  if (const V3d anchor_m = in.stored_anchor(); anchor_m != V3d(0, 0, 0)) {
    const V3d origin_m = to_world(in.get_vector("origin_m"), anchor_m);
    info["origin_m"] = fmt::format("[{}, {}, {}]", origin_m.x, origin_m.y, origin_m.z);
  }
  std::string names;
  for (auto grid_name = in.file.beginName(); grid_name != in.file.endName(); ++grid_name)
    names += (names.empty() ? "" : " ") + *grid_name;
  info["grids"] = names;
  info["file_bytes"] = std::int64_t(std::filesystem::file_size(in.path));
  if (in.file.hasGrid(visible_fraction_name)) {
    // In finer levels visible_fraction is active in whole bricks, of which not all vertices store something.
    const char* of_finer = in.file.hasGrid(variance_name) ? variance_name : "sum_0_0_r";
    std::int64_t active = 0;
    for (int level = 0; level < in.stored_levels(); ++level) {
      const std::string grid_name = (level == 0 ? visible_fraction_name : of_finer) + level_suffix(level);
      if (!in.file.hasGrid(grid_name)) throw in.missing("grid " + grid_name);
      const auto grid = in.file.readGridMetadata(grid_name);
      if (const auto count = grid->getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_VOXEL_COUNT))
        active += std::int64_t(count->value());
      else
        continue;
      info["active_vertices"] = active;
    }
  }
  return info;
}

}  // namespace

IrradianceGrid read_grid_vdb(const std::string& path, const std::string& copy) {
  return with_open_file(path, copy, read_grid);
}

GridAccumulator read_accumulator_vdb(const std::string& path, const std::string& copy) {
  return with_open_file(path, copy, read_accumulator);
}

Metadata read_vdb_info(const std::string& path, const std::string& copy) {
  return with_open_file(path, copy, read_info);
}

}  // namespace ivory
