// What every subcommand shares: its common options, how it shows progress and reports results. A subcommand is one file
// exporting add_<name>_command(app, common), declared in commands.h: it declares its options and hands its work to
// set_action().
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/cli/numbers.h"
#include "tools/cli/options.h"

namespace ivory {

class CommandHost;

struct CommonOptions {
  int threads = 0;     // 0: one a core
  bool json = false;   // one result object on stdout instead of lines for people
  bool quiet = false;  // neither progress nor lines for people
  bool force = false;  // overwrite existing outputs
  // Another command that runs this one, and takes what it prints (tools/cli/host.h); null for the command line.
  CommandHost* host = nullptr;
};

enum class Output { none, file };

// Adds --threads, --json, --quiet and, for a command that writes a file, --force, and runs `action`
// after the whole command line has been read and found right. To be called last, so that the shared
// options end the help page. While `action` runs TBB is held to --threads.
void set_action(Command command, CommonOptions& common, Output output, std::function<void()> action);

// Threads that --threads stands for, at least 1.
int thread_count(const CommonOptions& common);

// Fails early, before hours of work: throws Error where `path` exists and not --force, or cannot
// be written.
void check_output(const std::string& path, const CommonOptions& common);
// The same for formats that go by one extension (in lower case here, in any there); throws UsageError for another.
void check_output(const std::string& path, std::string_view extension, const CommonOptions& common);

// Prints `object` on stdout with --json, otherwise `human` (whole lines; unless --quiet).
void print_result(const CommonOptions& common, const nlohmann::ordered_json& object, const std::string& human);

// A line for people on stderr, unless --quiet: what was chosen, what was ignored.
void print_note(const CommonOptions& common, const std::string& line);
// Such a line for each, "warning: " before it.
void print_warnings(const CommonOptions& common, const std::vector<std::string>& warnings);

// Work done, its rate and the time left, redrawn in place on stderr where that is a terminal;
// silent otherwise and with --quiet. Thread-safe.
class Progress {
 public:
  // "baking: 12.3 M of 64 M photons, 1.20 M/s, 0:43 left": `label` "baking", `unit` "photons".
  Progress(const CommonOptions& common, std::string label, std::string unit);
  ~Progress();  // wipes the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(std::uint64_t done, std::uint64_t total);
  // A line above the progress, shown where progress is: what is about to happen.
  void note(const std::string& line);
  // The same wherever stderr goes, unless --quiet: what people must know.
  void say(const std::string& line);
  // update() as a callback; this object must outlive it.
  std::function<void(std::uint64_t, std::uint64_t)> callback();

 private:
  using Clock = std::chrono::steady_clock;
  CommandHost* host_;
  std::string label_;
  std::string unit_;
  bool quiet_;
  bool visible_;
  bool drawn_ = false;
  // Of the first update: what came before was preparation, not work to be timed.
  Clock::time_point start_;
  std::uint64_t start_done_ = 0;
  Clock::time_point last_drawn_;
  std::mutex mutex_;
};

}  // namespace ivory
