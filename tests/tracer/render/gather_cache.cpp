// The irradiance cache: derivatives of E against closed forms, records against what they must not reach, filled caches
// against furnaces and paths.
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/lit_scene.h"
#include "tracer/render/gather/fill.h"

namespace ivory {
namespace {

using Light = std::function<GatheredLight(const V3f&, RandomStream&)>;

Hemisphere gather(const V3f& normal, int split, const Light& light, std::uint64_t stream = 0) {
  RandomStream random(5, StreamPurpose::test, stream);
  return gather_hemisphere(normal, split, random, light);
}

// Means over seeds of a number found from a hemisphere.
template <typename Number>
Accumulator over_seeds(int count, int split, const Light& light, const Number& number) {
  Accumulator out;
  for (int i = 0; i < count; ++i)
    out.add(double(number(irradiance_of(gather({0, 1, 0}, split, light, std::uint64_t(i))))));
  return out;
}

TEST(GatherHemisphere, EvenLightHasNoDerivatives) {
  const V3f n = V3f(0.3F, 0.8F, -0.2F).normalized();
  const HemisphereIrradiance found = irradiance_of(gather(n, 2, [](const V3f&, RandomStream&) {
    return GatheredLight{{1, 2, 3}, 0.5F};
  }));
  for (int c = 0; c < 3; ++c) {
    const float e = pi * float(c + 1);
    EXPECT_NEAR(found.e[c], e, 1e-5F * e);
    EXPECT_LT((found.vector[c] - n * e).length(), 1e-5F * e);
    EXPECT_LT(found.gradient[c].length(), 1e-5F * e);
  }
  EXPECT_LT(found.bend, 1e-4F);
  EXPECT_NEAR(found.harmonic_distance_m, 2, 1e-5F);
}

// A wide ceiling at height h that shines with L0 + k x: E = pi (L0 + k x) below it, whose second derivatives are 0.
TEST(GatherHemisphere, GradientOfALinearField) {
  constexpr float h = 2;
  constexpr float l0 = 3;
  constexpr float k = 0.5F;
  const Light ceiling = [](const V3f& w, RandomStream&) {
    const float t = h / w.y;
    const float l = l0 + k * t * w.x;
    return GatheredLight{{l, l, l}, 1 / t};
  };
  const auto along_x = [](const HemisphereIrradiance& found) { return found.gradient[1].x; };
  const auto along_z = [](const HemisphereIrradiance& found) { return found.gradient[1].z; };
  // What 5 rings do to it was found as 8.5 %.
  EXPECT_NEAR(over_seeds(100, 4, ceiling, along_x).mean(), double(pi * k), 0.12 * double(pi * k));
  EXPECT_LT(std::abs(z_score(over_seeds(100, 4, ceiling, along_z), 0)), z_limit);
  const Accumulator e = over_seeds(100, 4, ceiling, [](const HemisphereIrradiance& found) { return found.e.y; });
  EXPECT_LT(std::abs(z_score(e, double(pi * l0))), z_limit);
}

// A square panel of half side a at height h: E by quadrature, and its derivatives by differences.
struct Panel {
  float a = 1, h = 1.5F;
  V3f from{0.7F, 0, 0.2F};

  GatheredLight seen(const V3f& w) const {
    const float t = h / w.y;
    const V3f at = from + w * t;
    const bool hit = std::abs(at.x) < a && std::abs(at.z) < a;
    return hit ? GatheredLight{{1, 1, 1}, 1 / t} : GatheredLight{};
  }
  double e(double x, double z) const {
    constexpr int n = 200;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const double dx = double(a) * (2 * (i + 0.5) / n - 1) - x;
        const double dz = double(a) * (2 * (j + 0.5) / n - 1) - z;
        const double r2 = dx * dx + dz * dz + double(h) * double(h);
        sum += double(h) * double(h) / (r2 * r2);
      }
    }
    return sum * 4 * double(a) * double(a) / (n * n);
  }
};

TEST(GatherHemisphere, DerivativesUnderAPanel) {
  const Panel panel;
  const Light light = [&](const V3f& w, RandomStream&) { return panel.seen(w); };
  const double x = double(panel.from.x);
  const double z = double(panel.from.z);
  constexpr double d = 0.02;
  const double gx = (panel.e(x + d, z) - panel.e(x - d, z)) / (2 * d);
  const double gz = (panel.e(x, z + d) - panel.e(x, z - d)) / (2 * d);
  const double e0 = panel.e(x, z);
  const double xx = (panel.e(x + d, z) - 2 * e0 + panel.e(x - d, z)) / (d * d);
  const double zz = (panel.e(x, z + d) - 2 * e0 + panel.e(x, z - d)) / (d * d);
  const double xz =
      (panel.e(x + d, z + d) - panel.e(x + d, z - d) - panel.e(x - d, z + d) + panel.e(x - d, z - d)) / (4 * d * d);
  const double bend = std::abs(xx + zz) / 2 + std::hypot((xx - zz) / 2, xz);
  const auto mean = [&](auto number) { return over_seeds(60, 4, light, number).mean(); };
  EXPECT_NEAR(mean([](const HemisphereIrradiance& f) { return f.e.x; }), e0, 0.01 * e0);
  // Edges of the panel do not follow the cells': a tenth of the whole gradient.
  const double g = std::hypot(gx, gz);
  EXPECT_NEAR(mean([](const HemisphereIrradiance& f) { return f.gradient[0].x; }), gx, 0.1 * g);
  EXPECT_NEAR(mean([](const HemisphereIrradiance& f) { return f.gradient[0].z; }), gz, 0.1 * g);
  // Only a measure of size is wanted of the second derivatives.
  const double found = mean([](const HemisphereIrradiance& f) { return f.bend; });
  EXPECT_GT(found, 0.6 * bend);
  EXPECT_LT(found, 1.8 * bend);
}

IrradianceRecord even_record(const Light& light, float most_radius_m = 1) {
  return make_record({0, 0, 0}, {0, 1, 0}, gather({0, 1, 0}, 4, light),
                     {.least_radius_m = 0.01F, .most_radius_m = most_radius_m});
}

// Light L from all around: what stays above both the surface and the turned normal's horizon gives pi L (1 + cos) / 2.
TEST(IrradianceRecord, TurnedNormalsInEvenLight) {
  const IrradianceRecord record = even_record([](const V3f&, RandomStream&) { return GatheredLight{{1, 1, 1}, 0.1F}; });
  for (const float angle : {0.0F, 0.2F, 0.4F}) {
    const Rgb e = irradiance(record, {0.1F, 0, 0.1F}, {std::sin(angle), std::cos(angle), 0});
    EXPECT_NEAR(e.x, pi * (1 + std::cos(angle)) / 2, 1e-4F);
  }
}

// A wall at x = 0.3: the record is used up to it, farther along it, and not beyond.
TEST(IrradianceRecord, EndsAtAWallOnTheSurface) {
  const IrradianceRecord record = even_record([](const V3f& w, RandomStream&) {
    return w.x > 0 ? GatheredLight{{1, 1, 1}, w.x / 0.3F} : GatheredLight{{1, 1, 1}, 0};
  });
  ASSERT_GT(record.radius_m, 0.4F);
  const V3f n(0, 1, 0);
  EXPECT_GT(weight(record, {0.2F, 0, 0}, n), 0);
  EXPECT_GT(weight(record, {0.1F, 0, 0.35F}, n), 0);
  EXPECT_GT(weight(record, {-0.35F, 0, 0}, n), 0);
  for (const float z : {-0.3F, 0.0F, 0.1F, 0.2F}) EXPECT_EQ(weight(record, {0.305F, 0, z}, n), 0) << z;
  EXPECT_EQ(weight(record, {-0.1F, 0, 0}, -n), 0);
  EXPECT_EQ(weight(record, {-0.1F, 0.2F, 0}, n), 0);  // a step higher
}

// Something that shines touches the surface: the gradient there is no more than the record's radius bears.
TEST(IrradianceRecord, ContactsDoNotShineAfar) {
  const IrradianceRecord record = even_record([](const V3f& w, RandomStream&) {
    return w.x > 0.5F ? GatheredLight{{1, 1, 1}, 1e6F} : GatheredLight{};
  });
  EXPECT_FLOAT_EQ(record.radius_m, 0.01F);
  for (const float x : {-0.01F, 0.01F}) EXPECT_LT(irradiance(record, {x, 0, 0}, {0, 1, 0}).x, 2 * record.e.x);
}

struct Picture {
  Film film;
  FilledCache filled;
};
Picture cached_picture(const LitScene& lit, const IndirectLight& indirect, const View& view, int threads,
                       int rays = 300) {
  GatherParams gather;
  gather.gather_rays = 1;
  gather.indirect_only = true;
  RenderParams render;
  render.samples = 16;
  render.threads = threads;
  FilledCache filled =
      fill_cache(lit, indirect, view, gather, {.rays = rays, .samples = 1024, .threads = threads, .progress = {}});
  gather.cache = &filled.cache;
  Film film = render_gather(lit, indirect, view, render, gather);
  return {std::move(film), std::move(filled)};
}

// Point light at the centre, albedo 1/2: E = 1 lux of indirect light everywhere, on facets that turn.
TEST(GatherCache, IntegratingSphere) {
  Scene scene;
  const int wall = add_lambert(scene, Rgb(0.5F, 0.5F, 0.5F));
  add_mesh(scene, make_inward_sphere(4, wall));
  scene.lights.emplace_back(PointLight{{0, 0, 0}, Rgb(1, 1, 1)});
  const LitScene lit = make_lit_scene(std::move(scene));
  const IndirectLight indirect = [](const Surface&) { return Rgb(1, 1, 1); };
  const Picture picture = cached_picture(lit, indirect, test_view(32, 24), 0);
  EXPECT_LT(picture.filled.cache.size(), 200U);
  EXPECT_EQ(picture.filled.uncovered, 0);
  // The facets of this sphere stand up to 0.3 % nearer than its corners, and turn by 3 degrees from one to the next.
  for (const Rgb& pixel : picture.film.pixels) EXPECT_NEAR(pixel.y, 0.5F / pi, 0.02F * 0.5F / pi);
}

TEST(GatherCache, SameBytesWhateverTheThreads) {
  const LitScene lit = make_lit_scene(small_room());
  const IndirectLight indirect = [](const Surface&) { return Rgb(1, 0.8F, 0.5F); };
  const Picture one = cached_picture(lit, indirect, test_view(40, 30), 1);
  const Picture two = cached_picture(lit, indirect, test_view(40, 30), 2);
  EXPECT_GT(one.filled.cache.size(), 10U);
  EXPECT_EQ(one.filled.cache.size(), two.filled.cache.size());
  EXPECT_TRUE(one.film.pixels == two.film.pixels);
}

TEST(GatherCache, AnEmptyCacheChangesNothing) {
  const LitScene lit = make_lit_scene(small_room());
  const IndirectLight indirect = [](const Surface&) { return Rgb(1, 1, 1); };
  GatherParams gather;
  gather.gather_rays = 2;
  RenderParams render;
  render.samples = 4;
  const View view = test_view(16, 12);
  const Film plain = render_gather(lit, indirect, view, render, gather);
  const IrradianceCache empty(lit.intersector.center(), lit.intersector.radius_m());
  gather.cache = &empty;
  EXPECT_TRUE(render_gather(lit, indirect, view, render, gather).pixels == plain.pixels);
}

// With stored light that is itself path-traced, one path a look-up, nothing but the cache may add bias. All diffuse.
TEST(GatherCache, AgreesWithPaths) {
  Scene scene = small_room();
  scene.materials[2] = scene.materials[0];
  const LitScene lit = make_lit_scene(std::move(scene));
  const IndirectLight indirect = [&lit](const Surface& surface) {
    const auto bits = [](float x) { return std::uint64_t(std::bit_cast<std::uint32_t>(x)); };
    RandomStream random(bits(surface.p.x) << 32U | bits(surface.p.y), StreamPurpose::test, bits(surface.p.z));
    Surface white = surface;
    white.diffuse_albedo = Rgb(1, 1, 1);
    white.emission = Rgb(0, 0, 0);
    return trace_scattered(lit, white, white.ns, {.indirect_only = true}, random) * pi;
  };
  const View view = test_view(32, 24);
  const Picture cached = cached_picture(lit, indirect, view, 0, 300);
  RenderParams render;
  render.samples = 128;
  const Film truth = render_path(lit, view, render, {.indirect_only = true});
  render.seed = 2;
  const Film again = render_path(lit, view, render, {.indirect_only = true});
  Accumulator mean;
  Accumulator differences;
  Accumulator squares;
  for (std::size_t i = 0; i < truth.pixels.size(); ++i) {
    mean.add(double(truth.pixels[i].y + again.pixels[i].y) / 2);
    const double off = double(cached.film.pixels[i].y) - double(truth.pixels[i].y);
    const double off_again = double(cached.film.pixels[i].y) - double(again.pixels[i].y);
    differences.add((off + off_again) / 2);
    // The noise of two truths is independent: what their products have in the mean is the cache's own error, squared.
    squares.add(off * off_again);
  }
  EXPECT_NEAR(differences.mean(), 0, 0.02 * mean.mean());
  // 300 rays a record, each with the noise of one path behind it.
  EXPECT_LT(squares.mean(), 0.06 * 0.06 * mean.mean() * mean.mean());
}

}  // namespace
}  // namespace ivory
