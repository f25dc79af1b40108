// Rendering by FIV tables: diffuse light of an environment, shadowed by moving occluders.
#pragma once

#include <functional>
#include <vector>

#include "grid/fiv/light.h"
#include "tracer/core/lit_scene.h"
#include "tracer/render/render.h"

namespace ivory {

struct FivScene {
  std::vector<FivPlacement> occluders;
  std::vector<int> occluder_of;                 // for each of the scene's instances: index of its occluder, or -1
  std::function<Rgb(const V3f& n)> unshadowed;  // E(n) of the environment in lux, n in the world
  // From the world to where the environment of the tables stood as they were baked, and where the occluders' places are
  // given: row vectors.
  M33f from_world;
};

// Every surface seen reflects E / pi by diffuse_reflectance() (tracer/bsdf/bsdf.h). Occluders shadow all others and
// themselves; nothing else casts shadows, and microfacet lobes are left out. Surfaces that emit and the environment
// behind are seen as they are. Needs no rays but the eye's. Throws as render_film() does.
Film render_fiv(const FivScene& scene, const LitScene& lit, const View& view, const RenderParams& render,
                const FivLightParams& params);

}  // namespace ivory
