// .vdb files behind their checksum. OpenVDB trusts the bytes that it reads, so what ivory reads through it is changed
// in OpenVDB's own terms: metadata of a valid file replaced, retyped and left out, grids of other types, values,
// transforms and places. What guards the bytes, the checksum, meets any.
#include "grid/io/vdb/vdb.h"

#include <cmath>
#include <iterator>
#include <sstream>

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include "grid/io/vdb/layout.h"
#include "grid/io/vdb/seal.h"
#include "tests/fuzz/samples.h"
#include "tests/fuzz/support.h"

namespace {

using namespace ivory;

struct VdbFile {
  openvdb::MetaMap metadata;
  std::vector<openvdb::GridBase::Ptr> grids;
};

class MemoryArchive : public openvdb::io::Archive {
 public:
  std::string sealed_bytes(const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata) {
    std::ostringstream out(std::ios::binary);
    Archive::write(out, grids, /*seekable=*/true, metadata);
    std::string bytes = std::move(out).str();
    seal_vdb(bytes);
    return bytes;
  }
};

VdbFile load(const std::string& path) {
  openvdb::io::File file(path);
  file.open(/*delayLoad=*/false);
  const auto grids = file.getGrids();
  return {*file.getMetadata(), {grids->begin(), grids->end()}};
}

const std::vector<VdbFile>& samples() {
  static const std::vector<VdbFile> files = [] {
    openvdb::initialize();
    std::vector<VdbFile> made;
    const std::string path = fuzz::file_of(nullptr, 0, ".vdb");
    for (const Basis basis : values_of<Basis>()) {
      write_vdb(path, fuzz::sample_grid(basis), true);
      made.push_back(load(path));
    }
    for (const IrradianceGrid& grid : {fuzz::sample_grid_of_levels(), fuzz::sample_grid_of_groups()}) {
      write_vdb(path, grid, true);
      made.push_back(load(path));
    }
    // Of the layouts of sums the one of fewest grids, as each costs its time.
    write_vdb(path, fuzz::sample_sums(Basis::sh4, Estimator::track), true);
    made.push_back(load(path));
    return made;
  }();
  return files;
}

void set_entry(fuzz::Bytes& bytes, openvdb::MetaMap& map, const std::string& key) {
  const auto component = [&] { return int(bytes.integer()); };
  map.removeMeta(key);
  switch (bytes.byte() % 6) {
    case 0:
      map.insertMeta(key, openvdb::Int64Metadata(bytes.integer()));
      break;
    case 1:
      map.insertMeta(key, openvdb::DoubleMetadata(bytes.wide_number()));
      break;
    case 2:
      map.insertMeta(key, openvdb::StringMetadata(bytes.text(12)));
      break;
    case 3: {
      const int x = component();
      const int y = component();
      map.insertMeta(key, openvdb::Vec3IMetadata(openvdb::Vec3i(x, y, component())));
      break;
    }
    case 4: {
      const float x = bytes.number();
      const float y = bytes.number();
      map.insertMeta(key, openvdb::Vec3SMetadata(openvdb::Vec3s(x, y, bytes.number())));
      break;
    }
    default:
      break;  // left out
  }
}

// A place in the file's box, near it, or anywhere.
openvdb::Coord place(fuzz::Bytes& bytes) {
  const auto one = [&] {
    const std::uint8_t choice = bytes.byte();
    return choice < 250 ? int(choice % 6) - 1 : int(bytes.integer() % 100'000);
  };
  const int x = one();
  const int y = one();
  return {x, y, one()};
}

void change_values(fuzz::Bytes& bytes, const openvdb::GridBase::Ptr& grid) {
  const std::size_t count = bytes.byte() % 8;
  if (const auto vectors = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grid)) {
    for (std::size_t i = 0; i < count; ++i) {
      const openvdb::Coord at = place(bytes);
      const float x = bytes.number();
      const float y = bytes.number();
      vectors->getAccessor().setValueOn(at, openvdb::Vec3s(x, y, bytes.number()));
    }
  } else if (const auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) {
    for (std::size_t i = 0; i < count; ++i) {
      const openvdb::Coord at = place(bytes);
      floats->getAccessor().setValueOn(at, bytes.number());
    }
  } else if (const auto integers = openvdb::gridPtrCast<openvdb::Int64Grid>(grid)) {
    for (std::size_t i = 0; i < count; ++i) {
      const openvdb::Coord at = place(bytes);
      integers->getAccessor().setValueOn(at, bytes.integer());
    }
  }
}

openvdb::math::Transform::Ptr any_transform(fuzz::Bytes& bytes) {
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  for (std::size_t i = bytes.byte() % 6; i-- > 0;) {
    const int row = int(bytes.byte() % 4);
    matrix[row][int(bytes.byte() % 3)] = bytes.wide_number();
  }
  try {
    return openvdb::math::Transform::createLinearTransform(matrix);
  } catch (const openvdb::Exception&) {
    return openvdb::math::Transform::createLinearTransform();  // OpenVDB writes no such matrix
  }
}

void change(fuzz::Bytes& bytes, VdbFile& file) {
  const std::size_t which = bytes.below_or(file.grids.size() - 1);
  switch (bytes.byte() % 8) {
    case 0:
    case 1:
    case 2: {
      auto at = file.metadata.beginMeta();
      std::advance(at, std::ptrdiff_t(bytes.below_or(file.metadata.metaCount() - 1)));
      const std::string key = at->first;
      set_entry(bytes, file.metadata, key);
      if (file.metadata.metaCount() == 0) file.metadata.insertMeta("x", openvdb::Int64Metadata(1));
      break;
    }
    case 3:
      change_values(bytes, file.grids[which]);
      break;
    case 4: {
      const auto transform = any_transform(bytes);
      const bool all = bytes.byte() % 2 == 0;
      for (std::size_t i = 0; i < file.grids.size(); ++i)
        if (all || i == which) file.grids[i]->setTransform(transform->copy());
      break;
    }
    case 5:
      if (file.grids.size() > 1) file.grids.erase(file.grids.begin() + std::ptrdiff_t(which));
      break;
    case 6: {
      const std::string name = file.grids[which]->getName();
      // From OpenVDB's registry: Grid::create() would compile all of a tree here.
      const std::string types[]{openvdb::DoubleGrid::gridType(), openvdb::Int32Grid::gridType(),
                                openvdb::BoolGrid::gridType(), openvdb::Vec3DGrid::gridType(),
                                openvdb::FloatGrid::gridType()};
      file.grids[which] = openvdb::GridBase::createGrid(types[bytes.byte() % std::size(types)]);
      file.grids[which]->setName(name);
      break;
    }
    default:
      set_entry(bytes, file.metadata, "ivory_file_" + bytes.text(8));
  }
}

void check_frame(const GridFrame& frame) {
  for (int i = 0; i < 3; ++i) {
    fuzz::require(frame.size[i] >= 2 && frame.spacing_m[i] > 0 && std::isfinite(frame.spacing_m[i]) &&
                      std::isfinite(frame.origin_m[i]),
                  "a grid's frame");
    for (int k = 0; k < 3; ++k) fuzz::require(std::isfinite(frame.local_to_world[i][k]), "a grid's axes");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // The bytes themselves: told as no file, or as one with a wrong checksum.
  const std::string raw = fuzz::file_of(data, size, ".raw");
  fuzz::reads(raw, [&] { fuzz::require(!is_sealed_vdb(raw) || (verify_vdb(raw), true), ""); });

  fuzz::Bytes bytes(data, size);
  const VdbFile& sample = samples()[bytes.below_or(samples().size() - 1)];
  VdbFile file{sample.metadata, {}};
  for (const auto& grid : sample.grids) file.grids.push_back(grid->deepCopyGrid());
  for (int i = 0; i < 8 && !bytes.empty(); ++i) change(bytes, file);
  const std::string sealed = MemoryArchive().sealed_bytes({file.grids.begin(), file.grids.end()}, file.metadata);
  const std::string path = fuzz::file_of(reinterpret_cast<const std::uint8_t*>(sealed.data()), sealed.size(), ".vdb");
  fuzz::reads(path, [&] {
    const IrradianceGrid grid = read_grid_vdb(path);
    for (int level = 0; level < grid.levels(); ++level) check_frame(grid.frame_of(level));
    fuzz::require(fuzz::all_finite(grid.moments) && fuzz::all_finite(grid.visible_fraction), "a grid's numbers");
  });
  fuzz::reads(path, [&] { check_frame(read_accumulator_vdb(path).frame); });
  fuzz::reads(path, [&] { read_vdb_info(path); });
  return 0;
}
