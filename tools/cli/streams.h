// The standard streams, which may be closed, full or broken.
#pragma once

#include <string>

namespace ivory {

// To be called first of all. A file opened while one of the three is closed would take its number, and what is printed
// would end up in the file. Reading and writing still fail afterwards.
void keep_standard_streams();

// On stdout, at once. Throws Error where that fails.
void print_stdout(const std::string& text);

// On stderr, at once. Where that cannot be written to nobody listens, and the work goes on.
void print_stderr(const std::string& text);

}  // namespace ivory
