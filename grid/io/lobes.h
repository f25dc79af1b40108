// Lobe tables as files: an OpenEXR asset of kind "lobes".
#pragma once

#include <string>

#include "grid/base/metadata.h"
#include "grid/lobes/table.h"

namespace ivory {

inline constexpr const char* lobes_kind = "lobes";

// Rows are (node of e1, node of e2), columns nodes of the angle; channels integral, axis, exponent as
// grid/lobes/table.cpp derives them. Throws Error as write_exr() does.
void write_lobes(const std::string& path, const LobeTable& table, const Metadata& metadata, bool force);

struct LobesFile {
  LobeTable table;
  Metadata metadata;
};
// Throws Error as read_exr() does, and for tables that are not what make_lobe_table() builds.
LobesFile read_lobes(const std::string& path);

}  // namespace ivory
