#include "grid/env/irradiance/error.h"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "grid/base/counted_random.h"
#include "grid/env/irradiance/sum.h"

namespace ivory {

namespace {

PointError point_error(const V3d& e, const V3d& truth) {
  PointError point;
  for (int c = 0; c < 3; ++c) {
    point.squared += (e[c] - truth[c]) * (e[c] - truth[c]) / 3;
    point.truth += truth[c] / 3;
  }
  return point;
}

template <typename Eval>
MeasuredError error_of(const IrradianceTruth& truth, const Eval& eval) {
  std::vector<PointError> points(truth.n.size());
  tbb::parallel_for(std::size_t(0), points.size(),
                    [&](std::size_t i) { points[i] = point_error(eval(truth.n[i]), truth.e[i]); });
  return root_mean_square(points);
}

V3d texel_irradiance(const IrradianceTree& tree, int size, std::size_t texel) {
  const auto edge = std::size_t(size);
  const V3f n = cube_texel_direction(size, int(texel / (edge * edge)), int(texel / edge % edge), int(texel % edge));
  return tree.irradiance(V3d(n)).e;
}

std::vector<V3d> random_normals(int count, std::uint64_t seed) {
  std::vector<V3d> normals(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < normals.size(); ++i)
    normals[i] = sphere_direction(counted_uniform(seed, 2 * i), counted_uniform(seed, 2 * i + 1));
  return normals;
}

}  // namespace

IrradianceTruth make_irradiance_truth(const IrradianceTree& tree, int count, std::uint64_t seed) {
  IrradianceTruth truth{random_normals(count, seed), std::vector<V3d>(std::size_t(count))};
  tbb::parallel_for(std::size_t(0), truth.n.size(), [&](std::size_t i) { truth.e[i] = tree.irradiance(truth.n[i]).e; });
  return truth;
}

IrradianceTruth sum_irradiance_truth(const EnvironmentImage& image, int count, std::uint64_t seed) {
  IrradianceTruth truth{random_normals(count, seed), {}};
  std::vector<V3f> normals;
  for (V3d& n : truth.n) {
    // Those that the sum is asked for.
    normals.push_back(V3f(n).normalized());
    n = V3d(normals.back()).normalized();
  }
  truth.e = sum_irradiance(image, normals).e;
  return truth;
}

MeasuredError difmap_error(const CubeMap& e, const IrradianceTruth& truth) {
  return error_of(truth, [&](const V3d& n) { return V3d(bilinear(e, V3f(n))); });
}

MeasuredError sh9_rms_error(const Sh9& sh, const IrradianceTruth& truth) {
  return error_of(truth, [&](const V3d& n) {
    const V3d e = irradiance_polynomial(sh, n);
    return V3d(std::max(e.x, 0.0), std::max(e.y, 0.0), std::max(e.z, 0.0));
  });
}

MeasuredError predicted_difmap_error(const IrradianceTree& tree, int size, const IrradianceTruth& truth) {
  return error_of(truth, [&](const V3d& n) {
    const CubeTaps taps = cube_taps(size, V3f(n));
    V3d e(0, 0, 0);
    for (std::size_t i = 0; i < taps.texel.size(); ++i)
      e += texel_irradiance(tree, size, taps.texel[i]) * double(taps.weight[i]);
    return e;
  });
}

}  // namespace ivory
