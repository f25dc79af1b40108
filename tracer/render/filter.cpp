#include "tracer/render/filter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace ivory {

namespace {

constexpr int patch = 2;                // radius
constexpr float least_albedo = 0.02F;   // that light is divided by
constexpr int features = 8;             // albedo, normal, logarithm of depth, hit
constexpr float feature_scale = 0.6F;   // k_f of Rousselle 2013
constexpr float feature_floor = 1e-3F;  // tau: differences of squares under it are none
constexpr int error_radius = 5;         // over which e is averaged before it is believed

struct Candidate {
  float color_scale;  // k: how far light may differ, in standard deviations of its noise; 0: whatever it does
  int radius;         // at most that of the parameters
};
constexpr std::array candidates{Candidate{0.5F, 99}, Candidate{1, 99}, Candidate{0, 99}, Candidate{0, 2}};
constexpr std::size_t none = candidates.size();
constexpr std::size_t choices = candidates.size() + 1;

using Feature = std::array<float, features>;
using Halves = std::array<std::vector<Rgb>, 2>;

Feature feature_of(const FirstHit& first) {
  // Ratios of depths count; what is not hit differs by `hit`.
  const float depth = first.depth_m > 0 ? std::log(first.depth_m) : 0;
  return {first.albedo.x, first.albedo.y, first.albedo.z, first.normal.x,
          first.normal.y, first.normal.z, depth,          first.hit};
}

float square(float x) { return x * x; }
Rgb square(const Rgb& c) { return c * c; }

// Means over squares of 2 radius + 1 pixels, of those in the picture.
template <typename T>
std::vector<T> box_mean(const std::vector<T>& values, int width, int height, int radius) {
  std::vector<T> rows(values.size());
  std::vector<T> means(values.size());
  const auto at = [&](int x, int y) { return std::size_t(y) * std::size_t(width) + std::size_t(x); };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      T sum = values[at(x, y)] * 0.0F;
      const int begin = std::max(0, x - radius);
      const int end = std::min(width - 1, x + radius);
      for (int i = begin; i <= end; ++i) sum += values[at(i, y)];
      rows[at(x, y)] = sum * (1.0F / float(end - begin + 1));
    }
  }
  for (int y = 0; y < height; ++y) {
    const int begin = std::max(0, y - radius);
    const int end = std::min(height - 1, y + radius);
    for (int x = 0; x < width; ++x) {
      T sum = values[at(x, y)] * 0.0F;
      for (int i = begin; i <= end; ++i) sum += rows[at(x, i)];
      means[at(x, y)] = sum * (1.0F / float(end - begin + 1));
    }
  }
  return means;
}

struct Prepared {
  int width = 0;
  int height = 0;
  std::vector<Rgb> albedo;             // that light was divided by
  Halves light;                        // divided
  std::vector<Rgb> variance;           // of a half's
  std::vector<Feature> feature;        // of both halves
  std::vector<Feature> feature_slack;  // what squared differences are measured by
  std::vector<Feature> feature_variance;

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
  p.variance = box_mean(p.variance, p.width, p.height, 2);
  for (std::size_t i = 0; i < count; ++i) p.variance[i] *= 1 / float(sums.samples[i]);
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
    distance_.resize(padded);
    rows_.resize(padded);
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

  // distance_ becomes the mean of light_distance() over the patches around each pixel and the one at (dx, dy) from it.
  void average_distances(const std::vector<Rgb>& light, int dx, int dy) {
    const int left = std::max(px0_, -dx);
    const int right = std::min(px1_, p_.width - dx);
    const int top = std::max(py0_, -dy);
    const int bottom = std::min(py1_, p_.height - dy);
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x)
        rows_[padded(x, y)] = light_distance(p_, light, p_.at(x, y), p_.at(x + dx, y + dy));
    }
    std::vector<float>& sums = distance_;
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < right; ++x) {
        float sum = 0;
        const int begin = std::max(left, x - patch);
        const int end = std::min(right - 1, x + patch);
        for (int i = begin; i <= end; ++i) sum += rows_[padded(i, y)];
        sums[padded(x, y)] = sum / float(end - begin + 1);
      }
    }
    std::swap(distance_, rows_);
    for (int y = top; y < bottom; ++y) {
      const int begin = std::max(top, y - patch);
      const int end = std::min(bottom - 1, y + patch);
      for (int x = left; x < right; ++x) {
        float sum = 0;
        for (int i = begin; i <= end; ++i) sum += rows_[padded(x, i)];
        distance_[padded(x, y)] = sum / float(end - begin + 1);
      }
    }
  }

  void add(std::size_t half, int x, int y, int dx, int dy) {
    const std::size_t i = p_.at(x, y);
    const std::size_t j = p_.at(x + dx, y + dy);
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
  std::vector<float> distance_;
  std::vector<float> rows_;
  std::vector<Rgb> sums_;
  std::vector<float> weights_;
};

Filtered filter_all(const Prepared& p, const FilterParams& params) {
  Filtered filtered;
  for (Halves& halves : filtered) {
    for (std::vector<Rgb>& half : halves) half.resize(p.albedo.size());
  }
  constexpr int side = 32;
  tbb::task_arena arena(params.threads > 0 ? params.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range2d<int>(0, p.height, side, 0, p.width, side),
        [&](const tbb::blocked_range2d<int>& range) {
          Tile tile(p, range.cols().begin(), range.cols().end(), range.rows().begin(), range.rows().end());
          for (int dy = -params.radius; dy <= params.radius; ++dy) {
            for (int dx = -params.radius; dx <= params.radius; ++dx) tile.add(dx, dy);
          }
          tile.put(filtered);
        },
        tbb::simple_partitioner());
  });
  return filtered;
}

// e of the file's head, of each channel.
Rgb squared_error(const Rgb& a, const Rgb& b, const Rgb& filtered_a, const Rgb& filtered_b) {
  return (square(filtered_a - b) + square(filtered_b - a) - square(a - b)) * 0.5F -
         square(filtered_a - filtered_b) * 0.25F;
}

double mean_error(const FilmSums& sums, const Halves& filtered) {
  double squares = 0;
  double mean = 0;
  for (std::size_t i = 0; i < sums.pixel_count(); ++i) {
    const double a = double(luminance(sums.radiance(0, i)));
    const double b = double(luminance(sums.radiance(1, i)));
    const double fa = double(luminance(filtered[0][i]));
    const double fb = double(luminance(filtered[1][i]));
    squares += 0.5 * ((fa - b) * (fa - b) + (fb - a) * (fb - a) - (a - b) * (a - b)) - 0.25 * (fa - fb) * (fa - fb);
    mean += 0.5 * (a + b);
  }
  return mean > 0 ? std::sqrt(std::max(0.0, squares * double(sums.pixel_count()))) / mean : 0;
}

}  // namespace

FilteredFilm filter_film(const FilmSums& sums, const FilterParams& params) {
  const Prepared p = prepare(sums);
  const std::size_t count = sums.pixel_count();
  Filtered filtered = filter_all(p, params);
  Halves unfiltered;
  for (int half = 0; half < 2; ++half) {
    for (std::size_t i = 0; i < count; ++i) unfiltered[std::size_t(half)].push_back(sums.radiance(half, i));
  }
  std::vector<std::size_t> best(count, none);
  std::vector<float> least(count, 0);
  for (std::size_t k = 0; k < choices; ++k) {
    std::vector<float> error(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (k != none) {
        for (std::vector<Rgb>& half : filtered[k]) half[i] *= p.albedo[i];
      }
      const Halves& light = k == none ? unfiltered : filtered[k];
      const Rgb e = squared_error(unfiltered[0][i], unfiltered[1][i], light[0][i], light[1][i]);
      error[i] = e.x + e.y + e.z;
    }
    error = box_mean(error, p.width, p.height, error_radius);
    for (std::size_t i = 0; i < count; ++i) {
      if (k != 0 && !(error[i] < least[i])) continue;
      least[i] = error[i];
      best[i] = k;
    }
  }
  // Choices fade into each other.
  std::array<std::vector<float>, choices> share;
  for (std::size_t k = 0; k < choices; ++k) {
    share[k].resize(count);
    for (std::size_t i = 0; i < count; ++i) share[k][i] = best[i] == k ? 1.0F : 0.0F;
    share[k] = box_mean(share[k], p.width, p.height, 2);
  }
  Halves chosen;
  FilteredFilm result;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t half = 0; half < 2; ++half) {
      Rgb light = unfiltered[half][i] * share[none][i];
      for (std::size_t k = 0; k < candidates.size(); ++k) light += filtered[k][half][i] * share[k][i];
      chosen[half].push_back(light);
    }
    result.filtered_share += double(1 - share[none][i]) / double(count);
  }
  result.film = make_film(sums);
  result.unfiltered_error = mean_error(sums, unfiltered);
  result.error = mean_error(sums, chosen);
  if (!(result.error < result.unfiltered_error)) {
    result.error = result.unfiltered_error;
    result.filtered_share = 0;
    return result;
  }
  for (std::size_t i = 0; i < count; ++i) result.film.pixels[i] = (chosen[0][i] + chosen[1][i]) * 0.5F;
  return result;
}

}  // namespace ivory
