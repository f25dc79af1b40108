// The one exception of ivory, thrown where the outside world is met: files, options, memory.
#pragma once

#include <stdexcept>
#include <string>

namespace ivory {

// what() is the single line shown to the user: "<file>: <cause>; <remedy>".
class Error : public std::runtime_error {
 public:
  Error(const std::string& file, const std::string& cause, const std::string& remedy)
      : std::runtime_error(file + ": " + cause + "; " + remedy) {}
};

// A command line that asks for something impossible: exit code 2 instead of 1.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace ivory
