// FIV tables without a bake: a few lights and an occluder that hides each of them more or less, by smooth functions
// with noise on top, so that every sample differs from its neighbours and the six hemispheres are those of one and the
// same light.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "grid/env/difmap.h"
#include "grid/fiv/light.h"
#include "tests/support/runtime_twin.h"

namespace ivory {

struct SyntheticSky {
  std::vector<V3f> w;
  std::vector<Rgb> power;  // lux, facing the light
};

inline SyntheticSky synthetic_sky(unsigned seed) {
  std::mt19937 random(seed);
  SyntheticSky sky;
  for (int i = 0; i < 24; ++i) {
    sky.w.push_back(i == 0 ? V3f(0.4F, 0.8F, 0.3F).normalized() : random_direction(random));
    const float strength = i == 0 ? 20.0F : 1.0F;
    sky.power.push_back(Rgb(1 + float(random() % 8), 1 + float(random() % 8), 1 + float(random() % 8)) * strength);
  }
  return sky;
}

inline FivMoments synthetic_moments(const SyntheticSky& sky, const auto& share) {
  FivMoments out{};
  for (std::size_t k = 0; k < sky.w.size(); ++k) {
    const auto f = eval(Basis::vectors, sky.w[k]);
    for (std::size_t i = 0; i < 12; ++i) {
      for (std::size_t c = 0; c < 3; ++c) out[3 * i + c] += f[i] * sky.power[k][unsigned(c)] * share(sky.w[k]);
    }
  }
  return out;
}

inline FivTable synthetic_table(const SyntheticSky& sky, const V3i& size, int hemispheres, std::vector<float> radii,
                                unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> noise(0.6F, 1.0F);
  FivTable table;
  table.size = size;
  table.hemispheres = hemispheres;
  table.radii = std::move(radii);
  table.coverage = 0.4F + 0.1F * float(seed % 5);
  const auto numbers = std::size_t(3 * fiv_function_count(hemispheres));
  for (int k = 0; k < size.z; ++k) {
    for (int p = 0; p < size.y; ++p) {
      FivMoments pole{};
      for (int a = 0; a < size.x; ++a) {
        const V3f towards = -V3f(fiv_sample_direction(size, a, p));
        const float falloff = fiv_falloff(table.radii[std::size_t(k)]);
        const float level = noise(random) * table.coverage;
        FivMoments here = synthetic_moments(sky, [&](const V3f& w) {
          const float off = 1 - w.dot(towards);
          return level * falloff * std::exp(-2 * off);
        });
        // All azimuths hold the same at the poles.
        if (p == 0 || p == size.y - 1) here = pole = a == 0 ? here : pole;
        table.values.insert(table.values.end(), here.begin(), here.begin() + std::ptrdiff_t(numbers));
      }
    }
  }
  table.total = synthetic_moments(sky, [](const V3f&) { return 1.0F; });
  if (hemispheres == 1) std::fill(table.total.begin() + 9, table.total.end(), 0.0F);
  return table;
}

// From `first` to `last`, unevenly, as a pilot bake would place them.
inline std::vector<float> uneven_radii(int count, float first, float last) {
  std::vector<float> out;
  for (int i = 0; i < count; ++i) {
    const float t = float(i) / float(count - 1);
    out.push_back(first * std::pow(last / first, t + 0.1F * std::sin(2 * pi * t)));
  }
  return out;
}

// Small, even and odd, one and six hemispheres, few and many spheres.
inline std::vector<FivTable> synthetic_tables(const SyntheticSky& sky) {
  std::vector<FivTable> out;
  out.push_back(synthetic_table(sky, {32, 17, 15}, 6, uneven_radii(15, 0.35F, 8), 1));
  out.push_back(synthetic_table(sky, {3, 2, 2}, 1, {0.5F, 2}, 2));
  out.push_back(synthetic_table(sky, {64, 33, 30}, 6, uneven_radii(30, 0.2F, 8), 3));
  out.push_back(synthetic_table(sky, {47, 12, 5}, 1, {0.9F, 0.95F, 1.7F, 3, 20}, 4));
  out.push_back(synthetic_table(sky, {3, 2, 2}, 6, {1, 1.5F}, 5));
  return out;
}

inline DifMap synthetic_difmap(const SyntheticSky& sky, int size) {
  DifMap map;
  map.e.size = size;
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        Rgb e(0, 0, 0);
        for (std::size_t k = 0; k < sky.w.size(); ++k)
          e += sky.power[k] * std::max(0.0F, sky.w[k].dot(cube_texel_direction(size, face, row, column)));
        map.e.texels.push_back(e);
      }
    }
  }
  return map;
}

}  // namespace ivory
