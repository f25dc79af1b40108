// Writing half of grid/io/vdb/vdb.h.
#include <algorithm>
#include <array>
#include <cassert>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include "grid/base/error.h"
#include "grid/io/file.h"
#include "grid/io/vdb/archive.h"
#include "grid/io/vdb/file_stream.h"
#include "grid/io/vdb/layout.h"
#include "grid/io/vdb/open_file.h"
#include "grid/io/vdb/rounding.h"
#include "grid/io/vdb/seal.h"
#include "grid/io/vdb/vdb.h"

namespace ivory {

namespace {

using Vec3fGrid = openvdb::Vec3SGrid;

openvdb::math::Transform::Ptr transform_of(const GridVertices& grid, int level) {
  const auto m = transform_matrix({grid.frame_of(level), grid.anchor_m});
  return openvdb::math::Transform::createLinearTransform(openvdb::Mat4d(m.data()));
}

// Numbers whose last bits were rounded off make a third less by deflate than by Blosc's LZ4, which knows repetitions
// alone and is ten times as fast.
constexpr std::uint32_t grid_compression = openvdb::io::COMPRESS_ZIP;
constexpr std::uint32_t sums_compression = openvdb::io::COMPRESS_BLOSC;

void put(openvdb::MetaMap& map, const std::string& key, std::int64_t value) {
  map.insertMeta(key, openvdb::Int64Metadata(value));
}
void put(openvdb::MetaMap& map, const std::string& key, double value) {
  map.insertMeta(key, openvdb::DoubleMetadata(value));
}
void put(openvdb::MetaMap& map, const std::string& key, std::string_view value) {
  map.insertMeta(key, openvdb::StringMetadata(std::string(value)));
}
void put(openvdb::MetaMap& map, const std::string& key, const V3f& v) {
  map.insertMeta(key, openvdb::Vec3SMetadata(openvdb::Vec3s(v.x, v.y, v.z)));
}

// What grids and sums have in common.
openvdb::MetaMap common_metadata(const char* kind, const GridVertices& vertices) {
  const GridFrame& frame = vertices.frame;
  openvdb::MetaMap map;
  put(map, file_prefix + "kind", kind);
  put(map, file_prefix + "format_version", vdb_format_version);
  put(map, file_prefix + "ivory_version", IVORY_VERSION);
  put(map, file_prefix + "units", "irradiance lux, length metre");
  put(map, file_prefix + "basis", name_of(vertices.basis));
  map.insertMeta(file_prefix + "size",
                 openvdb::Vec3IMetadata(openvdb::Vec3i(frame.size.x, frame.size.y, frame.size.z)));
  put(map, file_prefix + "origin_m", frame.origin_m);
  if (const V3d& a = vertices.anchor_m; a != V3d(0, 0, 0))
    map.insertMeta(file_prefix + anchor_key, openvdb::Vec3DMetadata(openvdb::Vec3d(a.x, a.y, a.z)));
  put(map, file_prefix + "spacing_m", frame.spacing_m);
  for (int axis = 0; axis < 3; ++axis) {
    const auto& row = frame.local_to_world[axis];
    put(map, file_prefix + "axis_" + "xyz"[axis], V3f(row[0], row[1], row[2]));
  }
  if (vertices.levels() > 1) put(map, file_prefix + levels_key, std::int64_t(vertices.levels()));
  put(map, meta_prefix + light_key, name_of(vertices.light));
  for (const auto& [key, value] : vertices.metadata) {
    assert(!(meta_prefix + key).starts_with(file_prefix));
    std::visit([&, &meta_key = key](const auto& v) { put(map, meta_prefix + meta_key, v); }, value);
  }
  return map;
}

// The names of its groups, where there are any.
template <typename Group>
void put_groups(openvdb::MetaMap& map, const std::vector<Group>& groups) {
  std::string names;
  for (const Group& group : groups) names += (names.empty() ? "" : " ") + group.name;
  if (!names.empty()) put(map, meta_prefix + light_groups_key, names);
}

// An empty grid of the file.
template <typename Grid>
typename Grid::Ptr make_grid(const std::string& grid_name, const openvdb::math::Transform::Ptr& transform) {
  // From OpenVDB's registry: Grid::create() would compile all virtual functions of Grid and its tree here.
  auto grid = openvdb::gridPtrCast<Grid>(openvdb::GridBase::createGrid(Grid::gridType()));
  grid->setName(grid_name);
  grid->setCreator("ivory " IVORY_VERSION);
  grid->setTransform(transform);
  return grid;
}

// Numbers of vertices of one level, half-open.
struct VertexRange {
  std::size_t first = 0;
  std::size_t last = 0;
};
VertexRange vertices_of(const Lattice& lattice, int level) {
  const std::size_t first = lattice.first_vertex_of(level);
  return {first, first + lattice.vertex_count_of(level)};
}

// Sets value(vertex) at those of a level's vertices in the range that `active` marks.
template <typename Grid, typename Value>
void fill(Grid& grid, const Lattice& lattice, const VertexRange& range, const std::vector<bool>& active,
          const Value& value) {
  typename Grid::Accessor accessor = grid.getAccessor();
  for (std::size_t vertex = range.first; vertex < range.last; ++vertex) {
    if (!active[vertex]) continue;
    const V3i at = lattice.place_of(std::uint32_t(vertex)).at;
    accessor.setValueOn(openvdb::Coord(at.x, at.y, at.z), value(vertex));
  }
}

template <typename Grid, typename Value>
typename Grid::Ptr make_grid(const std::string& grid_name, const openvdb::math::Transform::Ptr& transform,
                             const Lattice& lattice, int level, const std::vector<bool>& active, const Value& value) {
  auto grid = make_grid<Grid>(grid_name + level_suffix(level), transform);
  fill(*grid, lattice, vertices_of(lattice, level), active, value);
  return grid;
}

// The grids that say what the vertices of a level can see.
void add_visibility(openvdb::GridCPtrVec& grids, const openvdb::math::Transform::Ptr& transform,
                    const GridVertices& vertices, int level, const std::vector<bool>& active) {
  const std::vector<bool> all(level == 0 ? 0 : active.size(), true);
  grids.push_back(make_grid<openvdb::FloatGrid>(visible_fraction_name, transform, vertices, level,
                                                level == 0 ? active : all,
                                                [&](std::size_t vertex) { return vertices.visible_fraction[vertex]; }));
  if (vertices.guard.empty()) return;
  for (int half = 0; half < 2; ++half) {
    const auto grid =
        make_grid<Vec3fGrid>(guard_name(half), transform, vertices, level, active, [&](std::size_t vertex) {
          const auto floats = floats_from_guard(vertices.guard[vertex]);
          return openvdb::Vec3s(floats.data() + 3 * half);
        });
    grid->setVectorType(openvdb::VEC_INVARIANT);
    grids.push_back(grid);
  }
}

// Metadata belongs to the file; a second copy on one grid survives programs that keep grids only.
void add_metadata_copy(const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata) {
  for (const auto& grid : grids) {
    if (grid->getName() != visible_fraction_name) continue;
    const auto writable = std::const_pointer_cast<openvdb::GridBase>(grid);
    for (auto entry = metadata.beginMeta(); entry != metadata.endMeta(); ++entry)
      writable->insertMeta(entry->first, *entry->second);
  }
}

void remove_groups(openvdb::MetaMap& metadata) {
  for (const std::string& key : {meta_prefix + light_groups_key, meta_prefix + lamp_groups_key})
    metadata.removeMeta(key);
}

// OpenVDB's exceptions become the one line.
template <typename Action>
void guarded(const std::string& path, const Action& action) {
  try {
    action();
  } catch (const openvdb::Exception& error) {
    throw Error(path, std::string("OpenVDB reports ") + error.what(), "check the folder and the disk");
  }
}

}  // namespace

std::string resave_vdb(const std::string& path) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open(/*delayLoad=*/false);
  const auto grids = file.getGrids();
  const auto metadata = file.getMetadata();
  return MemoryArchive(file.compression())
      .sealed_bytes({grids->begin(), grids->end()}, metadata ? *metadata : openvdb::MetaMap());
}

std::string ungrouped_vdb(const std::string& path) {
  return with_open_file(path, {}, [](OpenVdbFile& in) {
    in.require_kind(vdb_grid_kind);
    openvdb::GridCPtrVec grids;
    openvdb::MetaMap metadata = *in.metadata;
    remove_groups(metadata);
    const auto basis = in.get_named<Basis>("basis");
    for (int level = 0; level < in.stored_levels(); ++level) {
      std::vector<std::string> names;
      for (const VectorField& field : vector_fields(basis)) names.push_back(field.name);
      names.insert(names.end(), {variance_name, visible_fraction_name, guard_name(0), guard_name(1)});
      for (const std::string& name : names) {
        if (!in.file.hasGrid(name + level_suffix(level))) continue;  // baked without guard
        const auto grid = in.file.readGrid(name + level_suffix(level));
        remove_groups(*grid);  // one of them has a copy of the file's
        grids.push_back(grid);
      }
    }
    return MemoryArchive(grid_compression).sealed_bytes(grids, metadata);
  });
}

void check_voxels(const std::string& path, const GridFrame& frame) {
  constexpr double least_volume_m3 = 3e-15;  // openvdb::math::AffineMap: three times Tolerance<double>
  const V3d h(frame.spacing_m);
  if (h.x * h.y * h.z > least_volume_m3 * 1.001) return;
  throw Error(path,
              fmt::format("cannot hold voxels of {:.2g} x {:.2g} x {:.2g} m: a .vdb file needs edges of 1.5e-05 m", h.x,
                          h.y, h.z),
              "ask for larger voxels, or take the scene's units for larger ones");
}

namespace {

// The moments' grids of a level, of all lights or of a group. File values of some vertices at a time, of which each
// field takes its own.
void add_fields(openvdb::GridCPtrVec& grids, const openvdb::math::Transform::Ptr& transform, const IrradianceGrid& grid,
                const StoredMoments& stored, const std::string& group, int level, const std::vector<bool>& active) {
  constexpr std::size_t vertices_at_once = 1 << 16;
  const auto stride = std::size_t(grid.stride());
  const auto stored_stride = std::size_t(file_stride(grid.basis));
  const std::vector<VectorField> fields = vector_fields(grid.basis);
  std::vector<Vec3fGrid::Ptr> filled;
  std::vector<HalfCheck> checks(fields.size());
  for (const VectorField& field : fields) {
    const auto made = make_grid<Vec3fGrid>(in_group(group, field.name) + level_suffix(level), transform->copy());
    // Vectors turn with the grid but are kept in its own axes, whatever its transform does.
    made->setIsInWorldSpace(!field.is_vector);
    made->setVectorType(field.is_vector ? openvdb::VEC_CONTRAVARIANT_RELATIVE : openvdb::VEC_INVARIANT);
    filled.push_back(made);
    grids.push_back(made);
  }
  const VertexRange all = vertices_of(grid, level);
  for (std::size_t first = all.first; first < all.last; first += vertices_at_once) {
    const VertexRange range{first, std::min(first + vertices_at_once, all.last)};
    const std::size_t count = range.last - range.first;
    const std::vector<float> values = file_values_from_moments(
        grid.basis, rounded_to_noise(std::span(stored.moments.data() + range.first * stride, count * stride),
                                     std::span(stored.variance.data() + range.first, count)));
    tbb::parallel_for(std::size_t(0), fields.size(), [&](std::size_t i) {
      const auto& offset = fields[i].offset;
      fill(*filled[i], grid, range, active, [&](std::size_t vertex) {
        const float* v = values.data() + (vertex - range.first) * stored_stride;
        for (const int component : offset) checks[i].add(v[component]);
        return openvdb::Vec3s(v[offset[0]], v[offset[1]], v[offset[2]]);
      });
    });
  }
  for (std::size_t i = 0; i < fields.size(); ++i) filled[i]->setSaveFloatAsHalf(checks[i].is_enough());
}

}  // namespace

void write_vdb(const std::string& path, const IrradianceGrid& grid, bool force) {
  check_voxels(path, grid.finest_frame());
  openvdb::initialize();
  guarded(path, [&] {
    std::vector<bool> active(grid.vertex_count());
    for (std::size_t vertex = 0; vertex < active.size(); ++vertex) active[vertex] = grid.visible_fraction[vertex] > 0;

    openvdb::GridCPtrVec grids;
    for (int level = 0; level < grid.levels(); ++level) {
      const auto transform = transform_of(grid, level);
      const auto add = [&](const StoredMoments& stored, const std::string& group) {
        add_fields(grids, transform, grid, stored, group, level, active);
        HalfCheck check;
        const auto variance = make_grid<Vec3fGrid>(in_group(group, variance_name), transform, grid, level, active,
                                                   [&](std::size_t vertex) {
                                                     const Rgb v = rounded_variance(stored.variance[vertex]);
                                                     for (unsigned c = 0; c < 3; ++c) check.add(v[c]);
                                                     return openvdb::Vec3s(v.x, v.y, v.z);
                                                   });
        variance->setSaveFloatAsHalf(check.is_enough());
        variance->setVectorType(openvdb::VEC_INVARIANT);
        grids.push_back(variance);
      };
      add(grid, "");
      for (const GridGroup& group : grid.groups) add(group, group.name);
      add_visibility(grids, transform, grid, level, active);
    }

    openvdb::MetaMap metadata = common_metadata(vdb_grid_kind, grid);
    put_groups(metadata, grid.groups);
    add_metadata_copy(grids, metadata);
    write_file(path, MemoryArchive(grid_compression).sealed_bytes(grids, metadata), force);
  });
}

void write_vdb(const std::string& path, const GridAccumulator& accumulator, bool force) {
  check_voxels(path, accumulator.finest_frame());
  openvdb::initialize();
  guarded(path, [&] {
    const std::vector<std::string> names = sum_field_names(sum_layout(accumulator.basis, accumulator.estimator));
    const std::size_t stride = names.size();
    std::vector<bool> active(accumulator.vertex_count());
    for (std::size_t vertex = 0; vertex < active.size(); ++vertex) {
      const auto first = accumulator.sums.begin() + std::ptrdiff_t(vertex * stride);
      active[vertex] = accumulator.visible_fraction[vertex] > 0 ||
                       std::any_of(first, first + std::ptrdiff_t(stride), [](std::int64_t sum) { return sum != 0; });
    }

    openvdb::MetaMap metadata = common_metadata(vdb_accumulator_kind, accumulator);
    put_groups(metadata, accumulator.groups);
    put(metadata, file_prefix + "estimator", name_of(accumulator.estimator));
    put(metadata, file_prefix + "quantum", accumulator.quantum);
    put(metadata, file_prefix + "quantum_squared", accumulator.quantum_squared);
    put(metadata, file_prefix + "photon_begin", std::int64_t(accumulator.photon_begin));
    put(metadata, file_prefix + "photon_end", std::int64_t(accumulator.photon_end));
    put(metadata, file_prefix + "guard_stored", std::int64_t(accumulator.guard.empty() ? 0 : 1));
    for (const auto& [key, value] : accumulator.counters) put(metadata, counter_prefix + key, value);

    PendingFile pending(path, force);
    {
      FileStream out(pending, path);
      const std::size_t a_level = stride * (1 + accumulator.groups.size()) + (accumulator.guard.empty() ? 1 : 3);
      GridStream stream(out, sums_compression, metadata, std::int32_t(a_level * std::size_t(accumulator.levels())));
      for (int level = 0; level < accumulator.levels(); ++level) {
        const auto transform = transform_of(accumulator, level);
        const auto add = [&](const std::vector<std::int64_t>& sums, const std::string& group) {
          constexpr std::size_t at_once = 8;
          std::array<openvdb::GridBase::Ptr, at_once> made;
          for (std::size_t first = 0; first < stride; first += at_once) {
            const std::size_t count = std::min(at_once, stride - first);
            tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
              made[i] = make_grid<openvdb::Int64Grid>(
                  in_group(group, names[first + i]), transform->copy(), accumulator, level, active,
                  [&](std::size_t vertex) { return sums[vertex * stride + first + i]; });
            });
            for (std::size_t i = 0; i < count; ++i) stream.add(std::exchange(made[i], nullptr));
          }
        };
        add(accumulator.sums, "");
        for (const SumGroup& group : accumulator.groups) add(group.sums, group.name);
        openvdb::GridCPtrVec grids;
        add_visibility(grids, transform, accumulator, level, active);
        add_metadata_copy(grids, metadata);
        for (const auto& grid : grids) stream.add(grid);
      }
      out.flush_all();
    }
    seal_vdb_file(pending.temporary(), path);
    pending.commit();
  });
}

}  // namespace ivory
