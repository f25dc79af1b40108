// Has an asset to be baked, and why?
#pragma once

#include <string>
#include <vector>

#include "tools/batch/state/record.h"
#include "tools/batch/state/sources.h"

namespace ivory {

// What an asset would be made from now. Assets that it needs count by their files; `to_come` says of which assets of
// the job the files are still to be made: their entries are empty, and not compared. Throws Error where a file is
// missing or a scene cannot be loaded.
AssetInputs inputs_of(const JobAsset& asset, Sources& sources, const std::vector<bool>& to_come);

// Why an asset is to be made, a line each, the weightiest first; nothing where what is there is what would be made.
// `record`: of the earlier bake, or nullptr.
std::vector<std::string> reasons_to_bake(const JobAsset& asset, const AssetInputs& now, const AssetRecord* record,
                                         Sources& sources);

// Throws Error where a file that the asset would write is there and is not what a batch has written: `record` may be
// nullptr.
void check_ownership(const JobAsset& asset, const AssetRecord* record, Sources& sources);

}  // namespace ivory
