#include "grid/env/cube_from_latlong.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

// A meridian at azimuth a runs through a sequence of cube texels. With mu = sin(latitude), so that dw = dmu da, and
//
//   P(a, mu) = integral of L from mu to 1 along the meridian,
//
// a texel entered at mu_1 and left at mu_0 receives P(a, mu_0) - P(a, mu_1); integrated over a, each edge of the cube's
// raster contributes J = integral of P(a, mu(a)) da with a plus sign to the texel north of it and with a minus sign to
// the one south of it. On the bottom face the same from the other pole, Q = integral from -1 to mu, so that P and Q
// vanish where the face's texels meet at its pole.
//
// Every edge is an arc of a great circle. Measured from the azimuth of its greatest latitude A,
//
//   tan(latitude) = tan A cos(psi),   mu = sin(latitude),
//   integral of mu dpsi = asin(sin A sin psi).
//
// Within one column and one row of the lat-long map P is linear in mu, so J is a sum of closed forms over the pieces
// into which columns and rows cut the arc. Meridians (edges through a pole) have da = 0.

namespace ivory {

namespace {

class Meridians {
 public:
  Meridians(std::span<const Rgb> texels, int width, int height)
      : texels_(texels), width_(width), height_(height), blocks_(height / stride + 1) {
    for (int row = 0; row <= height; ++row)
      mu_.push_back(row == height ? -1.0 : std::cos(row * std::numbers::pi / height));
    // Differences of neighbouring cosines, with all their digits near the poles.
    const double step = std::numbers::pi / height;
    for (int row = 0; row < height; ++row) span_.push_back(2 * std::sin((row + 0.5) * step) * std::sin(0.5 * step));
    sums_.resize(std::size_t(width) * std::size_t(blocks_), V3d(0, 0, 0));
    totals_.resize(std::size_t(width), V3d(0, 0, 0));
    for (int row = 0; row < height; ++row) {
      for (int column = 0; column < width; ++column) {
        V3d& total = totals_[std::size_t(column)];
        if (row % stride == 0) sums_[std::size_t(row / stride) * std::size_t(width) + std::size_t(column)] = total;
        total += radiance(row, column) * span_[std::size_t(row)];
      }
    }
  }

  int width() const { return width_; }
  int height() const { return height_; }

  // Integral of P (or Q, `from_south`) over a piece of an arc within one texel: its extent in azimuth and the integral
  // of mu over it.
  V3d piece(int row, int column, double extent, double mu_integral, bool from_south) const {
    const V3d north = above(row, column);
    const V3d here = radiance(row, column);
    if (!from_south) return north * extent + here * (mu_[std::size_t(row)] * extent - mu_integral);
    const V3d south = totals_[std::size_t(column)] - north - here * span_[std::size_t(row)];
    return south * extent + here * (mu_integral - mu_[std::size_t(row) + 1] * extent);
  }

 private:
  V3d radiance(int row, int column) const {
    return V3d(texels_[std::size_t(row) * std::size_t(width_) + std::size_t(column)]);
  }

  // P at the upper edge of a texel: from the nearest stored sum above.
  V3d above(int row, int column) const {
    const int block = row / stride;
    V3d sum = sums_[std::size_t(block) * std::size_t(width_) + std::size_t(column)];
    for (int r = block * stride; r < row; ++r) sum += radiance(r, column) * span_[std::size_t(r)];
    return sum;
  }

  static constexpr int stride = 8;  // rows a stored sum: 3 bytes a texel instead of 24
  std::span<const Rgb> texels_;
  int width_;
  int height_;
  int blocks_;
  std::vector<double> mu_;
  std::vector<double> span_;
  std::vector<V3d> sums_;
  std::vector<V3d> totals_;
};

// A great circle by its northernmost (southernmost) point.
struct GreatCircle {
  double azimuth;
  double tan_latitude;
};

class ArcIntegral {
 public:
  ArcIntegral(const Meridians& map, const GreatCircle& circle, bool from_south)
      : map_(map), circle_(circle), from_south_(from_south) {
    const double t = circle.tan_latitude;
    sin_latitude_ = t / std::sqrt(1 + t * t);
    cos_latitude_ = 1 / std::sqrt(1 + t * t);
  }

  // J over psi from a to b, -pi/2 < a <= b < pi/2.
  V3d operator()(double a, double b) {
    sum_ = V3d(0, 0, 0);
    if (a < 0 && b > 0) {
      columns(a, 0);
      columns(0, b);
    } else {
      columns(a, b);
    }
    return sum_;
  }

 private:
  double column_of(double psi) const {
    return (circle_.azimuth + psi + std::numbers::pi) / (2 * std::numbers::pi) * map_.width();
  }

  int row_of(double psi) const {
    const double theta = std::numbers::pi / 2 - std::atan(circle_.tan_latitude * std::cos(psi));
    return std::clamp(int(theta / std::numbers::pi * map_.height()), 0, map_.height() - 1);
  }

  // asin(sin A sin psi), with all digits where the product is near one.
  double mu_integral(double psi) const {
    const double s = sin_latitude_ * std::sin(psi);
    const double c = sin_latitude_ * std::cos(psi);
    return std::atan2(s, std::sqrt(cos_latitude_ * cos_latitude_ + c * c));
  }

  // psi keeps its sign within [a, b], so latitude is monotone there.
  void columns(double a, double b) {
    int column = int(std::floor(column_of(a)));
    double from = a;
    while (from < b) {
      const double edge = 2 * std::numbers::pi * (column + 1) / map_.width() - std::numbers::pi - circle_.azimuth;
      const double to = std::min(edge, b);
      if (to > from) {
        rows(from, to, ((column % map_.width()) + map_.width()) % map_.width());
        from = to;
      }
      ++column;
    }
  }

  void rows(double a, double b, int column) {
    const int last = row_of(b);
    int row = row_of(a);
    const int step = last > row ? 1 : -1;
    double from = a;
    double from_integral = mu_integral(a);
    while (true) {
      double to = b;
      if (row != last) {
        const double latitude = std::numbers::pi / 2 - std::numbers::pi * (row + (step > 0 ? 1 : 0)) / map_.height();
        const double cosine = std::clamp(std::tan(latitude) / circle_.tan_latitude, 0.0, 1.0);
        to = std::clamp(std::copysign(std::acos(cosine), a + b), from, b);
      }
      const double to_integral = mu_integral(to);
      sum_ += map_.piece(row, column, to - from, to_integral - from_integral, from_south_);
      if (row == last) return;
      from = to;
      from_integral = to_integral;
      row += step;
    }
  }

  const Meridians& map_;
  GreatCircle circle_;
  bool from_south_;
  double sin_latitude_ = 0;
  double cos_latitude_ = 0;
  V3d sum_{0, 0, 0};
};

double wrapped(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

class CubeSums {
 public:
  CubeSums(const Meridians& map, int size)
      : map_(map), size_(size), flux_(std::size_t(cube_faces) * std::size_t(size) * std::size_t(size), V3d(0, 0, 0)) {}

  // +X, -X, +Z, -Z: edges along rows; those along columns are meridians.
  void add_side(int face, double azimuth) {
    for (int line = 0; line <= size_; ++line) {
      ArcIntegral arc(map_, {azimuth, -cube_edge(size_, line)}, false);
      for (int column = 0; column < size_; ++column) {
        const V3d j = arc(std::atan(cube_edge(size_, column)), std::atan(cube_edge(size_, column + 1)));
        if (line > 0) flux(face, line - 1, column) += j;
        if (line < size_) flux(face, line, column) -= j;
      }
    }
  }

  // +Y and -Y: edges along both. With the cotangent of latitude as radius r, s = -r sin a and t = -+ r cos a.
  void add_pole(int face) {
    const bool south = face == 3;
    const double sign = south ? 1 : -1;
    for (int line = 0; line <= size_; ++line) {
      const double d = cube_edge(size_, line);
      if (d == 0) continue;
      const double tangent = (south ? -1 : 1) / std::abs(d);
      ArcIntegral along_t(map_, {std::atan2(-d, 0.0), tangent}, south);
      ArcIntegral along_s(map_, {std::atan2(0.0, sign * d), tangent}, south);
      // The texel nearer the pole, and the one beyond the line.
      const int inner = d > 0 ? line - 1 : line;
      const int outer = d > 0 ? line : line - 1;
      for (int i = 0; i < size_; ++i) {
        const double e0 = cube_edge(size_, i);
        const double e1 = cube_edge(size_, i + 1);
        const V3d jt = between(along_t, std::atan2(-d, sign * e0) - std::atan2(-d, 0.0),
                               std::atan2(-d, sign * e1) - std::atan2(-d, 0.0));
        const V3d js = between(along_s, std::atan2(-e0, sign * d) - std::atan2(0.0, sign * d),
                               std::atan2(-e1, sign * d) - std::atan2(0.0, sign * d));
        flux(face, i, inner) += jt;
        flux(face, inner, i) += js;
        if (outer >= 0 && outer < size_) {
          flux(face, i, outer) -= jt;
          flux(face, outer, i) -= js;
        }
      }
    }
  }

  CubeMap averaged() {
    CubeMap cube{size_, std::vector<Rgb>(flux_.size())};
    for (int row = 0; row < size_; ++row) {
      for (int column = 0; column < size_; ++column) {
        const double solid_angle = cube_texel_solid_angle(size_, row, column);
        for (int face = 0; face < cube_faces; ++face) {
          const V3d mean = flux(face, row, column) / solid_angle;
          // Differences of sums leave some 1e-16 of the column's flux behind, of either sign.
          Rgb& texel = cube.texels[cube_index(size_, face, row, column)];
          texel = Rgb(std::max(0.0F, float(mean.x)), std::max(0.0F, float(mean.y)), std::max(0.0F, float(mean.z)));
        }
      }
    }
    return cube;
  }

 private:
  V3d& flux(int face, int row, int column) { return flux_[cube_index(size_, face, row, column)]; }

  static V3d between(ArcIntegral& arc, double psi0, double psi1) {
    const double a = wrapped(psi0);
    const double b = wrapped(psi1);
    return arc(std::min(a, b), std::max(a, b));
  }

  const Meridians& map_;
  int size_;
  std::vector<V3d> flux_;
};

}  // namespace

CubeMap cube_from_latlong(std::span<const Rgb> texels, int width, int height, int size) {
  assert(width > 0 && height > 0 && size > 0 && texels.size() == std::size_t(width) * std::size_t(height));
  const Meridians map(texels, width, height);
  CubeSums sums(map, size);
  // Azimuth atan2(-x, z): columns grow with it.
  sums.add_side(0, -std::numbers::pi / 2);
  sums.add_side(1, std::numbers::pi / 2);
  sums.add_pole(2);
  sums.add_pole(3);
  sums.add_side(4, 0);
  sums.add_side(5, std::numbers::pi);
  return sums.averaged();
}

}  // namespace ivory
