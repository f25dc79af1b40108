// A scene made ready to be traced: the surfaces that rays meet and the lights.
#pragma once

#include <memory>

#include "tracer/lights/lights.h"

namespace ivory {

struct LitScene {
  std::unique_ptr<const Scene> scene;  // never null; on the heap, so that the others may refer to it
  Intersector intersector;
  Lights lights;
};

// Builds the acceleration structure and the lights. Throws Error (naming the scene) where a light is not finite.
LitScene make_lit_scene(Scene scene, const IntersectorParams& params = {});

}  // namespace ivory
