// Reading half of io_vdb.h.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/io/trial.h"
#include "grid/io/vdb/layout.h"
#include "grid/io/vdb/seal.h"
#include "grid/io/vdb/vdb.h"

namespace ivory {

namespace {

using Vec3fGrid = openvdb::Vec3SGrid;

constexpr const char* read_remedy = "give a .vdb file that ivory baked";

// action(name) reads the file under a name that is safe to open: its own where the checksum is right.
// A file without checksum OpenVDB reads first in a process of its own, which may crash over damage,
// and what it has saved again is read here. OpenVDB's exceptions become the one line.
template <typename Action>
auto read_safely(const std::string& path, const Action& action) {
  openvdb::initialize();
  try {
    if (verify_vdb(path)) return action(path);
    // Room for every byte of the file to unpack into 256.
    const std::uint64_t memory_bytes = (std::filesystem::file_size(path) + (1U << 20U)) * 256;
    const TrialOutcome trial = run_trial(memory_bytes, [&] { return resave_vdb(path); });
    if (trial.kind == TrialOutcome::Kind::crashed)
      throw Error(path, "is damaged", "save it again from the program that wrote it");
    if (trial.kind == TrialOutcome::Kind::threw) throw Error(path, "OpenVDB reports " + trial.text, read_remedy);
    return action(MemoryFile(trial.text).path());
  } catch (const openvdb::Exception& error) {
    throw Error(path, fmt::format("OpenVDB reports {}", error.what()), read_remedy);
  }
}

// An opened file and its metadata, wherever they survived.
struct OpenFile {
  OpenFile(std::string shown_path, const std::string& safe_name) : path(std::move(shown_path)), file(safe_name) {
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
  // get() where an unknown name is the file's fault, not the command line's.
  template <typename FromName>
  auto get_named(const std::string& key, const FromName& from_name) const {
    try {
      return from_name(get<std::string>(key));
    } catch (const UsageError&) {
      throw missing(file_prefix + key);
    }
  }

  void require_kind(const char* kind) const {
    const auto found = get<std::string>("kind");
    if (found == kind) return;
    if (found == vdb_sums_kind)
      throw Error(path, "holds the photon sums of a partial bake", "finish it first: ivory merge PART... -o OUT.vdb");
    if (found == vdb_grid_kind)
      throw Error(path, "is a finished grid", "give the parts that ivory bake grid --photon-range wrote");
    throw missing(file_prefix + "kind");
  }

  Metadata caller_metadata() const {
    Metadata result;
    for (auto entry = metadata->beginMeta(); entry != metadata->endMeta(); ++entry) {
      const std::string& key = entry->first;
      if (!key.starts_with(meta_prefix) || key.starts_with(file_prefix)) continue;
      const openvdb::Metadata& value = *entry->second;
      const std::string short_key = key.substr(meta_prefix.size());
      if (const auto* integer = dynamic_cast<const openvdb::Int64Metadata*>(&value)) {
        result[short_key] = std::int64_t(integer->value());
      } else if (const auto* number = dynamic_cast<const openvdb::DoubleMetadata*>(&value)) {
        result[short_key] = number->value();
      } else {
        result[short_key] = value.str();
      }
    }
    return result;
  }

  // The frame as baked; sizes checked against what memory can hold at `bytes_per_vertex`, the reader's peak.
  GridFrame stored_frame(std::size_t bytes_per_vertex) const {
    GridFrame frame;
    const auto size = get<openvdb::Vec3i>("size");
    frame.size = {size.x(), size.y(), size.z()};
    frame.origin_m = get_vector("origin_m");
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

// Calls take(vertex, value) for every active vertex of the box.
template <typename Grid, typename Take>
void for_each_vertex(const Grid& grid, const GridFrame& frame, const Take& take) {
  typename Grid::ConstAccessor accessor = grid.getConstAccessor();
  typename Grid::ValueType value;
  std::size_t vertex = 0;
  for (int k = 0; k < frame.size.z; ++k) {
    for (int j = 0; j < frame.size.y; ++j) {
      for (int i = 0; i < frame.size.x; ++i, ++vertex) {
        if (accessor.probeValue(openvdb::Coord(i, j, k), value)) take(vertex, value);
      }
    }
  }
}

struct Visibility {
  GridFrame frame;
  std::vector<float> visible_fraction;
  std::vector<GuardRecord> guard;
  openvdb::math::Transform::Ptr transform;
};

// Components of a Vec3f grid into floats at `offset`, `stride` apart.
void read_vectors(OpenFile& in, const std::string& grid_name, const Visibility& visibility, float least,
                  const std::array<int, 3>& offset, std::size_t stride, float* values) {
  const auto grid = in.grid<Vec3fGrid>(grid_name, visibility.frame, visibility.transform.get());
  for_each_vertex(*grid, visibility.frame, [&](std::size_t vertex, const openvdb::Vec3s& value) {
    for (int i = 0; i < 3; ++i) {
      if (!std::isfinite(value[i]) || value[i] < least)
        throw Error(in.path, "grid " + grid_name + " holds a value that is not finite or negative", "bake it again");
      values[vertex * stride + std::size_t(offset[std::size_t(i)])] = value[i];
    }
  });
}

// A visible fraction, a guard record and, while a grid is read, OpenVDB's 12 bytes for a vector or 8 for a sum.
constexpr std::size_t kept_bytes_per_vertex = sizeof(float) + sizeof(GuardRecord) + 12;

Visibility read_visibility(OpenFile& in, std::size_t bytes_per_vertex) {
  Visibility out;
  const GridFrame stored = in.stored_frame(bytes_per_vertex);
  const auto visible = in.grid<openvdb::FloatGrid>(visible_fraction_name, stored, nullptr);
  out.transform = visible->transformPtr();
  if (!out.transform->isLinear()) throw Error(in.path, "its transform is not linear", read_remedy);
  const openvdb::Mat4d matrix = out.transform->baseMap()->getAffineMap()->getMat4();
  std::array<double, 16> entries;
  std::copy_n(matrix.asPointer(), 16, entries.begin());
  out.frame = frame_from_transform(in.path, entries, stored);
  out.visible_fraction.assign(stored.vertex_count(), 0.0F);
  for_each_vertex(*visible, stored, [&](std::size_t vertex, float value) {
    if (!(value >= 0 && value <= 1)) throw Error(in.path, "grid visible_fraction leaves 0 to 1", read_remedy);
    out.visible_fraction[vertex] = value;
  });
  if (!in.file.hasGrid(guard_name(0))) return out;
  std::vector<float> floats(stored.vertex_count() * 6);
  read_vectors(in, guard_name(0), out, 0, {0, 1, 2}, 6, floats.data());
  read_vectors(in, guard_name(1), out, 0, {3, 4, 5}, 6, floats.data());
  out.guard.resize(stored.vertex_count());
  for (std::size_t vertex = 0; vertex < out.guard.size(); ++vertex) {
    std::array<float, 6> six{};
    std::copy_n(floats.begin() + std::ptrdiff_t(6 * vertex), 6, six.begin());
    const auto record = guard_from_floats(six);
    if (!record) throw in.missing("grid " + guard_name(0));
    out.guard[vertex] = *record;
  }
  return out;
}

}  // namespace

IrradianceGrid read_grid_vdb(const std::string& path) {
  return read_safely(path, [&](const std::string& safe_name) {
    OpenFile in(path, safe_name);
    in.require_kind(vdb_grid_kind);
    IrradianceGrid grid;
    grid.basis = in.get_named("basis", basis_from_name);
    grid.metadata = in.caller_metadata();
    const auto stride = std::size_t(file_stride(grid.basis));
    // At the peak there are the values as stored, the moments made of them, visible fraction and guard; or, the values
    // gone, the variance three times over (OpenVDB's grid, as floats, in its place), which is never more.
    const std::size_t resident = kept_bytes_per_vertex + std::size_t(grid.stride()) * sizeof(float);
    Visibility visibility = read_visibility(in, resident + stride * sizeof(float));

    {
      std::vector<float> values(visibility.frame.vertex_count() * stride);
      constexpr float any = -std::numeric_limits<float>::infinity();
      for (const VectorField& field : vector_fields(grid.basis))
        read_vectors(in, field.name, visibility, any, field.offset, stride, values.data());
      grid.moments = moments_from_file_values(grid.basis, values);
    }

    std::vector<float> variance(visibility.frame.vertex_count() * 3);
    read_vectors(in, variance_name, visibility, 0, {0, 1, 2}, 3, variance.data());
    grid.variance.resize(visibility.frame.vertex_count());
    for (std::size_t vertex = 0; vertex < grid.variance.size(); ++vertex)
      grid.variance[vertex] = Rgb(variance[3 * vertex], variance[3 * vertex + 1], variance[3 * vertex + 2]);

    grid.frame = visibility.frame;
    grid.visible_fraction = std::move(visibility.visible_fraction);
    grid.guard = std::move(visibility.guard);
    return grid;
  });
}

GridSums read_sums_vdb(const std::string& path) {
  return read_safely(path, [&](const std::string& safe_name) {
    OpenFile in(path, safe_name);
    in.require_kind(vdb_sums_kind);
    GridSums sums;
    sums.basis = in.get_named("basis", basis_from_name);
    sums.estimator = in.get_named("estimator", estimator_from_name);
    sums.metadata = in.caller_metadata();
    sums.quantum = in.get<double>("quantum");
    sums.quantum_squared = in.get<double>("quantum_squared");
    if (!(sums.quantum > 0) || !std::isfinite(sums.quantum)) throw in.missing(file_prefix + "quantum");
    if (!(sums.quantum_squared > 0) || !std::isfinite(sums.quantum_squared))
      throw in.missing(file_prefix + "quantum_squared");
    const auto begin = in.get<std::int64_t>("photon_begin");
    const auto end = in.get<std::int64_t>("photon_end");
    if (begin < 0 || end < begin) throw in.missing("its photon range");
    sums.photon_begin = std::uint64_t(begin);
    for (auto entry = in.metadata->beginMeta(); entry != in.metadata->endMeta(); ++entry) {
      if (!entry->first.starts_with(counter_prefix)) continue;
      sums.counters[entry->first.substr(counter_prefix.size())] =
          in.get<std::int64_t>(entry->first.substr(file_prefix.size()));
    }
    sums.photon_end = std::uint64_t(end);

    const auto layout = in.get_named(
        "estimator", [&](std::string_view text) { return sum_layout(sums.basis, estimator_from_name(text)); });
    const std::vector<std::string> names = sum_field_names(layout);
    const std::size_t stride = names.size();
    Visibility visibility = read_visibility(in, kept_bytes_per_vertex + stride * sizeof(std::int64_t));
    sums.sums.assign(visibility.frame.vertex_count() * stride, 0);
    for (std::size_t i = 0; i < stride; ++i) {
      const auto grid = in.grid<openvdb::Int64Grid>(names[i], visibility.frame, visibility.transform.get());
      for_each_vertex(*grid, visibility.frame,
                      [&](std::size_t vertex, std::int64_t value) { sums.sums[vertex * stride + i] = value; });
    }
    if ((in.get<std::int64_t>("guard_stored") != 0) != !visibility.guard.empty()) throw in.missing("grid guard_0");
    sums.frame = visibility.frame;
    sums.visible_fraction = std::move(visibility.visible_fraction);
    sums.guard = std::move(visibility.guard);
    return sums;
  });
}

Metadata read_vdb_info(const std::string& path) {
  return read_safely(path, [&](const std::string& safe_name) {
    OpenFile in(path, safe_name);
    Metadata info = in.caller_metadata();
    for (auto entry = in.metadata->beginMeta(); entry != in.metadata->endMeta(); ++entry) {
      if (!entry->first.starts_with(file_prefix)) continue;
      // Counters go by their bare name, as they do in a finished grid.
      const std::string key =
          entry->first.substr(entry->first.starts_with(counter_prefix) ? counter_prefix.size() : file_prefix.size());
      const openvdb::Metadata& value = *entry->second;
      if (const auto* integer = dynamic_cast<const openvdb::Int64Metadata*>(&value)) {
        info[key] = std::int64_t(integer->value());
      } else if (const auto* number = dynamic_cast<const openvdb::DoubleMetadata*>(&value)) {
        info[key] = number->value();
      } else {
        info[key] = value.str();
      }
    }
    std::string names;
    for (auto grid_name = in.file.beginName(); grid_name != in.file.endName(); ++grid_name)
      names += (names.empty() ? "" : " ") + *grid_name;
    info["grids"] = names;
    info["file_bytes"] = std::int64_t(std::filesystem::file_size(path));
    if (in.file.hasGrid(visible_fraction_name)) {
      const auto grid = in.file.readGridMetadata(visible_fraction_name);
      if (const auto count = grid->getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_VOXEL_COUNT))
        info["active_vertices"] = std::int64_t(count->value());
    }
    return info;
  });
}

}  // namespace ivory
