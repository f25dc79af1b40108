// What a scene consists of, as hashes by which two loads of it are told apart: edits that light does not feel leave
// them as they are.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "grid/base/names.h"
#include "tracer/core/scene.h"

namespace ivory {

// shape: triangles where they stand, and where they let light through. look: what of materials scatters or absorbs,
// with the textures that it is read from, and the normals that it is shaded by. light: lights and what is emitted.
// camera. name: of nodes, their order, and the groups and tables that they name.
enum class ContentKind { shape, look, light, camera, name };
template <>
inline constexpr auto name_table<ContentKind> = make_name_table<ContentKind>("kind of content",
                                                                             {{ContentKind::shape, "shape"},
                                                                              {ContentKind::look, "look"},
                                                                              {ContentKind::light, "light"},
                                                                              {ContentKind::camera, "camera"},
                                                                              {ContentKind::name, "name"}});

struct ContentPart {
  ContentKind kind;
  std::string name;  // for people: "material 'red wall'"; alone among the parts of its kind
  std::uint64_t hash = 0;
};

// All parts of a scene, in its order. Each part is what it is by its numbers: a material has the same hash whatever its
// place in the file, its name, and the file format of its images. What no instance shows is left out. Environments are
// not part of it.
std::vector<ContentPart> content_parts(const Scene& scene);

// One hash of them all, in order, by what they are and not by what they are called.
std::uint64_t hash_of(std::span<const ContentPart> parts);

}  // namespace ivory
