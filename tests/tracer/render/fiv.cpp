// Pictures by FIV tables, and the few directions that pilot bakes take.
#include "tracer/render/fiv.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"
#include "tools/stability/fiv_shapes.h"
#include "tracer/bake/fiv/directions.h"
#include "tracer/bsdf/bsdf.h"
#include "tracer/core/surface.h"

namespace ivory {
namespace {

// A floor of glTF's default dielectric under light that gives E lux everywhere: what it sends out is E / pi times the
// diffuse lobe's albedo, which is measured here by that lobe's samples, as the path tracer takes them.
TEST(FivRender, ReflectsByTheDiffuseLobeOfTheMaterial) {
  Scene scene;
  Material paint;
  paint.base_color = Rgb(0.8F, 0.5F, 0.2F);
  paint.metallic = 0;
  paint.roughness = 0.5F;
  scene.materials.push_back(paint);
  add_mesh(scene, make_quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, 0));
  const LitScene lit = make_lit_scene(std::move(scene));
  FivScene fiv;
  fiv.occluder_of = {-1};
  fiv.unshadowed = [](const V3f&) { return Rgb(2, 2, 2); };
  for (const float slope : {0.1F, 0.5F, 2.0F}) {
    View view;
    view.origin = V3f(0, 1, 0);
    view.forward = V3f(0, -slope, -1).normalized();
    view.right = V3f(1e-5F, 0, 0);
    view.up = V3f(0, 1e-5F, 0);
    RenderParams params;
    params.samples = 1;
    const Rgb seen = render_fiv(fiv, lit, view, params, {}).pixels.front();

    const Ray ray = make_ray(view, V2f(0.5F, 0.5F));
    const Bsdf bsdf = make_bsdf(make_surface(*lit.scene, ray, *lit.intersector.closest(ray)));
    RandomStream random(1, StreamPurpose::test, 0);
    Accumulator albedo;
    for (int i = 0; i < 20000; ++i) {
      const float u = random.next();
      const V2f at(random.next(), random.next());
      const auto s = sample(bsdf, -ray.direction, u, at, Lobes::diffuse);
      albedo.add(s ? double(s->throughput.x) : 0);
    }
    const double expected = 2 / double(pi) * albedo.mean();
    // What rounding makes of it.
    EXPECT_LT(std::abs(double(seen.x) - expected), 2 / double(pi) * (z_limit * albedo.standard_error() + 1e-4))
        << slope;
    EXPECT_LT(double(seen.x), 0.97 * 2 / double(pi) * 0.8) << slope;
    EXPECT_NEAR(seen.y / seen.x, 0.625F, 1e-5F);
  }
}

TEST(FivPilot, TakesFewDirectionsOfAnyEnvironment) {
  const FivMoments truth = total_moments(make_fiv_directions(coloured_cube(256)));
  for (const int size : {1, 7, 16, 17, 33, 251, 264}) {
    const FivDirections pilot = make_fiv_pilot_directions(coloured_cube(size), 16);
    EXPECT_EQ(pilot.w.size(), std::size_t(6 * std::min(size * size, 16 * 16))) << size;
    if (size < 16) continue;
    // The same light, to what 16 texels a face know of it.
    const FivMoments found = total_moments(pilot);
    double difference = 0;
    double norm = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      difference += std::pow(double(truth[i]) - double(found[i]), 2);
      norm += std::pow(double(truth[i]), 2);
    }
    EXPECT_LT(std::sqrt(difference / norm), 0.01) << size;
  }
}

}  // namespace
}  // namespace ivory
