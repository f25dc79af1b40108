#include <cmath>

#include "tracer/lights/emission/integral.h"
#include "tracer/lights/lights_state.h"

namespace ivory {

// A point chosen with density d (1/m2, sides and all picks included) on a surface of radiance L stands for 1/d of area.
// n of them give every receiver in the mean what the surfaces give:
//
//   E = sum over points of L / (n d) cos cos' / r^2.
std::vector<EmitterPoint> Lights::emitter_points(std::size_t count, std::uint64_t seed) const {
  const State& state = *state_;
  std::vector<double> weights;
  double total = 0;
  for (std::size_t i = 0; i < state.emitters.size(); ++i) {
    weights.push_back(double(state.picks().probability[state.punctual_count() + i]));
    total += weights.back();
  }
  std::vector<EmitterPoint> points;
  if (!(total > 0)) return points;
  const AliasTable table(weights);
  const std::vector<double> probability = table.probabilities();
  for (std::size_t i = 0; i < count; ++i) {
    RandomStream random(seed, StreamPurpose::emitter, i);
    random.begin_sample(std::uint32_t(i), std::uint32_t(seed), 6);
    const std::size_t choice = table.sample(random);
    const Emitter& emitter = state.emitters[choice];
    double picked = probability[choice];
    std::optional<PickedTriangle> of_instance;
    if (emitter.light == no_index) {
      of_instance = pick(*state.scene, state.instanced_of(emitter.instance), emitter.instance, random);
      picked *= double(of_instance->probability);
    }
    const TriangleLight& light = of_instance ? of_instance->light : state.triangles[std::size_t(emitter.light)];
    const EmissionPoint at = sample_point(*state.scene, *light.emission, light.triangle, random);
    const bool back = random.next() < 0.5F && light.double_sided;
    if (!(at.density > 0) || !(picked > 0)) continue;
    EmitterPoint point;
    point.p = light.vertex + light.edge1 * at.barycentric.x + light.edge2 * at.barycentric.y;
    point.n = back ? -light.ng : light.ng;
    point.area_m2 =
        float(double(light.area_m2) * (light.double_sided ? 2 : 1) / double(at.density) / picked / double(count));
    point.radiance_nits = covered_emission_at(*state.scene, light.emission->mesh, light.triangle, at.barycentric);
    point.instance = emitter.instance;
    if (!is_black(point.radiance_nits)) points.push_back(point);
  }
  return points;
}

}  // namespace ivory
