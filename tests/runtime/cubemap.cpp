// shaders/base/fast_angle.glsl, env/cube_map.glsl, cubemap/localized.glsl against their C++ twins, and cube maps as GL
// objects.
#include "grid/io/cubemap.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/base/fast_angle.h"
#include "grid/cubemap/edges.h"
#include "runtime/assets/cubemap.h"
#include "tests/support/runtime_twin.h"
#include "tools/stability/cube_builder.h"

namespace ivory {
namespace {

constexpr int count = 10000;

class RuntimeCubemap : public GlTest {};

TEST_F(RuntimeCubemap, FastAngle) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::uniform_int_distribution<int> power(-18, 18);
  std::vector<V4f> in;
  for (const float y : {0.0F, 1.0F, -1.0F}) {
    for (const float x : {0.0F, 1.0F, -1.0F}) in.emplace_back(y, x, 0.0F, 0.0F);
  }
  while (int(in.size()) < count)
    in.emplace_back(std::ldexp(normal(random), power(random)), std::ldexp(normal(random), power(random)), 0.0F, 0.0F);
  const auto out = evaluate_on_gpu(
      "#include \"base/fast_angle.glsl\"\nvec4 evaluate(int i) { vec4 a = input0(i); return vec4(ivory_fast_angle(a.x, "
      "a.y)); }",
      {in});
  for (int i = 0; i < count; ++i) {
    const V4f& a = in[std::size_t(i)];
    // Roundings of one division and eight steps.
    EXPECT_NEAR(out[std::size_t(i)].x, fast_angle(a.x, a.y), 1e-6F) << a;
    EXPECT_NEAR(double(out[std::size_t(i)].x), std::atan2(double(a.x), double(a.y)), 2e-6) << a;
  }
}

TEST_F(RuntimeCubemap, CubePosition) {
  std::mt19937 random(2);
  std::vector<V4f> in;
  for (int x = -1; x <= 1; ++x) {  // axes, edges, corners and the zero vector
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) in.emplace_back(float(x), float(y), float(z), 0.0F);
    }
  }
  while (int(in.size()) < count)
    in.push_back(to_v4(random_direction(random) * std::ldexp(1.0F, int(random() % 40) - 20)));
  const auto out = evaluate_on_gpu(R"(
#include "env/cube_map.glsl"
vec4 evaluate(int i) {
  int face; float s, t;
  ivory_cube_position(input0(i).xyz, face, s, t);
  vec3 forward, right, down;
  ivory_cube_face_axes(face, forward, right, down);
  vec3 q = forward + s * right + t * down;
  return vec4(q, float(face));
})",
                                   {in});
  for (int i = 0; i < count; ++i) {
    const CubePosition at = cube_position(xyz(in[std::size_t(i)]));
    const V3f q(cube_point(at.face, double(at.s), double(at.t)));
    EXPECT_EQ(int(out[std::size_t(i)].w), at.face) << in[std::size_t(i)];
    EXPECT_LT((xyz(out[std::size_t(i)]) - q).length(), 1e-6F) << in[std::size_t(i)];
  }
}

struct Receivers {
  std::vector<V4f> p, n;
};

// In the shell, on it, without it, far, not numbers; planes through the reference point, where vertices and edges lie
// on the horizon and on the meridian.
Receivers make_receivers(const LocalizedCube& cube, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  Receivers r;
  for (int i = 0; i < count; ++i) {
    V3f offset = random_direction(random);
    offset *= 2.5F * unit(random);
    if (i % 3 == 0) offset = inside_shell(cube, random_direction(random) * 1e6F);
    if (i % 5 == 0) offset[i % 3] = 0;
    if (i % 50 == 0) offset = V3f(0, 0, 0);
    if (i % 50 == 1) offset *= 1e9F;
    if (i % 1000 == 2) offset = V3f(std::numeric_limits<float>::infinity(), 0, 0);
    V3f n = random_direction(random);
    if (i % 7 == 0) {
      n = V3f(0, 0, 0);
      n[i % 3] = i % 2 == 0 ? 1.0F : -1.0F;
    }
    r.p.push_back(to_v4(cube.origin_m + offset));
    r.n.push_back(to_v4(n));
  }
  return r;
}

// Boxes, folded shells, shells with holes to the sky; radiance over four decades.
LocalizedCube random_cube(int size, int kind, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  const Light light = [&](const V3f&) {
    const float red = unit(random);
    return Rgb(red, 100 * std::pow(unit(random), 4.0F), 1);
  };
  if (kind == 0) return make_cube(size, V3f(1, 2, 3), box_around(V3d(-1, -0.5, -2), V3d(0.7, 1.5, 1)), light);
  return make_cube(
      size, V3f(-3, 0, 1),
      [&](const V3d& w) {
        const double u = std::abs(std::sin(12.9898 * w.x + 78.233 * w.y + 37.719 * w.z + seed));
        return kind == 2 && u < 0.4 ? 0.0F : float(0.3 + u);
      },
      light);
}

void compare(CubeMethod method, int size, int kind) {
  const LocalizedCube cube = random_cube(size, kind, std::uint32_t(17 * size + kind));
  const GpuLocalizedCube gpu = upload(cube);
  const Receivers r = make_receivers(cube, std::uint32_t(size));
  const auto out = evaluate_on_gpu(ambient(gpu, method).shader +
                                       "vec4 evaluate(int i) { vec3 n = input1(i).xyz;"
                                       "return vec4(ivory_ambient(input0(i).xyz, n, n), 0.0); }",
                                   {r.p, r.n}, [&](gl::Program& program) { bind(gpu, program, 0); });
  const CubeEdges edges = make_cube_edges(cube);
  int off = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const V3f p = xyz(r.p[i]);
    const V3f n = xyz(r.n[i]);
    const Rgb e =
        method == CubeMethod::polygon ? polygon_irradiance(cube, edges, p, n) : irradiance(cube, method, p, n);
    // Texel by texel loses its digits where most of the shell is a point in the distance; edges keep them.
    const bool near = (p - cube.origin_m).length() < 5;
    const Rgb slow = near ? irradiance(cube, method, p, n) : e;
    for (int c = 0; c < 3; ++c) {
      // Relative to E, or to a tenth of what the brightest texel gives all around: it is a sum of terms of either sign
      // and of that size, near the shell of directions that are a thousandth of positions.
      const float scale = std::max(e[c], 0.1F * pi * edges.brightest[c]);
      const float difference = std::max(std::abs(out[i][c] - e[c]), std::abs(slow[c] - e[c])) / scale;
      if (!(difference < 1e-3F)) ++off;
      ASSERT_LT(difference, 1e-2F) << name_of(method) << " size " << size << " kind " << kind << " p "
                                   << p - cube.origin_m << " n " << n << " gpu " << out[i] << " cpu " << e << " slow "
                                   << slow;
    }
  }
  // A receiver that happens to lie within 1e-4 of the shell's size of a corner has directions of three digits.
  EXPECT_LE(off, 3 * count / 1000);
}

TEST_F(RuntimeCubemap, Polygon) {
  for (const int size : {1, 2, 3, 4, 8, 16}) {
    for (int kind = 0; kind < 3; ++kind) compare(CubeMethod::polygon, size, kind);
  }
}

TEST_F(RuntimeCubemap, PolygonAsPublished) {
  for (const int size : {2, 4, 5}) compare(CubeMethod::polygon_paper, size, size % 3);
}

TEST_F(RuntimeCubemap, Convolved) {
  for (const int size : {2, 4}) compare(CubeMethod::convolved, size, size % 3);
}

TEST_F(RuntimeCubemap, Points) {
  for (const int size : {2, 4, 5}) compare(CubeMethod::point, size, size % 3);
}

TEST_F(RuntimeCubemap, ConstantRadianceGivesPi) {
  LocalizedCube cube = random_cube(4, 1, 5);
  for (Rgb& texel : cube.radiance.texels) texel = Rgb(2, 0, 1e20F);
  const GpuLocalizedCube gpu = upload(cube);
  const Receivers r = make_receivers(cube, 4);
  const auto out = evaluate_on_gpu(
      ambient(gpu).shader +
          "vec4 evaluate(int i) { return vec4(ivory_ambient(input0(i).xyz, vec3(0.0), input1(i).xyz), 0.0); }",
      {r.p, r.n}, [&](gl::Program& program) { bind(gpu, program, 0); });
  for (const V4f& e : out) {
    ASSERT_NEAR(e.x, 2 * pi, 1e-6F);
    ASSERT_EQ(e.y, 0);
    ASSERT_NEAR(e.z / 1e20F, pi, 1e-6F);
  }
}

TEST_F(RuntimeCubemap, LoadsFilesAndRefusesBadOnesWithoutLeavingObjects) {
  const std::string good = testing::TempDir() + "runtime_cubemap.exr";
  const LocalizedCube cube = random_cube(4, 0, 1);
  write_localized_cube(good, cube, true);
  const int before = live_gl_objects();
  {
    const GpuLocalizedCube gpu = load_localized_cube(good);
    EXPECT_EQ(gpu.size, 4);
    EXPECT_EQ(gpu.bytes(), (36U * 16 + 10) * 16);
    EXPECT_EQ(live_gl_objects(), before + 2);
  }
  EXPECT_EQ(live_gl_objects(), before);

  expect_damage_refused(good, load_localized_cube);
  // Corners that neighbours disagree about, and light that is no number.
  LocalizedCube broken = cube;
  broken.corners[7][2] *= 2;
  EXPECT_THROW(upload(broken), Error);
  broken = cube;
  broken.radiance.texels[3].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(upload(broken), Error);
  EXPECT_EQ(live_gl_objects(), before);
}

}  // namespace
}  // namespace ivory
