// The contract that every bake with a knob offers: an error that is asked for, and the certificate of what was reached.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "grid/base/certificate.h"
#include "tools/cli/options.h"

namespace ivory {

// "2%" or "0.02", as a share: above 0, at most 1. A plain number of 1 and more is refused: it was meant in per cent.
double parse_share(std::string_view option, std::string_view text);
// "2 %", "0.25 %": two significant digits.
std::string format_share(double share);

// --target-error; what is not given stays empty. `description` says of what the error is.
Option add_target_error_option(Command command, std::optional<double>& target, const std::string& description);
// --dry-run: says what would be made, and writes nothing.
Option add_dry_run_option(Command command, bool& dry_run);

// For results and `ivory info`: target (where asked for), error, low, high, met, measure, parts.
nlohmann::ordered_json certificate_json(const Certificate& certificate);
// The same for people, whole lines.
std::string certificate_text(const Certificate& certificate);

// One line for a warning where the certificate misses its target, its interval taken into account: empty where the
// measured error is at most the target.
std::string missed_text(const Certificate& certificate);

}  // namespace ivory
