// Time by the processor's own account, so that other work on the machine counts as little as can be.
#pragma once

#include <chrono>

#include <time.h>

namespace ivory {

struct BenchTime {
  double wall_s = 0;
  double cpu_s = 0;  // of all of the process's threads together
};

template <typename Work>
BenchTime time_of(const Work& work) {
  const auto cpu_s = [] {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
  };
  const auto wall = std::chrono::steady_clock::now();
  const double cpu = cpu_s();
  work();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count(), cpu_s() - cpu};
}

}  // namespace ivory
