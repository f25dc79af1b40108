// Numbers kept as IEEE halves: as half textures hold them.
#pragma once

namespace ivory {

// Rounded to half as OpenGL does it, to nearest even; beyond 65504 infinity.
float rounded_to_half(float x);

// The power of two by which `largest`, the greatest magnitude of what is to be kept in half floats, is divided so that
// it lies within [2^14, 2^15): no overflow, and eleven bits for all down to 2^-28 of it. 1 for 0.
float half_scale(float largest);

}  // namespace ivory
