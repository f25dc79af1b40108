// Objects that a command places in a scene, or finds there: what moves, while the rest stays as it was baked.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "grid/base/placement.h"
#include "tools/cli/common.h"
#include "tools/input/scene.h"
#include "tracer/core/scene.h"

namespace ivory {

// How an object is to stand, in the world, from where its file has it: scaled and turned (grid/base/placement.h) about
// a point of its own, then moved. That point is the origin of a file, and of a node's first mesh.
struct ObjectPlace {
  V3d offset_m{0, 0, 0};
  V3f turn_deg{0, 0, 0};
  float scale = 1;
};
// "X,Y,Z", "X,Y,Z,RX,RY,RZ" or "X,Y,Z,RX,RY,RZ,SCALE": metres, degrees. Throws UsageError naming `option`.
ObjectPlace parse_place(std::string_view option, std::string_view text);

// What --place gives: OBJECT=PLACE.
struct NamedPlace {
  std::string object;  // node, or file without folders
  ObjectPlace place;
};
NamedPlace parse_named_place(const std::string& text);
// --place, may be repeated: texts for parse_named_place().
Option add_place_option(Command command, std::vector<std::string>& places);

// Adds to `scene` each object given as "FILE.glb", "FILE.glb@PLACE" or as the name of a node of the scene's own file,
// which takes all below it, and moves them as `places` say: a file's replaces that after its @. Cameras and punctual
// lights of added files are left out, with a note. Returns for each of the scene's instances whether it belongs to one
// of the objects. Throws UsageError for names of no node and places of no object, Error as load_gltf() does and for
// objects without triangles.
std::vector<bool> place_objects(Scene& scene, const std::vector<std::string>& objects,
                                const std::vector<NamedPlace>& places, const SceneOptions& options,
                                const CommonOptions& common);

// The point that the node of that name and all below it turn about: the origin of its first mesh. Throws UsageError as
// take_node() does.
V3f pivot_of_node(const Scene& scene, const std::string& name);
// The origin of an object's own file, local to its scene.
V3f pivot_of_file(const Scene& object);

// For each of the scene's instances: does it belong to that node, or to one below it?
std::vector<bool> instances_below(const Scene& scene, int node);

// A model file and where it is to stand, as --object gives it.
struct ObjectFile {
  std::string path;
  ObjectPlace place;
};
// "FILE.glb" or "FILE.glb@PLACE"; nothing for other texts, which name a node. Throws UsageError for no such place.
std::optional<ObjectFile> parse_object(const std::string& text);

// What a node and all below it place, as a scene of their own, taken out of `scene`. Both keep the handles that they
// had; what neither of them shows any more is emptied. Throws UsageError where there is none of that name, or no mesh.
Scene take_node(Scene& scene, const std::string& name);

}  // namespace ivory
