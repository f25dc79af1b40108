// The files of shaders/ as the build embeds them.
#pragma once

#include <string_view>
#include <vector>

namespace ivory {

struct EmbeddedShader {
  std::string_view name;
  std::string_view text;
};
// All of them, sorted by name; made by tools/cmake/EmbedShaders.cmake.
const std::vector<EmbeddedShader>& embedded_shaders();

}  // namespace ivory
