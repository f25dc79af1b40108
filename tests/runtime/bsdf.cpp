// shaders/renderer/bsdf.glsl against tracer/bsdf/bsdf.cpp.
#include "tracer/bsdf/bsdf.h"

#include <gtest/gtest.h>

#include "tests/support/runtime_twin.h"

namespace ivory {

namespace {

constexpr std::size_t count = 10000;

struct Case {
  Surface surface;
  V3f wo;
  V3f wi;
};

// All kinds of glTF material, normals bent by up to 60 degrees, directions all around; one case in four with wi near
// the mirror direction, where narrow lobes are.
std::vector<Case> random_cases() {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> u(0, 1);
  std::vector<Case> cases(count);
  for (std::size_t i = 0; i < count; ++i) {
    Case& c = cases[i];
    c.surface.ng = random_direction(random);
    c.surface.ns = (c.surface.ng + random_direction(random) * (0.86F * u(random))).normalized();
    do c.wo = random_direction(random);
    while (i % 8 != 0 && (c.wo.dot(c.surface.ng) <= 0 || c.wo.dot(c.surface.ns) <= 0));
    c.wi = random_direction(random);
    c.surface.roughness_alpha = std::max(1e-3F, u(random) * u(random));
    if (i % 4 == 1) {
      const V3f mirror = c.surface.ns * (2 * c.surface.ns.dot(c.wo)) - c.wo;
      c.wi = (mirror + random_direction(random) * (2 * c.surface.roughness_alpha)).normalized();
    }
    c.surface.diffuse_albedo = Rgb(u(random), u(random), u(random));
    const bool lambert = i % 3 == 0;
    c.surface.specular_f0 = lambert ? Rgb(0, 0, 0) : Rgb(u(random), u(random), u(random)) * u(random);
    c.surface.specular_f90 = lambert ? Rgb(0, 0, 0) : Rgb(1, 1, 1) * (i % 3 == 1 ? 1.0F : u(random));
  }
  return cases;
}

// Four inputs hold it all where the channels are in fixed ratios: see in_ratio().
std::vector<V4f> evaluate(const std::vector<Case>& cases, const std::string& expression) {
  std::vector<std::vector<V4f>> inputs(4, std::vector<V4f>(cases.size()));
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    const Rgb& f0 = c.surface.specular_f0;
    inputs[0][i] = to_v4(c.surface.ns, c.surface.diffuse_albedo.x);
    inputs[1][i] = to_v4(c.surface.ng, f0.x);
    inputs[2][i] = to_v4(c.wo, c.surface.specular_f90.x);
    inputs[3][i] = to_v4(c.wi, c.surface.roughness_alpha);
  }
  return evaluate_on_gpu(R"(
#include "renderer/bsdf.glsl"
vec4 evaluate(int i) {
  IvorySurface s;
  s.ns = input0(i).xyz;
  s.ng = input1(i).xyz;
  s.wo = input2(i).xyz;
  s.diffuse_albedo = vec3(1.0, 0.5, 0.25) * input0(i).w;
  s.f0 = vec3(1.0, 0.5, 0.25) * input1(i).w;
  s.f90 = vec3(input2(i).w);
  s.alpha = input3(i).w;
  vec3 wi = input3(i).xyz;
  return vec4()" + expression +
                             R"(, 0.0);
}
)",
                         inputs);
}

// As the shader sees them: three channels in fixed ratios.
std::vector<Case> in_ratio(std::vector<Case> cases) {
  for (Case& c : cases) {
    c.surface.diffuse_albedo = Rgb(1, 0.5F, 0.25F) * c.surface.diffuse_albedo.x;
    c.surface.specular_f0 = Rgb(1, 0.5F, 0.25F) * c.surface.specular_f0.x;
    c.surface.specular_f90 = Rgb(1, 1, 1) * c.surface.specular_f90.x;
  }
  return cases;
}

class RuntimeBsdf : public GlTest {};

TEST_F(RuntimeBsdf, EvalIsItsTwins) {
  const std::vector<Case> cases = in_ratio(random_cases());
  const std::vector<V4f> gpu = evaluate(cases, "ivory_eval_bsdf(s, wi)");
  int lit = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Rgb cpu = eval(make_bsdf(cases[i].surface), cases[i].wo, cases[i].wi);
    // Directions within rounding of the horizon may fall to either side of it.
    const bool on_edge =
        std::min({std::abs(cases[i].wo.dot(cases[i].surface.ng)), std::abs(cases[i].wo.dot(cases[i].surface.ns)),
                  std::abs(cases[i].wi.dot(cases[i].surface.ng)), std::abs(cases[i].wi.dot(cases[i].surface.ns))}) <
        1e-5F;
    if (on_edge) continue;
    lit += int(!is_black(cpu));
    // Half vectors are good to some 2e-7, which a lobe of width alpha turns into 4e-7 / alpha of its value.
    const float tolerance = 1e-3F + 1e-6F / cases[i].surface.roughness_alpha;
    for (unsigned c = 0; c < 3; ++c) ASSERT_NEAR((&gpu[i].x)[c], cpu[c], tolerance * cpu[c] + 1e-7F) << i;
  }
  EXPECT_GT(lit, int(count / 4));
}

// The sums of powers of roughness, in float there and in double here, are of terms up to 800: 1e-4 of what is left.
TEST_F(RuntimeBsdf, DiffuseReflectanceIsItsTwins) {
  const std::vector<Case> cases = in_ratio(random_cases());
  const std::vector<V4f> gpu = evaluate(cases, "ivory_diffuse_reflectance(s)");
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Bsdf bsdf = make_bsdf(cases[i].surface);
    if (std::min(std::abs(cases[i].wo.dot(bsdf.ng)), std::abs(cases[i].wo.dot(bsdf.ns))) < 1e-5F) continue;
    const Rgb cpu = diffuse_reflectance(bsdf, cases[i].wo);
    for (unsigned c = 0; c < 3; ++c) ASSERT_NEAR((&gpu[i].x)[c], cpu[c], 1e-3F * cpu[c] + 3e-5F) << i;
  }
}

}  // namespace

}  // namespace ivory
