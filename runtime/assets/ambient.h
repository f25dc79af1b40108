// Where an object's indirect or environment light comes from. Each asset makes one of these of itself; programs may
// bring their own.
#pragma once

#include <functional>
#include <string>

#include "grid/base/types.h"
#include "runtime/gl/gl.h"

namespace ivory {

// A piece of fragment shader and what it reads.
//
// `shader` is GLSL that may hold #include and #define lines, and defines
//   vec3 ivory_ambient(vec3 p, vec3 ng, vec3 n)
//       irradiance E in lux at world position p (m) for the unit shading normal n; ng is the unit geometric normal, on
//       the same side
// or, where it defines the macro IVORY_AMBIENT_RADIANCE,
//   vec3 ivory_ambient_radiance(IvorySurface s)
//       radiance in nits that the surface reflects towards s.wo
// `bind` sets its uniforms and binds its textures from `first_unit` on; it returns the next free unit. What it refers
// to must outlive the drawing.
struct AmbientSource {
  std::string shader;
  std::function<int(gl::Program& program, int first_unit)> bind;
};

// Black.
AmbientSource no_ambient();
// The same E, in lux, everywhere and for all normals.
AmbientSource constant_ambient(const Rgb& e_lux);

}  // namespace ivory
