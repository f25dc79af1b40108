// Dynamic objects lit by a localized cube map, in a scene that is rendered otherwise.
#pragma once

#include <vector>

#include "grid/cubemap/localized.h"
#include "tracer/render/final_gather.h"

namespace ivory {

struct CubeLight {
  const LocalizedCube* cube = nullptr;
  CubeMethod method = CubeMethod::polygon;
};

struct ObjectLightParams {
  std::vector<bool> is_object;      // for each of the scene's instances
  const GridLight* grid = nullptr;  // the background's indirect light; path-traced where null
  int max_specular_bounces = 16;    // between objects
};

// The objects' diffuse lobes reflect the cube map's irradiance at each point, unshadowed; both lobes reflect punctual
// lights with shadows; the specular lobe reflects what a traced ray meets. Everything else is path traced, or read from
// the grid, with the objects in place: they shadow and colour it. Throws as render_film() does.
Film render_with_cube(const LitScene& lit, const CubeLight& cube, const View& view, const RenderParams& render,
                      const ObjectLightParams& params);

}  // namespace ivory
