// Unshadowed irradiance of an environment, from a baked asset or found at once.
#pragma once

#include <functional>
#include <string>

#include "tools/input/scene.h"

namespace ivory {

// E(n) in lux from `path`, a DifMap (.exr) or SH9 (.json), or, where that is empty, from a DifMap baked here of the
// scene's environment, which must be there. Throws Error as reading them does, and for assets of another environment.
std::function<Rgb(const V3f& n)> load_ambient(const std::string& path, const SceneInput& input,
                                              const CommonOptions& common);

}  // namespace ivory
