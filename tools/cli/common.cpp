#include "tools/cli/common.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>
#include <unistd.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "grid/io/file.h"
#include "tools/cli/host.h"
#include "tools/cli/streams.h"

namespace ivory {

int thread_count(const CommonOptions& common) {
  if (common.threads > 0) return common.threads;
  return available_processors();
}

void set_action(Command command, CommonOptions& common, Output output, std::function<void()> action) {
  const std::string group = "Common options";
  command.add_option("--threads", common.threads, "Threads to use; one a core by default")
      .within(1, 1024)
      .type_name("N")
      .group(group);
  if (output == Output::file)
    command.add_flag("-f,--force", common.force, "Overwrite the output where it exists").group(group);
  command.add_flag("--json", common.json, "Print one JSON object on stdout as the result").group(group);
  command.add_flag("-q,--quiet", common.quiet, "Neither progress nor messages, errors excepted").group(group);
  command.callback([&common, action = std::move(action)] {
    if (common.host != nullptr && common.host->stage == CommandStage::parse) return;
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(thread_count(common)));
    action();
  });
}

void check_output(const std::string& path, const CommonOptions& common) {
  if (path == "-")
    throw UsageError("--output: '-' is no file name, and nothing is written to standard output; ./- names such a file");
  if (common.host != nullptr && common.host->stage == CommandStage::check) return;
  std::error_code unreadable;  // then the probe says why
  if (!common.force && std::filesystem::is_regular_file(path, unreadable))
    throw Error(path, "already exists", "give --force to overwrite it");
  const PendingFile probe(path, common.force);
}

void check_output(const std::string& path, std::string_view extension, const CommonOptions& common) {
  if (lower_extension(path) != extension)
    throw UsageError(fmt::format("--output: '{}' does not end in {}", path, extension));
  check_output(path, common);
}

void print_result(const CommonOptions& common, const nlohmann::ordered_json& object, const std::string& human) {
  if (common.host != nullptr) return common.host->result(object, human);
  std::string text = common.quiet ? "" : human;
  // Names in files need not be UTF-8; a replacement character beats a crash.
  if (common.json) text = object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  print_stdout(text);
}

void print_note(const CommonOptions& common, const std::string& line) {
  if (common.host != nullptr) return common.host->note(in_one_line(line));
  if (!common.quiet) print_stderr(in_one_line(line) + "\n");
}

void print_warnings(const CommonOptions& common, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) print_note(common, "warning: " + warning);
}

Progress::Progress(const CommonOptions& common, std::string label, std::string unit)
    : host_(common.host),
      label_(std::move(label)),
      unit_(std::move(unit)),
      quiet_(common.quiet),
      visible_(host_ == nullptr && !common.quiet && ::isatty(STDERR_FILENO) == 1) {
  begin_work(common);
}

Progress::~Progress() {
  if (drawn_) print_stderr("\r\033[K");
}

void Progress::update(std::uint64_t done, std::uint64_t total) {
  if (host_ != nullptr) return host_->progress(label_, unit_, done, total);
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
  print_stderr(line + "\033[K");
}

void Progress::note(const std::string& line) {
  if (visible_ || host_ != nullptr) say(line);
}

void Progress::say(const std::string& line) {
  if (host_ != nullptr) return host_->note(in_one_line(line));
  if (quiet_) return;
  const std::scoped_lock lock(mutex_);
  print_stderr((drawn_ ? "\r\033[K" : "") + in_one_line(line) + "\n");
}

std::function<void(std::uint64_t, std::uint64_t)> Progress::callback() {
  return [this](std::uint64_t done, std::uint64_t total) { update(done, total); };
}

}  // namespace ivory
