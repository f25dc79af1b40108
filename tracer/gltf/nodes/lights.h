// Punctual lights (KHR_lights_punctual). Private to the loader.
#pragma once

#include <optional>

#include "tracer/core/scene.h"
#include "tracer/gltf/document.h"

namespace ivory::gltf {

// The file's light of that index under its node's transform to the scene, metres; nothing, with a warning, for one that
// lights nothing or is of no known type. What exporters write beside the specification is mended with a warning.
std::optional<PunctualLight> read_light(Document& document, std::size_t index, std::size_t node,
                                        const Imath::M44d& to_scene);

}  // namespace ivory::gltf
