// ivory bake grid --report: one page that shows what was asked for, what was reached, and where it falls short.
#pragma once

#include <string>

#include "tracer/bake/field/contract/contract.h"

namespace ivory {

// The page, which needs no file beside it. The certificate is there; `lookup` is how it read.
std::string grid_report(const std::string& grid_path, const LitScene& lit, const IrradianceGrid& grid,
                        const ContractResult& contract, const LookupParams& lookup);

}  // namespace ivory
