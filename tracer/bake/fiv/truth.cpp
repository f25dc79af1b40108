#include "tracer/bake/fiv/truth.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "grid/base/counted_random.h"
#include "grid/fiv/light.h"
#include "tracer/core/sampling.h"
#include "tracer/lights/environment.h"

// The light hidden from a receiver is the integral of L(w) max(n.w, 0) over the directions w in which a ray meets the
// mesh. All of these lie in the cone of the bounding sphere. Half of the samples are drawn uniformly from that cone,
// for skies, and half in proportion to the map's luminance, for suns; both are weighted by their density together (the
// balance heuristic, Veach 1997), so that neither a small sun nor a far, narrow cone is noisy.

namespace ivory {

namespace {

struct BoundingCone {
  V3f axis{0, 1, 0};
  float cosine = -1;  // of the half-angle; -1: all directions
};

BoundingCone cone_at(const V3f& p) {
  const float r2 = p.length2();
  // Within the sphere, and so near above it that rounding decides, all directions count.
  if (!(r2 > 1.01F)) return {};
  return {-p.normalized(), std::sqrt(1 - 1 / r2)};
}

V3f sample_cone(const BoundingCone& cone, const V2f& u) {
  const float z = 1 - u.x * (1 - cone.cosine);
  const float s = std::sqrt(std::max(0.0F, 1 - z * z));
  const float phi = 2 * pi * u.y;
  const ShadingFrame frame = make_shading_frame(cone.axis);
  return (frame.x * (s * std::cos(phi)) + frame.y * (s * std::sin(phi)) + cone.axis * z).normalized();
}

class HiddenLight {
 public:
  HiddenLight(const FivOccluder& occluder, const EnvironmentMap& map)
      : object_(occluder.scene), light_(make_environment_light(map)) {}

  V3d estimate(const V3f& p, const V3f& n, int samples, std::uint64_t seed, std::uint64_t index) const {
    constexpr std::uint32_t calls = 4;  // a texel by the alias table's two numbers, a place in it, or one direction
    const BoundingCone cone = cone_at(p);
    const float pdf_cone = 1 / (2 * pi * (1 - cone.cosine));
    V3d sum(0, 0, 0);
    for (const bool by_light : {false, true}) {
      RandomStream random(seed, StreamPurpose::probe, 2 * index + (by_light ? 1 : 0));
      const std::uint32_t key = random.next_u32();
      for (int k = 0; k < samples / 2; ++k) {
        random.begin_sample(std::uint32_t(k), key, calls);
        V3f w;
        if (by_light) {
          const std::optional<LightSample> s = sample(light_, random);
          if (!s) continue;
          w = s->w;
        } else {
          w = sample_cone(cone, random.next2());
        }
        const float cosine = n.dot(w);
        const bool in_cone = w.dot(cone.axis) >= cone.cosine;
        if (!(cosine > 0) || !in_cone) continue;
        const Rgb radiance = eval(*light_.map, w);
        if (is_black(radiance)) continue;
        Ray ray;
        ray.origin = p;
        ray.direction = w;
        ray.blocking_coverage = half_coverage;
        if (!object_.closest(ray)) continue;
        const float density = 0.5F * (pdf_cone + pdf_solid_angle(light_, w));
        sum += V3d(radiance) * double(cosine / (density * float(samples)));
      }
    }
    return sum;
  }

 private:
  Intersector object_;
  EnvironmentLight light_;
};

std::vector<V3f> mesh_points(const Scene& scene) {
  std::vector<V3f> points;
  for (const Instance& instance : scene.instances) {
    for (const V3f& p : scene.meshes[std::size_t(instance.mesh)].positions) points.push_back(p * instance.to_world);
  }
  return points;
}

V3f receiver_position(const std::vector<V3f>& mesh, std::uint64_t seed, std::uint64_t index) {
  const auto uniform = [&](std::uint64_t k) { return counted_uniform(seed, 5 * index + k); };
  const V3f out = V3f(sphere_direction(uniform(0), uniform(1))).normalized();
  float reach = -1;
  for (const V3f& p : mesh) reach = std::max(reach, p.dot(out));
  const double gap = nearest_fiv_gap * std::pow(farthest_fiv_gap / nearest_fiv_gap, uniform(2));
  const ShadingFrame frame = make_shading_frame(out);
  const double aside = farthest_aside * uniform(3);
  const double turn = 2 * double(pi) * uniform(4);
  return frame.to_world(V3f(float(aside * std::cos(turn)), float(aside * std::sin(turn)), float(double(reach) + gap)));
}

}  // namespace

FivTruth trace_fiv_truth(const FivOccluder& occluder, const EnvironmentMap& map, const IrradianceTree& tree,
                         const FivTruthParams& params) {
  const HiddenLight hidden(occluder, map);
  const std::vector<V3f> mesh = mesh_points(occluder.scene);
  FivTruth truth;
  truth.receivers.resize(std::size_t(params.receivers));
  tbb::parallel_for(std::size_t(0), truth.receivers.size(), [&](std::size_t i) {
    FivReceiver& receiver = truth.receivers[i];
    receiver.p = receiver_position(mesh, params.seed, i);
    // Numbers of a stream of their own.
    const std::uint64_t seed = ~params.seed;
    receiver.n = V3f(sphere_direction(counted_uniform(seed, 2 * i), counted_uniform(seed, 2 * i + 1)));
    receiver.unshadowed = Rgb(tree.irradiance(V3d(receiver.n).normalized()).e);
    for (std::size_t k = 0; k < 2; ++k)
      receiver.hidden[k] = hidden.estimate(receiver.p, receiver.n, params.samples, params.seed, 2 * i + k);
  });
  // Mean of max(n.w, 0) over all n is a quarter.
  const V3d total = tree.total();
  truth.mean_unshadowed = (total.x + total.y + total.z) / 12;
  return truth;
}

MeasuredError fiv_error(const FivTable& table, const FivTruth& truth) {
  const FivPlacement placement{&table, V3f(0, 0, 0), 1};
  std::vector<PointError> points;
  for (const FivReceiver& receiver : truth.receivers) {
    const Rgb e = fiv_irradiance({&placement, 1}, receiver.p, receiver.n, -1, receiver.unshadowed, {});
    PointError point{0, truth.mean_unshadowed};
    for (int c = 0; c < 3; ++c) {
      const double taken = double(receiver.unshadowed[unsigned(c)]) - double(e[unsigned(c)]);
      point.squared += (taken - receiver.hidden[0][c]) * (taken - receiver.hidden[1][c]) / 3;
    }
    points.push_back(point);
  }
  return root_mean_square(points);
}

}  // namespace ivory
