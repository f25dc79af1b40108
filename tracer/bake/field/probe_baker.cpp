#include "tracer/bake/field/probe_baker.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include "grid/base/error.h"
#include "tracer/bake/field/baker.h"
#include "tracer/bake/field/guard_fit.h"
#include "tracer/bake/field/kept_vertices.h"
#include "tracer/bake/field/vertex_visibility.h"
#include "tracer/render/path_tracer.h"

// m_k = int L f_k dw, with N directions of density 1 / (4 pi): m_k ~ 4 pi / N sum_i L(w_i) f_k(w_i).

namespace ivory {
namespace {

// The calls for random numbers of a path that are drawn evenly: direction, coverage, and those of its first surface.
constexpr std::uint32_t even_calls = 8;

// Past those of all points that truths are traced at.
constexpr std::uint64_t first_stream = std::uint64_t(1) << 40U;

V3f sphere_direction(const V2f& u) {
  const float z = 1 - 2 * u.x;
  const float r = std::sqrt(std::max(0.0F, 1 - z * z));
  const float angle = 2 * pi * u.y;
  return {r * std::cos(angle), r * std::sin(angle), z};
}

struct Probe {
  std::array<double, std::size_t(max_functions) * 3> moments{};
  V3d variance{0, 0, 0};
};

Probe trace_probe(const LitScene& lit, const GridFrame& frame, const V3f& p, const GridBakeParams& params, int rays,
                  std::uint64_t index) {
  PathParams path;
  path.max_bounces = params.max_bounces;
  RandomStream random(params.seed, StreamPurpose::probe, first_stream + index);
  const std::uint32_t key = random.next_u32();
  const auto functions = std::size_t(function_count(params.basis));
  Probe out;
  V3d sum(0, 0, 0);
  V3d squares(0, 0, 0);
  for (int i = 0; i < rays; ++i) {
    random.begin_sample(std::uint32_t(i), key, even_calls);
    const V3f w = sphere_direction(random.next2());
    const Ray ray{.origin = p, .direction = w, .coverage_seed = random.next_u32()};
    const std::optional<Hit> hit = lit.intersector.closest(ray);
    if (!hit) continue;
    const V3d l(trace_scattered(lit, make_surface(*lit.scene, ray, *hit), -w, path, random));
    const auto f = eval(params.basis, frame.direction_to_local(w));
    for (std::size_t k = 0; k < functions; ++k) {
      for (unsigned c = 0; c < 3; ++c) out.moments[3 * k + c] += l[int(c)] * double(f[k]);
    }
    sum += l;
    squares += l * l;
  }
  const double n = rays;
  for (double& moment : out.moments) moment *= 4 * double(pi) / n;
  // Of E = 4 pi mean of L max(0, n.w): over the sphere max(0, n.w) has the mean 1/4, its square 1/6.
  for (int c = 0; c < 3; ++c) {
    const double mean = sum[c] / n;
    out.variance[c] = 16 * double(pi) * double(pi) * (squares[c] / n / 6 - mean * mean / 16) / std::max(1.0, n - 1);
  }
  return out;
}

}  // namespace

IrradianceGrid bake_grid_by_probes(const LitScene& lit, const GridBakeParams& params, int rays) {
  const Scene& scene = *lit.scene;
  if (lit.lights.empty())
    throw Error(scene.name, "nothing in it shines", "add a light, an emissive material or an environment");
  if (params.include_direct) throw ParameterError("direct", "probes hold indirect light alone");
  if (params.groups) throw ParameterError("groups", "probes do not keep lights apart; photons do");
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  std::size_t(params.threads > 0 ? params.threads : tbb::info::default_concurrency()));

  IrradianceGrid grid;
  static_cast<Lattice&>(grid) = params.lattice ? *params.lattice : default_lattice(scene, params);
  const std::size_t vertices = grid.vertex_count();
  grid.basis = params.basis;
  grid.anchor_m = scene.anchor_m;
  grid.visible_fraction = params.guard == Guard::off ? std::vector<float>(vertices, 1.0F)
                                                     : visible_fractions(vertex_cell_masks(lit.intersector, grid));
  if (params.dynamic_regions) {
    const std::vector<bool> kept = kept_vertices(scene, grid.frame, *params.dynamic_regions);
    for (std::size_t v = 0; v < kept.size(); ++v) {
      if (!kept[v]) grid.visible_fraction[v] = 0;
    }
  }
  const auto stride = std::size_t(grid.stride());
  grid.moments.assign(vertices * stride, 0.0F);
  grid.variance.assign(vertices, Rgb(0, 0, 0));
  std::vector<std::uint8_t> lit_ones(vertices, 0);
  std::mutex mutex;
  std::uint64_t done = 0;
  tbb::parallel_for(std::size_t(0), vertices, [&](std::size_t v) {
    if (grid.visible_fraction[v] > 0) {
      const Probe probe = trace_probe(lit, grid.frame, grid.position_of(std::uint32_t(v)), params, rays, v);
      for (std::size_t i = 0; i < stride; ++i) {
        grid.moments[v * stride + i] = float(probe.moments[i]);
        if (probe.moments[i] != 0) lit_ones[v] = 1;
      }
      grid.variance[v] = Rgb(float(probe.variance.x), float(probe.variance.y), float(probe.variance.z));
    }
    if (!params.progress) return;
    const std::lock_guard lock(mutex);
    params.progress(++done, vertices);
  });
  if (params.guard != Guard::off) {
    const std::vector<bool> reached(lit_ones.begin(), lit_ones.end());
    grid.guard = fit_guard(lit.intersector, grid, grid.visible_fraction, reached);
  }

  grid.metadata = grid_facts(scene, params, grid);
  grid.metadata["made_by"] = std::string("probes");
  grid.metadata["probe_rays"] = std::int64_t(rays);
  return grid;
}

}  // namespace ivory
