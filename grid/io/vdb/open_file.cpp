#include "grid/io/vdb/open_file.h"

#include <cmath>
#include <iterator>
#include <sstream>
#include <utility>

#include "grid/base/memory.h"
#include "grid/io/vdb/seal.h"

namespace ivory {

MetaValue meta_value(const openvdb::Metadata& value) {
  if (const auto* integer = dynamic_cast<const openvdb::Int64Metadata*>(&value)) return std::int64_t(integer->value());
  if (const auto* number = dynamic_cast<const openvdb::DoubleMetadata*>(&value)) return number->value();
  return value.str();
}

OpenVdbFile::OpenVdbFile(std::string shown_path, const std::string& name) : path(std::move(shown_path)), file(name) {
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

std::unique_ptr<openvdb::io::File> OpenVdbFile::another() const {
  auto opened = std::make_unique<openvdb::io::File>(file.filename());
  opened->open(/*delayLoad=*/false);
  return opened;
}

Error OpenVdbFile::missing(const std::string& what) const {
  return Error(path, "lacks or misstates " + what, read_remedy);
}

V3f OpenVdbFile::get_vector(const std::string& key) const {
  const auto v = get<openvdb::Vec3s>(key);
  return {v.x(), v.y(), v.z()};
}

void OpenVdbFile::require_kind(const char* kind) const {
  const auto found = get<std::string>("kind");
  if (found == kind) return;
  if (found == vdb_accumulator_kind)
    throw Error(path, "holds the photon sums of a partial bake", "finish it first: ivory merge PART... -o OUT.vdb");
  if (found == vdb_grid_kind) throw Error(path, "is a finished grid", "give the parts of a partial bake");
  throw missing(file_prefix + "kind");
}

Metadata OpenVdbFile::caller_metadata() const {
  Metadata result;
  for (auto entry = metadata->beginMeta(); entry != metadata->endMeta(); ++entry) {
    const std::string& key = entry->first;
    if (!key.starts_with(meta_prefix) || key.starts_with(file_prefix)) continue;
    result[key.substr(meta_prefix.size())] = meta_value(*entry->second);
  }
  return result;
}

GridFrame OpenVdbFile::stored_frame(std::size_t bytes_per_vertex) const {
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

int OpenVdbFile::stored_levels() const {
  if (!(*metadata)[file_prefix + levels_key]) return 1;
  const auto levels = get<std::int64_t>(levels_key);
  if (levels < 2 || levels > max_levels) throw missing(file_prefix + levels_key);
  return int(levels);
}

std::vector<std::string> OpenVdbFile::stored_groups() const {
  const auto stored = metadata->getMetadata<openvdb::StringMetadata>(meta_prefix + light_groups_key);
  if (!stored) return {};
  std::istringstream names(stored->value());
  return {std::istream_iterator<std::string>(names), {}};
}

V3d OpenVdbFile::stored_anchor() const {
  if (!(*metadata)[file_prefix + anchor_key]) return V3d(0, 0, 0);
  const auto v = get<openvdb::Vec3d>(anchor_key);
  const V3d anchor_m(v.x(), v.y(), v.z());
  if (!(std::abs(anchor_m.x) <= 1e30 && std::abs(anchor_m.y) <= 1e30 && std::abs(anchor_m.z) <= 1e30))
    throw missing(file_prefix + anchor_key);
  return anchor_m;
}

}  // namespace ivory
