// A surface's reflectance made of cosine lobes: Lambert, the modified Phong model, Lafortune's.
#pragma once

#include "grid/lobes/light.h"
#include "tracer/core/surface.h"

namespace ivory {

static_assert(max_glossy_lobes >= max_lafortune_lobes);

// From the material at a hit. With material.lafortune those lobes and the diffuse albedo; otherwise modified Phong,
// f = kd/pi + ks (e + 2)/(2 pi) max(r.wi, 0)^e, ks the specular reflectance at normal incidence, kd the diffuse albedo
// times what ks leaves over.
LobeReflectance make_lobe_reflectance(const Scene& scene, const Hit& hit, const Surface& surface, const V3f& wo);

}  // namespace ivory
