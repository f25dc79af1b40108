// The one file that knows toml++, whose header takes long to compile.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <tuple>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "tools/batch/job/value.h"

namespace ivory {

namespace {

using File = std::shared_ptr<const std::string>;

JobPlace place_of(const toml::source_region& region, const File& file) {
  return {file, std::max(1, int(region.begin.line)), std::max(1, int(region.begin.column))};
}

JobValue value_of(const toml::node& node, const File& file);

JobTable table_of(const toml::table& table, const File& file) {
  JobTable entries;
  for (const auto& [key, node] : table)
    entries.push_back({std::string(key.str()), place_of(key.source(), file), value_of(node, file)});
  // toml++ sorts by name.
  std::stable_sort(entries.begin(), entries.end(), [](const JobEntry& a, const JobEntry& b) {
    return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
  });
  return entries;
}

JobValue value_of(const toml::node& node, const File& file) {
  JobValue value;
  value.place = place_of(node.source(), file);
  if (const toml::table* table = node.as_table()) {
    value.data = table_of(*table, file);
  } else if (const toml::array* array = node.as_array()) {
    JobArray values;
    for (const toml::node& element : *array) values.push_back(value_of(element, file));
    value.data = std::move(values);
  } else if (const auto* text = node.as_string()) {
    value.data = text->get();
  } else if (const auto* whole = node.as_integer()) {
    value.data = whole->get();
  } else if (const auto* number = node.as_floating_point()) {
    value.data = number->get();
  } else if (const auto* flag = node.as_boolean()) {
    value.data = flag->get();
  } else {
    throw JobError(value.place, "is a date or a time", "write a text, a number, true or false, a list or a table");
  }
  return value;
}

}  // namespace

JobTable read_toml(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error(path, "cannot be read", "check the name");
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) throw Error(path, "cannot be read", "check the name");
  const auto file = std::make_shared<const std::string>(path);
  try {
    return table_of(toml::parse(bytes, path), file);
  } catch (const toml::parse_error& error) {
    throw JobError(place_of(error.source(), file), std::string(error.description()),
                   "a job file is written in TOML (toml.io): [kind.name], key = value");
  }
}

}  // namespace ivory
