// What bake grid and merge have in common: turning sums into the file, and reporting it.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "grid/field/accumulator.h"
#include "tools/cli/common.h"

namespace ivory {

// True where the sums hold every photon of the bake they belong to.
bool is_whole(const GridAccumulator& accumulator);

// Writes the finished grid, or, unless `finished`, the sums themselves, and describes what was
// written; "warnings" says where too few photons came, which it also prints as notes and, in a finished grid, leaves in
// the metadata as few_photons. Equal sums give equal files.
// The sums, by far the largest part, are let go before the file is made of a finished grid.
nlohmann::ordered_json write_result(const std::string& path, GridAccumulator accumulator, bool finished,
                                    const CommonOptions& common);

// The same for people: whole lines.
std::string result_text(const nlohmann::ordered_json& result);

}  // namespace ivory
