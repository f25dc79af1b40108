// Environment maps from files of every layout: detection, orientation, resampling, irradiance, bad input.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <string>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "grid/base/error.h"
#include "grid/env/cube_from_latlong.h"
#include "grid/env/environment_image.h"
#include "grid/env/irradiance.h"
#include "grid/env/latlong_map.h"
#include "grid/io/environment.h"
#include "tests/support/environment_pictures.h"
#include "tests/support/folder_test.h"
#include "tests/support/paths.h"
#include "tests/support/scene_check.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
constexpr double pi_d = 3.14159265358979323846;

class EnvironmentFiles : public FolderTest {
 protected:
  std::string write(const std::string& name, const Picture& picture) const {
    const auto output = OIIO::ImageOutput::create(path(name));
    EXPECT_TRUE(output->open(path(name), OIIO::ImageSpec(picture.width, picture.height, 3, OIIO::TypeDesc::FLOAT)));
    EXPECT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, picture.texels.data()) && output->close());
    return path(name);
  }
  std::string message(const std::string& file, std::optional<EnvironmentLayout> layout = {}) const {
    try {
      load_environment(file, layout);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
};

// Smooth, different towards all six axes and their mixtures.
Rgb sky(const V3d& w) {
  return Rgb(float(2 + w.x + 0.5 * w.y * w.z), float(2 + w.y - 0.4 * w.x * w.z), float(2 + w.z + 0.3 * w.x * w.y));
}

TEST_F(EnvironmentFiles, EveryLayoutShowsTheSameWorld) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const EnvironmentLayout layout : all_layouts) {
    const std::string file = write(std::string(name_of(layout)) + ".exr", make_picture(layout, 32, sky));
    EXPECT_EQ(load_environment_image(file).image.layout, layout);
    const EnvironmentMap map = load_environment(file);
    ASSERT_EQ(map.width, 2 * map.height);
    for (int i = 0; i < 3000; ++i) {
      V3d w(normal(random), normal(random), normal(random));
      if (i < 6) w = V3d(i / 2 == 0, i / 2 == 1, i / 2 == 2) * (i % 2 == 0 ? 1 : -1) + V3d(1e-4, 1e-4, 1e-4);
      w.normalize();
      const Rgb seen = eval(map, V3f(w));
      const Rgb real = sky(w);
      // Within a texel of both maps, a right angle / 32, slopes up to 1.5: 0.07; at the angular map's rim twice.
      for (unsigned c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], real[c], 0.15) << name_of(layout);
    }
  }
}

TEST_F(EnvironmentFiles, ResamplingKeepsFluxConstantsAndSuns) {
  for (const EnvironmentLayout layout : all_layouts) {
    for (const int detail : {1, 7, 24}) {
      const EnvironmentMap uniform =
          load_environment(write("u.exr", make_picture(layout, detail, [](const V3d&) { return Rgb(3, 0.5F, 0); })));
      // The angular map's own texels cover the sphere to 4e-3 at 4 x 4, 1e-4 from 16 x 16 on.
      const float tolerance = layout != EnvironmentLayout::angular ? 1e-6F : (detail == 1 ? 2e-2F : 2e-4F);
      for (const Rgb& texel : uniform.radiance) {
        EXPECT_NEAR(texel.x / 3, 1, tolerance) << name_of(layout) << detail;
        EXPECT_NEAR(texel.y / 0.5, 1, tolerance);
        EXPECT_EQ(texel.z, 0);
      }
      // A dim sky and three suns of one texel each.
      Picture picture = make_picture(layout, detail, sky);
      std::mt19937 random(2);
      for (int sun = 0; sun < 3;) {
        const std::size_t at = random() % picture.texels.size();
        const double column = double(at % std::size_t(picture.width)) + 0.5;
        const double row = double(at / std::size_t(picture.width)) + 0.5;
        if (!picture_direction(layout, picture.width, picture.height, column, row)) continue;
        picture.texels[at] = Rgb(1e4F, 2e4F, 5e3F);
        ++sun;
      }
      const EnvironmentImage image = load_environment_image(write("s.exr", picture)).image;
      const RadianceMoments before = radiance_moments(image);
      const EnvironmentMap map = to_latlong(image);
      const RadianceMoments after = radiance_moments({EnvironmentLayout::latlong, map});
      for (int c = 0; c < 3; ++c) {
        // Floats, millions of roundings of either sign; the cube's own quadrature to 1e-9.
        EXPECT_NEAR(after.total[c] / before.total[c], 1, 1e-6) << name_of(layout) << detail;
        // And it comes from the same side: suns move by less than a texel of either map.
        for (std::size_t i = 0; i < 3; ++i)
          EXPECT_NEAR(after.first[i][c] / before.total[c], before.first[i][c] / before.total[c], 0.7 / detail);
      }
      // Nothing dimmer or brighter than there was.
      for (const Rgb& texel : map.radiance) EXPECT_LT(texel.y, 2.1e4F * 4);
    }
  }
}

TEST_F(EnvironmentFiles, OrientationMapsAgree) {
  const std::string data = sample_data();
  if (data.empty() || !fs::exists(data + "/env/OrientationCube.exr")) GTEST_SKIP() << no_sample_data;
  const EnvironmentImage cube_image = load_environment_image(data + "/env/OrientationCube.exr").image;
  const EnvironmentImage latlong_image = load_environment_image(data + "/env/OrientationLatLong.exr").image;
  EXPECT_EQ(cube_image.layout, EnvironmentLayout::cube);
  EXPECT_EQ(latlong_image.layout, EnvironmentLayout::latlong);
  const EnvironmentMap from_cube = to_latlong(cube_image);
  const EnvironmentMap latlong = to_latlong(latlong_image);
  // Both as cubes of 64: letters are still legible, the maps' different sampling is not.
  const CubeMap a = cube_from_environment(from_cube, 64);
  const CubeMap b = cube_from_environment(latlong, 64);
  // Correlation of the writing, face by face, with the other map's face and its mirror images. Lines of text mirrored
  // left to right still lie on each other: 0.63.
  const auto correlation = [](const CubeMap& x, const CubeMap& y, int face, bool mirror_columns, bool mirror_rows) {
    double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
    constexpr int n = 64;
    for (int row = 0; row < n; ++row) {
      for (int column = 0; column < n; ++column) {
        const double p = x.texels[cube_index(n, face, row, column)].x;
        const double q =
            y.texels[cube_index(n, face, mirror_rows ? n - 1 - row : row, mirror_columns ? n - 1 - column : column)].x;
        sx += p;
        sy += q;
        sxx += p * p;
        syy += q * q;
        sxy += p * q;
      }
    }
    constexpr double count = n * n;
    return (sxy - sx * sy / count) / std::sqrt((sxx - sx * sx / count) * (syy - sy * sy / count));
  };
  for (int face = 0; face < cube_faces; ++face) {
    EXPECT_GT(correlation(a, b, face, false, false), 0.95) << face;
    EXPECT_LT(correlation(a, b, face, true, false), 0.7) << face;
    EXPECT_LT(correlation(a, b, face, false, true), 0.5) << face;
    EXPECT_LT(correlation(a, b, face, true, true), 0.5) << face;
  }
}

TEST_F(EnvironmentFiles, LayoutIsAskedForOrReadOrSeen) {
  const Picture latlong = make_picture(EnvironmentLayout::latlong, 4, sky);
  const std::string file = write("a.exr", latlong);
  EXPECT_EQ(load_environment_image(file).image.layout, EnvironmentLayout::latlong);
  const std::string refused = message(file, EnvironmentLayout::cube);
  EXPECT_NE(refused.find("16 x 8"), std::string::npos) << refused;
  EXPECT_NE(refused.find("the layout given is cube"), std::string::npos) << refused;
  const std::string square = write("b.exr", make_picture(EnvironmentLayout::angular, 4, sky));
  EXPECT_EQ(message(square), "");
  EXPECT_NE(message(square, EnvironmentLayout::latlong).find("twice as wide as high"), std::string::npos);

  // An envmap attribute that the picture cannot have.
  auto output = OIIO::ImageOutput::create(path("c.exr"));
  OIIO::ImageSpec spec(4, 4, 3, OIIO::TypeDesc::FLOAT);
  spec.attribute("textureformat", "LatLong Environment");
  ASSERT_TRUE(output->open(path("c.exr"), spec));
  const std::vector<float> grey(4 * 4 * 3, 0.5F);
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, grey.data()) && output->close());
  output.reset();
  EXPECT_NE(message(path("c.exr")).find("envmap"), std::string::npos) << message(path("c.exr"));
  EXPECT_EQ(message(path("c.exr"), EnvironmentLayout::angular), "");
}

TEST_F(EnvironmentFiles, BadInputIsOneClearLine) {
  const auto expect = [&](const std::string& file, const std::string& part) {
    const std::string text = message(file);
    EXPECT_NE(text.find(file), std::string::npos) << text;
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  };
  expect(write("dot.exr", {1, 1, {Rgb(1, 1, 1)}}), "too small");
  expect(write("odd.exr", {7, 5, std::vector<Rgb>(35, Rgb(1, 1, 1))}), "7 x 5");
  for (const EnvironmentLayout layout : all_layouts) {
    Picture picture = make_picture(layout, 4, sky);
    const std::string file = std::string(name_of(layout)) + ".exr";
    // In the middle every layout shows something.
    float& value = picture.texels[std::size_t(picture.height / 2 * picture.width + picture.width / 2)].y;
    value = -1e3F;
    expect(write(file, picture), "below zero");
    value = std::numeric_limits<float>::quiet_NaN();
    expect(write(file, picture), "not finite");
    value = std::numeric_limits<float>::infinity();
    expect(write(file, picture), "not finite");
  }
  const std::string whole = write("whole.hdr", make_picture(EnvironmentLayout::vertical_cross, 16, sky));
  fs::resize_file(whole, fs::file_size(whole) / 2);
  EXPECT_NE(message(whole), "");
  std::ofstream(path("empty.exr"));
  EXPECT_NE(message(path("empty.exr")), "");
}

// The slow twin: every texel of a random map, in every layout, against the hierarchy.
TEST_F(EnvironmentFiles, IrradianceEqualsTheSumOverAllTexels) {
  for (const EnvironmentLayout layout : all_layouts) {
    Picture picture = make_picture(layout, 12, sky);
    std::mt19937 random(3);
    std::exponential_distribution<float> value;
    for (Rgb& texel : picture.texels) texel *= value(random);
    const EnvironmentImage image = load_environment_image(write("r.exr", picture)).image;
    const IrradianceMap baked = bake_irradiance(make_irradiance_tree(image), 8);
    const double total = radiance_moments(image).total.y;
    // n x n points a texel, weights by their exact solid angles, from the picture itself.
    constexpr int n = 8;
    std::vector<std::pair<V3d, double>> lights;
    for (int row = 0; row < picture.height * n; ++row) {
      for (int column = 0; column < picture.width * n; ++column) {
        const double x = (column + 0.5) / n;
        const double y = (row + 0.5) / n;
        const auto w = picture_direction(layout, picture.width, picture.height, x, y);
        if (!w) continue;
        double density;  // solid angle a texel's area
        if (layout == EnvironmentLayout::latlong) {
          density = std::sin(pi_d * y / picture.height) * pi_d / picture.height * 2 * pi_d / picture.width;
        } else if (layout == EnvironmentLayout::angular) {
          const double theta = std::acos(std::clamp(w->z, -1.0, 1.0));
          density = (theta > 0 ? std::sin(theta) / theta : 1) * std::pow(2 * pi_d / picture.width, 2);
        } else {
          const double c = std::max({std::abs(w->x), std::abs(w->y), std::abs(w->z)});
          density = c * c * c * 4 / (12.0 * 12.0);
        }
        lights.emplace_back(
            *w, density / (n * n) *
                    picture.texels[std::size_t(row / n) * std::size_t(picture.width) + std::size_t(column / n)].y);
      }
    }
    double worst = 0;
    for (int face = 0; face < cube_faces; ++face) {
      for (int row = 0; row < 8; ++row) {
        for (int column = 0; column < 8; ++column) {
          const V3d normal(cube_texel_direction(8, face, row, column));
          double sum = 0;
          for (const auto& [w, flux] : lights) sum += flux * std::max(0.0, normal.dot(w));
          worst = std::max(worst, std::abs(sum - baked.e.texels[cube_index(8, face, row, column)].y) / total);
        }
      }
    }
    // The twin's midpoint rule: (1/96)^2 of a right angle; the hierarchy's cells of 1/128 on the horizon.
    EXPECT_LT(worst, 1e-4) << name_of(layout);
    EXPECT_LT(baked.error_bound.y / total, 1e-3) << name_of(layout);
    EXPECT_GT(baked.error_bound.y, 0);
  }
}

TEST_F(EnvironmentFiles, SumsDoNotDependOnThreads) {
  const EnvironmentImage image =
      load_environment_image(write("t.exr", make_picture(EnvironmentLayout::latlong, 64, sky))).image;
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return std::pair(radiance_moments(image).second[3], bake_irradiance(make_irradiance_tree(image), 6).e.texels);
  };
  EXPECT_EQ(run(1), run(3));
}

TEST_F(EnvironmentFiles, NaturalMapsAgainstThePapersFigures) {
  const std::string data = sample_data();
  if (data.empty()) GTEST_SKIP() << no_sample_data;
  int seen = 0;
  for (const auto& entry : fs::directory_iterator(data + "/env")) {
    if (entry.path().extension() != ".hdr") continue;
    ++seen;
    const EnvironmentImage image = load_environment_image(entry.path().string()).image;
    const RadianceMoments moments = radiance_moments(image);
    const IrradianceMap truth = bake_irradiance(make_irradiance_tree(image), 32);
    const Sh9Error error = sh9_error(sh9_from_moments(moments), truth.e, moments.total);
    // A single light, the worst there is, has 9.4 % and 2.3 % (Sh9.ErrorOfOneDirectionalLight).
    EXPECT_LT(error.maximum, 0.09) << entry.path();
    EXPECT_LT(error.average, 0.023) << entry.path();
    EXPECT_GT(error.average, 1e-4) << entry.path();
  }
  EXPECT_GT(seen, 0);
}

}  // namespace
}  // namespace ivory
