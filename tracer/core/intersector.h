// Rays against the scene's triangles, through Embree.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "tracer/core/scene.h"

namespace ivory {

// Where whole surfaces are wanted, of what they are made of: BLEND surfaces of a lower coverage are not there.
inline constexpr float half_coverage = 0.5F;

struct Ray {
  V3f origin{0, 0, 0};
  V3f direction{0, 0, 0};  // unit, to be set
  float t_min = 0;
  float t_max = std::numeric_limits<float>::infinity();
  // Decides stochastic BLEND coverage along the ray; to be drawn anew, uniform over 32 bits, for each.
  std::uint32_t coverage_seed = 0;
  // At least 0: nothing is left to chance, and surfaces of at least that coverage are there, as in visible().
  float blocking_coverage = -1;
  // glTF culls back faces of single-sided materials for the eye; light meets both sides.
  bool cull_back_faces = false;
};

struct Hit {
  float t = 0;
  V2f barycentric;  // weights of the triangle's 2nd and 3rd vertex
  int instance = no_index;
  int triangle = no_index;  // in the instance's mesh
  V3f ng;                   // world geometric normal of the front side, unit
};

// What a ray meets where surfaces of part coverage (BLEND, transmission) are taken as they are, not at random.
struct CoveredHit {
  Hit hit;
  float coverage = 0;  // above 0, below 1
};
struct Passage {
  static constexpr std::size_t most = 8;
  std::array<CoveredHit, most> crossed;  // the first `count` of them, nearest first
  std::size_t count = 0;
  // The first surface behind those: a whole one or, where more than `most` are crossed, what closest() finds behind
  // them. None where there is none.
  std::optional<Hit> end;
};

struct IntersectorParams {
  // The same hits on every CPU, to the last bit, by triangles of ivory's own in Embree's hierarchy. Embree's own differ
  // in their last bits, and at edges in which triangle is hit, with the vector instructions that it finds.
  bool portable = false;
};

// Holds the Embree scene of `scene`, which must outlive it unchanged. A mesh placed once is built
// in world space; a mesh placed several times is built once and instanced. Coverage (MASK, BLEND)
// is resolved during traversal. All queries are thread-safe.
class Intersector {
 public:
  // Throws Error (naming the scene) where Embree cannot build it, for want of memory above all.
  explicit Intersector(const Scene& scene, const IntersectorParams& params = {});
  ~Intersector();
  Intersector(Intersector&&) noexcept;
  Intersector& operator=(Intersector&&) noexcept;

  const Scene& scene() const;
  bool portable() const;
  // Can any surface be passed through (MASK, BLEND, transmission)? Only then do rays need a coverage seed.
  bool has_coverage() const;

  // First surface along the ray between t_min and t_max; none where there is none. BLEND surfaces are there with
  // probability alpha, as ray.coverage_seed decides.
  std::optional<Hit> closest(const Ray& ray) const;

  // All surfaces along the ray up to the first whole one; those of part coverage with it, so that nothing is left to
  // chance unless they are many. Where two triangles meet in an edge that the ray goes through, they are one surface.
  Passage pass(const Ray& ray) const;

  // Fraction of light that passes along the ray between t_min and t_max: 0 or 1 but for BLEND
  // surfaces, which let 1 - alpha pass.
  float transmittance(const Ray& ray) const;

  // For each of the first `count` (at most 8) targets: is the open segment from `origin` free of
  // surfaces? Bit i of the answer. Surfaces of a coverage below half_coverage do not block.
  std::uint32_t visible(const V3f& origin, const std::array<V3f, 8>& targets, int count) const;

  // Distances along `direction` (unit) to the first surface from each of the first `count` (at most 8) origins,
  // infinity for none. Surfaces of a coverage below half_coverage are not there. For rays side by side.
  std::array<float, 8> distances(const std::array<V3f, 8>& origins, int count, const V3f& direction) const;

  // How many of the rays hit something: Embree's closest-hit queries one by one, nothing made of the hits. The rate
  // that everything else is measured against.
  std::uint64_t count_hits(std::span<const Ray> rays) const;

  // Sphere around everything, world: centre and radius in metres. The radius is above 0 for a scene with triangles, and
  // 0 for one without.
  V3f center() const;
  float radius_m() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ivory
