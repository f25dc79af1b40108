#include "tracer/render/object_light.h"

#include <algorithm>
#include <cmath>

#include "grid/cubemap/reader.h"
#include "tracer/render/path_tracer.h"

// At a point x of an object, seen from wo,
//
//   L = L_e + R_d(wo)/pi E_cube(x, ns)    all light that the map holds, by the diffuse lobe
//     + f cos I/r^2                       punctual lights, which no map can hold, by both lobes
//     + f_s cos/p L(y)                    the specular lobe: one ray, its hit y shaded by the same rules
//
// Emissive surfaces and the sky are in the map and in L(y), and so must not be sampled as lights as well.

namespace ivory {

namespace {

struct Renderer {
  const LitScene& lit;
  const CubeReader& cube;
  const ObjectLightParams& params;

  Rgb background(const Ray& ray, RandomStream& random) const {
    return params.grid != nullptr ? trace_gather(lit, *params.grid, ray, GatherParams{}, random)
                                  : trace_path(lit, ray, PathParams{}, random);
  }

  Rgb trace(const Ray& eye_ray, RandomStream& random) const {
    Rgb radiance(0, 0, 0);
    Rgb throughput(1, 1, 1);
    Ray ray = eye_ray;
    for (int bounce = 0; bounce <= params.max_specular_bounces; ++bounce) {
      const std::optional<Hit> hit = lit.intersector.closest(ray);
      if (!hit || !params.is_object[std::size_t(hit->instance)]) return radiance + throughput * background(ray, random);

      const Surface surface = make_surface(*lit.scene, ray, *hit);
      const Bsdf bsdf = make_bsdf(surface);
      const V3f wo = -ray.direction;
      Rgb here = surface.emission;
      // This strategy samples punctual lights only.
      here += sample_direct(lit, surface, bsdf, wo, DirectStrategy::bsdf, random);
      const Rgb reflectance = diffuse_reflectance(bsdf, wo);
      if (!is_black(reflectance)) here += reflectance / pi * irradiance(cube, surface.p, surface.ns);
      radiance += throughput * here;

      if (is_lambertian(bsdf)) break;
      const float u_lobe = random.next();
      const std::optional<BsdfSample> s = sample(bsdf, wo, u_lobe, random.next2(), Lobes::specular);
      if (!s) break;
      throughput *= s->throughput;
      // Weak reflections cost as much to trace as strong ones, which a survival of the root of their weight balances.
      const float survival = std::min(1.0F, std::sqrt(max_component(throughput)));
      if (!(random.next() < survival)) break;
      throughput /= survival;
      ray = spawn_ray(surface, s->wi, random.next_u32());
    }
    return radiance;
  }
};

}  // namespace

Film render_with_cube(const LitScene& lit, const CubeLight& cube, const View& view, const RenderParams& render,
                      const ObjectLightParams& params) {
  const CubeReader reader = make_cube_reader(*cube.cube, cube.method);
  const Renderer renderer{lit, reader, params};
  return render_film(view, render, [&](const Ray& ray, RandomStream& random) { return renderer.trace(ray, random); });
}

}  // namespace ivory
