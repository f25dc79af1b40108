#include "tools/export/web/three_package.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>

#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "grid/io/file.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

constexpr const char* remedy = "run 'npm install three@0.187.0', or name the package's folder by --three";

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::error_code error;
  if (!file || !fs::is_regular_file(path, error)) throw Error(path.string(), "cannot be read", remedy);
  return {std::istreambuf_iterator<char>(file), {}};
}

fs::path look_for_package() {
  std::error_code error;
  for (fs::path folder = fs::current_path(error); !folder.empty(); folder = folder.parent_path()) {
    const fs::path package = folder / "node_modules" / "three";
    if (fs::exists(package / "package.json", error)) return package;
    if (folder == folder.parent_path()) break;
  }
  throw Error("three.js", "is not in node_modules", remedy);
}

// Relative names that a module imports.
std::vector<std::string> imports_of(const std::string& text) {
  static const std::regex pattern(R"re((?:from|import)\s*['"](\.\.?/[^'"]+)['"])re");
  std::vector<std::string> names;
  for (auto at = std::sregex_iterator(text.begin(), text.end(), pattern); at != std::sregex_iterator(); ++at)
    names.push_back((*at)[1]);
  return names;
}

}  // namespace

ThreePackage find_three(const std::string& path) {
  const fs::path folder = path.empty() ? look_for_package() : fs::path(path);
  const auto json = nlohmann::json::parse(read_text(folder / "package.json"), nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || json.value("name", nlohmann::json()) != "three" || !json.contains("version") ||
      !json["version"].is_string())
    throw Error(folder.string(), "is not the npm package three", remedy);
  ThreePackage package{folder.string(), json["version"].get<std::string>()};
  std::error_code error;
  if (!fs::exists(folder / "examples/jsm/lighting/LightProbeGridWebGL.js", error))
    throw Error(package.folder, "is three.js " + package.version + ", which has no LightProbeGridWebGL", remedy);
  return package;
}

std::size_t copy_three(const ThreePackage& package, const std::vector<std::string>& modules, const std::string& to) {
  std::set<std::string> copied;
  std::vector<std::string> left = modules;
  left.emplace_back("LICENSE");
  std::size_t bytes = 0;
  while (!left.empty()) {
    const std::string name = left.back();
    left.pop_back();
    if (!copied.insert(name).second) continue;
    const std::string text = read_text(fs::path(package.folder) / name);
    const fs::path target = fs::path(to) / name;
    std::error_code error;
    fs::create_directories(target.parent_path(), error);
    write_file(target.string(), text, false);
    bytes += text.size();
    if (!name.ends_with(".js")) continue;
    for (const std::string& import : imports_of(text))
      left.push_back((fs::path(name).parent_path() / import).lexically_normal().generic_string());
  }
  return bytes;
}

}  // namespace ivory
