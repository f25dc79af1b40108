#include "tracer/render/lobes.h"

#include <algorithm>
#include <cmath>

#include "tracer/core/sampling.h"

namespace ivory {

namespace {

// Monte Carlo: directions uniform over the cap, one in each of rows x columns strata,
//   L = solid angle / n  sum f(w) cos V(w).
Rgb by_rays(const LitScene& lit, const Sphere& light, const LightCap& cap, const Surface& surface,
            const LobeReflectance& reflectance, std::span<const Sphere> near, const LobeParams& params,
            RandomStream& random) {
  const V3f& p = surface.p;
  const float light_power = power(light, p);
  // As square as the count allows; a prime is a row.
  int rows = int(std::sqrt(float(params.shadow_rays)));
  while (params.shadow_rays % rows != 0) --rows;
  const int columns = params.shadow_rays / rows;
  Rgb sum(0, 0, 0);
  for (int i = 0; i < params.shadow_rays; ++i) {
    const V2f u = random.next2();
    // Concentric map (Shirley & Chiu 1997): strata of the square stay compact on the disc, areas in proportion.
    const float a = 2 * (float(i % columns) + u.x) / float(columns) - 1;
    const float b = 2 * (float(i / columns) + u.y) / float(rows) - 1;
    const bool wide = std::abs(a) > std::abs(b);
    const float r = wide ? a : b;
    const float other = wide ? b : a;
    const float turn = r != 0 ? 0.25F * pi * other / r : 0.0F;
    const float x = r * (wide ? std::cos(turn) : std::sin(turn));
    const float y = r * (wide ? std::sin(turn) : std::cos(turn));
    // Lambert's equal-area map of the disc to the cap.
    const float versine = (x * x + y * y) * cap.height;
    const float stretch = std::sqrt(cap.height * (2 - versine));
    const V3f w = (cap.x * (x * stretch) + cap.y * (y * stretch) + cap.z * (1 - versine)).normalized();
    const Rgb f = eval(reflectance, w);
    const bool below = surface.ng.dot(w) <= 0;  // of the surface itself, where shading normals say otherwise
    if (is_black(f) || (below && params.shadows == LobeShadows::mesh)) continue;
    float visible = 1;
    if (params.shadows == LobeShadows::spheres) {
      const auto hides = [&](const Sphere& sphere) { return power(sphere, p) < light_power && meets(sphere, p, w); };
      if (std::any_of(near.begin(), near.end(), hides)) visible = 0;
    } else {
      Ray ray = spawn_ray(surface, w);
      // To the ball, short of it by more than its mesh stands out of it.
      const V3f d = light.center - ray.origin;
      const float along = d.dot(w);
      const float inside2 = light.radius_m * light.radius_m - (d - w * along).length2();
      ray.t_max = along - std::sqrt(std::max(inside2, 0.0F)) - 2e-3F * light.radius_m;
      if (lit.intersector.has_coverage()) ray.coverage_seed = random.next_u32();
      if (ray.t_max > 0) visible = lit.intersector.transmittance(ray);
    }
    sum += f * visible;
  }
  return sum * (solid_angle(cap) / float(params.shadow_rays));
}

}  // namespace

Rgb lobe_direct_light(const LobeScene& lobes, const LitScene& lit, const Surface& surface,
                      const LobeReflectance& reflectance, const LobeParams& params, RandomStream& random) {
  const bool by_products = params.shadows == LobeShadows::lobes || params.shadows == LobeShadows::none;
  const V3f& p = surface.p;
  Rgb sum(0, 0, 0);
  if (by_products) {
    static const SphereGroups nothing;
    const SphereGroups& occluders = params.shadows == LobeShadows::lobes ? lobes.occluders : nothing;
    const ReflectanceLobes reflectance_lobes = make_reflectance_lobes(lobes.table, reflectance);
    for (const SphereLight& source : lobes.lights) {
      const Sphere light{source.center, source.radius_m};
      sum += source.radiance_nits *
             lobe_light(lobes.table, light, occluders, p, reflectance.ns, reflectance_lobes, params);
    }
    return sum;
  }
  thread_local std::vector<Sphere> near;
  for (const SphereLight& source : lobes.lights) {
    const Sphere light{source.center, source.radius_m};
    if (!(power(light, p) > 0)) continue;
    // Below the horizon altogether.
    if ((light.center - p).dot(reflectance.ns) <= -light.radius_m) continue;
    const LightCap cap = make_light_cap(light, p);
    near.clear();
    if (params.shadows == LobeShadows::spheres) find_hiding(lobes.occluders, make_cone(cap, p), near);
    sum += source.radiance_nits * by_rays(lit, light, cap, surface, reflectance, near, params, random);
  }
  return sum;
}

Film render_lobes(const LobeScene& lobes, const LitScene& lit, const View& view, const RenderParams& render,
                  const LobeParams& params) {
  const Scene& scene = *lit.scene;
  return render_film(view, render, [&](const Ray& ray, RandomStream& random) {
    const std::optional<Hit> hit = lit.intersector.closest(ray);
    if (!hit) return Rgb(0, 0, 0);
    const Surface surface = make_surface(scene, ray, *hit);
    const V3f wo = -ray.direction;
    const LobeReflectance reflectance = make_lobe_reflectance(scene, *hit, surface, wo);
    return surface.emission + lobe_direct_light(lobes, lit, surface, reflectance, params, random);
  });
}

}  // namespace ivory
