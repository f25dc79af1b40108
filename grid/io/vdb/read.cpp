// Reading half of grid/io/vdb/vdb.h.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/io/vdb/layout.h"
#include "grid/io/vdb/open_file.h"
#include "grid/io/vdb/read_levels.h"
#include "grid/io/vdb/vdb.h"

namespace ivory {
namespace {

// Of all lights, or of a group.
StoredMoments read_moments(const OpenVdbFile& in, const ReadVertices& read, Basis basis, const std::string& group) {
  const std::size_t count = read.vertices.vertex_count();
  const auto file_floats = std::size_t(file_stride(basis));
  const auto stride = std::size_t(function_count(basis)) * 3;
  const std::vector<VectorField> fields = vector_fields(basis);
  StoredMoments stored;
  {
    std::vector<std::string> names;
    names.reserve(fields.size());
    for (const VectorField& field : fields) names.push_back(in_group(group, field.name));
    const auto vectors = read_vectors(in, names, read, -std::numeric_limits<float>::infinity());
    stored.moments.resize(count * stride);
    constexpr std::size_t at_once = 4096;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, at_once), [&](const auto& range) {
      std::vector<float> values(range.size() * file_floats);
      for (std::size_t f = 0; f < fields.size(); ++f) {
        for (std::size_t vertex = range.begin(); vertex < range.end(); ++vertex) {
          for (std::size_t k = 0; k < 3; ++k) {
            values[(vertex - range.begin()) * file_floats + std::size_t(fields[f].offset[k])] =
                vectors[f][3 * vertex + k];
          }
        }
      }
      const std::vector<float> moments = moments_from_file_values(basis, values);
      std::copy(moments.begin(), moments.end(), stored.moments.begin() + std::ptrdiff_t(range.begin() * stride));
    });
  }
  const std::vector<float> variance = std::move(read_vectors(in, {in_group(group, variance_name)}, read, 0).front());
  stored.variance.resize(count);
  for (std::size_t vertex = 0; vertex < count; ++vertex)
    stored.variance[vertex] = Rgb(variance[3 * vertex], variance[3 * vertex + 1], variance[3 * vertex + 2]);
  return stored;
}

IrradianceGrid read_grid(OpenVdbFile& in, bool with_groups) {
  in.require_kind(vdb_grid_kind);
  const auto basis = in.get_named<Basis>("basis");
  const std::vector<std::string> groups = with_groups ? in.stored_groups() : std::vector<std::string>();
  const std::size_t moment_bytes = std::size_t(function_count(basis)) * 3 * sizeof(float);
  // At the peak there are the values as stored, the moments made of them, visible fraction and guard, and what was
  // read of groups before; or, the values gone, the variance three times over (OpenVDB's grid, as floats, in its
  // place), which is never more.
  // Each thread reads a grid; one is reckoned with anyway.
  const std::size_t at_once =
      std::min(vector_fields(basis).size(), std::size_t(tbb::this_task_arena::max_concurrency()));
  ReadVertices read =
      read_vertices(in, basis,
                    moment_bytes + std::size_t(file_stride(basis)) * sizeof(float) +
                        (at_once - 1) * sizeof(openvdb::Vec3s) + groups.size() * (moment_bytes + sizeof(Rgb)));
  StoredMoments all = read_moments(in, read, basis, "");
  std::vector<GridGroup> of_groups;
  of_groups.reserve(groups.size());
  for (const std::string& group : groups) of_groups.push_back({read_moments(in, read, basis, group), group});
  return {std::move(read.vertices), std::move(all), std::move(of_groups)};
}

GridAccumulator read_accumulator(OpenVdbFile& in) {
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
  const std::vector<std::string> group_names = in.stored_groups();
  ReadVertices read = read_vertices(in, basis, stride * sizeof(std::int64_t) * (1 + group_names.size()));
  const auto read_sums = [&](const std::string& group) {
    std::vector<std::int64_t> sums(read.vertices.vertex_count() * stride, 0);
    for (std::size_t i = 0; i < stride; ++i) {
      read_levels<openvdb::Int64Grid>(
          in, in.file, in_group(group, names[i]), read,
          [&](std::size_t vertex, std::int64_t value) { sums[vertex * stride + i] = value; });
    }
    return sums;
  };
  std::vector<std::int64_t> sums = read_sums("");
  std::vector<SumGroup> groups;
  groups.reserve(group_names.size());
  for (const std::string& group : group_names) groups.push_back({group, read_sums(group)});
  if ((in.get<std::int64_t>("guard_stored") != 0) != !read.vertices.guard.empty()) throw in.missing("grid guard_0");
  return {std::move(read.vertices), estimator,          std::move(sums),     quantum,          quantum_squared,
          std::uint64_t(begin),     std::uint64_t(end), std::move(counters), std::move(groups)};
}

Metadata read_info(OpenVdbFile& in) {
  Metadata info = in.caller_metadata();
  for (auto entry = in.metadata->beginMeta(); entry != in.metadata->endMeta(); ++entry) {
    if (!entry->first.starts_with(file_prefix)) continue;
    // Counters go by their bare name, as they do in a finished grid.
    const std::string key =
        entry->first.substr(entry->first.starts_with(counter_prefix) ? counter_prefix.size() : file_prefix.size());
    info[key] = meta_value(*entry->second);
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
      const auto count = grid->getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_VOXEL_COUNT);
      if (!count) continue;
      active += std::int64_t(count->value());
      info["active_vertices"] = active;
    }
  }
  return info;
}

}  // namespace

IrradianceGrid read_grid_vdb(const std::string& path, const std::string& copy, bool with_groups) {
  return with_open_file(path, copy, [&](OpenVdbFile& in) { return read_grid(in, with_groups); });
}

GridAccumulator read_accumulator_vdb(const std::string& path, const std::string& copy) {
  return with_open_file(path, copy, read_accumulator);
}

Metadata read_vdb_info(const std::string& path, const std::string& copy) {
  return with_open_file(path, copy, read_info);
}

}  // namespace ivory
