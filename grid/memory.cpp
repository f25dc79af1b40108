#include "grid/memory.h"

#include <cmath>

#include <unistd.h>

#include "grid/error.h"

namespace ivory {

void check_memory(const std::string& file, double bytes, const std::string& remedy) {
  const double memory = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGESIZE));
  if (bytes <= 0.75 * memory) return;
  throw Error(
      file, "needs " + std::to_string(std::llround(std::ceil(bytes / 0x1p30))) + " GiB of memory, more than can be had",
      remedy);
}

}  // namespace ivory
