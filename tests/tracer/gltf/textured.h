// A textured glTF file to start from.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "grid/base/types.h"
#include "tests/support/gltf_builder.h"

namespace ivory {

// White, in a pixel: an image's "uri".
inline constexpr const char* white_pixel =
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4//8/"
    "AAX+Av4N70a4AAAAAElFTkSuQmCC";

// A triangle with uv in a textured material; `image` is what glTF says of the image.
inline GltfBuilder textured(const nlohmann::json& image, const char* slot = "baseColorTexture") {
  GltfBuilder builder;
  builder.root["images"] = nlohmann::json::array({image});
  builder.root["textures"] = {{{"source", 0}}};
  builder.root["materials"] = {{{"pbrMetallicRoughness", {{slot, {{"index", 0}}}}}}};
  const int p = builder.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const int t = builder.add(std::vector<V2f>{{0, 0}, {1, 0}, {0, 1}});
  builder.add_node(
      {{"mesh", builder.add_mesh({{"attributes", {{"POSITION", p}, {"TEXCOORD_0", t}}}, {"material", 0}})}});
  return builder;
}

}  // namespace ivory
