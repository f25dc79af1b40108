#include "tools/cli/options.h"

#include <cmath>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/cli/numbers.h"

namespace ivory {

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::description(const std::string& text) {
  option_->description(text);
  return *this;
}

Option& Option::type_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Option& Option::group(const std::string& heading) {
  option_->group(heading);
  return *this;
}

Option& Option::default_str(const std::string& text) {
  option_->default_str(text);
  return *this;
}

Option& Option::repeated() {
  option_->expected(1, -1)->allow_extra_args(false);  // as many as wanted
  return *this;
}

Option& Option::one_of(const std::vector<std::string>& values) {
  option_->check(CLI::IsMember(values));
  return *this;
}

// Not CLI::Range and CLI::PositiveNumber, which take nan too.
Option& Option::within(double low, double high) {
  const auto check = [low, high](const std::string& text) {
    const auto value = parse_number(text);
    if (value && *value >= low && *value <= high) return std::string();
    return fmt::format("'{}' is not a number from {} to {}", text, low, high);
  };
  option_->check(check, fmt::format("in [{} - {}]", low, high));
  return *this;
}

Option& Option::positive() {
  const auto check = [](const std::string& text) {
    const auto value = parse_number(text);
    return value && *value > 0 && std::isfinite(*value) ? std::string()
                                                        : fmt::format("'{}' is not a number above 0", text);
  };
  option_->check(check, "above 0");
  return *this;
}

Option& Option::needs(const Option& other) {
  option_->needs(other.option_);
  return *this;
}

Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

bool Option::given() const { return option_->count() > 0; }

namespace {

template <typename T>
Option add(CLI::App& app, const std::string& name, T& value, const std::string& description) {
  CLI::Option* option = app.add_option(name, value, description);
  if (value != T{}) option->capture_default_str();
  return Option(option);
}

}  // namespace

Command Command::add_subcommand(const std::string& name, const std::string& description) {
  return Command(*app_->add_subcommand(name, description));
}

void Command::require_subcommand() { app_->require_subcommand(1); }

void Command::footer(const std::string& text) { app_->footer(text); }

void Command::callback(std::function<void()> function) { app_->callback(std::move(function)); }

Option Command::add_option(const std::string& name, std::string& value, const std::string& description) {
  return add(*app_, name, value, description);
}

Option Command::add_option(const std::string& name, std::vector<std::string>& values, const std::string& description) {
  return add(*app_, name, values, description);
}

Option Command::add_option(const std::string& name, int& value, const std::string& description) {
  return add(*app_, name, value, description);
}

Option Command::add_option(const std::string& name, float& value, const std::string& description) {
  return add(*app_, name, value, description);
}

Option Command::add_option(const std::string& name, double& value, const std::string& description) {
  return add(*app_, name, value, description);
}

Option Command::add_option(const std::string& name, std::optional<float>& value, const std::string& description) {
  return Option(app_->add_option(name, value, description));
}

Option Command::add_option(const std::string& name, std::function<void(const std::string&)> read,
                           const std::string& description) {
  const auto read_all = [read = std::move(read)](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) read(text);
  };
  CLI::Option* option = app_->add_option_function<std::vector<std::string>>(name, read_all, description);
  return Option(option->expected(1)->allow_extra_args(false));  // what follows its one value is no second one
}

Option Command::add_flag(const std::string& name, bool& value, const std::string& description) {
  return Option(app_->add_flag(name, value, description));
}

Option Command::add_flag(const std::string& name, std::function<void()> given, const std::string& description) {
  return Option(app_->add_flag_callback(name, std::move(given), description));
}

Option Command::add_count(const std::string& name, std::uint64_t& value, const std::string& description) {
  Option option = add_option(
      name, [&value, name](const std::string& text) { value = parse_count(name, text); }, description);
  option.type_name("COUNT");
  if (value != 0) option.default_str(std::to_string(value));
  return option;
}

Option Command::add_count(const std::string& name, int& value, int least, int most, const std::string& description) {
  const auto read = [&value, name, least, most](const std::string& text) {
    const std::uint64_t count = parse_count(name, text);
    if (count < std::uint64_t(least) || count > std::uint64_t(most))
      throw UsageError(fmt::format("{}: {} is not from {} to {}", name, text, least, most));
    value = int(count);
  };
  return add_option(name, read, description).type_name("COUNT").default_str(std::to_string(value));
}

Option Command::add_image_size(const std::string& name, Imath::V2i& value, const std::string& description) {
  Option option = add_option(
      name, [&value, name](const std::string& text) { value = parse_image_size(name, text); }, description);
  option.type_name("WxH");
  if (value.x != 0) option.default_str(fmt::format("{}x{}", value.x, value.y));
  return option;
}

Option Command::get_option(const std::string& name) const { return Option(app_->get_option(name)); }

}  // namespace ivory
