#include "tools/batch/job/options.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/batch/job/units.h"
#include "tools/cli/host.h"

namespace ivory {

namespace {

std::string command_name(const AssetKind& kind) { return fmt::format("{}", fmt::join(kind.command, " ")); }

// The first words of the option's own help: what is expected.
std::string meaning(const OptionFacts& option) {
  const std::string& text = option.description;
  const std::string first = text.substr(0, text.find_first_of("\n;:"));
  return type_of(option) + ": " + first;
}

std::string number_text(double value) { return fmt::format("{}", value); }

// A list as the option's form has it: "1,2,3", boxes with a colon between their corners.
std::string joined(const JobValue& value, const OptionFacts& option);

std::string scalar_text(const JobValue& value, const OptionFacts& option) {
  if (const std::string* text = value.text()) {
    if (text->empty())
      throw JobError(value.place, fmt::format("'{}' is an empty text", key_of_option(option.name)),
                     "write " + meaning(option));
    const auto bare = without_units(*text, type_of(option));
    if (bare) return *bare;
    throw JobError(value.place, fmt::format("'{}' is no value of '{}'", *text, key_of_option(option.name)),
                   fmt::format("write {}, with units of {}", meaning(option), units_for(type_of(option))));
  }
  if (const auto* whole = std::get_if<std::int64_t>(&value.data)) return fmt::format("{}", *whole);
  if (const auto* number = std::get_if<double>(&value.data)) return number_text(*number);
  if (value.array() != nullptr) return joined(value, option);
  throw JobError(value.place, fmt::format("'{}' is {}", key_of_option(option.name), kind_of(value)),
                 "write " + meaning(option));
}

std::string joined(const JobValue& value, const OptionFacts& option) {
  const JobArray& list = *value.array();
  if (list.empty())
    throw JobError(value.place, fmt::format("'{}' is an empty list", key_of_option(option.name)),
                   "write " + meaning(option));
  const bool nested = list.front().array() != nullptr;
  std::string text;
  for (const JobValue& element : list) {
    if (!text.empty()) text += nested ? ":" : ",";
    text += scalar_text(element, option);
  }
  return text;
}

// Numbers in a list are one value, "0,1,2"; lists of lists a box, or several values.
bool is_one_value(const JobArray& list, const OptionFacts& option) {
  if (!option.repeated) return true;
  return std::all_of(list.begin(), list.end(),
                     [](const JobValue& v) { return v.data.index() == 1 || v.data.index() == 2; });
}

// "--target-error" is "target_error" in a job file.
std::string as_keys(std::string message, const AssetKind& kind) {
  for (const OptionFacts& option : options_of(kind)) {
    if (option.by_place) continue;
    const std::string flag = "--" + option.name;
    for (std::size_t at = message.find(flag); at != std::string::npos; at = message.find(flag, at)) {
      const std::size_t end = at + flag.size();
      if (end < message.size() &&
          (message[end] == '-' || std::isalnum(static_cast<unsigned char>(message[end])) != 0)) {
        at = end;
        continue;
      }
      message.replace(at, flag.size(), key_of_option(option.name));
    }
  }
  return message;
}

// The message's first option; nullptr where it names none.
const JobOption* option_in(const JobAsset& asset, const std::string& message) {
  std::size_t first = std::string::npos;
  const JobOption* found = nullptr;
  for (const JobOption& option : asset.options) {
    const std::size_t at = message.find(option.by_place ? option.name : "--" + option.name);
    // Of two at one place the longer name is meant.
    if (at == std::string::npos || at > first || (at == first && option.name.size() < found->name.size())) continue;
    first = at;
    found = &option;
  }
  return found;
}

// What the command says of a name of a file to write is no usage error, but no input is needed to find it.
const JobOption* output_in(const JobAsset& asset, const std::string& message) {
  for (const JobOption& option : asset.options) {
    if (option.name != asset.kind->outputs.front()) continue;
    for (const std::string& file : option.values) {
      if (message.starts_with(file + ": ")) return &option;
    }
  }
  return nullptr;
}

// Nothing is printed while options are checked.
class SilentHost : public CommandHost {
 public:
  using CommandHost::CommandHost;
  void result(const nlohmann::ordered_json&, const std::string&) override {}
  void note(const std::string&) override {}
  void progress(const std::string&, const std::string&, std::uint64_t, std::uint64_t) override {}
};

}  // namespace

const std::vector<OptionFacts>& options_of(const AssetKind& kind) {
  static std::map<std::string, std::vector<OptionFacts>> known;
  auto found = known.find(kind.name);
  if (found == known.end()) found = known.emplace(kind.name, options_of(kind.command)).first;
  return found->second;
}

const OptionFacts* find_option(const AssetKind& kind, const std::string& name) {
  for (const OptionFacts& option : options_of(kind)) {
    if (option.name == name) return &option;
  }
  return nullptr;
}

std::string type_of(const OptionFacts& option) { return option.type_name.substr(0, option.type_name.find(':')); }

std::vector<JobOption> make_option(const AssetKind& kind, const JobEntry& entry) {
  const OptionFacts* facts = find_option(kind, option_of_key(entry.key));
  if (facts == nullptr || facts->name == "dry-run") {
    std::vector<std::string> keys;
    for (const OptionFacts& option : options_of(kind)) {
      if (option.name != "dry-run") keys.push_back(key_of_option(option.name));
    }
    throw JobError(entry.place, fmt::format("'{}' is no option of {}{}", entry.key, kind.name, like(entry.key, keys)),
                   fmt::format("options are those of 'ivory {} --help'", command_name(kind)));
  }
  JobOption option{facts->name, facts->by_place, facts->flag, {}, entry.value.place};
  if (facts->flag) {
    const bool* given = std::get_if<bool>(&entry.value.data);
    if (given == nullptr)
      throw JobError(entry.value.place, fmt::format("'{}' is {}", entry.key, kind_of(entry.value)),
                     "write true or false");
    if (!*given) return {};
    return {option};
  }
  const JobArray* list = entry.value.array();
  if (list != nullptr && !is_one_value(*list, *facts)) {
    for (const JobValue& element : *list) option.values.push_back(scalar_text(element, *facts));
  } else {
    option.values.push_back(scalar_text(entry.value, *facts));
  }
  return {option};
}

void check_options(const JobAsset& asset) {
  const AssetKind& kind = *asset.kind;
  for (const OptionFacts& option : options_of(kind)) {
    const auto given = std::find_if(asset.options.begin(), asset.options.end(),
                                    [&](const JobOption& other) { return other.name == option.name; });
    if (!option.required || given != asset.options.end()) continue;
    throw JobError(asset.place, fmt::format("[{}] lacks '{}'", asset.name, key_of_option(option.name)),
                   "give it " + meaning(option));
  }
  SilentHost host(kind.check ? CommandStage::check : CommandStage::parse);
  const ProgramEnd end = run_hosted(arguments_of(asset), host);
  const JobOption* option = end.exit_code == 2 ? option_in(asset, end.message) : output_in(asset, end.message);
  // What only its files will tell is for the run to say.
  if (end.exit_code == 0 || (end.exit_code != 2 && option == nullptr)) return;
  std::string message = end.message;
  const std::string help = "; --help explains";
  if (message.ends_with(help)) message.resize(message.size() - help.size());
  message = as_keys(message, kind);
  const JobPlace place = option != nullptr ? option->place : asset.place;
  const std::size_t stop = message.find("; ");
  if (stop != std::string::npos) throw JobError(place, message.substr(0, stop), message.substr(stop + 2));
  std::string expected = fmt::format("'ivory {} --help' explains it", command_name(kind));
  if (option != nullptr)
    expected = fmt::format("'{}' is {}", key_of_option(option->name), meaning(*find_option(kind, option->name)));
  throw JobError(place, message, expected);
}

}  // namespace ivory
