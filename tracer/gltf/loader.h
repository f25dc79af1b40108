// glTF 2.0 and GLB to Scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tracer/core/scene.h"

namespace ivory {

// How a file is taken.
struct LoadParams {
  double scale = 1;  // metres a unit of the file: multiplies positions, not light (candela, lux and nits stay)
  std::optional<double> time_s = {};  // poses nodes, skins and morphs as the animation has them then; none: as stored
  std::string animation = {};         // its name, or its index; empty: the first
  std::vector<std::string> without =
      {};                         // names or indices of nodes: left out with all below, but for cameras and joints
  std::vector<int> uv_sets = {};  // TEXCOORD_n to read though no texture asks for them, of meshes that have them
};

struct LoadedScene {
  Scene scene;
  std::vector<std::string> warnings;  // one line each: what was ignored or mended, and where
  std::vector<std::string> files;     // that were read: the glTF file first, then buffers and images, by name
  // Of all cameras and punctual lights of the file that state them, in its units: nothing else reads them.
  std::vector<double> camera_near;
  std::vector<double> light_ranges;
};

// Loads the file's default scene (the first where it names none, all nodes where it has none).
//
// Throws Error naming the file, the cause and a remedy for anything that cannot be rendered right:
// malformed JSON or GLB, accessors out of their buffers, indices out of range, non-finite or
// impossible values, an unknown required extension, a node loop, a missing or damaged image that a
// material shows. Nothing is allocated on the word of the file alone. What can be left out, and what
// was mended, is a warning.
//
// Read: glTF 2.0 and GLB; triangle lists, strips and fans; sparse, normalised and quantized
// accessors; PNG, JPEG and WebP images; KHR_draco_mesh_compression, EXT_meshopt_compression,
// KHR_mesh_quantization, EXT_mesh_gpu_instancing, KHR_lights_punctual, KHR_materials_
// emissive_strength, _ior, _specular, _pbrSpecularGlossiness, _unlit (left out), _transmission (as
// straight-through coverage), KHR_texture_transform, EXT_texture_webp, KHR_node_visibility.
// Skins are placed by their joints, morphs by the weights of node or mesh, all as the file stores them or as `params`
// asks. Throws ParameterError ("time", "animation", "without") for an animation or nodes that the file lacks. Nodes
// that share a mesh share it in the Scene, but for those that pose it by morph weights of their own or by a skin.
// Points and lines are left out. Tangents are made from the uv derivatives where a normal map needs them and the file
// brings none.
LoadedScene load_gltf(const std::string& path, const LoadParams& params = {});

}  // namespace ivory
