// A .vdb file that is open for reading: what it says of itself, checked, and its grids. Names OpenVDB's types: private
// to the readers of grid/io/vdb/.
#pragma once

#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include "grid/base/error.h"
#include "grid/base/metadata.h"
#include "grid/base/names.h"
#include "grid/io/vdb/layout.h"

namespace ivory {

inline constexpr const char* read_remedy = "give a .vdb file that ivory baked";

MetaValue meta_value(const openvdb::Metadata& value);

// An opened file and its metadata, wherever they survived. Members throw Error where the file lacks or misstates what
// they return.
struct OpenVdbFile {
  // Reads `name`; `shown_path` is for messages.
  OpenVdbFile(std::string shown_path, const std::string& name);

  // To be thrown.
  Error missing(const std::string& what) const;

  template <typename T>
  T get(const std::string& key) const {
    const auto typed = metadata->getMetadata<openvdb::TypedMetadata<T>>(file_prefix + key);
    if (!typed) throw missing(file_prefix + key);
    return typed->value();
  }
  V3f get_vector(const std::string& key) const;
  template <typename Enum>
  Enum get_named(const std::string& key) const {
    if (const auto value = find_by_name<Enum>(get<std::string>(key))) return *value;
    throw missing(file_prefix + key);
  }

  // Throws Error for a file of another kind.
  void require_kind(const char* kind) const;

  Metadata caller_metadata() const;
  // The (coarsest) frame as baked; sizes checked against what memory can hold at `bytes_per_vertex`, the reader's peak.
  GridFrame stored_frame(std::size_t bytes_per_vertex) const;
  int stored_levels() const;
  // Names of the groups of lights that it keeps apart; none in most files.
  std::vector<std::string> stored_groups() const;
  // Zero in files of grids near the world's origin, which state none.
  V3d stored_anchor() const;

  // Grid `grid_name` as type Grid, inside the index box and placed as the others.
  template <typename Grid>
  typename Grid::Ptr grid(const std::string& grid_name, const GridFrame& frame,
                          const openvdb::math::Transform* transform) {
    return grid<Grid>(file, grid_name, frame, transform);
  }
  // The same from another(): each thread has its own.
  template <typename Grid>
  typename Grid::Ptr grid(openvdb::io::File& from, const std::string& grid_name, const GridFrame& frame,
                          const openvdb::math::Transform* transform) const {
    if (!from.hasGrid(grid_name)) throw missing("grid " + grid_name);
    auto typed = openvdb::gridPtrCast<Grid>(from.readGrid(grid_name));
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

  // The file once more.
  std::unique_ptr<openvdb::io::File> another() const;

  std::string path;  // for messages
  openvdb::io::File file;
  openvdb::MetaMap::Ptr metadata;
};

// OpenVDB's exceptions, and what a damaged file that no checksum guards may cause in it, become the one line.
template <typename Read>
auto with_open_file(const std::string& path, const std::string& copy, const Read& read) {
  try {
    OpenVdbFile in(path, copy.empty() ? path : copy);
    return read(in);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(path, fmt::format("OpenVDB reports {}", error.what()), read_remedy);
  }
}

}  // namespace ivory
