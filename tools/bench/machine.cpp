#include "tools/bench/machine.h"

#include <fstream>

#include <tbb/task_arena.h>

namespace ivory {

Machine this_machine() {
  Machine machine{"unknown", tbb::this_task_arena::max_concurrency(), "sse2"};
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) machine.cpu = line.substr(colon + 2);
    break;
  }
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) {
    machine.isa = "avx512";
  } else if (__builtin_cpu_supports("avx2")) {
    machine.isa = "avx2";
  } else if (__builtin_cpu_supports("avx")) {
    machine.isa = "avx";
  } else if (__builtin_cpu_supports("sse4.2")) {
    machine.isa = "sse4.2";
  }
#else
  machine.isa = "unknown";
#endif
  return machine;
}

}  // namespace ivory
