// The command line, as the commands declare it: the part of CLI11 that they need, under CLI11's own names. CLI11's
// header costs about ten seconds a file to compile, so only options.cpp and main.cpp include it.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "grid/base/names.h"
#include "grid/base/types.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace ivory {

// An option or argument of a command; a handle that may be copied. All but given() answer the option itself.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option& required();
  Option& description(const std::string& text);
  Option& type_name(const std::string& name);    // what stands for its value in the help
  Option& group(const std::string& heading);     // of the help
  Option& default_str(const std::string& text);  // shown in place of the value itself
  Option& repeated();                            // may be given several times, one value each
  Option& one_of(const std::vector<std::string>& values);
  Option& within(double low, double high);  // a number from low to high; nan is none
  Option& positive();                       // a number above zero
  Option& needs(const Option& other);
  Option& excludes(const Option& other);

  bool given() const;  // on the command line; to be asked after it has been read

 private:
  CLI::Option* option_;
};

// A command, or the program itself; a handle that may be copied. Values that options are read into must outlive it;
// what they hold before is shown as the default, unless it is zero or empty.
class Command {
 public:
  explicit Command(CLI::App& app) : app_(&app) {}

  Command add_subcommand(const std::string& name, const std::string& description);
  void require_subcommand();
  void footer(const std::string& text);           // of the help
  void callback(std::function<void()> function);  // runs after the whole command line has been read and found right

  // "--name", "-n,--name", or "name" for an argument that goes by its place.
  Option add_option(const std::string& name, std::string& value, const std::string& description = {});
  Option add_option(const std::string& name, std::vector<std::string>& values, const std::string& description);
  Option add_option(const std::string& name, int& value, const std::string& description);
  Option add_option(const std::string& name, float& value, const std::string& description);
  Option add_option(const std::string& name, double& value, const std::string& description);
  Option add_option(const std::string& name, std::optional<float>& value, const std::string& description);
  // Text that `read` takes, once a value; what it throws ends the program.
  Option add_option(const std::string& name, std::function<void(const std::string& text)> read,
                    const std::string& description);
  // One of the enum's names.
  template <typename Enum>
  Option add_choice(const std::string& name, Enum& value, const std::string& description) {
    return add_option(
               name, [&value](const std::string& text) { value = from_name<Enum>(text); }, description)
        .one_of(names_of<Enum>())
        .default_str(std::string(name_of(value)));
  }
  Option add_flag(const std::string& name, bool& value, const std::string& description);
  Option add_flag(const std::string& name, std::function<void()> given, const std::string& description);

  // Options whose values go through the parsers of numbers.h.
  Option add_count(const std::string& name, std::uint64_t& value, const std::string& description);
  // A count from `least` to `most`.
  Option add_count(const std::string& name, int& value, int least, int most, const std::string& description);
  Option add_count(const std::string& name, int& value, int least, const std::string& description) {
    return add_count(name, value, least, std::numeric_limits<int>::max(), description);
  }
  Option add_image_size(const std::string& name, Imath::V2i& value, const std::string& description);

  Option get_option(const std::string& name) const;  // that was added before

 private:
  CLI::App* app_;
};

}  // namespace ivory
