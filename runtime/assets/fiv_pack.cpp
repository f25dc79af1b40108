#include "runtime/assets/fiv_pack.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/fiv/light.h"

namespace ivory {

namespace {

constexpr int most_bins = 1024;  // OpenGL 3.3 takes textures at least so wide

int slab_count(const FivTable& table) { return table.hemispheres == 1 ? 3 : 9; }

// Which of a sample's numbers is channel c of slab s, or -1: see shaders/fiv/table.glsl.
int number_at(const FivTable& table, int s, int c) {
  if (s < 3 && c < 3) return 3 * s + c;
  if (table.hemispheres == 1) return -1;
  return s < 3 ? 9 + s : 4 * s + c;
}

}  // namespace

V3i fiv_box_of(const FivTable& table) {
  return {3 * (table.size.x + 1), slab_count(table) / 3 * table.size.y, table.size.z};
}

FivSphereBins make_fiv_bins(const std::string& name, const std::vector<float>& radii) {
  std::vector<double> x;
  x.reserve(radii.size());
  for (const float r : radii) x.push_back(std::log2(double(r)));
  const double range = x.back() - x.front();
  double narrowest = range;
  for (std::size_t k = 1; k < x.size(); ++k) narrowest = std::min(narrowest, x[k] - x[k - 1]);
  // A little narrower than the narrowest interval, against rounding.
  const double count = std::ceil(1.02 * range / narrowest);
  if (!(count <= most_bins)) {
    throw Error(name, fmt::format("has spheres closer to one another than a {}th of their range", most_bins),
                "bake it with fewer spheres");
  }
  FivSphereBins out;
  out.first = float(x.front());
  out.last = float(x.back());
  out.per_octave = float(count / range);
  std::size_t k = 0;  // the interval that the bin begins in
  for (int bin = 0; bin < int(count); ++bin) {
    const double begin = x.front() + range * bin / count;
    const double end = x.front() + range * (bin + 1) / count;
    while (k + 2 < x.size() && x[k + 1] <= begin) ++k;
    const double before = 1 / (x[k + 1] - x[k]);
    if (k + 2 < x.size() && x[k + 1] < end) {
      out.knots.emplace_back(float(x[k + 1]), float(k + 1), float(before), float(1 / (x[k + 2] - x[k + 1])));
    } else {
      out.knots.emplace_back(float(x[k]), float(k), float(before), float(before));
    }
  }
  return out;
}

void fill_fiv_box(const FivTable& table, const V3i& corner, const V3i& atlas_size, float factor,
                  std::vector<V4f>& atlas) {
  const auto numbers = 3 * std::size_t(fiv_function_count(table.hemispheres));
  for (int s = 0; s < slab_count(table); ++s) {
    for (int k = 0; k < table.size.z; ++k) {
      const float level = factor / fiv_falloff(table.radii[std::size_t(k)]);
      for (int p = 0; p < table.size.y; ++p) {
        for (int a = 0; a <= table.size.x; ++a) {
          const std::size_t sample =
              (std::size_t(k) * std::size_t(table.size.y) + std::size_t(p)) * std::size_t(table.size.x) +
              std::size_t(a % table.size.x);
          const V3i at = corner + V3i(s % 3 * (table.size.x + 1) + a, s / 3 * table.size.y + p, k);
          V4f& texel =
              atlas[(std::size_t(at.z) * std::size_t(atlas_size.y) + std::size_t(at.y)) * std::size_t(atlas_size.x) +
                    std::size_t(at.x)];
          for (int c = 0; c < 4; ++c) {
            const int number = number_at(table, s, c);
            texel[unsigned(c)] = number < 0 ? 0 : table.values[sample * numbers + std::size_t(number)] * level;
          }
        }
      }
    }
  }
}

float largest_fiv_level(const FivTable& table) {
  const std::size_t sphere = table.values.size() / std::size_t(table.size.z);
  float largest = 0;
  for (std::size_t i = 0; i < table.values.size(); ++i)
    largest = std::max(largest, std::abs(table.values[i]) / fiv_falloff(table.radii[i / sphere]));
  return largest;
}

FivTableBlock describe_fiv(const FivTable& table, const V3i& corner, const FivSphereBins& bins, float scale, int row) {
  FivTableBlock block;
  block.origin = {float(corner.x), float(corner.y), float(corner.z), float(slab_count(table))};
  block.samples = {float(table.size.x), float(table.size.y), float(table.size.z), table.coverage};
  block.bins = {bins.first, bins.last, bins.per_octave, float(bins.knots.size())};
  block.scale = {scale, most_hidden(table), float(row), 0};
  for (int s = 0; s < 9; ++s) {
    for (int c = 0; c < 4; ++c) {
      const int number = s < slab_count(table) ? number_at(table, s, c) : -1;
      block.total[std::size_t(s)][unsigned(c)] = number < 0 ? 0 : table.total[std::size_t(number)];
    }
  }
  return block;
}

}  // namespace ivory
