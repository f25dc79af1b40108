// Grids as volumes of probes for other engines.
#pragma once

#include "grid/export/target.h"

namespace ivory {

struct ExportOptions;
struct CommonOptions;

// Writes options.output and what stands beside it, and prints the result.
void export_grid(const ExportOptions& options, const ExportFormat& format, const CommonOptions& common);

}  // namespace ivory
