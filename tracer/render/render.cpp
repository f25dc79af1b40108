#include "tracer/render/render.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <utility>

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "tracer/bsdf/bsdf.h"

namespace ivory {

namespace {

// Random numbers of a sample that are spread evenly over a pixel's samples: position, coverage, the
// light (which, where on it) and the BSDF sample of the first surface. Beyond those a path's dimensions are
// too many for the samples to cover.
constexpr std::uint32_t even_calls = 7;
// Samples from one look at whether to pause to the next.
constexpr std::uint32_t samples_a_look = 16;
constexpr std::uint32_t first_round = 16;  // samples of each half, where as many are asked for everywhere

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

// Whether to pause, as one thread at a time asks and all hear.
class Pause {
 public:
  Pause(const RenderParams& params, Clock::time_point deadline) : params_(params), deadline_(deadline) {}
  PauseWish wish() {
    if (wish_.load(std::memory_order_relaxed) == PauseWish::at_once) return PauseWish::at_once;
    const Clock::time_point now = Clock::now();
    if (now.time_since_epoch().count() < next_look_.load(std::memory_order_relaxed)) return wish_;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock()) return wish_;
    next_look_ = (now + std::chrono::milliseconds(10)).time_since_epoch().count();
    if (now >= deadline_) out_of_time_ = true;
    const PauseWish asked = params_.wants_pause ? params_.wants_pause() : PauseWish::none;
    if (out_of_time_ || asked == PauseWish::at_once) {
      wish_ = PauseWish::at_once;
    } else if (asked == PauseWish::soon) {
      wish_ = PauseWish::soon;
    }
    return wish_;
  }
  bool out_of_time() const { return out_of_time_; }
  void reset() { wish_ = PauseWish::none; }

 private:
  const RenderParams& params_;
  Clock::time_point deadline_;
  std::atomic<PauseWish> wish_{PauseWish::none};
  bool out_of_time_ = false;
  std::mutex mutex_;
  std::atomic<Clock::rep> next_look_{0};
};

FirstHit first_hit(const LitScene& lit, const View& view, const Ray& ray) {
  FirstHit first;
  const std::optional<Hit> hit = lit.intersector.closest(ray);
  if (!hit) return first;
  const Surface surface = make_surface(*lit.scene, ray, *hit);
  // f0 is what the microfacet lobe reflects of most of what is seen, all but grazing angles.
  const Rgb albedo = surface.diffuse_albedo + surface.specular_f0;
  first.emits = is_black(surface.emission) ? 0.0F : 1.0F;
  if (first.emits == 0) first.albedo = albedo;
  first.normal = surface.ns;
  first.depth_m = hit->t * ray.direction.dot(view.forward);
  first.hit = 1;
  return first;
}

// Later than that is no time_point.
bool is_timed(const AdaptiveParams& adaptive) { return adaptive.max_seconds < 1e9; }

class FilmRenderer {
 public:
  FilmRenderer(const View& view, const RenderParams& params, const RadianceFunction& radiance)
      : view_(view),
        params_(params),
        radiance_(radiance),
        pausable_(params.wants_pause || (params.adaptive && is_timed(*params.adaptive))) {
    sums_ = params.begin_with ? *params.begin_with
                              : make_film_sums(view.width, view.height, halves(), params.first_hits_of != nullptr);
  }

  Film run() {
    const Clock::time_point start = Clock::now();
    const double before_s = sums_.seconds;
    const AdaptiveParams* adaptive = params_.adaptive ? &*params_.adaptive : nullptr;
    const bool timed = adaptive != nullptr && is_timed(*adaptive);
    Clock::time_point deadline = Clock::time_point::max();
    if (timed)
      deadline =
          start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(adaptive->max_seconds));
    bool out_of_time = false;
    while (!out_of_time) {
      if (sums_.samples == sums_.goal) {
        std::vector<std::uint32_t> goal = next_goal(timed ? adaptive->max_seconds : 0, seconds_since(start));
        if (goal.empty()) break;
        sums_.goal = std::move(goal);
        ++sums_.rounds;
      }
      // What every pixel needs is not left out.
      Pause pause(params_, sums_.rounds > 1 ? deadline : Clock::time_point::max());
      while (!run_round(pause)) {
        sums_.seconds = before_s + seconds_since(start);
        out_of_time = pause.out_of_time();
        if (out_of_time) break;
        params_.pause(sums_);
        pause.reset();
      }
      sums_.seconds = before_s + seconds_since(start);
      out_of_time = out_of_time || (timed && Clock::now() >= deadline);
    }
    if (params_.progress) params_.progress(1);
    return finish(out_of_time);
  }

 private:
  int halves() const { return params_.adaptive || params_.halves ? 2 : 1; }

  // Of each half; empty: the picture is done.
  std::vector<std::uint32_t> next_goal(double max_seconds, double seconds) {
    if (!params_.adaptive) {
      const auto asked = std::uint32_t((params_.samples + halves() - 1) / halves());
      const std::uint32_t now = sums_.samples.front();
      set_progress(double(now), double(asked));
      if (now == asked) return {};
      const std::uint32_t next = now == 0 ? std::min(first_round, asked) : now * 2;
      return std::vector<std::uint32_t>(sums_.pixel_count(), std::min(next, asked));
    }
    double most_new = std::numeric_limits<double>::infinity();
    double expected = 0;
    const double total = mean_samples();
    if (sums_.rounds > 0) {
      const NoiseError noise = measure_noise(sums_);
      const double error = noise.pixel + noise.pixel_standard_error;
      const double target = params_.adaptive->target;
      if (error <= target) return {};
      if (target > 0) expected = total * (error / target) * (error / target);
      if (max_seconds > 0 && seconds > 0) {
        // The last round is to end with the time.
        const double new_a_second = total * double(sums_.pixel_count()) / seconds;
        most_new = std::max(0.9 * new_a_second * (max_seconds - seconds), double(sums_.pixel_count()));
        const double in_time = total * max_seconds / seconds;
        expected = expected > 0 ? std::min(expected, in_time) : in_time;
      }
    }
    std::vector<std::uint32_t> goal = plan_round(sums_, *params_.adaptive, most_new);
    double next = 0;
    for (const std::uint32_t g : goal) next += 2.0 * g / double(sums_.pixel_count());
    set_progress(total, std::max(expected, next));
    return goal;
  }

  double mean_samples() const {
    double total = 0;
    for (const std::uint32_t s : sums_.samples) total += double(s) * sums_.halves;
    return total / double(sums_.pixel_count());
  }

  // In samples a pixel, or of anything.
  void set_progress(double done, double expected) {
    progress_base_ = expected > 0 ? std::min(1.0, done / expected) : 0;
    progress_scale_ = expected > 0 ? 1 / expected : 0;
  }

  // True when all pixels have what the round wants.
  bool run_round(Pause& pause) {
    constexpr int tile = 16;
    double wanted = 0;
    for (std::size_t i = 0; i < sums_.pixel_count(); ++i) wanted += sums_.goal[i] - sums_.samples[i];
    const double share = wanted * sums_.halves / double(sums_.pixel_count()) *
                         (params_.adaptive ? progress_scale_ : progress_scale_ / sums_.halves);
    std::atomic<double> done{0};
    std::atomic<bool> complete{true};
    std::atomic<bool> visited{false};
    const auto render_tile = [&](const tbb::blocked_range2d<int>& range) {
      double finished = 0;
      for (int y = range.rows().begin(); y < range.rows().end(); ++y) {
        for (int x = range.cols().begin(); x < range.cols().end(); ++x) {
          const std::size_t i = std::size_t(y) * std::size_t(view_.width) + std::size_t(x);
          const std::uint32_t wanted_here = sums_.goal[i] - sums_.samples[i];
          if (wanted_here == 0) continue;
          // Pauses that are in no hurry come after some pixel: however often, they let the picture go on.
          const bool ended = pausable_ && visited.load(std::memory_order_relaxed) && pause.wish() != PauseWish::none;
          if (ended || !visit(x, y, i, pause)) {
            complete = false;
            return;
          }
          visited.store(true, std::memory_order_relaxed);
          finished += wanted_here;
        }
      }
      if (!params_.progress || finished == 0) return;
      double before = done.load();
      while (!done.compare_exchange_weak(before, before + finished)) {
      }
      params_.progress(std::min(1.0, progress_base_ + share * (before + finished) / wanted));
    };
    tbb::task_arena arena(params_.threads > 0 ? params_.threads : tbb::task_arena::automatic);
    arena.execute([&] {
      tbb::parallel_for(tbb::blocked_range2d<int>(0, view_.height, tile, 0, view_.width, tile), render_tile,
                        tbb::simple_partitioner());
    });
    return complete;
  }

  // Brings a pixel to its goal, or leaves it as it is and returns false.
  bool visit(int x, int y, std::size_t pixel, Pause& pause) {
    std::array<double, 2 * FilmSums::channels_with_features> added{};
    for (int half = 0; half < sums_.halves; ++half) {
      // One sequence a half; numbers beyond it, of a stream of the visit's own.
      const std::uint32_t first = sums_.samples[pixel];
      const auto stream = [&](std::uint64_t visit) {
        return RandomStream(params_.seed, StreamPurpose::pixel, pixel | (visit << 32U));
      };
      RandomStream random = stream(std::uint64_t(half));
      const std::uint32_t key = random.next_u32();
      if (first > 0) random = stream(2 * std::uint64_t(first) + std::uint64_t(half));
      double* sum = &added[std::size_t(half * FilmSums::channels_with_features)];
      for (std::uint32_t i = first; i < sums_.goal[pixel]; ++i) {
        if (pausable_ && i % samples_a_look == 0 && pause.wish() == PauseWish::at_once) return false;
        random.begin_sample(i, key, even_calls);
        Ray ray = make_ray(view_, V2f(float(x), float(y)) + random.next2());
        ray.coverage_seed = random.next_u32();
        const Rgb estimate = radiance_(ray, random);
        for (int c = 0; c < 3; ++c) sum[c] += double(estimate[c]);
        if (params_.first_hits_of == nullptr) continue;
        const FirstHit hit = first_hit(*params_.first_hits_of, view_, ray);
        for (int c = 0; c < 3; ++c) sum[3 + c] += double(hit.albedo[c]);
        for (int c = 0; c < 3; ++c) sum[6 + c] += double(hit.normal[c]);
        sum[9] += double(hit.depth_m);
        sum[10] += double(hit.hit);
        sum[11] += double(hit.emits);
      }
    }
    for (int half = 0; half < sums_.halves; ++half) {
      float* sum = &sums_.sums[std::size_t(half)][pixel * std::size_t(sums_.channels)];
      const double* more = &added[std::size_t(half * FilmSums::channels_with_features)];
      for (int c = 0; c < sums_.channels; ++c) sum[c] = float(double(sum[c]) + more[c]);
    }
    sums_.samples[pixel] = sums_.goal[pixel];
    return true;
  }

  Film finish(bool out_of_time) {
    Film film = make_film(sums_);
    if (sums_.halves == 2) {
      FilmNoise noise;
      noise.error = measure_noise(sums_);
      const auto [least, most] = std::minmax_element(sums_.samples.begin(), sums_.samples.end());
      noise.least_samples = int(*least) * 2;
      noise.most_samples = int(*most) * 2;
      noise.mean_samples = mean_samples();
      noise.rounds = sums_.rounds;
      noise.out_of_time = out_of_time;
      film.noise = noise;
    }
    if (sums_.halves == 2 || sums_.has_features()) film.sums = std::make_shared<const FilmSums>(std::move(sums_));
    return film;
  }

  const View& view_;
  const RenderParams& params_;
  const RadianceFunction& radiance_;
  bool pausable_;
  FilmSums sums_;
  double progress_base_ = 0;   // share done before the round
  double progress_scale_ = 0;  // share a sample a pixel
};

}  // namespace

Film render_film(const View& view, const RenderParams& params, const RadianceFunction& radiance) {
  return FilmRenderer(view, params, radiance).run();
}

}  // namespace ivory
