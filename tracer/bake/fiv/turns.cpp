#include "tracer/bake/fiv/turns.h"

#include "grid/base/placement.h"

namespace ivory {

FivOccluder turned(const FivOccluder& occluder, double turn_rad) {
  const M33f turn = turn_about_y(turn_rad);
  Imath::M44d matrix;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) matrix[row][column] = double(turn[row][column]);
  FivOccluder out = occluder;
  for (Instance& instance : out.scene.instances) instance.to_world = M44f(Imath::M44d(instance.to_world) * matrix);
  return out;
}

FivSet bake_fiv_turns(const FivOccluder& occluder, const CubeMap& environment, const FivParams& params, int turns) {
  FivParams own = params;
  FivSet set;
  for (int k = 0; k < turns; ++k) {
    own.progress = [&](std::size_t done, std::size_t all) {
      if (params.progress) params.progress(std::size_t(k) * all + done, std::size_t(turns) * all);
    };
    const double turn_rad = 2 * 3.14159265358979323846 * k / turns;
    set.turns.push_back(bake_fiv(k == 0 ? occluder : turned(occluder, turn_rad), environment, own));
    // Two tables that are mixed have their samples at the same places.
    own.radii = set.turns.front().radii;
  }
  return set;
}

}  // namespace ivory
