#include "tools/batch/work/board.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "tools/cli/streams.h"

namespace ivory {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::size_t terminal_width() {
  winsize size{};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 100;
}

}  // namespace

Board::Board(const CommonOptions& common, std::vector<double> seconds)
    : visible_(!common.quiet && ::isatty(STDERR_FILENO) == 1),
      seconds_(std::move(seconds)),
      finished_(seconds_.size(), false),
      count_(std::count_if(seconds_.begin(), seconds_.end(), [](double s) { return s >= 0; })),
      start_(Clock::now()),
      last_drawn_(start_) {}

Board::~Board() { end(); }

void Board::end() {
  const std::scoped_lock lock(mutex_);
  if (drawn_) print_stderr("\r\033[K");
  drawn_ = false;
  visible_ = false;
}

void Board::start(int asset, const std::string& name) {
  const std::scoped_lock lock(mutex_);
  running_[asset] = {name, "", 0, Clock::now(), 0, ""};
  draw(/*at_once=*/true);
}

void Board::progress(int asset, const std::string& label, const std::string& unit, std::uint64_t done,
                     std::uint64_t total) {
  const std::scoped_lock lock(mutex_);
  const auto found = running_.find(asset);
  if (found == running_.end()) return;
  Running& running = found->second;
  if (running.label != label) {
    running.label = label;
    running.part_start = Clock::now();
  }
  running.unit = unit;
  running.share = total > 0 ? std::min(1.0, double(done) / double(total)) : 0;
  const double seconds = seconds_since(running.part_start);
  running.rate = seconds > 0 ? double(done) / seconds : 0;
  draw(/*at_once=*/false);
}

void Board::finish(int asset) {
  const std::scoped_lock lock(mutex_);
  running_.erase(asset);
  if (seconds_[std::size_t(asset)] < 0) return;
  finished_[std::size_t(asset)] = true;
  done_seconds_ += seconds_[std::size_t(asset)];
  draw(/*at_once=*/true);
}

void Board::say(const std::string& line, bool on_stdout) {
  const std::scoped_lock lock(mutex_);
  if (drawn_) print_stderr("\r\033[K");
  if (on_stdout) {
    print_stdout(line + "\n");
  } else {
    print_stderr(line + "\n");
  }
  draw(/*at_once=*/true);
}

std::string Board::line() const {
  const auto finished = std::count(finished_.begin(), finished_.end(), true);
  double done = done_seconds_;
  double all = 0;
  for (const double seconds : seconds_) all += std::max(seconds, 0.0);
  std::string text = fmt::format("{} of {}", finished, count_);
  for (const auto& [asset, running] : running_) {
    done += seconds_[std::size_t(asset)] * running.share;
    text += " | " + running.name;
    if (running.label.empty()) continue;
    text += fmt::format(" {} {:.0f} %", running.label, 100 * running.share);
    if (running.rate > 0) text += fmt::format(", {} {}/s", format_count(running.rate), running.unit);
  }
  const double elapsed = seconds_since(start_);
  if (done > 0.02 * all) text += fmt::format(" | {} left", format_duration(elapsed * (all - done) / done));
  return text;
}

void Board::draw(bool at_once) {
  if (!visible_) return;
  const Clock::time_point now = Clock::now();
  if (!at_once && now - last_drawn_ < std::chrono::milliseconds(200)) return;
  last_drawn_ = now;
  drawn_ = true;
  print_stderr("\r" + line().substr(0, terminal_width() - 1) + "\033[K");
}

}  // namespace ivory
