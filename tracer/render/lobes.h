// Direct light of spherical lights by products of cosine lobes, with soft shadows from sphere sets; and its Monte
// Carlo twin, which differs in nothing but how the integral is done.
#pragma once

#include "tracer/bsdf/lobe_reflectance.h"
#include "tracer/core/lit_scene.h"
#include "tracer/render/render.h"

namespace ivory {

// Who casts shadows, and how the light is integrated.
enum class LobeShadows {
  lobes,    // sphere sets; masks and lobe products
  none,     // nothing; lobe products
  spheres,  // sphere sets; Monte Carlo, stratified over the light
  mesh,     // the scene's triangles; Monte Carlo, stratified over the light
};
template <>
inline constexpr auto name_table<LobeShadows> = make_name_table<LobeShadows>("shadows",
                                                                             {{LobeShadows::lobes, "lobes"},
                                                                              {LobeShadows::spheres, "spheres"},
                                                                              {LobeShadows::mesh, "mesh"},
                                                                              {LobeShadows::none, "none"}});

struct LobeParams : LobeLightParams {
  LobeShadows shadows = LobeShadows::lobes;
  int shadow_rays = 64;  // a light and sample, for spheres and mesh
};

struct LobeScene {
  LobeTable table;
  std::vector<SphereLight> lights;
  SphereGroups occluders;  // the sphere sets', placed, and the lights themselves
};

// Radiance in nits that `reflectance` sends on from the lights. Of the surface, only p, ng and reach_m are read;
// `random` serves the Monte Carlo twin alone. Lights that hold p inside give nothing; spheres that hold it cast no
// shadow there.
Rgb lobe_direct_light(const LobeScene& lobes, const LitScene& lit, const Surface& surface,
                      const LobeReflectance& reflectance, const LobeParams& params, RandomStream& random);

// Emission and direct light of the first surface seen. Throws as render_film() does.
Film render_lobes(const LobeScene& lobes, const LitScene& lit, const View& view, const RenderParams& render,
                  const LobeParams& params);

}  // namespace ivory
