// Radiance of emissive texels that alpha covers, by the filters of both textures.
#pragma once

#include "tracer/lights/emission/map.h"

namespace ivory {

// Does `use` name a texture with an image?
bool is_textured(const Scene& scene, const TextureUse& use);

// Do two textures lie the same way on every triangle, whatever their sizes?
bool same_coordinates(const Scene& scene, const TextureUse& a, const TextureUse& b);

struct CoveredLight {
  V3d mean;     // nits over the cell; MASK to a sixty-fourth of the cell where the edge runs through it
  double most;  // no point of the cell has a greater sum of channels
};

// Of stored cell (i, j) of a map that is not joined to blocks. Alpha by other coordinates than emission's, and by
// vertices, is left out.
CoveredLight covered_light(const EmissionMap& map, int i, int j);

}  // namespace ivory
