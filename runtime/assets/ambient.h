// Where an object's indirect or environment light comes from. Each asset makes one of these of itself; programs may
// bring their own.
#pragma once

#include <functional>
#include <span>
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

// Light adds up: a source that is the weighted sum of others, of any kinds, several of one kind too. All is composed
// into one shader, in which each has names of its own (gl/shader_source.h) and texture units after those of the one
// before. Its text depends on the kinds alone, so that the renderer compiles one program for each list of kinds;
// weights and assets may change from frame to frame. Sources of irradiance and of radiance may be mixed. Only names
// that begin with ivory_, IVORY_ or Ivory are kept apart: two sources of the program's own that declare the same other
// name do not compile in one list. OpenGL 3.3 promises 16 texture units, of which the renderer takes five.
struct WeightedSource {
  AmbientSource source;
  Rgb weight{1, 1, 1};  // factor on its light, per channel
};
// Copies the sources; what they refer to must outlive it. Black for none.
AmbientSource sum_of(std::span<const WeightedSource> sources);

// Black.
AmbientSource no_ambient();
// The same E, in lux, everywhere and for all normals.
AmbientSource constant_ambient(const Rgb& e_lux);

}  // namespace ivory
