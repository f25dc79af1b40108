#include "tools/cli/target_error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/cli/numbers.h"
#include "tools/cli/usage_error.h"

namespace ivory {

namespace {

template <typename Text>
std::string prediction_text(const Prediction& prediction, const Text& text) {
  return fmt::format("{} ({} to {})", text(prediction.expected), text(prediction.low), text(prediction.high));
}

}  // namespace

double parse_share(std::string_view option, std::string_view text) {
  const bool percent = text.ends_with('%');
  std::string_view digits = percent ? text.substr(0, text.size() - 1) : text;
  while (digits.ends_with(' ')) digits.remove_suffix(1);
  const std::optional<double> number = parse_number(digits);
  const double share = number.value_or(0) / (percent ? 100 : 1);
  if (!number || !(share > 0) || !(share <= 1) || (!percent && share == 1))
    throw UsageError(fmt::format("{}: '{}' is no share between 0 and 100 %, as 2% or 0.02", option, text));
  return share;
}

std::string format_share(double share) { return fmt::format("{:.2g} %", 100 * share); }

Option add_target_error_option(Command command, std::optional<double>& target, const std::string& description) {
  return command
      .add_option(
          "--target-error", [&target](const std::string& text) { target = parse_share("--target-error", text); },
          description)
      .type_name("SHARE");
}

Option add_dry_run_option(Command command, bool& dry_run) {
  return command.add_flag("--dry-run", dry_run, "Say what would be baked, at what cost, and write nothing");
}

nlohmann::ordered_json prediction_json(const Prediction& prediction) {
  return {{"low", prediction.low}, {"expected", prediction.expected}, {"high", prediction.high}};
}

std::string seconds_text(const Prediction& seconds) {
  return prediction_text(seconds, [](double s) { return s < 100 ? fmt::format("{:.2g} s", s) : format_duration(s); });
}

std::string bytes_text(const Prediction& bytes) {
  return prediction_text(bytes, [](double count) { return format_bytes(std::uint64_t(count)); });
}

std::string share_text(const Prediction& share) { return prediction_text(share, format_share); }

nlohmann::ordered_json certificate_json(const Certificate& certificate) {
  nlohmann::ordered_json json;
  if (certificate.target > 0) json["target"] = certificate.target;
  json["error"] = certificate.error;
  json["low"] = certificate.low;
  json["high"] = certificate.high;
  if (certificate.target > 0) json["met"] = certificate.error <= certificate.target;
  json["measure"] = certificate.measure;
  json["parts"] = nlohmann::ordered_json::object();
  for (const auto& [name, share] : certificate.parts) json["parts"][name] = share;
  return json;
}

std::string certificate_text(const Certificate& certificate) {
  std::string text = fmt::format("error {} (95 %: {} to {})", format_share(certificate.error),
                                 format_share(certificate.low), format_share(certificate.high));
  if (certificate.target > 0) {
    text += fmt::format(", {} {}", certificate.error <= certificate.target ? "within the asked-for" : "MISSES",
                        format_share(certificate.target));
  }
  if (!certificate.measure.empty()) text += ": " + certificate.measure;
  text += '\n';
  std::string parts;
  for (const auto& [name, share] : certificate.parts)
    parts += fmt::format("{}{} {}", parts.empty() ? "parts: " : ", ", name, format_share(share));
  return parts.empty() ? text : text + parts + "\n";
}

std::string missed_text(const Certificate& certificate) {
  if (!(certificate.target > 0) || certificate.error <= certificate.target) return {};
  return fmt::format("the error of {} (95 %: {} to {}) misses the asked-for {}", format_share(certificate.error),
                     format_share(certificate.low), format_share(certificate.high), format_share(certificate.target));
}

}  // namespace ivory
