// SH9 assets as JSON, and what other engines take of them.
#pragma once

#include <string>

#include "grid/base/metadata.h"
#include "grid/env/difmap.h"
#include "grid/env/sh9.h"

namespace ivory {

struct Sh9Asset {
  Sh9 sh;             // as read: bands above `order` zero, window applied
  int order = 2;      // highest band stored: 0, 1 or 2
  Sh9Window window;   // applied already
  Sh9Error error;     // measured against the full irradiance of the map
  Metadata metadata;  // environment, environment_hash, layout ...
};

// One object: format, coefficients (9 x 3), matrices (3 x 4 x 4, R G B), average_error and maximum_error (relative to
// the light of the whole sphere) and ..._of_mean_irradiance, order, window (three factors), units, and the metadata.
// Whole or not at all; throws Error where the file exists and not `force`, or cannot be written.
void write_sh9(const std::string& path, const Sh9Asset& asset, bool force);

// Throws Error for what is no such file: bad JSON, missing or misshapen entries, numbers that are not finite, a later
// format version, matrices that do not belong to the coefficients.
Sh9Asset read_sh9(const std::string& path);

// True for names that end in .json, in any case.
bool is_sh9_name(const std::string& path);

}  // namespace ivory
