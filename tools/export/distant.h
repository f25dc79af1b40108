// SH9 and DifMaps as other engines take them.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "grid/export/target.h"
#include "tools/input/file_kind.h"

namespace ivory {

struct ExportOptions;
struct CommonOptions;

// Writes options.output and prints the result.
void export_distant(const ExportOptions& options, FileKind kind, const ExportFormat& format,
                    const CommonOptions& common);

}  // namespace ivory
