#include "tracer/bake/field/guard_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "tracer/bake/field/scene_lattice.h"
#include "tracer/core/sampler.h"

// What a vertex sees is star-shaped; an intersection of half-spaces n.u <= d is the part of that idea
// that fits in a few bytes. It is exact in convex rooms, whose walls are the planes. Around convex
// objects, which hide a cone behind them, no half-space may cut into what is seen beside the cone: for
// a given normal the best offset is then the one that clips the most hidden points at the least
// cost in visible ones. So: sample the support, trace each sample, take the normals of the surfaces that
// were hit as candidates, and choose greedily.

namespace ivory {
namespace {

struct Samples {
  std::vector<V3f> visible;  // offsets in voxels
  std::vector<V3f> hidden;
  std::vector<GuardPlane> hits;  // the planes of the surfaces that hid them
};

Samples trace_samples(const Intersector& intersector, const GridFrame& frame, const V3f& vertex, std::size_t index,
                      const GuardFitParams& params) {
  Samples samples;
  RandomStream random(0, StreamPurpose::visibility, index);
  const V3f eye = frame.to_world(vertex);
  const auto add_hidden = [&](const V3f& u, const V3f& target) {
    samples.hidden.push_back(u);
    const V3f path = target - eye;
    const float length = path.length();
    const V3f direction = path / length;
    const auto hit = intersector.closest(
        {.origin = eye, .direction = direction, .t_max = length, .blocking_coverage = half_coverage});
    if (!hit) return;
    // The surface's plane in index space: positions divide by the spacing, normals multiply.
    const V3f ng = hit->ng.dot(direction) > 0 ? hit->ng : -hit->ng;
    const V3f normal = (frame.direction_to_local(ng) * frame.spacing_m).normalized();
    samples.hits.push_back({normal, normal.dot(u) * (hit->t / length)});
  };
  std::array<V3f, 8> offsets;
  std::array<V3f, 8> targets;
  int filled = 0;
  const int n = params.samples_per_axis;
  for (int cell = 0; cell < n * n * n; ++cell) {
    const V3f jitter(random.next(), random.next(), random.next());
    const V3f u =
        (V3f(V3i(cell % n, cell / n % n, cell / (n * n))) + jitter) * (2.0F / static_cast<float>(n)) - V3f(1, 1, 1);
    offsets[std::size_t(filled)] = u;
    targets[std::size_t(filled++)] = frame.to_world(vertex + u);
    if (filled < 8 && cell + 1 < n * n * n) continue;
    const std::uint32_t visible = intersector.visible(eye, targets, filled);
    for (std::size_t i = 0; i < std::size_t(filled); ++i) {
      if (((visible >> i) & 1U) != 0) {
        samples.visible.push_back(offsets[i]);
      } else {
        add_hidden(offsets[i], targets[i]);
      }
    }
    filled = 0;
  }
  return samples;
}

// Candidates that differ by less than the packing can tell, or nearly so, are one.
void add_candidate(std::vector<GuardPlane>& candidates, const GuardPlane& plane) {
  constexpr float same_normal = 0.995F;
  constexpr float same_distance = 0.1F;
  for (const GuardPlane& known : candidates) {
    if (known.normal.dot(plane.normal) > same_normal && std::abs(known.distance - plane.distance) < same_distance)
      return;
  }
  candidates.push_back(plane);
}

std::vector<GuardPlane> candidate_planes(const Samples& samples) {
  std::vector<GuardPlane> candidates;
  constexpr std::size_t most = 48;
  const std::size_t stride = std::max<std::size_t>(1, samples.hits.size() / (4 * most));
  for (std::size_t i = 0; i < samples.hits.size() && candidates.size() < most; i += stride)
    add_candidate(candidates, samples.hits[i]);
  V3f mean(0, 0, 0);
  for (const GuardPlane& hit : samples.hits) mean += hit.normal;
  if (mean.length2() > 0) add_candidate(candidates, {mean.normalized(), 0});
  return candidates;
}

struct Scored {
  GuardPlane plane;
  float score = 0;
};

// The best offset for a normal: going down from the largest projection, every hidden point passed gains
// one, every visible point costs the penalty. Projections are sorted into bins, far narrower than the
// samples are apart. The cut goes as near to the hit plane as the gap between the last bin passed and the
// next one that holds anything allows.
Scored best_offset(const GuardPlane& candidate, const Samples& samples, float penalty) {
  constexpr int bins = 128;
  constexpr float reach = 1.75F;  // the support's corners are sqrt(3) away
  constexpr float width = 2 * reach / bins;
  std::array<float, bins> gain{};
  std::array<bool, bins> used{};
  const auto add = [&](const std::vector<V3f>& points, float value) {
    for (const V3f& u : points) {
      const auto bin = static_cast<std::size_t>((candidate.normal.dot(u) + reach) / width);
      gain[bin] += value;
      used[bin] = true;
    }
  };
  add(samples.hidden, 1);
  add(samples.visible, -penalty);

  Scored best{candidate, 0};
  float score = 0;
  for (int bin = bins - 1; bin >= 0; --bin) {
    if (!used[std::size_t(bin)]) continue;
    score += gain[std::size_t(bin)];
    if (score <= best.score) continue;
    int next = bin - 1;
    while (next >= 0 && !used[std::size_t(next)]) --next;
    const float above = static_cast<float>(bin) * width - reach;
    const float below = static_cast<float>(next + 1) * width - reach;
    best = {{candidate.normal, std::clamp(candidate.distance, below, above)}, score};
  }
  return best;
}

// Adds planes to the record while they are worth it; takes what they clip out of the samples.
void add_planes(Samples& samples, const std::vector<GuardPlane>& candidates, float clip_penalty, float least_score,
                GuardRecord& record) {
  for (std::uint32_t& word : record.words) {
    if (word != 0) continue;
    Scored best;
    for (const GuardPlane& candidate : candidates) {
      const Scored scored = best_offset(candidate, samples, clip_penalty);
      if (scored.score > best.score) best = scored;
    }
    if (best.score < least_score) return;
    word = pack(best.plane);
    const auto clipped = [&](const V3f& u) { return best.plane.normal.dot(u) > best.plane.distance; };
    std::erase_if(samples.hidden, clipped);
    std::erase_if(samples.visible, clipped);
  }
}

GuardRecord fit_vertex(Samples samples, bool lit, const GuardFitParams& params) {
  GuardRecord record;
  const std::vector<GuardPlane> candidates = candidate_planes(samples);
  const auto count = static_cast<float>(samples.hidden.size() + samples.visible.size());
  add_planes(samples, candidates, params.clip_penalty, 1.5F, record);
  // Outside a convex room's corner no plane parts the room from the free space beside it. Where that
  // space is dark, its claim is given up.
  if (!lit) add_planes(samples, candidates, params.clip_penalty_dark, 0.04F * count, record);
  return record;
}

}  // namespace

std::vector<GuardRecord> fit_guard(const Intersector& intersector, const Lattice& lattice,
                                   const std::vector<float>& visible_fraction, const std::vector<bool>& lit,
                                   const GuardFitParams& params) {
  std::vector<GuardRecord> records(lattice.vertex_count());
  // Elsewhere nothing is hidden: a voxel's support, and a tenth more for rounding.
  const std::vector<NearVertices> near = vertices_near_surfaces(intersector.scene(), lattice, 1.1F);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, records.size(), 64), [&](const auto& range) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) {
      if (visible_fraction[v] <= 0) continue;
      const VertexPlace place = lattice.place_of(std::uint32_t(v));
      if (!near[std::size_t(place.level)].holds(place.at)) continue;
      const GridFrame& frame = lattice.frame_of(place.level);
      // Numbered within its level, so that the same vertex of a uniform grid has the same planes.
      const std::size_t stream = frame.vertex_index(place.at.x, place.at.y, place.at.z);
      const Samples samples = trace_samples(intersector, frame, V3f(place.at), stream, params);
      if (!samples.hidden.empty()) records[v] = fit_vertex(samples, lit[v], params);
    }
  });
  return records;
}

}  // namespace ivory
