// Animations: nodes as they stand at a time. Private to the loader.
#pragma once

#include <string>

#include "tracer/gltf/document.h"

namespace ivory::gltf {

// Sets translation, rotation, scale and weights of the document's nodes to what the animation makes of them at time_s.
// `animation` is a name or an index; empty: the first. Before the first key and behind the last their values hold, with
// a warning where that is so of all channels. The document's hash becomes that of the pose. Throws ParameterError
// ("animation", "time") where the file has no such animation; Error for one that breaks the specification.
void apply_animation(Document& document, const std::string& animation, double time_s);

// Where the file has animations: that its nodes are taken as they are stored.
void warn_of_animations(Document& document);

}  // namespace ivory::gltf
