// A glTF file that is kept open to be posed again and again: animations that play.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tracer/core/scene.h"
#include "tracer/gltf/loader.h"

namespace ivory {

// One of a file's animations: its channels have keys between the two times, seconds.
struct AnimationSpan {
  std::string name;
  double begin_s = 0;
  double end_s = 0;
};

class PosedGltf {
 public:
  // Throws as load_gltf() does, and Error for animations that break the specification. `params`: its time and animation
  // are of no account.
  PosedGltf(const std::string& path, const LoadParams& params);
  ~PosedGltf();
  PosedGltf(PosedGltf&&) noexcept;
  PosedGltf& operator=(PosedGltf&&) noexcept;

  const std::vector<AnimationSpan>& animations() const;

  // The scene that load_gltf() gives at that time, by the same code, but for its images, which no pose changes: their
  // list is empty. Relative to `anchor_m`. What load_gltf() warns of is not said again. Throws as load_gltf() does.
  Scene pose(std::size_t animation, double time_s, const V3d& anchor_m);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ivory
