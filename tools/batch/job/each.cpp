#include "tools/batch/job/each.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <fnmatch.h>
#include <glob.h>

#include "tools/batch/job/units.h"
#include "tools/cli/numbers.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

std::vector<std::string> files_like(const std::string& pattern) {
  glob_t found{};
  std::vector<std::string> files;
  if (::glob(pattern.c_str(), 0, nullptr, &found) == 0) {
    for (std::size_t i = 0; i < found.gl_pathc; ++i) files.emplace_back(found.gl_pathv[i]);
  }
  ::globfree(&found);
  return files;
}

std::vector<EachItem> each_file(const std::string& pattern, const JobPlace& place, const std::string& folder) {
  std::vector<EachItem> items;
  for (const std::string& path : files_like((fs::path(folder) / pattern).string())) {
    const std::string stem = fs::path(path).stem().string();
    // As it is written in that job file, which what takes it goes by.
    const std::string file = folder.empty() ? path : fs::path(path).lexically_relative(folder).string();
    items.push_back({stem, {{"file", {file, place}}, {"stem", {stem, place}}}});
  }
  if (items.empty())
    throw JobError(place, fmt::format("no file matches '{}'", pattern), "patterns are a shell's: props/*.glb");
  return items;
}

double margin_of(const JobEntry& entry) {
  if (const auto* whole = std::get_if<std::int64_t>(&entry.value.data)) return double(*whole);
  if (const auto* number = std::get_if<double>(&entry.value.data)) return *number;
  if (const std::string* text = entry.value.text()) {
    const auto bare = without_units(*text, "METRES");
    const auto value = bare ? parse_number(*bare) : std::nullopt;
    if (value) return *value;
  }
  throw JobError(entry.value.place, "'margin' is no length", "write metres, as 0.25 or \"25 cm\"");
}

std::vector<EachItem> each_node(const JobTable& table, const JobPlace& place,
                                const std::map<std::string, NamedScene>& scenes, const NodeReader& nodes) {
  const std::string expected = "each = { scene = \"NAME\", nodes = \"Room*\" }, with margin if you like";
  double margin_m = 0;
  for (const JobEntry& entry : table) {
    if (entry.key == "margin") {
      margin_m = margin_of(entry);
    } else if (entry.key != "scene" && entry.key != "nodes") {
      throw JobError(entry.place, fmt::format("'{}' says nothing of nodes", entry.key), "write " + expected);
    }
  }
  const JobEntry* scene = find_entry(table, "scene");
  const JobEntry* pattern = find_entry(table, "nodes");
  if (scene == nullptr || pattern == nullptr)
    throw JobError(place, fmt::format("'each' lacks '{}'", scene == nullptr ? "scene" : "nodes"), "write " + expected);
  const std::string name = text_of(*scene, expected);
  const std::string wanted = text_of(*pattern, expected);
  const auto known = scenes.find(name);
  if (known == scenes.end()) {
    std::vector<std::string> names;
    for (const auto& [other, unused] : scenes) names.push_back(other);
    throw JobError(scene->value.place, fmt::format("there is no [scene.{}]{}", name, like(name, names)),
                   "name one that the job has");
  }
  std::vector<EachItem> items;
  for (const NodeBox& node : nodes(known->second.path, known->second.load)) {
    if (!matches(wanted, node.name)) continue;
    const V3d low = node.bounds_m.min - V3d(margin_m, margin_m, margin_m);
    const V3d high = node.bounds_m.max + V3d(margin_m, margin_m, margin_m);
    const V3d middle = (low + high) / 2;
    const auto text = [](const V3d& p) { return fmt::format("{:.6g},{:.6g},{:.6g}", p.x, p.y, p.z); };
    items.push_back({node.name,
                     {{"node", {node.name, place}},
                      {"bounds", {text(low) + ":" + text(high), place}},
                      {"center", {text(middle), place}}}});
  }
  if (items.empty())
    throw JobError(pattern->value.place,
                   fmt::format("no node with triangles of {} matches '{}'", known->second.path, wanted),
                   "'ivory info' lists a scene; patterns are a shell's: Room*");
  return items;
}

std::vector<EachItem> each_word(const JobArray& words) {
  std::vector<EachItem> items;
  for (const JobValue& word : words) {
    const std::string* text = word.text();
    if (text == nullptr)
      throw JobError(word.place, fmt::format("'each' lists {}", kind_of(word)), "list texts: each = [\"a\", \"b\"]");
    items.push_back({*text, {{"each", word}}});
  }
  return items;
}

}  // namespace

bool matches(const std::string& pattern, const std::string& name) {
  return ::fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

bool is_pattern(const std::string& text) { return text.find_first_of("*?[") != std::string::npos; }

std::string plain_name(const std::string& text) {
  std::string name = text;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '-' && c != '.') c = '_';
  }
  return name.empty() ? "_" : name;
}

std::vector<EachItem> find_each(const JobEntry& entry, const std::string& folder,
                                const std::map<std::string, NamedScene>& scenes, const NodeReader& nodes) {
  std::vector<EachItem> items;
  if (const std::string* pattern = entry.value.text()) {
    items = each_file(*pattern, entry.value.place, folder);
  } else if (const JobTable* table = entry.value.table()) {
    items = each_node(*table, entry.value.place, scenes, nodes);
  } else if (const JobArray* words = entry.value.array(); words != nullptr && !words->empty()) {
    items = each_word(*words);
  } else {
    throw JobError(entry.value.place,
                   fmt::format("'each' is {}", words != nullptr ? "an empty list" : kind_of(entry.value)),
                   "write a pattern of files, { scene = ..., nodes = ... } or a list of texts");
  }
  std::set<std::string> names;
  for (std::size_t i = 0; i < items.size(); ++i) {
    EachItem& item = items[i];
    item.name = plain_name(item.name);
    if (!names.insert(item.name).second)
      throw JobError(entry.value.place, fmt::format("'each' finds two that are called '{}'", item.name),
                     "give them names of their own, or a pattern that takes one");
    item.variables["index"] = {std::int64_t(i), entry.value.place};
    item.variables["name"] = {item.name, entry.value.place};
  }
  return items;
}

}  // namespace ivory
