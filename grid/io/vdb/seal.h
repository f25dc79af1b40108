// The 36 characters of UUID near the start of every .vdb file. OpenVDB fills them at random; ivory
// writes a mark and a checksum of all other bytes there. So equal content gives equal files, and a
// damaged file is told apart before OpenVDB's parser, which trusts its input, sees it. Files saved
// again by other programs carry a random UUID and cannot be checked.
#pragma once

#include <string>

namespace ivory {

// Replaces the UUID of a whole .vdb file held in memory.
void seal_vdb(std::string& bytes);

// Throws Error where the file cannot be read, is no .vdb file, or bears ivory's mark but another
// checksum. True where the checksum was there and right, false where the file bears none.
bool verify_vdb(const std::string& path);

// The file's grids and metadata saved again, sealed, in memory (io_vdb_write.cpp). Throws what OpenVDB
// throws, and may crash where it does.
std::string resave_vdb(const std::string& path);

}  // namespace ivory
