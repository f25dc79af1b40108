#include "tracer/render/fiv.h"

#include "tracer/bsdf/bsdf.h"
#include "tracer/core/surface.h"

namespace ivory {

Film render_fiv(const FivScene& scene, const LitScene& lit, const View& view, const RenderParams& render,
                const FivLightParams& params) {
  return render_film(view, render, [&](const Ray& ray, RandomStream&) {
    const std::optional<Hit> hit = lit.intersector.closest(ray);
    if (!hit) return lit.lights.environment_radiance(ray.direction);
    const Surface surface = make_surface(*lit.scene, ray, *hit);
    const int self = scene.occluder_of[std::size_t(hit->instance)];
    const Rgb e = fiv_irradiance(scene.occluders, surface.p * scene.from_world, surface.ns * scene.from_world, self,
                                 scene.unshadowed(surface.ns), params);
    return surface.emission + diffuse_reflectance(make_bsdf(surface), -ray.direction) * e * (1 / pi);
  });
}

}  // namespace ivory
