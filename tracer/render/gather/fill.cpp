#include "tracer/render/gather/fill.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace ivory {

namespace {

// Records wanted where those that there are have less weight than this together: more than is asked for when the cache
// is read, so that what is read has no edge where a record ends.
constexpr float enough_coverage = 0.5F;
// Records made at a time, side by side; each knows of those of the batches before. Whatever the threads.
constexpr std::size_t batch = 64;
constexpr int coarsest_step = 32;  // pixels
constexpr int tile = 16;           // pixels
// Rays for records in a tile, as a share of those that its samples would gather, or that 64 rays a pixel would: what no
// record serves is as noisy as its few samples leave it, beside what has no noise.
constexpr double share_of_rays = 0.5;
constexpr int least_rays_a_pixel = 64;
// Of pixels, the least and the most radius of a record.
constexpr float least_pixels = 1.5F;
constexpr float most_pixels = 80;

struct Candidate {
  int x = 0, y = 0;
  Surface surface;
  float pixel_m = 0;  // the side of a pixel there, across the view
};

class Filler {
 public:
  Filler(const LitScene& lit, const IndirectLight& indirect, const View& view, const GatherParams& gather,
         const CacheParams& params)
      : lit_(lit),
        indirect_(indirect),
        view_(view),
        gather_(gather),
        params_(params),
        split_(split_for(params.rays)),
        tiles_across_((view.width + tile - 1) / tile),
        rays_in_tile_(std::size_t(tiles_across_) * std::size_t((view.height + tile - 1) / tile), 0),
        filled_{IrradianceCache(lit.intersector.center(), lit.intersector.radius_m())} {
    most_rays_in_tile_ =
        std::int64_t(share_of_rays * tile * tile * std::max(params.samples * params.gather_rays, least_rays_a_pixel));
  }

  FilledCache fill() {
    std::vector<Imath::V2i> pixels;
    std::int64_t seen = 0;
    std::int64_t uncovered = 0;
    const double all = double(view_.width) * double(view_.height);
    double done = 0;
    for (int step = coarsest_step; step >= 1; step /= 2) {
      for (int y = 0; y < view_.height; y += step) {
        for (int x = 0; x < view_.width; x += step) {
          const bool coarser = step < coarsest_step && x % (2 * step) == 0 && y % (2 * step) == 0;
          if (!coarser) pixels.emplace_back(x, y);
          const bool last = y + step >= view_.height && x + step >= view_.width;
          if (pixels.size() < chunk && !last) continue;
          const auto [with_surface, left] = look_at(pixels);
          seen += with_surface;
          uncovered += left;
          done += double(pixels.size());
          if (params_.progress) params_.progress(done / all);
          pixels.clear();
        }
      }
    }
    filled_.uncovered = seen > 0 ? double(uncovered) / double(seen) : 0;
    return std::move(filled_);
  }

 private:
  static constexpr std::size_t chunk = 8192;

  std::optional<Candidate> candidate_at(const Imath::V2i& at) const {
    Ray ray = make_ray(view_, V2f(float(at.x) + 0.5F, float(at.y) + 0.5F));
    RandomStream random(params_.seed, StreamPurpose::gather, index_of(at.x, at.y));
    ray.coverage_seed = random.next_u32();
    const std::optional<Hit> hit = lit_.intersector.closest(ray);
    if (!hit) return std::nullopt;
    Candidate c{at.x, at.y, make_surface(*lit_.scene, ray, *hit)};
    const float across_m = 2 * view_.right.length() / float(view_.width);
    c.pixel_m = view_.perspective ? across_m * (c.surface.p - view_.origin).dot(view_.forward) : across_m;
    return c;
  }

  std::uint64_t index_of(int x, int y) const {
    return std::uint64_t(y) * std::uint64_t(view_.width) + std::uint64_t(x);
  }

  // How many of the pixels see a surface, and how many of those stay without records.
  std::pair<std::int64_t, std::int64_t> look_at(const std::vector<Imath::V2i>& pixels) {
    std::vector<std::optional<Candidate>> candidates(pixels.size());
    std::vector<float> covered(pixels.size(), 0);
    tbb::parallel_for(std::size_t(0), pixels.size(), [&](std::size_t i) {
      candidates[i] = candidate_at(pixels[i]);
      if (candidates[i]) covered[i] = filled_.cache.coverage(candidates[i]->surface);
    });
    std::vector<const Candidate*> open;
    std::int64_t seen = 0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (!candidates[i]) continue;
      ++seen;
      const bool dark = is_black(candidates[i]->surface.diffuse_albedo);
      if (covered[i] < enough_coverage && !dark) open.push_back(&*candidates[i]);
    }
    // Neighbours are made far from each other, so that those of one batch seldom cover one another.
    const std::size_t stride = coprime_stride(open.size());
    std::vector<const Candidate*> chosen;
    std::int64_t left = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const Candidate& c = *open[(i * stride) % open.size()];
      const float coverage = filled_.cache.coverage(c.surface);
      if (coverage >= enough_coverage) continue;
      std::int64_t& rays =
          rays_in_tile_[std::size_t(c.y / tile) * std::size_t(tiles_across_) + std::size_t(c.x / tile)];
      if (rays + rays_of(split_) > most_rays_in_tile_) {
        if (coverage < IrradianceCache::least_coverage) ++left;
        continue;
      }
      rays += rays_of(split_);
      chosen.push_back(&c);
      if (chosen.size() == batch) make_records(chosen);
    }
    make_records(chosen);
    return {seen, left};
  }

  static std::size_t coprime_stride(std::size_t n) {
    if (n < 3) return 1;
    auto stride = std::size_t(double(n) * 0.381966);
    while (std::gcd(stride, n) != 1) ++stride;
    return stride;
  }

  void make_records(std::vector<const Candidate*>& chosen) {
    std::vector<Hemisphere> hemispheres(chosen.size());
    tbb::parallel_for(std::size_t(0), chosen.size(), [&](std::size_t i) { hemispheres[i] = gather(*chosen[i]); });
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const Candidate& c = *chosen[i];
      const RecordLimits limits{.error = params_.error,
                                .floor_lux = records_ > 0 ? float(luminances_ / double(records_)) : 0,
                                .least_radius_m = least_pixels * c.pixel_m,
                                .most_radius_m = most_pixels * c.pixel_m};
      const IrradianceRecord record = make_record(c.surface.p, c.surface.ng, hemispheres[i], limits);
      luminances_ += double(luminance(record.e));
      ++records_;
      filled_.rays += rays_of(split_);
      filled_.cache.add(record, limits.least_radius_m);
    }
    chosen.clear();
  }

  Hemisphere gather(const Candidate& c) const {
    RandomStream random(params_.seed, StreamPurpose::gather, index_of(c.x, c.y));
    return gather_hemisphere(c.surface.ng, split_, random, [&](const V3f& w, RandomStream& r) {
      return gather_light(lit_, indirect_, spawn_ray(c.surface, w, r.next_u32()), gather_, r);
    });
  }

  const LitScene& lit_;
  const IndirectLight& indirect_;
  const View& view_;
  const GatherParams& gather_;
  const CacheParams& params_;
  int split_;
  int tiles_across_;
  std::vector<std::int64_t> rays_in_tile_;
  std::int64_t most_rays_in_tile_ = 0;
  double luminances_ = 0;
  std::int64_t records_ = 0;
  FilledCache filled_;
};

}  // namespace

FilledCache fill_cache(const LitScene& lit, const IndirectLight& indirect, const View& view, const GatherParams& gather,
                       const CacheParams& params) {
  tbb::task_arena arena(params.threads > 0 ? params.threads : tbb::task_arena::automatic);
  return arena.execute([&] { return Filler(lit, indirect, view, gather, params).fill(); });
}

}  // namespace ivory
