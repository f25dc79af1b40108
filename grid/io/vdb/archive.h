// OpenVDB's archives as ivory writes them: into memory, or grid by grid. Private to the writer.
#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>

#include <openvdb/openvdb.h>

#include "grid/io/vdb/seal.h"

namespace ivory {

// io::File can only write to a name; the bytes are wanted in memory, to be sealed.
class MemoryArchive : public openvdb::io::Archive {
 public:
  explicit MemoryArchive(std::uint32_t compression) { setCompression(compression | openvdb::io::COMPRESS_ACTIVE_MASK); }
  std::string sealed_bytes(const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& metadata) {
    std::ostringstream out(std::ios::binary);
    Archive::write(out, grids, /*seekable=*/true, metadata);
    std::string result = std::move(out).str();
    seal_vdb(result);
    return result;
  }
};

// The same archive, grid by grid: of a large one there is never more than what is being written.
class GridStream : private openvdb::io::Archive {
 public:
  // `count` grids follow.
  GridStream(std::ostream& out, std::uint32_t compression, const openvdb::MetaMap& metadata, std::int32_t count)
      : out_(out) {
    setCompression(compression | openvdb::io::COMPRESS_ACTIVE_MASK);
    openvdb::io::setStreamMetadataPtr(out_, facts_, /*transfer=*/false);
    openvdb::io::setDataCompression(out_, Archive::compression());
    openvdb::io::setWriteGridStatsMetadata(out_, isGridStatsMetadataEnabled());
    writeHeader(out_, /*seekable=*/true);
    metadata.writeMeta(out_);
    out_.write(reinterpret_cast<const char*>(&count), sizeof(count));
  }
  ~GridStream() override { openvdb::io::clearStreamMetadataPtr(out_); }
  GridStream(const GridStream&) = delete;
  GridStream& operator=(const GridStream&) = delete;
  void add(const openvdb::GridBase::ConstPtr& grid) {
    openvdb::io::GridDescriptor descriptor(grid->getName(), grid->type(), grid->saveFloatAsHalf());
    writeGrid(descriptor, grid, out_, /*seekable=*/true);
    openvdb::io::setDataCompression(out_, compression());  // each grid may have one of its own
  }

 private:
  std::ostream& out_;
  // The stream knows it by its place.
  std::shared_ptr<openvdb::io::StreamMetadata> facts_ = std::make_shared<openvdb::io::StreamMetadata>();
};

}  // namespace ivory
