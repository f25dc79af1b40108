#include "tools/cli/common.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>
#include <unistd.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/io/file.h"

namespace ivory {

int thread_count(const CommonOptions& common) {
  if (common.threads > 0) return common.threads;
  return available_processors();
}

void set_action(CLI::App& command, CommonOptions& common, Output output, std::function<void()> action) {
  const std::string group = "Common options";
  command.add_option("--threads", common.threads, "Threads to use; one a core by default")
      ->check(CLI::Range(1, 1024))
      ->type_name("N")
      ->group(group);
  if (output == Output::file)
    command.add_flag("-f,--force", common.force, "Overwrite the output where it exists")->group(group);
  command.add_flag("--json", common.json, "Print one JSON object on stdout as the result")->group(group);
  command.add_flag("-q,--quiet", common.quiet, "Neither progress nor messages, errors excepted")->group(group);
  command.callback([&common, action = std::move(action)] {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(thread_count(common)));
    action();
  });
}

namespace {

[[noreturn]] void refuse(std::string_view option, std::string_view text, std::string_view expected) {
  throw UsageError(fmt::format("{}: '{}' is not {}", option, text, expected));
}

// All of `text` as a plain number.
template <typename T>
std::optional<T> parse_number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

std::optional<std::uint64_t> count_from(std::string_view text) {
  constexpr std::uint64_t limit = std::numeric_limits<std::int64_t>::max();  // files store int64
  std::uint64_t unit = 1;
  if (!text.empty()) {
    switch (text.back()) {
      case 'k':
      case 'K':
        unit = 1'000;
        break;
      case 'm':
      case 'M':
        unit = 1'000'000;
        break;
      case 'g':
      case 'G':
        unit = 1'000'000'000;
        break;
      default:
        break;
    }
    if (unit != 1) text.remove_suffix(1);
  }
  // Integer arithmetic throughout, so that large counts stay exact.
  const std::size_t point = text.find('.');
  const std::string_view whole_text = text.substr(0, point);
  const auto whole = parse_number<std::uint64_t>(whole_text);
  if (!whole || *whole > limit / unit) return std::nullopt;
  std::uint64_t count = *whole * unit;
  if (point != std::string_view::npos) {
    const std::string_view digits = text.substr(point + 1);
    if (digits.empty()) return std::nullopt;
    for (const char digit : digits) {
      if (digit < '0' || digit > '9') return std::nullopt;
      unit /= 10;
      if (unit == 0 && digit != '0') return std::nullopt;
      count += std::uint64_t(digit - '0') * unit;
    }
  }
  if (count > limit) return std::nullopt;
  return count;
}

}  // namespace

std::uint64_t parse_count(std::string_view option, std::string_view text) {
  const auto count = count_from(text);
  if (!count) refuse(option, text, "a count (a whole number, or 250k, 8m, 1.5g)");
  return *count;
}

V3i parse_size3(std::string_view option, std::string_view text, int least) {
  const auto parts = split(text, ',');
  V3i size;
  for (int axis = 0; axis < 3; ++axis) {
    const auto value = parse_number<int>(parts[parts.size() == 1 ? 0 : std::min(std::size_t(axis), parts.size() - 1)]);
    if ((parts.size() != 1 && parts.size() != 3) || !value || *value < least || *value > 65536)
      refuse(option, text, fmt::format("NX,NY,NZ (or one number for all three), each from {} to 65536", least));
    size[axis] = *value;
  }
  return size;
}

Imath::V2i parse_image_size(std::string_view option, std::string_view text) {
  const auto parts = split(text, 'x');
  const auto width = parse_number<int>(parts[0]);
  const auto height = parse_number<int>(parts.back());
  if (parts.size() != 2 || !width || !height || *width < 1 || *height < 1 || *width > 65536 || *height > 65536)
    refuse(option, text, "WxH in pixels, such as 640x480, each from 1 to 65536");
  return {*width, *height};
}

std::pair<std::uint64_t, std::uint64_t> parse_range(std::string_view option, std::string_view text) {
  const auto parts = split(text, ':');
  const auto begin = count_from(parts[0]);
  const auto end = count_from(parts.back());
  if (parts.size() != 2 || !begin || !end || *begin >= *end)
    refuse(option, text, "a range A:B with A < B, such as 0:8m (B itself is left out)");
  return {*begin, *end};
}

std::vector<float> parse_floats(std::string_view option, std::string_view text, std::size_t count,
                                std::string_view form) {
  std::vector<float> values;
  for (const std::string_view part : split(text, ',')) {
    const auto value = parse_number<float>(part);
    if (!value || !std::isfinite(*value)) refuse(option, text, form);
    values.push_back(*value);
  }
  if (values.size() != count) refuse(option, text, form);
  return values;
}

std::function<std::string(const std::string&)> within(double low, double high) {
  return [low, high](const std::string& text) {
    const auto value = parse_number<double>(text);
    if (value && *value >= low && *value <= high) return std::string();
    return fmt::format("'{}' is not a number from {} to {}", text, low, high);
  };
}

V3f parse_vector3(std::string_view option, std::string_view text) {
  const std::vector<float> v = parse_floats(option, text, 3, "X,Y,Z");
  return {v[0], v[1], v[2]};
}

CLI::Option* add_count_option(CLI::App& command, const std::string& name, std::uint64_t& value,
                              const std::string& description) {
  CLI::Option* option = command.add_option_function<std::string>(
      name, [&value, name](const std::string& text) { value = parse_count(name, text); }, description);
  option->type_name("COUNT");
  if (value != 0) option->default_str(std::to_string(value));
  return option;
}

CLI::Option* add_count_option(CLI::App& command, const std::string& name, int& value, int least, int most,
                              const std::string& description) {
  return command
      .add_option_function<std::string>(
          name,
          [&value, name, least, most](const std::string& text) {
            const std::uint64_t count = parse_count(name, text);
            if (count < std::uint64_t(least) || count > std::uint64_t(most))
              throw UsageError(fmt::format("{}: {} is not from {} to {}", name, text, least, most));
            value = int(count);
          },
          description)
      ->type_name("COUNT")
      ->default_str(std::to_string(value));
}

CLI::Option* add_image_size_option(CLI::App& command, const std::string& name, Imath::V2i& value,
                                   const std::string& description) {
  CLI::Option* option = command.add_option_function<std::string>(
      name, [&value, name](const std::string& text) { value = parse_image_size(name, text); }, description);
  option->type_name("WxH");
  if (value.x != 0) option->default_str(fmt::format("{}x{}", value.x, value.y));
  return option;
}

void check_output(const std::string& path, const CommonOptions& common) { const PendingFile probe(path, common.force); }

void check_output(const std::string& path, std::string_view extension, const CommonOptions& common) {
  if (lower_extension(path) != extension)
    throw UsageError(fmt::format("--output: '{}' does not end in {}", path, extension));
  check_output(path, common);
}

void print_result(const CommonOptions& common, const nlohmann::ordered_json& object, const std::string& human) {
  if (common.json) {
    // Names in files need not be UTF-8; a replacement character beats a crash.
    fmt::print("{}\n", object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  } else if (!common.quiet) {
    fmt::print("{}", human);
  }
  if (std::fflush(stdout) != 0) throw Error("standard output", "cannot be written", "check the disk or the pipe");
}

void print_note(const CommonOptions& common, const std::string& line) {
  if (!common.quiet) fmt::print(stderr, "{}\n", line);
}

Progress::Progress(const CommonOptions& common, std::string label, std::string unit)
    : label_(std::move(label)), unit_(std::move(unit)), visible_(!common.quiet && ::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
}

void Progress::update(std::uint64_t done, std::uint64_t total) {
  if (!visible_) return;
  const std::scoped_lock lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (drawn_ && now - last_drawn_ < std::chrono::milliseconds(200)) return;
  if (!drawn_) {
    start_ = now;
    start_done_ = done;
  }
  last_drawn_ = now;
  drawn_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const double rate = seconds > 0 ? static_cast<double>(done - std::min(done, start_done_)) / seconds : 0;
  std::string line = fmt::format("\r{}: {} of {} {}", label_, format_count(static_cast<double>(done)),
                                 format_count(static_cast<double>(total)), unit_);
  if (rate > 0 && total >= done) {
    line +=
        fmt::format(", {}/s, {} left", format_count(rate), format_duration(static_cast<double>(total - done) / rate));
  }
  fmt::print(stderr, "{}\033[K", line);
  std::fflush(stderr);
}

void Progress::note(const std::string& line) {
  if (!visible_) return;
  const std::scoped_lock lock(mutex_);
  fmt::print(stderr, "{}{}\n", drawn_ ? "\r\033[K" : "", line);
}

std::function<void(std::uint64_t, std::uint64_t)> Progress::callback() {
  return [this](std::uint64_t done, std::uint64_t total) { update(done, total); };
}

double shortest(float value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return parse_number<double>(std::string_view(text.data(), std::size_t(end - text.data()))).value_or(double(value));
}

std::string format_count(double count) {
  const std::array<std::pair<double, const char*>, 3> units{{{1e9, " G"}, {1e6, " M"}, {1e3, " k"}}};
  for (const auto& [unit, suffix] : units) {
    if (count >= 0.9995 * unit) return fmt::format("{:.3g}{}", count / unit, suffix);
  }
  return fmt::format("{:.3g}", count);
}

std::string format_duration(double seconds) {
  if (!(seconds < 1e9)) return "unknown time";
  const auto total = static_cast<std::int64_t>(std::llround(seconds));
  const std::int64_t hours = total / 3600;
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, total / 60 % 60, total % 60);
  return fmt::format("{}:{:02}", total / 60, total % 60);
}

std::string format_bytes(std::uint64_t bytes) {
  const auto value = static_cast<double>(bytes);
  if (value >= 0x1p30) return fmt::format("{:.4g} GiB", value / 0x1p30);
  if (value >= 0x1p20) return fmt::format("{:.4g} MiB", value / 0x1p20);
  if (value >= 0x1p10) return fmt::format("{:.4g} KiB", value / 0x1p10);
  return fmt::format("{} bytes", bytes);
}

}  // namespace ivory
