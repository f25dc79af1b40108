// The machine that figures were measured on.
#pragma once

#include <string>

namespace ivory {

struct Machine {
  std::string cpu;  // its name as the system gives it; "unknown" where it gives none
  int cores = 0;    // hardware threads that this process may use
  std::string isa;  // the widest vector instructions that it has: sse2, sse4.2, avx, avx2, avx512
};
Machine this_machine();

}  // namespace ivory
