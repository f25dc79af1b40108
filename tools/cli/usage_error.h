#pragma once

#include <stdexcept>

namespace ivory {

// A command line that asks for something impossible: exit code 2 instead of 1.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace ivory
