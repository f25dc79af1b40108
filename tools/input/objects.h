// Objects that a command places in a scene, or finds there: what moves, while the rest stays as it was baked.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/cli/common.h"
#include "tools/input/scene.h"
#include "tracer/core/scene.h"

namespace ivory {

// Adds to `scene` each object given as "FILE.glb", "FILE.glb@X,Y,Z" (moved there, in metres) or as the name of a
// node of the scene's own file, which takes all below it. Cameras and punctual lights of added files are left
// out, with a note. Returns for each of the scene's instances whether it belongs to one of the objects.
// Throws UsageError for names of no node, Error as load_gltf() does and for objects without triangles.
std::vector<bool> place_objects(Scene& scene, const std::vector<std::string>& objects, const SceneOptions& options,
                                const CommonOptions& common);

// For each of the scene's instances: does it belong to that node, or to one below it?
std::vector<bool> instances_below(const Scene& scene, int node);

// A model file and where it is to stand, as --object gives it.
struct ObjectFile {
  std::string path;
  V3d translation{0, 0, 0};
};
// "FILE.glb" or "FILE.glb@X,Y,Z"; nothing for other texts, which name a node. Throws UsageError for no such place.
std::optional<ObjectFile> parse_object(const std::string& text);

// What a node and all below it place, as a scene of their own, taken out of `scene`. Both keep the handles that they
// had; what neither of them shows any more is emptied. Throws UsageError where there is none of that name, or no mesh.
Scene take_node(Scene& scene, const std::string& name);

}  // namespace ivory
