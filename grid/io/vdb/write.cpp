// Writing half of grid/io/vdb/vdb.h.
#include <algorithm>
#include <cassert>
#include <sstream>

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include "grid/base/error.h"
#include "grid/io/file.h"
#include "grid/io/vdb/layout.h"
#include "grid/io/vdb/seal.h"
#include "grid/io/vdb/vdb.h"

namespace ivory {

namespace {

using Vec3fGrid = openvdb::Vec3SGrid;

openvdb::math::Transform::Ptr transform_of(const GridVertices& grid) {
  const auto m = transform_matrix({grid.frame, grid.anchor_m});
  return openvdb::math::Transform::createLinearTransform(openvdb::Mat4d(m.data()));
}

// io::File can only write to a name; the bytes are wanted in memory, to be sealed.
class MemoryArchive : public openvdb::io::Archive {
 public:
  std::string sealed_bytes(const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata) {
    std::ostringstream out(std::ios::binary);
    Archive::write(out, grids, /*seekable=*/true, metadata);
    std::string result = std::move(out).str();
    seal_vdb(result);
    return result;
  }
};

void write_sealed(const std::string& path, bool force, const openvdb::GridCPtrVec& grids,
                  const openvdb::MetaMap& metadata) {
  write_file(path, MemoryArchive().sealed_bytes(grids, metadata), force);
}

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
  put(map, meta_prefix + light_key, name_of(vertices.light));
  for (const auto& [key, value] : vertices.metadata) {
    assert(!(meta_prefix + key).starts_with(file_prefix));
    std::visit([&, &meta_key = key](const auto& v) { put(map, meta_prefix + meta_key, v); }, value);
  }
  return map;
}

// A grid of the vertices that `active` marks; value(vertex) gives what they hold.
template <typename Grid, typename Value>
openvdb::GridBase::Ptr make_grid(const std::string& grid_name, const openvdb::math::Transform::Ptr& transform,
                                 const GridFrame& frame, const std::vector<bool>& active, const Value& value) {
  // From OpenVDB's registry: Grid::create() would compile all virtual functions of Grid and its tree here.
  const auto grid = openvdb::gridPtrCast<Grid>(openvdb::GridBase::createGrid(Grid::gridType()));
  grid->setName(grid_name);
  grid->setCreator("ivory " IVORY_VERSION);
  grid->setTransform(transform);
  typename Grid::Accessor accessor = grid->getAccessor();
  std::size_t vertex = 0;
  for (int k = 0; k < frame.size.z; ++k) {
    for (int j = 0; j < frame.size.y; ++j) {
      for (int i = 0; i < frame.size.x; ++i, ++vertex) {
        if (active[vertex]) accessor.setValueOn(openvdb::Coord(i, j, k), value(vertex));
      }
    }
  }
  return grid;
}

// The grids that say what the vertices can see.
void add_visibility(openvdb::GridCPtrVec& grids, const openvdb::math::Transform::Ptr& transform,
                    const GridVertices& vertices, const std::vector<bool>& active) {
  grids.push_back(make_grid<openvdb::FloatGrid>(visible_fraction_name, transform, vertices.frame, active,
                                                [&](std::size_t vertex) { return vertices.visible_fraction[vertex]; }));
  if (vertices.guard.empty()) return;
  for (int half = 0; half < 2; ++half) {
    const auto grid =
        make_grid<Vec3fGrid>(guard_name(half), transform, vertices.frame, active, [&](std::size_t vertex) {
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
  return MemoryArchive().sealed_bytes({grids->begin(), grids->end()}, metadata ? *metadata : openvdb::MetaMap());
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

void write_vdb(const std::string& path, const IrradianceGrid& grid, bool force) {
  check_voxels(path, grid.frame);
  openvdb::initialize();
  guarded(path, [&] {
    const std::vector<float> values = file_values_from_moments(grid.basis, grid.moments);
    const auto stride = std::size_t(file_stride(grid.basis));
    const auto transform = transform_of(grid);
    std::vector<bool> active(grid.frame.vertex_count());
    for (std::size_t vertex = 0; vertex < active.size(); ++vertex) active[vertex] = grid.visible_fraction[vertex] > 0;

    openvdb::GridCPtrVec grids;
    const std::vector<VectorField> fields = vector_fields(grid.basis);
    grids.resize(fields.size());
    tbb::parallel_for(std::size_t(0), fields.size(), [&](std::size_t i) {
      const auto& offset = fields[i].offset;
      const auto field =
          make_grid<Vec3fGrid>(fields[i].name, transform->copy(), grid.frame, active, [&](std::size_t vertex) {
            const float* v = values.data() + vertex * stride;
            return openvdb::Vec3s(v[offset[0]], v[offset[1]], v[offset[2]]);
          });
      // Vectors turn with the grid but are kept in its own axes, whatever its transform does.
      field->setIsInWorldSpace(!fields[i].is_vector);
      field->setVectorType(fields[i].is_vector ? openvdb::VEC_CONTRAVARIANT_RELATIVE : openvdb::VEC_INVARIANT);
      grids[i] = field;
    });
    const auto variance = make_grid<Vec3fGrid>(variance_name, transform, grid.frame, active, [&](std::size_t vertex) {
      const Rgb& v = grid.variance[vertex];
      return openvdb::Vec3s(v.x, v.y, v.z);
    });
    variance->setVectorType(openvdb::VEC_INVARIANT);
    grids.push_back(variance);
    add_visibility(grids, transform, grid, active);

    const openvdb::MetaMap metadata = common_metadata(vdb_grid_kind, grid);
    add_metadata_copy(grids, metadata);
    write_sealed(path, force, grids, metadata);
  });
}

void write_vdb(const std::string& path, const GridAccumulator& accumulator, bool force) {
  check_voxels(path, accumulator.frame);
  openvdb::initialize();
  guarded(path, [&] {
    const std::vector<std::string> names = sum_field_names(sum_layout(accumulator.basis, accumulator.estimator));
    const std::size_t stride = names.size();
    const auto transform = transform_of(accumulator);
    std::vector<bool> active(accumulator.frame.vertex_count());
    for (std::size_t vertex = 0; vertex < active.size(); ++vertex) {
      const auto first = accumulator.sums.begin() + std::ptrdiff_t(vertex * stride);
      active[vertex] = accumulator.visible_fraction[vertex] > 0 ||
                       std::any_of(first, first + std::ptrdiff_t(stride), [](std::int64_t sum) { return sum != 0; });
    }

    openvdb::GridCPtrVec grids(stride);
    tbb::parallel_for(std::size_t(0), stride, [&](std::size_t i) {
      grids[i] =
          make_grid<openvdb::Int64Grid>(names[i], transform->copy(), accumulator.frame, active,
                                        [&](std::size_t vertex) { return accumulator.sums[vertex * stride + i]; });
    });
    add_visibility(grids, transform, accumulator, active);

    openvdb::MetaMap metadata = common_metadata(vdb_accumulator_kind, accumulator);
    put(metadata, file_prefix + "estimator", name_of(accumulator.estimator));
    put(metadata, file_prefix + "quantum", accumulator.quantum);
    put(metadata, file_prefix + "quantum_squared", accumulator.quantum_squared);
    put(metadata, file_prefix + "photon_begin", std::int64_t(accumulator.photon_begin));
    put(metadata, file_prefix + "photon_end", std::int64_t(accumulator.photon_end));
    put(metadata, file_prefix + "guard_stored", std::int64_t(accumulator.guard.empty() ? 0 : 1));
    for (const auto& [key, value] : accumulator.counters) put(metadata, counter_prefix + key, value);
    add_metadata_copy(grids, metadata);
    write_sealed(path, force, grids, metadata);
  });
}

}  // namespace ivory
