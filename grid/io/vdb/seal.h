// The 36 characters of UUID near the start of every .vdb file. OpenVDB fills them at random; ivory writes a mark and a
// checksum of all other bytes there. So equal content gives equal files, and a damaged file is told apart before
// OpenVDB's parser, which trusts its input, sees it. Files saved again by other programs carry a random UUID and cannot
// be checked.
#pragma once

#include <string>

namespace ivory {

// Replaces the UUID of a whole .vdb file held in memory.
void seal_vdb(std::string& bytes);

// Of one on the disk, all of which has been written. Throws Error, which names `path`, where that fails.
void seal_vdb_file(const std::string& file, const std::string& path);

// Does the file bear ivory's mark? Reads its first bytes alone. Throws Error where it cannot be read or is no .vdb
// file.
bool is_sealed_vdb(const std::string& path);

// Throws Error where the file cannot be read, is no .vdb file, or bears ivory's mark but another checksum.
void verify_vdb(const std::string& path);

}  // namespace ivory
