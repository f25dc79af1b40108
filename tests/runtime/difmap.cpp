// DifMaps in GLSL against C++: orientation, filtering, seams.
#include "grid/io/difmap.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/base/half.h"
#include "runtime/assets/difmap.h"
#include "tests/support/runtime_twin.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

class RuntimeDifMap : public GlTest {};

// Every texel its own value between 1e-4 and 1e5 lux, unlike all its neighbours.
DifMap noise(int size) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> exponent(-4, 5);
  DifMap map;
  map.e.size = size;
  for (int i = 0; i < 6 * size * size; ++i)
    map.e.texels.emplace_back(std::pow(10.0F, exponent(random)), 1 + float(random() % 1000), float(i));
  return map;
}

std::vector<V4f> normals_for(int size) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> jitter(-0.7F, 0.7F);
  std::vector<V4f> out;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        // Axes, middles of edges, corners.
        if (x != 0 || y != 0 || z != 0) out.push_back(to_v4(V3f(float(x), float(y), float(z)).normalized()));
        // Close about corners and edges, within a texel.
        for (int k = 0; k < 100 && x * x + y * y + z * z >= 2; ++k) {
          const V3f off = V3f(jitter(random), jitter(random), jitter(random)) * (2 / float(size));
          out.push_back(to_v4((V3f(float(x), float(y), float(z)) + off).normalized()));
        }
      }
    }
  }
  while (out.size() < 10000) out.push_back(to_v4(random_direction(random)));
  return out;
}

std::vector<V4f> read(const GpuDifMap& gpu, const std::vector<V4f>& normals) {
  return evaluate_on_gpu(
      "#include \"ambient/difmap.glsl\"\n"
      "vec4 evaluate(int i) { return vec4(ivory_ambient(vec3(7.0), input0(i).xyz, input0(i).xyz), 1.0); }",
      {normals}, [&](gl::Program& program) { EXPECT_EQ(bind(gpu, program, 2), 3); });
}

// Weights are off by rounding of the texel coordinate, 2^-24 of `size` texels, times the largest of the four texels:
// the error relative to what is read has no bound for noise over nine decades, the one relative to that texel has.
float largest_tap(const DifMap& map, const V3f& n, unsigned channel) {
  const CubeTaps taps = cube_taps(map.e.size, n);
  float largest = 0;
  for (std::size_t i = 0; i < 4; ++i) largest = std::max(largest, map.e.texels[taps.texel[i]][channel]);
  return largest;
}

TEST_F(RuntimeDifMap, AgreesWithItsTwin) {
  for (const int size : {1, 2, 5, 32, 64}) {
    const DifMap map = noise(size);
    const GpuDifMap gpu = upload(map);
    EXPECT_EQ(gpu.bytes(), std::size_t(6 * size * size) * 12);
    const std::vector<V4f> normals = normals_for(size);
    const std::vector<V4f> e = read(gpu, normals);
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const Rgb expected = irradiance(map, xyz(normals[i]));
      for (unsigned c = 0; c < 3; ++c)
        ASSERT_NEAR(e[i][c], expected[c], 1e-3F * expected[c] + 3e-5F * largest_tap(map, xyz(normals[i]), c))
            << "size " << size << " n " << xyz(normals[i]);
    }
  }
}

// Texels rounded as halves are; the rest as exact as before.
TEST_F(RuntimeDifMap, HalvesKeepElevenBits) {
  DifMap map = noise(16);
  const GpuDifMap gpu = upload(map, {.half_floats = true});
  EXPECT_EQ(gpu.bytes(), 6U * 16 * 16 * 6);
  for (Rgb& texel : map.e.texels) {
    for (unsigned c = 0; c < 3; ++c) {
      const float rounded = rounded_to_half(texel[c] / gpu.scale) * gpu.scale;
      // Below 2^-14 of a scale halves are 2^-24 of it apart.
      ASSERT_NEAR(rounded, texel[c], texel[c] / 2048 + gpu.scale * 3e-8F);
      texel[c] = rounded;
    }
  }
  const std::vector<V4f> normals = normals_for(16);
  const std::vector<V4f> e = read(gpu, normals);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Rgb expected = irradiance(map, xyz(normals[i]));
    for (unsigned c = 0; c < 3; ++c)
      ASSERT_NEAR(e[i][c], expected[c], 1e-3F * expected[c] + 3e-5F * largest_tap(map, xyz(normals[i]), c)) << i;
  }
}

TEST_F(RuntimeDifMap, BadFilesLeaveNothingBehind) {
  const std::string path = (fs::path(testing::TempDir()) / "runtime_difmap.exr").string();
  write_difmap(path, noise(16), true);
  const int before = live_gl_objects();
  load_difmap(path);
  EXPECT_EQ(live_gl_objects(), before);
  std::string bytes;
  {
    std::ifstream in(path, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  for (const std::string& bad : {std::string(), bytes.substr(0, 10), bytes.substr(0, bytes.size() / 2),
                                 std::string("#?RADIANCE\n"), "x" + bytes}) {
    std::ofstream(path, std::ios::binary) << bad;
    try {
      load_difmap(path);
      ADD_FAILURE() << bad.size();
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find(path), 0U) << error.what();
    }
    EXPECT_EQ(live_gl_objects(), before);
  }
  fs::remove(path);
}

}  // namespace
}  // namespace ivory
