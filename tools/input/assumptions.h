// What a command had to assume, clamp or leave out of its inputs: told once to who ran it, and kept in the asset.
#pragma once

#include <string>
#include <vector>

#include "grid/base/metadata.h"
#include "tools/cli/common.h"

namespace ivory {

// Prints each as a note "warning: ...".
void print_warnings(const CommonOptions& common, const std::vector<std::string>& warnings);

// Adds them to `metadata` as "assumptions", a line each, behind those that are there; a file's name stands without its
// folders, so that the asset does not depend on where its inputs lie.
void keep_assumptions(Metadata& metadata, const std::vector<std::string>& warnings);

}  // namespace ivory
