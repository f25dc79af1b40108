#include "tracer/render/render.h"

#include <atomic>
#include <chrono>

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "grid/base/memory.h"

namespace ivory {

namespace {

// Random numbers of a sample that are spread evenly over a pixel's samples: position, coverage, the
// light (which, where on it) and the BSDF sample of the first surface. Beyond those a path's dimensions are
// too many for the samples to cover.
constexpr std::uint32_t even_calls = 7;

Rgb render_pixel(const View& view, const RenderParams& params, const RadianceFunction& radiance, int x, int y) {
  RandomStream random(params.seed, StreamPurpose::pixel,
                      std::uint64_t(y) * std::uint64_t(view.width) + std::uint64_t(x));
  double sum[3] = {0, 0, 0};
  const std::uint32_t key = random.next_u32();
  for (int i = 0; i < params.samples; ++i) {
    random.begin_sample(std::uint32_t(i), key, even_calls);
    Ray ray = make_ray(view, V2f(float(x), float(y)) + random.next2());
    ray.coverage_seed = random.next_u32();
    const Rgb estimate = radiance(ray, random);
    for (int c = 0; c < 3; ++c) sum[c] += double(estimate[c]);
  }
  const double scale = 1.0 / params.samples;
  return Rgb(float(sum[0] * scale), float(sum[1] * scale), float(sum[2] * scale));
}

}  // namespace

Film render_film(const View& view, const RenderParams& params, const RadianceFunction& radiance) {
  Film film;
  film.width = view.width;
  film.height = view.height;
  const std::size_t count = std::size_t(view.width) * std::size_t(view.height);
  // Pixels, and their copy on the way to a file.
  check_memory("image of " + std::to_string(view.width) + "x" + std::to_string(view.height), double(count) * 24,
               "choose a smaller size");
  film.pixels.assign(count, Rgb(0, 0, 0));
  std::atomic<std::size_t> done{0};
  constexpr int tile = 16;
  const auto render_tile = [&](const tbb::blocked_range2d<int>& range) {
    for (int y = range.rows().begin(); y < range.rows().end(); ++y) {
      for (int x = range.cols().begin(); x < range.cols().end(); ++x)
        film.at(x, y) = render_pixel(view, params, radiance, x, y);
    }
    const std::size_t finished = done += range.rows().size() * range.cols().size();
    if (params.progress) params.progress(double(finished) / double(film.pixels.size()));
  };
  const auto start = std::chrono::steady_clock::now();
  tbb::task_arena arena(params.threads > 0 ? params.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range2d<int>(0, view.height, tile, 0, view.width, tile), render_tile,
                      tbb::simple_partitioner());
  });
  film.render_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return film;
}

}  // namespace ivory
