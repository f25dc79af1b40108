// The part of the glTF 2.0 schema that ivory reads, checked before anything else looks at the file.
// Private to the loader.
#pragma once

#include "tracer/gltf/document.h"

namespace ivory::gltf {

// Throws Error for a missing required property, a wrong type, a value out of its range, or an index
// that points nowhere. Whole numbers written as floats become integers. What ivory does not read
// (extras, unknown extensions) is not looked at, nor are animations.
void check_schema(Document& document);

// The same for animations, which most scenes are loaded without.
void check_animation_schema(Document& document);

// Throws Error for an unknown required extension; warns of optional ones that are ignored.
void check_extensions(Document& document);

}  // namespace ivory::gltf
