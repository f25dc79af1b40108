// ivory bake grid --report: one page that shows what was asked for, what was reached, and where it falls short.
#pragma once

#include <string>

#include "tools/cli/common.h"
#include "tracer/bake/field/contract/contract.h"

namespace ivory {

// Writes the page; it needs no file beside it. The certificate is there. `lookup` is how the certificate read. Throws
// as write_file() does.
void write_grid_report(const std::string& path, const std::string& grid_path, const LitScene& lit,
                       const IrradianceGrid& grid, const ContractResult& contract, const LookupParams& lookup,
                       const CommonOptions& common);

}  // namespace ivory
