// Typed reading of accessors: strided, normalised, sparse. Private to the loader.
#pragma once

#include "grid/base/types.h"
#include "tracer/gltf/document.h"

namespace ivory::gltf {

// Throws Error where any accessor reaches beyond its buffer view, or claims more than the file can
// back: after this, reading needs no further checks of ranges.
void check_accessors(Document& document);

// Some elements of an accessor.
struct Range {
  std::size_t first = 0;
  std::size_t count = std::size_t(-1);  // more than there are: all that follow
};

// Elements as floats, normalised integers divided as the specification says (glTF 2.0, 3.11).
// Throws Error where the accessor has another number of components, no data, or a value that is not
// finite. `what` names the user in messages.
std::vector<V2f> read_vec2(const Document& document, int accessor, const std::string& what, const Range& range = {});
std::vector<V3f> read_vec3(const Document& document, int accessor, const std::string& what, const Range& range = {});
std::vector<V4f> read_vec4(const Document& document, int accessor, const std::string& what, const Range& range = {});

// The same side by side, all elements, of 1, 3, 4 or 16 components (SCALAR, VEC3, VEC4, MAT4).
std::vector<float> read_floats(const Document& document, int accessor, int components, const std::string& what);

// Unsigned integers (8, 16 or 32 bits).
std::vector<std::uint32_t> read_indices(const Document& document, int accessor, const std::string& what);

}  // namespace ivory::gltf
