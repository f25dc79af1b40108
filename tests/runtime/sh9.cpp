// SH9 in GLSL against C++.
#include "runtime/assets/sh9.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "runtime/gl/shader_source.h"
#include "tests/support/runtime_twin.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

class RuntimeSh9 : public GlTest {};

// A sun over a dim coloured sky, in lux up to 100,000, negative for some normals before it is cut off at nothing.
Sh9 sun_and_sky() {
  Sh9 sh;
  const V3d w = V3d(0.3, 0.8, -0.5).normalized();
  const double y[9] = {0.282095,
                       0.488603 * w.y,
                       0.488603 * w.z,
                       0.488603 * w.x,
                       1.092548 * w.x * w.y,
                       1.092548 * w.y * w.z,
                       0.315392 * (3 * w.z * w.z - 1),
                       1.092548 * w.x * w.z,
                       0.546274 * (w.x * w.x - w.y * w.y)};
  for (std::size_t i = 0; i < 9; ++i) sh.coefficients[i] = V3d(1e5, 9e4, 7e4) * y[i];
  sh.coefficients[0] += V3d(500, 800, 1500);
  return sh;
}

TEST_F(RuntimeSh9, AgreesWithItsTwin) {
  std::mt19937 random(1);
  std::vector<V4f> normals;
  for (unsigned axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0F, 1.0F}) {
      V4f n(0, 0, 0, 0);
      n[axis] = sign;
      normals.push_back(n);
    }
  }
  while (normals.size() < 10000) normals.push_back(to_v4(random_direction(random)));
  const GpuSh9 sh = upload(sun_and_sky());
  const std::vector<V4f> e = evaluate_on_gpu(
      "#include \"ambient/sh9.glsl\"\n"
      "vec4 evaluate(int i) { return vec4(ivory_ambient(vec3(7.0), input0(i).xyz, input0(i).xyz), 1.0); }",
      {normals}, [&](gl::Program& program) { EXPECT_EQ(bind(sh, program, 3), 3); });
  int dark = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Rgb expected = irradiance(sh.matrices, xyz(normals[i]));
    // Terms of 1e5 lux cancel where E is small: 20 roundings of 2^-24 of those.
    for (unsigned c = 0; c < 3; ++c) ASSERT_NEAR(e[i][c], expected[c], 1e-3F * expected[c] + 0.2F) << i;
    if (expected.x == 0) ++dark;
  }
  EXPECT_GT(dark, 100);
}

TEST_F(RuntimeSh9, BadFilesAreRefused) {
  const std::string path = (fs::path(testing::TempDir()) / "runtime_sh9.json").string();
  for (const char* text : {"", "{", "{\"asset\": {\"version\": \"2.0\"}}", "\x76\x2f\x31\x01"}) {
    std::ofstream(path) << text;
    try {
      load_sh9(path);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find(path), 0U) << error.what();
    }
  }
  fs::remove(path);
  EXPECT_THROW(load_sh9(path), Error);
}

}  // namespace
}  // namespace ivory
