// What a person sees of a batch while it runs: one line on a terminal for all that is being made, and the lines above
// it.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "tools/cli/common.h"

namespace ivory {

// Thread-safe.
class Board {
 public:
  // `seconds`: [asset] that each takes, about: what of all the work is done is weighed by it. Below 0: it is none of
  // the batch's.
  Board(const CommonOptions& common, std::vector<double> seconds);
  ~Board();  // as end()
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  void start(int asset, const std::string& name);
  // How far it is with one of its parts: "baking", "photons".
  void progress(int asset, const std::string& label, const std::string& unit, std::uint64_t done, std::uint64_t total);
  void finish(int asset);
  // A line that stays, above.
  void say(const std::string& line, bool on_stdout);
  // Wipes the line, for good.
  void end();

 private:
  struct Running {
    std::string name;
    std::string label;
    double share = 0;  // of its present part
    std::chrono::steady_clock::time_point part_start;
    double rate = 0;  // of its unit, a second
    std::string unit;
  };
  void draw(bool at_once);
  std::string line() const;

  bool visible_;
  std::vector<double> seconds_;
  std::vector<bool> finished_;
  std::ptrdiff_t count_;
  std::map<int, Running> running_;
  double done_seconds_ = 0;  // of the weights
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_drawn_;
  std::mutex mutex_;
};

}  // namespace ivory
