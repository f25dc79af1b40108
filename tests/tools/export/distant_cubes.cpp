// ivory export of distant light as cubes: Filament's KTX1 and Bevy's KTX2.
#include <array>
#include <bit>
#include <cmath>
#include <sstream>

#include "tests/tools/export/distant_fixture.h"
#include "tests/tools/export/ktx2_reader.h"

namespace ivory {
namespace {

using Json = nlohmann::json;

// KTX1: what Ktx1Bundle takes for the harmonics, and the cube beside it.
TEST_F(ExportDistant, FilamentReadsKtx) {
  export_to("filament", "sky.ktx");
  const std::string bytes = bytes_of(path("sky.ktx"));
  const std::size_t notes = number_at(bytes, 60, 4);
  const std::string pair = bytes.substr(68, number_at(bytes, 64, 4));
  ASSERT_EQ(pair.substr(0, 3), std::string("sh\0", 3));
  std::istringstream numbers(pair.substr(3));
  Values sh;
  for (V3d& v : sh) ASSERT_TRUE(numbers >> v.x >> v.y >> v.z);
  expect_sky("filament, KTX1", printed, [&](const V3d& n) { return prescaled(sh, n); });
  // 16 + 8 + 4 + 2 + 1: the last level has a texel a face, the face's own direction. Six bits of mantissa, five in
  // blue.
  const std::size_t last = 64 + notes + 4 * 4 + 6 * 4 * (256 + 64 + 16 + 4) + 4;
  ASSERT_EQ(bytes.size(), last + 24);
  for (std::size_t i = 0; i < 6; ++i) {
    const auto word = std::uint32_t(number_at(bytes, last + 4 * i, 4));
    half red;
    red.setBits(std::uint16_t((word & 0x7FFU) << 4U));
    EXPECT_NEAR(float(red) / (irradiance_polynomial(sh_, V3d(axes[i])).x / 3.14159265), 1, 1.0 / 64);
  }
}

TEST_F(ExportDistant, BevyReadsTheCube) {
  const Json result = export_to("bevy", "sky.ktx2");
  EXPECT_EQ(result["intensity"], 1);
  const Ktx2Read file = read_ktx2(bytes_of(path("sky.ktx2")));
  EXPECT_EQ(file.vk_format, 97U);
  EXPECT_EQ(file.faces, 6U);
  // environment_map.wesl: radiance = sample(n.x, n.y, -n.z) * intensity. Here the nearest texel answers, whose centre
  // is up to 0.044 off, and E / pi of this sky changes by up to 1.3 of itself a radian.
  expect_sky("bevy", 0.06, [&](const V3d& n) {
    const V4f texel = cube_texel_at(file, V3d(n.x, n.y, -n.z));
    return V3d(texel.x, texel.y, texel.z);
  });
  // A bright sky is scaled so that halves hold it.
  Json bright = json("sky.json");
  for (const char* key : {"coefficients", "matrices"}) {
    for (Json& row : bright[key])
      for (Json& entry : row) {
        if (entry.is_number())
          entry = 1e5 * entry.get<double>();
        else
          for (Json& number : entry) number = 1e5 * number.get<double>();
      }
  }
  std::ofstream(path("bright.json")) << bright;
  const Json scaled = run("export " + path("bright.json") + " --to bevy -o " + path("bright.ktx2"));
  const double intensity = scaled["intensity"];
  EXPECT_GT(intensity, 1);
  const Ktx2Read bright_file = read_ktx2(bytes_of(path("bright.ktx2")));
  EXPECT_NEAR(ktx2_texel(bright_file, 7).x * intensity / (1e5 * ktx2_texel(file, 7).x), 1, 2e-3);  // two halves' steps
}

}  // namespace
}  // namespace ivory
