// The exceptions of ivory: Error where the outside world is met (files, memory), ParameterError for what callers ask.
#pragma once

#include <stdexcept>
#include <string>

namespace ivory {

// What files and libraries say may hold line ends and other control characters; each turns into a space.
inline std::string in_one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  return text;
}

// what() is the single line shown to the user: "<file>: <cause>; <remedy>".
class Error : public std::runtime_error {
 public:
  Error(const std::string& file, const std::string& cause, const std::string& remedy)
      : std::runtime_error(in_one_line(file + ": " + cause + "; " + remedy)) {}
};

// A parameter that is out of range, or does not go with the others or with what it is used on.
class ParameterError : public std::runtime_error {
 public:
  // what() is "<parameter>: <cause>", the parameter called as in its Params struct, without unit: "voxel_size".
  ParameterError(const std::string& parameter, const std::string& cause)
      : std::runtime_error(parameter + ": " + cause), parameter_(parameter), cause_(cause) {}
  const std::string& parameter() const { return parameter_; }
  const std::string& cause() const { return cause_; }

 private:
  std::string parameter_;
  std::string cause_;
};

}  // namespace ivory
