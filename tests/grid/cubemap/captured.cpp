// From captured cube maps to localized ones.
#include "grid/cubemap/captured.h"

#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "grid/base/error.h"

namespace ivory {
namespace {

constexpr ShellFit fits[] = {ShellFit::fitted, ShellFit::corners, ShellFit::averaged};

CapturedCube make_captured(int size, const std::function<double(const V3d& w)>& inverse_distance,
                           const std::function<Rgb(const V3f& w)>& light) {
  CapturedCube captured;
  captured.radiance.size = size;
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const V3f w = cube_texel_direction(size, face, row, column);
        captured.radiance.texels.push_back(light(w));
        captured.inverse_distance.push_back(float(inverse_distance(V3d(w))));
      }
    }
  }
  return captured;
}

double box(const V3d& w, const V3d& low, const V3d& high) {
  double v = 0;
  for (int c = 0; c < 3; ++c) v = std::max(v, w[c] / (w[c] > 0 ? high[c] : low[c]));
  return v;
}

Rgb white(const V3f&) { return {1, 1, 1}; }

// Planes that end where faces do are met exactly, whatever the texels' size.
TEST(CapturedCube, CubesAreExact) {
  const CapturedCube captured = make_captured(
      32, [](const V3d& w) { return box(w, V3d(-2, -2, -2), V3d(2, 2, 2)); }, white);
  for (const ShellFit fit : {ShellFit::fitted, ShellFit::corners}) {
    for (const int size : {1, 2, 4, 8, 32}) {
      for (const TexelCorners& v : localize(captured, size, fit).corners) {
        for (const float inverse_depth : v)
          EXPECT_NEAR(inverse_depth, 0.5F, 1e-5F) << size << std::string(name_of(fit));
      }
    }
  }
}

// The paper's mean distances bulge: here between the face's 2 m and the corner's 2 sqrt(3) m everywhere.
TEST(CapturedCube, AveragedDistancesAreThePapers) {
  const CapturedCube captured = make_captured(
      64, [](const V3d& w) { return box(w, V3d(-2, -2, -2), V3d(2, 2, 2)); }, white);
  // One texel a face: each has the mean over its texels of 2 |q|; a vertex is the same distance away, |q| = sqrt(3).
  double mean = 0;
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column)
      mean += 2 * cube_point(0, (2 * column - 63) / 64.0, (2 * row - 63) / 64.0).length() / 4096;
  }
  for (const TexelCorners& v : localize(captured, 1, ShellFit::averaged).corners) {
    for (const float inverse_depth : v) EXPECT_NEAR(std::sqrt(3.0) / double(inverse_depth), mean, 1e-5 * mean);
  }
}

// What the fit minimises, by the shell as it is read.
double misfit(const CapturedCube& captured, const LocalizedCube& cube) {
  const int size = captured.radiance.size;
  double sum = 0;
  std::size_t i = 0;
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column, ++i) {
        const V3f far = cube_texel_direction(size, face, row, column) * 1e6F;
        const double inverse = 0.999 / double(inside_shell(cube, far).length());
        const double error = inverse - double(captured.inverse_distance[i]);
        sum += cube_texel_solid_angle(size, row, column) * error * error;
      }
    }
  }
  return sum;
}

TEST(CapturedCube, FitIsTheBestShell) {
  // A box seen askew, with a ball in it.
  const CapturedCube captured = make_captured(
      64,
      [](const V3d& w) {
        const V3d turned(0.8 * w.x + 0.6 * w.z, w.y, 0.8 * w.z - 0.6 * w.x);
        const double ball = w.dot(V3d(0.6, 0.64, 0.48)) > 0.95 ? 1.25 : 0;
        return std::max(ball, box(turned, V3d(-1, -2, -1.5), V3d(3, 1, 2)));
      },
      white);
  std::mt19937 random(1);
  for (const int size : {2, 4, 8}) {
    const LocalizedCube best = localize(captured, size, ShellFit::fitted);
    const double least = misfit(captured, best);
    EXPECT_LT(least, 0.95 * misfit(captured, localize(captured, size, ShellFit::corners))) << size;
    const std::vector<std::uint32_t> vertices = corner_vertices(size);
    int lower = 0;
    for (int trial = 0; trial < 40; ++trial) {
      const std::uint32_t vertex = vertices[random() % vertices.size()];
      LocalizedCube other = best;
      const float factor = trial % 2 == 0 ? 1.03F : 0.97F;
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (vertices[i] == vertex) other.corners[i / 4][i % 4] *= factor;
      }
      lower += misfit(captured, other) < least ? 1 : 0;
    }
    // But for the weak pull towards single distances.
    EXPECT_LE(lower, 1) << size;
  }
}

TEST(CapturedCube, AnyShellIsClosed) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const int size : {1, 2, 3, 6, 12}) {
    const CapturedCube captured = make_captured(
        12, [&](const V3d&) { return unit(random) < 0.3 ? 0.0 : std::pow(10, 8 * unit(random) - 4); }, white);
    for (const ShellFit fit : fits)
      EXPECT_EQ(find_fault(localize(captured, size, fit)), "") << size << std::string(name_of(fit));
  }
}

TEST(CapturedCube, SkyStaysSky) {
  const CapturedCube captured = make_captured(
      8, [](const V3d&) { return 0.0; }, white);
  for (const ShellFit fit : fits) {
    for (const TexelCorners& v : localize(captured, 4, fit).corners)
      EXPECT_EQ(v, TexelCorners{}) << std::string(name_of(fit));
  }
}

TEST(CapturedCube, LightIsKept) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  const CapturedCube captured = make_captured(
      24, [](const V3d&) { return 1.0; }, [&](const V3f&) { return Rgb(unit(random), 1, 0); });
  const auto power = [](const CubeMap& map) {
    double sum = 0;
    for (std::size_t i = 0; i < map.texels.size(); ++i) {
      const int in_face = int(i % (std::size_t(map.size) * std::size_t(map.size)));
      sum += double(map.texels[i].x) * cube_texel_solid_angle(map.size, in_face / map.size, in_face % map.size);
    }
    return sum;
  };
  for (const int size : {1, 2, 3, 4, 6, 8, 12, 24}) {
    const LocalizedCube cube = localize(captured, size);
    EXPECT_NEAR(power(cube.radiance) / power(captured.radiance), 1, 1e-6) << size;
    for (const Rgb& radiance : cube.radiance.texels) {
      EXPECT_FLOAT_EQ(radiance.y, 1);
      EXPECT_EQ(radiance.z, 0);
    }
  }
  // One bright captured texel lights the large one that it lies in.
  CapturedCube spot = make_captured(
      24, [](const V3d&) { return 1.0; }, [](const V3f&) { return Rgb(0, 0, 0); });
  const std::size_t at = cube_index(24, 3, 17, 5);
  spot.radiance.texels[at] = Rgb(100, 100, 100);
  const LocalizedCube cube = localize(spot, 4);
  for (std::size_t i = 0; i < cube.radiance.texels.size(); ++i)
    EXPECT_EQ(cube.radiance.texels[i].x > 0, i == cube_index(4, 3, 2, 0)) << i;
}

TEST(CapturedCube, FitsHaveNames) {
  for (const ShellFit fit : fits) EXPECT_EQ(from_name<ShellFit>(name_of(fit)), fit);
  EXPECT_THROW(from_name<ShellFit>("nonsense"), ParameterError);
}

}  // namespace
}  // namespace ivory
