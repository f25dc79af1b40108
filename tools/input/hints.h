// Hints at what commonly goes wrong on a scene's way out of other programs: light in the wrong unit, lamps inside their
// own models, nothing that shines.
#pragma once

#include <string>
#include <vector>

#include "tracer/core/lit_scene.h"

namespace ivory {

// One line each, for people; none where nothing looks odd. They are guesses: the light is what the file says.
std::vector<std::string> hints(const LitScene& lit);

}  // namespace ivory
