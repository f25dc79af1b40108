// What ivory reads from `extras`, where glTF leaves room for applications.
#pragma once

#include "tracer/core/scene.h"
#include "tracer/gltf/document.h"

namespace ivory::gltf {

// materials[i].extras.ivory_lafortune: a list of {"k": [r, g, b], "c": [x, y, z], "exponent": e, "tinted": bool}.
std::vector<LafortuneLobe> read_lafortune(const Document& document, std::size_t material);

// nodes[i].extras.ivory_sphere_light: {"radius": metres, "radiance": [r, g, b] in nits}; of any node, at its origin,
// its radius scaled as the node scales volumes. Nothing where there is none.
std::optional<SphereLight> read_sphere_light(const Document& document, std::size_t node, const M44f& to_world);

// nodes[i].extras.ivory_occluder: the name of an FIV table, relative to the file. Empty where there is none.
std::string read_fiv_table(const Document& document, std::size_t node);

// nodes[i].extras.ivory_group: the group of the lights below it, for bakes that keep groups apart. Empty where there is
// none.
std::string read_light_group(const Document& document, std::size_t node);

}  // namespace ivory::gltf
