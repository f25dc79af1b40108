#include "runtime/gl/shader_source.h"

#include <algorithm>
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

// `file` is the source string's number, which compilers name beside the line (GLSL has no file names).
void append(std::string_view text, std::size_t file, std::set<std::string>& done, std::string& out) {
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    const std::string_view include = included_file(line);
    if (include.empty()) {
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

}  // namespace

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
