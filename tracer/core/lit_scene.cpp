#include "tracer/core/lit_scene.h"

namespace ivory {

LitScene make_lit_scene(Scene scene, const IntersectorParams& params) {
  auto kept = std::make_unique<const Scene>(std::move(scene));
  Intersector intersector(*kept, params);
  Lights lights(intersector);
  return {std::move(kept), std::move(intersector), std::move(lights)};
}

}  // namespace ivory
