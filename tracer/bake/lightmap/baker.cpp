#include "tracer/bake/lightmap/baker.h"

#include <algorithm>
#include <atomic>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "tracer/core/sampler.h"
#include "tracer/core/sampling.h"

namespace ivory {

namespace {

// Random numbers of a sample that are spread evenly over a texel's samples: place, then the light (which, where on it)
// and the BSDF's ray. Gather rays have sequences of their own.
constexpr std::uint32_t even_calls = 6;
constexpr int burial_rays = 32;

Surface receiver(const ChartPoint& point) {
  Surface white;
  white.p = point.p;
  white.ng = point.ng;
  white.ns = point.ns;
  white.diffuse_albedo = Rgb(1, 1, 1);
  white.specular_f0 = Rgb(0, 0, 0);
  white.specular_f90 = Rgb(0, 0, 0);
  white.emission = Rgb(0, 0, 0);
  white.reach_m = point.reach_m;
  return white;
}

bool is_buried(const LitScene& lit, const ChartPoint& point, RandomStream& random) {
  const Surface surface = receiver(point);
  const ShadingFrame frame = make_shading_frame(point.ng);
  int backs = 0;
  for (int i = 0; i < burial_rays; ++i) {
    const V3f w = frame.to_world(sample_cosine_hemisphere(random.next2()));
    const Ray ray = spawn_ray(surface, w, random.next_u32());
    const std::optional<Hit> hit = lit.intersector.closest(ray);
    if (!hit || w.dot(hit->ng) <= 0) continue;
    const Instance& instance = lit.scene->instances[std::size_t(hit->instance)];
    const Mesh& mesh = lit.scene->meshes[std::size_t(instance.mesh)];
    if (!lit.scene->materials[std::size_t(mesh.material)].double_sided) ++backs;
  }
  return 2 * backs > burial_rays;
}

// Gives texels that are not known the mean of known neighbours; all of them, or those in charts alone. Answers whether
// there were any.
bool grow(Lightmap& map, std::vector<char>& known, bool in_charts) {
  const std::vector<char> before = known;
  bool any = false;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(map.width) + std::size_t(x);
      if (before[i] != 0 || (in_charts && map.states[i] == TexelState::empty)) continue;
      Rgb sum(0, 0, 0);
      float weights = 0;
      for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, map.height - 1); ++ny) {
        for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, map.width - 1); ++nx) {
          const std::size_t n = std::size_t(ny) * std::size_t(map.width) + std::size_t(nx);
          if (before[n] == 0) continue;
          const float weight = nx != x && ny != y ? 0.5F : 1.0F;
          sum += map.e[n] * weight;
          weights += weight;
        }
      }
      if (weights == 0) continue;
      map.e[i] = sum / weights;
      known[i] = 1;
      if (map.states[i] == TexelState::empty) map.states[i] = TexelState::dilated;
      any = true;
    }
  }
  return any;
}

}  // namespace

std::size_t Lightmap::count(TexelState state) const {
  return std::size_t(std::count(states.begin(), states.end(), state));
}

Lightmap bake_lightmap(const LitScene& lit, const IndirectLight& indirect, const Charts& charts,
                       const LightmapParams& params) {
  Lightmap map;
  map.width = charts.width;
  map.height = charts.height;
  const std::size_t count = charts.texels.size();
  map.e.assign(count, Rgb(0, 0, 0));
  map.states.assign(count, TexelState::empty);
  GatherParams gather;
  gather.gather_rays = params.gather_rays;
  gather.indirect_only = params.indirect_only;
  std::atomic<std::size_t> done{0};
  const auto bake = [&](std::size_t i) {
    if (charts.texels[i].instance == no_index) return;
    RandomStream random(params.seed, StreamPurpose::gather, i);
    const ChartPoint center = chart_point(*lit.scene, charts, i, V2f(0, 0));
    if (is_buried(lit, center, random)) {
      map.states[i] = TexelState::buried;
      return;
    }
    map.states[i] = TexelState::baked;
    double sum[3] = {0, 0, 0};
    const std::uint32_t key = random.next_u32();
    for (int s = 0; s < params.samples; ++s) {
      random.begin_sample(std::uint32_t(s), key, even_calls);
      const ChartPoint point = chart_point(*lit.scene, charts, i, random.next2() - V2f(0.5F, 0.5F));
      const Rgb e = gather_irradiance(lit, indirect, receiver(point), gather, random);
      for (int c = 0; c < 3; ++c) sum[c] += double(e[c]);
    }
    for (int c = 0; c < 3; ++c) map.e[i][c] = float(sum[c] / params.samples);
  };
  tbb::task_arena arena(params.threads > 0 ? params.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 256), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) bake(i);
      const std::size_t finished = done += range.size();
      if (params.progress) params.progress(double(finished) / double(count));
    });
  });
  std::vector<char> known(count);
  for (std::size_t i = 0; i < count; ++i) known[i] = map.states[i] == TexelState::baked ? 1 : 0;
  for (int ring = 0; ring < params.dilate && grow(map, known, /*in_charts=*/false); ++ring) {
  }
  // What is buried shows where a surface runs into a solid: to its last texel it has no light of its own.
  while (grow(map, known, /*in_charts=*/true)) {
  }
  return map;
}

}  // namespace ivory
