#include "tracer/bake/checkpoint.h"

#include <algorithm>

#include <fmt/format.h>

#include "grid/base/error.h"

namespace ivory {

BakeStopped::BakeStopped(const std::string& path, std::uint64_t done, std::uint64_t total, const std::string& unit)
    : std::runtime_error(
          in_one_line(path.empty() ? fmt::format("stopped with {} of {} {} done, which are lost", done, total, unit)
                                   : fmt::format("stopped with {} of {} {} done; the same command goes on from {}",
                                                 done, total, unit, path))) {}

double CheckpointClock::end() {
  const double seconds = seconds_since(began_);
  wait_s_ = std::max(every_s_, seconds / most_share);
  last_ = Clock::now();
  return seconds;
}

}  // namespace ivory
