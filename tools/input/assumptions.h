// What a command had to assume, clamp or leave out of its inputs: kept in the asset.
#pragma once

#include <string>
#include <vector>

#include "grid/base/metadata.h"

namespace ivory {

// Adds them to `metadata` as "assumptions", a line each, behind those that are there and unless they are; a file's name
// stands without its folders, so that the asset does not depend on where its inputs lie.
void keep_assumptions(Metadata& metadata, const std::vector<std::string>& warnings);

}  // namespace ivory
