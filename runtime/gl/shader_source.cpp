#include "runtime/gl/shader_source.h"

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <set>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "runtime/gl/shader_table.h"

namespace ivory {

namespace {

std::string_view embedded(std::string_view name) {
  for (const EmbeddedShader& shader : embedded_shaders()) {
    if (shader.name == name) return shader.text;
  }
  throw Error("shaders/" + std::string(name), "no such shader in the library", "shader_names() lists them");
}

// The file that the line includes; empty where it is another line.
std::string_view included_file(std::string_view line) {
  constexpr std::string_view directive = "#include \"";
  if (!line.starts_with(directive)) return {};
  const std::string_view rest = line.substr(directive.size());
  return rest.substr(0, rest.find('"'));
}

constexpr std::string_view slot_begin = "#ivory_slot ";
constexpr std::string_view slot_end = "#ivory_end_slot";

bool is_name_start(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_name_part(char c) { return is_name_start(c) || (c >= '0' && c <= '9'); }

// Calls on_name() for each name outside of comments and on_rest() for what lies between.
template <typename OnName, typename OnRest>
void split_names(std::string_view text, const OnName& on_name, const OnRest& on_rest) {
  while (!text.empty()) {
    std::size_t length = 0;
    if (is_name_start(text.front())) {
      while (length < text.size() && is_name_part(text[length])) ++length;
      on_name(text.substr(0, length));
    } else {
      if (text.starts_with("//")) {
        length = std::min(text.find('\n'), text.size());
      } else if (is_name_part(text.front())) {
        while (length < text.size() && is_name_part(text[length])) ++length;  // 1e3 holds no name
      } else {
        length = 1;
      }
      on_rest(text.substr(0, length));
    }
    text.remove_prefix(length);
  }
}

using Names = std::set<std::string, std::less<>>;

// The lines of a slot, which ends before its own end line; `text` begins behind it then.
std::string_view take_slot(std::string_view& text) {
  int depth = 1;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    if (line.starts_with(slot_begin)) ++depth;
    if (line.starts_with(slot_end) && --depth == 0) {
      const std::string_view inner = text.substr(0, at);
      text.remove_prefix(std::min(end + 1, text.size()));
      return inner;
    }
    at = end + 1;
  }
  throw Error("shader", "has a line #ivory_slot without its #ivory_end_slot", "end the slot");
}

bool is_shared(std::string_view file) { return file.starts_with("renderer/") || file.starts_with("base/"); }

std::string in_slot(int slot, std::string_view inner, const std::set<std::string>& included);

// `file` is the source string's number, which compilers name beside the line (GLSL has no file names).
void append(std::string_view text, std::size_t file, std::set<std::string>& done, std::string& out) {
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    const std::string_view include = included_file(line);
    if (line.starts_with(slot_begin)) {
      const std::string_view inner = take_slot(text);
      out += in_slot(std::atoi(std::string(line.substr(slot_begin.size())).c_str()), inner, done);
      number += 1 + std::size_t(std::count(inner.begin(), inner.end(), '\n'));
      out += fmt::format("#line {} {}\n", number + 1, file);
    } else if (include.empty()) {
      out.append(line).push_back('\n');
    } else if (done.insert(std::string(include)).second) {
      const std::size_t inner = done.size();
      out += fmt::format("#line 1 {} // {}\n", inner, include);
      append(embedded(include), inner, done, out);
      out += fmt::format("#line {} {}\n", number + 1, file);
    } else {
      out.push_back('\n');
    }
  }
}

std::string in_slot(int slot, std::string_view inner, const std::set<std::string>& included) {
  std::set<std::string> done;
  Names kept;
  for (const std::string& file : included) {
    if (!is_shared(file)) continue;
    done.insert(file);
    split_names(
        embedded(file), [&](std::string_view name) { kept.emplace(name); }, [](std::string_view) {});
  }
  std::string text;
  append(inner, 0, done, text);
  std::string out;
  split_names(
      text, [&](std::string_view name) { out += kept.contains(name) ? std::string(name) : slot_name(slot, name); },
      [&](std::string_view rest) { out += rest; });
  return out;
}

}  // namespace

std::string slot_name(int slot, std::string_view name) {
  for (const std::string_view prefix : {"ivory_", "IVORY_", "Ivory"}) {
    if (!name.starts_with(prefix)) continue;
    return fmt::format("{}s{}_{}", prefix, slot, name.substr(prefix.size()));
  }
  return std::string(name);
}

std::string with_includes(std::string_view text) {
  std::set<std::string> done;
  std::string out;
  append(text, 0, done, out);
  return out;
}

std::string shader_source(std::string_view name) { return with_includes(fmt::format("#include \"{}\"\n", name)); }

std::vector<std::string> shader_names() {
  std::vector<std::string> names;
  for (const EmbeddedShader& shader : embedded_shaders()) names.emplace_back(shader.name);
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace ivory
