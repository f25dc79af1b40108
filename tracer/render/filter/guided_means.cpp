#include "tracer/render/filter/guided_means.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "tracer/render/filter/box_mean.h"

namespace ivory {

namespace {

constexpr int patch = 2;                // radius
constexpr float least_albedo = 0.02F;   // that light is divided by
constexpr int features = 8;             // albedo, normal, logarithm of depth, hit
constexpr float feature_scale = 0.6F;   // k_f of Rousselle 2013
constexpr float feature_floor = 1e-3F;  // tau: differences of squares under it are none

using Feature = std::array<float, features>;
using Halves = LightHalves;

Feature feature_of(const FirstHit& first) {
  // Ratios of depths count; what is not hit differs by `hit`.
  const float depth = first.depth_m > 0 ? std::log(first.depth_m) : 0;
  return {first.albedo.x, first.albedo.y, first.albedo.z, first.normal.x,
          first.normal.y, first.normal.z, depth,          first.hit};
}

float square(float x) { return x * x; }
Rgb square(const Rgb& c) { return c * c; }

struct Prepared {
  int width = 0;
  int height = 0;
  std::vector<Rgb> albedo;             // that light was divided by
  Halves light;                        // divided
  std::vector<Rgb> variance;           // of a half's
  std::vector<Feature> feature;        // of both halves
  std::vector<Feature> feature_slack;  // what squared differences are measured by
  std::vector<Feature> feature_variance;
  // Something that shines by itself is seen in the pixel: at a lamp's edge noise is of its outline, and no other pixel
  // knows that. Left as it is, and averaged into none.
  std::vector<bool> shines;

  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
};

Prepared prepare(const FilmSums& sums) {
  Prepared p;
  p.width = sums.width;
  p.height = sums.height;
  const std::size_t count = sums.pixel_count();
  p.albedo.reserve(count);
  for (std::vector<Rgb>& half : p.light) half.reserve(count);
  p.variance.resize(count);
  p.feature.resize(count);
  p.feature_variance.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const FirstHit a = sums.first_hit(0, i);
    const FirstHit b = sums.first_hit(1, i);
    p.shines.push_back(a.emits + b.emits > 0);
    Rgb albedo = (a.albedo + b.albedo) * 0.5F;
    for (int c = 0; c < 3; ++c) albedo[c] = std::max(albedo[c], least_albedo);
    p.albedo.push_back(albedo);
    for (int half = 0; half < 2; ++half) p.light[std::size_t(half)].push_back(sums.radiance(half, i) / albedo);
    // As of one sample, to be averaged with pixels that have more or fewer.
    p.variance[i] = square(p.light[0][i] - p.light[1][i]) * (0.5F * float(sums.samples[i]));
    const Feature fa = feature_of(a);
    const Feature fb = feature_of(b);
    for (std::size_t f = 0; f < features; ++f) {
      p.feature[i][f] = 0.5F * (fa[f] + fb[f]);
      p.feature_variance[i][f] = 0.25F * square(fa[f] - fb[f]);
    }
  }
  // Lamps' edges are not to be taken for noise of the walls beside them.
  std::vector<float> known(count);
  for (std::size_t i = 0; i < count; ++i) {
    known[i] = p.shines[i] ? 0.0F : 1.0F;
    p.variance[i] *= known[i];
  }
  p.variance = box_mean(p.variance, p.width, p.height, 2);
  known = box_mean(known, p.width, p.height, 2);
  for (std::size_t i = 0; i < count; ++i)
    p.variance[i] *= known[i] > 0 ? 1 / (known[i] * float(sums.samples[i])) : 0.0F;
  // Slopes: where a feature changes evenly, as on a curved surface, a step along it is no edge.
  p.feature_slack.resize(count);
  for (int y = 0; y < p.height; ++y) {
    for (int x = 0; x < p.width; ++x) {
      const Feature& left = p.feature[p.at(std::max(0, x - 1), y)];
      const Feature& right = p.feature[p.at(std::min(p.width - 1, x + 1), y)];
      const Feature& up = p.feature[p.at(x, std::max(0, y - 1))];
      const Feature& down = p.feature[p.at(x, std::min(p.height - 1, y + 1))];
      const Feature& here = p.feature[p.at(x, y)];
      for (std::size_t f = 0; f < features; ++f) {
        // The lesser of the two sides: at an edge one of them is even.
        const float along_x = std::min(std::abs(left[f] - here[f]), std::abs(right[f] - here[f]));
        const float along_y = std::min(std::abs(up[f] - here[f]), std::abs(down[f] - here[f]));
        const float slack =
            std::max({feature_floor, p.feature_variance[p.at(x, y)][f], square(along_x) + square(along_y)});
        p.feature_slack[p.at(x, y)][f] = 1 / (square(feature_scale) * slack);
      }
    }
  }
  return p;
}

float feature_distance(const Prepared& p, std::size_t i, std::size_t j) {
  float most = 0;
  for (std::size_t f = 0; f < features; ++f) {
    const float noise = p.feature_variance[i][f] + std::min(p.feature_variance[i][f], p.feature_variance[j][f]);
    most = std::max(most, (square(p.feature[i][f] - p.feature[j][f]) - noise) * p.feature_slack[i][f]);
  }
  return most;
}

// Of the light of one half at two pixels, in variances of their difference; 0 in the mean for equal ones.
float light_distance(const Prepared& p, const std::vector<Rgb>& light, std::size_t i, std::size_t j) {
  float sum = 0;
  for (int c = 0; c < 3; ++c) {
    const float vi = p.variance[i][c];
    const float vj = p.variance[j][c];
    sum += (square(light[i][c] - light[j][c]) - (vi + std::min(vi, vj))) / (1e-10F + vi + vj);
  }
  return sum / 3;
}

// Each candidate's light of both halves, divided by albedo.
using Filtered = std::array<Halves, candidates.size()>;

class Tile {
 public:
  Tile(const Prepared& p, int x0, int x1, int y0, int y1) : p_(p), x0_(x0), x1_(x1), y0_(y0), y1_(y1) {
    px0_ = std::max(0, x0 - patch);
    px1_ = std::min(p.width, x1 + patch);
    py0_ = std::max(0, y0 - patch);
    py1_ = std::min(p.height, y1 + patch);
    const auto padded = std::size_t(px1_ - px0_) * std::size_t(py1_ - py0_);
    raw_.resize(padded);
    rows_.resize(padded);
    distance_.resize(padded);
    sums_.assign(2 * candidates.size() * std::size_t(x1 - x0) * std::size_t(y1 - y0), Rgb(0, 0, 0));
    weights_.assign(sums_.size(), 0);
  }

  void add(int dx, int dy) {
    for (std::size_t half = 0; half < 2; ++half) {
      average_distances(p_.light[1 - half], dx, dy);
      for (int y = std::max(y0_, -dy); y < std::min(y1_, p_.height - dy); ++y) {
        for (int x = std::max(x0_, -dx); x < std::min(x1_, p_.width - dx); ++x) add(half, x, y, dx, dy);
      }
    }
  }

  void put(Filtered& filtered) const {
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      for (std::size_t half = 0; half < 2; ++half) {
        for (int y = y0_; y < y1_; ++y) {
          for (int x = x0_; x < x1_; ++x)
            filtered[k][half][p_.at(x, y)] = sums_[slot(k, half, x, y)] / weights_[slot(k, half, x, y)];
        }
      }
    }
  }

 private:
  std::size_t slot(std::size_t candidate, std::size_t half, int x, int y) const {
    return ((candidate * 2 + half) * std::size_t(y1_ - y0_) + std::size_t(y - y0_)) * std::size_t(x1_ - x0_) +
           std::size_t(x - x0_);
  }
  std::size_t padded(int x, int y) const {
    return std::size_t(y - py0_) * std::size_t(px1_ - px0_) + std::size_t(x - px0_);
  }

  // distance_ becomes the mean of light_distance() over the patches around each pixel and the one at (dx, dy) from it,
  // but for pairs that the pixel itself is in: what it is averaged with does not hang on its own light, with which the
  // result is to be compared.
  void average_distances(const std::vector<Rgb>& light, int dx, int dy) {
    const int left = std::max(px0_, -dx);
    const int right = std::min(px1_, p_.width - dx);
    const int top = std::max(py0_, -dy);
    const int bottom = std::min(py1_, p_.height - dy);
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x)
        raw_[padded(x, y)] = light_distance(p_, light, p_.at(x, y), p_.at(x + dx, y + dy));
    }
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) {
        float sum = 0;
        for (int i = std::max(left, x - patch); i <= std::min(right - 1, x + patch); ++i) sum += raw_[padded(i, y)];
        rows_[padded(x, y)] = sum;
      }
    }
    const auto length = [](int at, int begin, int end) {
      return std::min(end - 1, at + patch) - std::max(begin, at - patch) + 1;
    };
    const bool meets_itself = std::abs(dx) <= patch && std::abs(dy) <= patch;
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) {
        float sum = -raw_[padded(x, y)];
        for (int i = std::max(top, y - patch); i <= std::min(bottom - 1, y + patch); ++i) sum += rows_[padded(x, i)];
        int count = length(x, left, right) * length(y, top, bottom) - 1;
        const int ox = x - dx;
        const int oy = y - dy;
        if (meets_itself && ox >= left && ox < right && oy >= top && oy < bottom) {
          sum -= raw_[padded(ox, oy)];
          --count;
        }
        distance_[padded(x, y)] = count > 0 ? sum / float(count) : 0;
      }
    }
  }

  void add(std::size_t half, int x, int y, int dx, int dy) {
    const std::size_t i = p_.at(x, y);
    const std::size_t j = p_.at(x + dx, y + dy);
    if (i != j && (p_.shines[i] || p_.shines[j])) return;
    const float by_features = i == j ? 0 : feature_distance(p_, i, j);
    if (by_features > 8) return;  // e^-8: nothing
    const float by_light = std::max(0.0F, distance_[padded(x, y)]);
    const Rgb light = p_.light[half][j];
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const Candidate& candidate = candidates[k];
      if (std::max(std::abs(dx), std::abs(dy)) > candidate.radius) continue;
      const float scaled = candidate.color_scale > 0 ? by_light / square(candidate.color_scale) : 0;
      const float weight = std::exp(-std::max(by_features, scaled));
      sums_[slot(k, half, x, y)] += light * weight;
      weights_[slot(k, half, x, y)] += weight;
    }
  }

  const Prepared& p_;
  int x0_, x1_, y0_, y1_;
  int px0_, px1_, py0_, py1_;  // with patches
  std::vector<float> raw_;
  std::vector<float> rows_;
  std::vector<float> distance_;
  std::vector<Rgb> sums_;
  std::vector<float> weights_;
};

Filtered filter_all(const Prepared& p, int radius, int threads) {
  Filtered filtered;
  for (Halves& halves : filtered) {
    for (std::vector<Rgb>& half : halves) half.resize(p.albedo.size());
  }
  constexpr int side = 32;
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range2d<int>(0, p.height, side, 0, p.width, side),
        [&](const tbb::blocked_range2d<int>& range) {
          Tile tile(p, range.cols().begin(), range.cols().end(), range.rows().begin(), range.rows().end());
          for (int dy = -radius; dy <= radius; ++dy) {
            for (int dx = -radius; dx <= radius; ++dx) tile.add(dx, dy);
          }
          tile.put(filtered);
        },
        tbb::simple_partitioner());
  });
  return filtered;
}

}  // namespace

GuidedMeans guided_means(const FilmSums& sums, int radius, int threads) {
  Prepared p = prepare(sums);
  GuidedMeans means{filter_all(p, radius, threads), {}};
  for (LightHalves& halves : means.light) {
    for (std::vector<Rgb>& half : halves) {
      for (std::size_t i = 0; i < half.size(); ++i) half[i] *= p.albedo[i];
    }
  }
  means.shines = std::move(p.shines);
  return means;
}

}  // namespace ivory
