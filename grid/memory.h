// How much may be asked of this machine.
#pragma once

#include <string>

namespace ivory {

// Throws Error(file, "... needs N GiB of memory, more than this machine has", remedy) for more than three
// quarters of it: to be asked before an allocation whose size a user or a file decides, because Linux
// promises memory that it does not have and ends the program when that is used.
void check_memory(const std::string& file, double bytes, const std::string& remedy);

}  // namespace ivory
