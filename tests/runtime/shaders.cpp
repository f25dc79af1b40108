// The shaders by the reference compiler, which allows nothing beyond GLSL 3.30; drivers allow more, each something
// else.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "runtime/assets/ambient.h"
#include "runtime/gl/shader_source.h"
#include "tests/support/paths.h"

namespace ivory {

namespace {

// Every file by itself, and every source of ambient light as ivory::Renderer puts it into its fragment shader.
std::vector<std::pair<std::string, std::string>> fragment_shaders() {
  std::vector<std::pair<std::string, std::string>> shaders;
  for (const std::string& name : shader_names()) {
    if (name == "renderer/surface_vertex.glsl") continue;
    const std::string include = "#include \"" + name + "\"\n";
    const bool whole = name == "renderer/surface_fragment.glsl" || name == "renderer/depth_fragment.glsl";
    // A fragment shader that uses nothing still needs its main().
    if (name != "renderer/surface_fragment.glsl")
      shaders.emplace_back(name, include + (whole ? "" : "void main() {}\n"));
    if (!name.starts_with("ambient/")) continue;
    std::vector<std::string> variants{""};
    if (name == "ambient/lobes.glsl") variants.emplace_back("#define IVORY_LOBES_GLOSSY\n");
    if (name == "ambient/fiv.glsl") {
      variants.emplace_back("#define IVORY_FIV_TURNS\n#define IVORY_FIV_SELF\n");
      for (const char* overlap : {"0", "1", "2", "3"})
        variants.push_back("#define IVORY_FIV_OVERLAP " + std::string(overlap) + "\n");
    }
    for (const std::string& variant : variants) {
      shaders.emplace_back("renderer with " + name + " " + variant,
                           "#include \"renderer/punctual_lights.glsl\"\n" + variant + include +
                               "#include \"renderer/surface_fragment.glsl\"\n");
    }
  }
  // All sources, each twice, in one sum.
  std::vector<WeightedSource> sum;
  for (const std::string& name : shader_names()) {
    if (!name.starts_with("ambient/")) continue;
    sum.push_back({{"#include \"" + name + "\"\n", {}}});
    sum.push_back(
        {{(name == "ambient/lobes.glsl" ? "#define IVORY_LOBES_GLOSSY\n" : "") + sum.back().source.shader, {}}});
  }
  shaders.emplace_back("renderer with a sum", "#include \"renderer/punctual_lights.glsl\"\n" + sum_of(sum).shader +
                                                  "#include \"renderer/surface_fragment.glsl\"\n");
  return shaders;
}

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  char buffer[4096];
  for (std::size_t n = 0; pipe != nullptr && (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, n);
  if (pipe != nullptr) pclose(pipe);
  return text;
}

TEST(RuntimeShaders, AreStrictGlsl330) {
  if (std::system("command -v glslangValidator >/dev/null") != 0)
    GTEST_SKIP() << "needs glslangValidator (Debian package glslang-tools)";
  const std::filesystem::path folder = std::filesystem::path(output_folder) / "shaders";
  std::filesystem::create_directories(folder);
  const auto check = [&](const std::string& what, const std::string& source, const char* extension) {
    const std::string path = (folder / (std::string("shader.") + extension)).string();
    std::ofstream(path) << "#version 330 core\n" << with_includes(source);
    const std::string output = output_of("glslangValidator " + path);
    EXPECT_EQ(output.find("ERROR"), std::string::npos) << what << "\n" << output;
  };
  int with_ambient = 0;
  for (const auto& [what, source] : fragment_shaders()) {
    check(what, source, "frag");
    with_ambient += int(what.starts_with("renderer with"));
  }
  EXPECT_GE(with_ambient, 12);  // seven sources, some in several variants
  check("renderer/surface_vertex.glsl", "#include \"renderer/surface_vertex.glsl\"\n", "vert");
  // It does find what drivers let pass.
  std::ofstream(folder / "wrong.frag") << "#version 330 core\n#define F \\\n  1\nvoid main() {}\n";
  EXPECT_NE(output_of("glslangValidator " + (folder / "wrong.frag").string()).find("ERROR"), std::string::npos);
}

}  // namespace

}  // namespace ivory
