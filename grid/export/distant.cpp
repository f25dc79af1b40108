#include "grid/export/distant.h"

#include <cmath>

#include "grid/env/sh9.h"
#include "grid/export/least_squares.h"

namespace ivory {

namespace {

// A grid of normals, each with its solid angle: the map's own texels, or more of them where it has few.
constexpr int least_size = 16;

template <typename Visit>
void for_normals(int size, const Visit& visit) {
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column)
        visit(cube_texel_direction(size, face, row, column), cube_texel_solid_angle(size, row, column));
    }
  }
}

}  // namespace

DistantLight distant_light(const Sh9& sh, const Metadata& metadata) {
  const Sh9MatricesF matrices = to_float(sh9_matrices(sh));
  DistantLight light;
  light.sh = sh;
  light.e = [matrices](const V3f& n) { return irradiance(matrices, n); };
  light.metadata = metadata;
  return light;
}

DistantLight distant_light(const DifMap& map) {
  DistantLight light;
  light.e = [map](const V3f& n) { return irradiance(map, n); };
  light.size = map.e.size;
  light.metadata = map.metadata;
  const int size = std::max(map.e.size, least_size);
  LeastSquares<9> fit;
  for_normals(size, [&](const V3f& n, double weight) { fit.add(sh9_polynomials(V3d(n)), V3d(light.e(n)), weight); });
  const std::array<V3d, 9> solution = fit.solve();
  for (std::size_t i = 0; i < 9; ++i) light.sh.coefficients[i] = solution[i] / (sh9_factor[i] * sh9_cosine[i]);
  const Sh9MatricesF matrices = to_float(sh9_matrices(light.sh));
  double squares = 0;
  double sum = 0;
  for_normals(size, [&](const V3f& n, double weight) {
    const Rgb e = light.e(n);
    squares += weight * double((irradiance(matrices, n) - e).length2());
    sum += weight * double(e.x + e.y + e.z);
  });
  // Over 4 pi sr and three channels, both.
  const double whole = 4 * double(pi) * 3;
  light.sh_loss = sum > 0 ? std::sqrt(squares / whole) / (sum / whole) : 0;
  return light;
}

std::vector<Rgb> gpu_cube(int size, const std::function<Rgb(const V3f& d)>& texel) {
  // Vulkan 1.3 section 16.5.4, table of cube map face selection: where s (columns) and t (rows) grow.
  struct Axes {
    V3f forward, s, t;
  };
  const std::array<Axes, 6> axes{{{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                  {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                  {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                  {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                                  {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},
                                  {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}}};
  std::vector<Rgb> out;
  out.reserve(std::size_t(6) * std::size_t(size) * std::size_t(size));
  for (const Axes& face : axes) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const float s = float(2 * column + 1 - size) / float(size);
        const float t = float(2 * row + 1 - size) / float(size);
        out.push_back(texel((face.forward + face.s * s + face.t * t).normalized()));
      }
    }
  }
  return out;
}

Rgb mean_radiance(const DistantLight& light) {
  V3d sum(0, 0, 0);
  for_normals(least_size, [&](const V3f& n, double weight) { sum += V3d(light.e(n)) * weight; });
  return Rgb(sum / (4 * double(pi) * double(pi)));
}

}  // namespace ivory
