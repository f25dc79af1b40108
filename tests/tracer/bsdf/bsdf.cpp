// The BSDF against what must hold for any: reciprocity, sampling in proportion to its pdf, energy;
// and against closed forms where the model has one.
#include "tracer/bsdf/bsdf.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"
#include "tracer/core/sampler.h"
#include "tracer/core/sampling.h"

namespace ivory {
namespace {

struct Case {
  const char* name;
  Rgb albedo;
  Rgb f0;
  Rgb f90;
  float alpha;
};

Bsdf make(const Case& c, const V3f& ns = V3f(0, 0, 1), const V3f& ng = V3f(0, 0, 1)) {
  Surface surface;
  surface.ns = ns;
  surface.ng = ng;
  surface.diffuse_albedo = c.albedo;
  surface.specular_f0 = c.f0;
  surface.specular_f90 = c.f90;
  surface.roughness_alpha = c.alpha;
  return make_bsdf(surface);
}

const std::vector<Case> cases{
    {"lambert", {0.8F, 0.5F, 0.2F}, {0, 0, 0}, {0, 0, 0}, 1},
    {"rough plastic", {0.8F, 0.5F, 0.2F}, {0.04F, 0.04F, 0.04F}, {1, 1, 1}, 0.36F},
    {"glossy plastic", {0.1F, 0.1F, 0.6F}, {0.04F, 0.04F, 0.04F}, {1, 1, 1}, 0.04F},
    {"half specular", {0.7F, 0.7F, 0.7F}, {0.02F, 0.02F, 0.02F}, {0.5F, 0.5F, 0.5F}, 0.25F},
    {"gold", {0, 0, 0}, {1, 0.77F, 0.34F}, {1, 1, 1}, 0.2F},
    {"rough silver", {0, 0, 0}, {0.95F, 0.93F, 0.88F}, {1, 1, 1}, 1},
    {"mirror", {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, 0},
};

V3f at_angle(float cosine, float azimuth_turns = 0.1F) { return direction_at_cosine(cosine, azimuth_turns); }

TEST(Bsdf, IsReciprocal) {
  RandomStream random(1, StreamPurpose::test, 0);
  for (const Case& c : cases) {
    const Bsdf bsdf = make(c);
    for (int i = 0; i < 1000; ++i) {
      V3f a = sample_cosine_hemisphere(random.next2());
      V3f b = sample_cosine_hemisphere(random.next2());
      // Narrow lobes are only met near the mirror direction.
      if (c.alpha < 0.1F) b = V3f(-a.x + 0.02F * b.x, -a.y + 0.02F * b.y, a.z).normalized();
      if (a.z < 1e-3F || b.z < 1e-3F) continue;
      const Rgb ab = eval(bsdf, a, b) / b.z;
      const Rgb ba = eval(bsdf, b, a) / a.z;
      for (int channel = 0; channel < 3; ++channel) {
        // Rounding: the two half vectors are the same floats, the cosines are divided out again.
        ASSERT_NEAR(ab[channel], ba[channel], 1e-5F * std::abs(ab[channel]) + 1e-12F) << c.name;
      }
    }
  }
}

TEST(Bsdf, WithoutFresnelIsLambertToTheLastBit) {
  const Rgb albedo(0.8F, 0.5F, 0.2F);
  const Bsdf bsdf = make({"", albedo, {0, 0, 0}, {0, 0, 0}, 0.3F});
  RandomStream random(2, StreamPurpose::test, 0);
  for (int i = 0; i < 1000; ++i) {
    const V3f wo = sample_cosine_hemisphere(random.next2());
    const auto s = sample(bsdf, wo, random.next(), random.next2());
    ASSERT_TRUE(s);
    EXPECT_EQ(s->throughput, albedo);
    EXPECT_FLOAT_EQ(s->pdf_solid_angle, pdf(bsdf, wo, s->wi));
    EXPECT_FLOAT_EQ(eval(bsdf, wo, s->wi).x, albedo.x * s->wi.z / pi);
  }
  EXPECT_EQ(diffuse_reflectance(bsdf, at_angle(0.3F)), albedo);
}

// Directions that sample() returns, counted in cells of equal projected area, against pdf() integrated
// over the cells by quadrature; samples lost below the surface make the rest.
void expect_sampling_matches_pdf(const Bsdf& bsdf, const V3f& wo, Lobes lobes, const std::string& label) {
  constexpr int rings = 24;
  constexpr int sectors = 24;
  constexpr int samples = 200000;
  std::vector<double> counts(rings * sectors + 1, 0);
  std::vector<double> expected(rings * sectors + 1, 0);
  RandomStream random(3, StreamPurpose::test, 0);
  for (int i = 0; i < samples; ++i) {
    const auto s = sample(bsdf, wo, random.next(), random.next2(), lobes);
    if (!s) {
      counts.back() += 1;
      continue;
    }
    ASSERT_TRUE(std::isfinite(s->throughput.x) && s->throughput.x >= 0);
    const double turn = std::atan2(double(s->wi.y), double(s->wi.x)) / (2 * double(pi));
    const int sector = std::min(sectors - 1, int((turn < 0 ? turn + 1 : turn) * sectors));
    const int ring = std::min(rings - 1, int((1 - double(s->wi.z)) * rings));
    counts[std::size_t(ring * sectors + sector)] += 1;
  }
  constexpr int fine = 24;
  double total = 0;
  for (int ring = 0; ring < rings; ++ring) {
    for (int sector = 0; sector < sectors; ++sector) {
      double sum = 0;
      for (int i = 0; i < fine; ++i) {
        for (int j = 0; j < fine; ++j) {
          const float cosine = 1 - (float(ring) + (float(i) + 0.5F) / fine) / rings;
          const float turn = (float(sector) + (float(j) + 0.5F) / fine) / sectors;
          sum += double(pdf(bsdf, wo, direction_at_cosine(cosine, turn), lobes));
        }
      }
      const double mass = sum * 2 * double(pi) / (double(rings) * sectors * fine * fine);
      expected[std::size_t(ring * sectors + sector)] = mass * samples;
      total += mass;
    }
  }
  // Quadrature error of the sharpest lobe tried here is below 1e-4.
  EXPECT_LT(total, 1 + 1e-3) << label;
  expected.back() = std::max(0.0, 1 - total) * samples;
  // One-sided: false alarm once in 31,000.
  EXPECT_LT(chi_square_score(counts, expected), 4.0) << label;
}

TEST(Bsdf, SamplesInProportionToItsPdf) {
  for (const Case& c : cases) {
    if (c.alpha < 0.1F) continue;  // too narrow for the cells; throughput of those is tested below
    for (const float cosine : {0.95F, 0.5F, 0.1F}) {
      for (const Lobes lobes : {Lobes::all, Lobes::diffuse, Lobes::specular}) {
        if (lobes == Lobes::specular && c.f0 == Rgb(0, 0, 0)) continue;
        const std::string label = std::string(c.name) + " at cosine " + std::to_string(cosine);
        expect_sampling_matches_pdf(make(c), at_angle(cosine), lobes, label);
      }
    }
  }
}

TEST(Bsdf, SamplesInProportionToItsPdfWithTiltedShadingNormal) {
  const V3f tilted = V3f(0.5F, 0.2F, 0.8F).normalized();
  // ng is +z, so the cells above cover all that may be sampled.
  expect_sampling_matches_pdf(make(cases[1], tilted), at_angle(0.6F), Lobes::all, "tilted");
}

// Mean of throughput (importance sampling) against mean of f cos over uniform directions.
TEST(Bsdf, ThroughputTimesPdfIsTheModel) {
  for (const Case& c : cases) {
    if (c.alpha < 0.03F) continue;  // uniform directions would never find the lobe
    const Bsdf bsdf = make(c);
    const V3f wo = at_angle(0.5F);
    RandomStream random(4, StreamPurpose::test, 0);
    for (const Lobes lobes : {Lobes::all, Lobes::diffuse, Lobes::specular}) {
      Accumulator sampled;
      Accumulator uniform;
      for (int i = 0; i < 200000; ++i) {
        const auto s = sample(bsdf, wo, random.next(), random.next2(), lobes);
        sampled.add(s ? double(s->throughput.x) : 0.0);
        const V2f u = random.next2();
        uniform.add(double(eval(bsdf, wo, direction_at_cosine(1 - u.x, u.y), lobes).x * 2 * pi));
      }
      EXPECT_LT(std::abs(z_score(sampled, uniform)), z_limit) << c.name;
    }
  }
}

// Reflected share of light arriving from wo, one estimate.
double reflected(const Bsdf& bsdf, const V3f& wo, Lobes lobes, RandomStream& random) {
  const auto s = sample(bsdf, wo, random.next(), random.next2(), lobes);
  return s ? double(s->throughput.x) : 0.0;
}

TEST(Bsdf, NoLobeReflectsMoreThanArrives) {
  RandomStream random(5, StreamPurpose::test, 0);
  for (Case c : cases) {
    if (c.albedo.x > 0) c.albedo = Rgb(1, 1, 1);
    for (const Lobes lobes : {Lobes::diffuse, Lobes::specular}) {
      for (const float cosine : {1.0F, 0.5F, 0.05F, 0.001F}) {
        Accumulator reflectance;
        for (int i = 0; i < 50000; ++i) reflectance.add(reflected(make(c), at_angle(cosine), lobes, random));
        EXPECT_LT(reflectance.mean(), 1.0 + 4 * reflectance.standard_error() + 1e-5) << c.name << " " << cosine;
      }
    }
  }
}

TEST(Bsdf, MirrorReflectsEverythingInTheMirrorDirection) {
  const Bsdf bsdf = make(cases.back());
  const V3f wo = at_angle(0.7F);
  RandomStream random(6, StreamPurpose::test, 0);
  for (int i = 0; i < 1000; ++i) {
    const auto s = sample(bsdf, wo, random.next(), random.next2());
    ASSERT_TRUE(s);
    // alpha is clamped to 1e-3: masking takes next to nothing, and GGX's long tail holds 1 - 1e-4 of the
    // lobe within 100 alpha of its centre.
    EXPECT_NEAR(s->throughput.x, 1.0F, 1e-3F);
    EXPECT_GT(s->wi.dot(V3f(-wo.x, -wo.y, wo.z)), 0.9F);
  }
}

// The closed form against quadrature of the lobe.
TEST(Bsdf, DiffuseReflectanceIsTheLobesIntegral) {
  RandomStream random(7, StreamPurpose::test, 0);
  for (const Case& c : cases) {
    if (c.albedo.x == 0) continue;
    const Bsdf bsdf = make(c);
    for (const float cosine : {1.0F, 0.71F, 0.33F, 0.1F, 0.01F}) {
      // Reference by quadrature in the measure cos/pi.
      double sum = 0;
      constexpr int steps = 400;
      const V3f wo = at_angle(cosine, 0.0F);
      for (int i = 0; i < steps; ++i) {
        const float cos_i = std::sqrt((float(i) + 0.5F) / steps);
        for (int j = 0; j < steps; ++j) {
          const V3f wi = direction_at_cosine(cos_i, (float(j) + 0.5F) / steps);
          sum += double(eval(bsdf, wo, wi, Lobes::diffuse).x * pi / wi.z);
        }
      }
      // Both are polynomials in the cosine; the mid-point rule is good to 1e-5, floats to as much.
      EXPECT_NEAR(diffuse_reflectance(bsdf, wo).x, sum / (steps * steps), 1e-4 * double(c.albedo.x))
          << c.name << " " << cosine;
    }
  }
}

// Across the horizon of the facet, where it was cut off, light bent normals promise fades without a step; nowhere is
// there more of it than without, and photons are dimmed by the side that they come from.
TEST(Bsdf, DiffuseLightFadesAtTheFacetsHorizon) {
  const V3f ns = V3f(0.5F, 0, 0.8F).normalized();
  const Bsdf bent = make(cases[0], ns);
  const Bsdf flat = make(cases[0], ns, ns);
  const V3f wo = at_angle(0.9F);
  const auto share = [&](float cosine, LightFrom light) {
    const V3f w(std::sqrt(1 - cosine * cosine), 0, cosine);
    const Rgb value = light == LightFrom::wi ? eval(bent, wo, w) : eval(bent, w, wo, Lobes::all, light);
    return value.x / (light == LightFrom::wi ? eval(flat, wo, w) : eval(flat, w, wo)).x;
  };
  float last = 0;
  for (int i = 1; i <= 100; ++i) {
    const float cosine = float(i) / 100;
    const float now = share(cosine, LightFrom::wi);
    EXPECT_LE(now, 1 + 1e-6F);
    EXPECT_GE(now, last - 1e-6F);
    // The slope is that of g, 1 / (ns.w ng.ns), times 4/3 at most: 2.5 a unit of the cosine here.
    EXPECT_LT(now - last, 0.04F) << cosine;
    EXPECT_NEAR(share(cosine, LightFrom::wo), now, 1e-5F);
    last = now;
  }
  EXPECT_EQ(last, 1);
}

TEST(Bsdf, IsFiniteForAnyInput) {
  RandomStream random(8, StreamPurpose::test, 0);
  for (int i = 0; i < 200000; ++i) {
    const float alpha = random.next() < 0.3F ? 0.0F : random.next();
    const float f = random.next() < 0.3F ? 0.0F : random.next();
    const V3f ng = sample_sphere(random.next2());
    V3f ns = random.next() < 0.5F ? ng : sample_sphere(random.next2());
    if (ns.dot(ng) < 0) ns = -ns;
    const Bsdf bsdf = make({"", Rgb(random.next(), 0, 1), Rgb(f, f, 1), Rgb(1, 1, 1), alpha}, ns, ng);
    V3f wo = sample_sphere(random.next2());
    V3f wi = sample_sphere(random.next2());
    if (random.next() < 0.3F) wo = (wo - ng * (ng.dot(wo) * (1 - 1e-7F))).normalized();  // grazing
    if (random.next() < 0.1F) wi = -wo;
    if (random.next() < 0.1F) wi = wo;
    const Rgb value = eval(bsdf, wo, wi);
    ASSERT_TRUE(std::isfinite(value.x) && std::isfinite(value.z) && value.x >= 0 && value.z >= 0);
    ASSERT_TRUE(std::isfinite(pdf(bsdf, wo, wi)));
    ASSERT_EQ(eval_with_pdf(bsdf, wo, wi).value, value);
    ASSERT_EQ(eval_with_pdf(bsdf, wo, wi).pdf_solid_angle, pdf(bsdf, wo, wi));
    const Rgb reflectance = diffuse_reflectance(bsdf, wo);
    ASSERT_TRUE(std::isfinite(reflectance.x) && reflectance.x >= 0);
    if (wi.dot(ng) < 0 || wo.dot(ng) < 0 || wi.dot(ns) < 0 || wo.dot(ns) < 0) {
      ASSERT_TRUE(is_black(value));
      ASSERT_EQ(pdf(bsdf, wo, wi), 0);
    }
    const auto s = sample(bsdf, wo, random.next(), random.next2());
    if (!s) continue;
    ASSERT_TRUE(std::isfinite(s->throughput.x) && std::isfinite(s->throughput.z) && s->throughput.x >= 0);
    ASSERT_NEAR(s->wi.length(), 1.0F, 1e-5F);
    ASSERT_GT(s->wi.dot(ng), 0);
  }
}

}  // namespace
}  // namespace ivory
