// Volumes of probes with more than one texel each, as one 3D texture: blocks one behind the other along z, each with a
// copy of its first slice before it and of its last behind it, so that filtering within a block never reads another.
#pragma once

#include <functional>
#include <vector>

#include "grid/base/types.h"

namespace ivory {

struct Atlas {
  V3i size{0, 0, 0};        // texels
  std::vector<V4f> texels;  // x fastest
};

// Block b has its slice k at z = b (size.z + 2) + 1 + k. texel(b, probe) answers for each of `blocks`; probes are
// numbered as GridFrame does.
Atlas padded_atlas(const V3i& size, int blocks, const std::function<V4f(int block, std::size_t probe)>& texel);

// Bevy's: 2 size.y along y, 3 size.z along z, without copies. texel(side, probe) answers for the sides +x -x +y -y +z
// -z: the axis is the block along z, and the negative side lies behind along y. (irradiance_volume.wesl has it so; the
// comment of irradiance_volume.rs says the opposite of y.)
Atlas bevy_atlas(const V3i& size, const std::function<V4f(std::size_t side, std::size_t probe)>& texel);

// The largest magnitude of a channel but alpha.
float largest_channel(const Atlas& atlas);

}  // namespace ivory
