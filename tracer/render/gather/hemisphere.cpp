#include "tracer/render/gather/hemisphere.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

// With radiance L_c constant over each cell c of the hemisphere, moving by delta along the surface changes E by what
// the cells' edges sweep over: an edge at direction w and distance d, whose normal to the left is nu, moves by -delta /
// d,
//
//   grad E = sum_edges (L_left - L_right) cos theta nu dl / d                                         along the
//   surface.
//
// Where light changes from one cell to the next, something ends at the nearer of two surfaces, or one surface changes:
// the edge stands in space there (Ward & Heckbert, "Irradiance Gradients", 1992, eq. 9 to 12). From a fixed edge y -
// e/2 to y + e/2, seen along r = y - x,  cos theta nu dl / d = (n.r) (r x e) / |r|^4, of which n.r does not change
// along the surface; derived by x once more, its symmetric part is
//
//   Hessian E = sum_edges (L_left - L_right) 4 cos theta sym(nu dl w^T) / d^2
//
// (Schwarzhaupt, Jensen & Jarosz, "Practical Hessian-Based Error Control for Irradiance Caching", 2012, do so by the
// form factors of triangles). The horizon is an edge, too, which no movement along the surface moves.

namespace ivory {

namespace {

constexpr int channels = 3;

struct CoarseCell {
  Rgb radiance{0, 0, 0};
  float inverse_m = 0;  // mean of the rays that meet something
  int hits = 0;
};
using CoarseCells = std::array<std::array<CoarseCell, coarse_sectors>, coarse_rings>;

CoarseCells coarse_cells(const Hemisphere& h) {
  CoarseCells coarse;
  const float share = 1.0F / float(h.split * h.split);
  for (int j = 0; j < h.rings(); ++j) {
    for (int k = 0; k < h.sectors(); ++k) {
      CoarseCell& cell = coarse[std::size_t(j / h.split)][std::size_t(k / h.split)];
      cell.radiance += h.at(j, k).radiance * share;
      cell.inverse_m += h.at(j, k).inverse_m;
      cell.hits += h.at(j, k).inverse_m > 0 ? 1 : 0;
    }
  }
  for (auto& ring : coarse) {
    for (CoarseCell& cell : ring) cell.inverse_m /= float(std::max(1, cell.hits));
  }
  return coarse;
}

struct Derivatives {
  V2f gradient[channels] = {V2f(0, 0), V2f(0, 0), V2f(0, 0)};
  float xx = 0, xy = 0, yy = 0;  // of luminance

  // An edge in the direction of tangential part w; `swept` is cos theta nu dl along the surface.
  void add(const CoarseCell& left, const CoarseCell& right, const V2f& w, const V2f& swept) {
    const float inverse_m = edge_inverse_m(left.inverse_m, right.inverse_m);
    if (inverse_m == 0) return;
    const Rgb step = left.radiance - right.radiance;
    for (int c = 0; c < channels; ++c) gradient[c] += swept * (step[c] * inverse_m);
    const float weight = 4 * luminance(step) * inverse_m * inverse_m;
    xx += weight * swept.x * w.x;
    yy += weight * swept.y * w.y;
    xy += weight * (swept.x * w.y + swept.y * w.x) / 2;
  }

  // Of one surface that goes on, in the middle; of two, the nearer one's.
  static float edge_inverse_m(float a, float b) {
    const float larger = std::max(a, b);
    return std::min(a, b) > larger / 2 ? (a + b) / 2 : larger;
  }
};

float ring_sine(int ring, int rings) { return std::sqrt(float(ring) / float(rings)); }
V2f azimuth(double turns) { return V2f(on_unit_circle(turns)); }

Derivatives derive(const CoarseCells& cells) {
  Derivatives out;
  const float width = 2 * azimuth(0.5 / coarse_sectors).y;  // integral of the azimuth's vector over a sector
  for (int k = 0; k < coarse_sectors; ++k) {
    const V2f middle = azimuth((k + 0.5) / coarse_sectors);
    const V2f end = azimuth(double(k + 1) / coarse_sectors);
    const int next = (k + 1) % coarse_sectors;
    for (int j = 0; j < coarse_rings; ++j) {
      const auto& here = cells[std::size_t(j)];
      const float inner = ring_sine(j, coarse_rings);
      const float outer = ring_sine(j + 1, coarse_rings);
      // Between rings, towards larger azimuths: the inner cell lies to the left, nu is -cos theta along the surface.
      if (j > 0) {
        out.add(cells[std::size_t(j - 1)][std::size_t(k)], here[std::size_t(k)], middle * inner,
                middle * (-(1 - inner * inner) * inner * width));
      }
      // Between this sector and the next, outwards: the next lies to the left, and cos theta dtheta is d sin theta.
      out.add(here[std::size_t(next)], here[std::size_t(k)], end * ((inner + outer) / 2),
              V2f(-end.y, end.x) * (outer - inner));
    }
  }
  return out;
}

}  // namespace

int split_for(int rays) {
  return std::max(1, int(std::lround(std::sqrt(double(rays) / (coarse_rings * coarse_sectors)))));
}

Hemisphere gather_hemisphere(const V3f& normal, int split, RandomStream& random,
                             const std::function<GatheredLight(const V3f&, RandomStream&)>& light) {
  // A ray's direction, coverage, and the light (which, where on it) at its hit are spread evenly over all rays.
  constexpr std::uint32_t even_calls = 5;
  Hemisphere h{.frame = make_shading_frame(normal), .split = split, .cells = {}};
  h.cells.resize(std::size_t(rays_of(split)));
  const std::uint32_t key = random.next_u32();
  std::size_t i = 0;
  for (int j = 0; j < h.rings(); ++j) {
    for (int k = 0; k < h.sectors(); ++k, ++i) {
      random.begin_sample(std::uint32_t(i), key, even_calls);
      const V2f u = random.next2();
      const float sine2 = (float(j) + u.x) / float(h.rings());
      const V2f around = azimuth((double(k) + double(u.y)) / h.sectors()) * std::sqrt(sine2);
      const V3f w(around.x, around.y, std::sqrt(std::max(0x1p-24F, 1 - sine2)));
      h.cells[i] = light(h.frame.to_world(w), random);
    }
  }
  return h;
}

HemisphereIrradiance irradiance_of(const Hemisphere& h) {
  HemisphereIrradiance out;
  const int rings = h.rings();
  const int sectors = h.sectors();
  std::fill(std::begin(out.free_inverse_m), std::end(out.free_inverse_m), 0.0F);
  double sum[channels] = {0, 0, 0};
  double inverse_m = 0;
  V2f across[channels] = {V2f(0, 0), V2f(0, 0), V2f(0, 0)};
  // Light of a cell along the surface: integral of sin^2 theta dtheta, times that of the azimuth's vector.
  const double half_turn = 0.5 / sectors;
  const float width = 2 * azimuth(half_turn).y;
  // What blocks the way to a point of the surface nearby stands on it: rays lower than 30 degrees over it meet that.
  constexpr float low_sine2 = 0.75F;
  float theta0 = 0;
  for (int j = 0; j < rings; ++j) {
    const float theta1 = j + 1 == rings ? pi / 2 : std::asin(ring_sine(j + 1, rings));
    const auto antiderivative = [](float theta) { return (theta - std::sin(theta) * std::cos(theta)) / 2; };
    const float lever = (antiderivative(theta1) - antiderivative(theta0)) * width;
    const float sine2 = (float(j) + 0.5F) / float(rings);
    theta0 = theta1;
    for (int k = 0; k < sectors; ++k) {
      const GatheredLight& cell = h.at(j, k);
      inverse_m += double(cell.inverse_m);
      const V2f a = azimuth((k + 0.5) / sectors);
      for (int c = 0; c < channels; ++c) {
        sum[c] += double(cell.radiance[c]);
        across[c] += a * (lever * cell.radiance[c]);
      }
      if (sine2 > low_sine2) {
        float& free = out.free_inverse_m[k / h.split];
        free = std::max(free, cell.inverse_m / std::sqrt(sine2));
      }
    }
  }
  const double rays = double(h.cells.size());
  const Derivatives d = derive(coarse_cells(h));
  for (int c = 0; c < channels; ++c) {
    out.e[c] = float(double(pi) * sum[c] / rays);
    out.vector[c] = h.frame.to_world({across[c].x, across[c].y, out.e[c]});
    out.gradient[c] = h.frame.to_world({d.gradient[c].x, d.gradient[c].y, 0});
  }
  const float mean = (d.xx + d.yy) / 2;
  const float apart = std::sqrt((d.xx - d.yy) * (d.xx - d.yy) / 4 + d.xy * d.xy);
  out.bend = std::abs(mean) + apart;
  out.harmonic_distance_m = inverse_m > 0 ? float(rays / inverse_m) : std::numeric_limits<float>::infinity();
  return out;
}

}  // namespace ivory
