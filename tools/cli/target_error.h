// The contract that every bake with a knob offers: an error that is asked for, and the certificate of what was reached.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "grid/base/certificate.h"
#include "grid/base/prediction.h"
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

// low, expected and high.
nlohmann::ordered_json prediction_json(const Prediction& prediction);
// The same for people: "12 s (8 to 19)", of seconds, bytes and shares.
std::string seconds_text(const Prediction& seconds);
std::string bytes_text(const Prediction& bytes);
std::string share_text(const Prediction& share);

// For results and `ivory info`: target (where asked for), error, low, high, met, measure, parts.
nlohmann::ordered_json certificate_json(const Certificate& certificate);
// The same for people, whole lines.
std::string certificate_text(const Certificate& certificate);

// One line for a warning where the certificate misses its target, its interval taken into account: empty where the
// measured error is at most the target.
std::string missed_text(const Certificate& certificate);

}  // namespace ivory
