// Texture look-up as glTF defines it.
#pragma once

#include "tracer/core/scene.h"

namespace ivory {

// RGBA in 0..1 at uv (as uv_at() gives it), filtered and wrapped by the texture's sampler; decoded
// from sRGB to linear first where `srgb` (alpha is always linear). White (1,1,1,1) where `use` names
// no texture. uv beyond 8 million texels are clamped.
V4f sample(const Scene& scene, const TextureUse& use, const V2f& uv, bool srgb);

// RGBA of the texel in column x and row y, both unbounded: wrapped and decoded as by sample().
V4f texel(const Scene& scene, const TextureUse& use, int x, int y, bool srgb);

// Width and height of its image in texels; {0, 0} where `use` names no texture or the texture no image.
Imath::V2i texture_size(const Scene& scene, const TextureUse& use);

// uv (as uv_at() gives it) in texels of the image, as sample() takes it: {0, 0} is the upper left corner of the first
// texel; limited to +-8 million.
V2f uv_texels(const Imath::V2i& size, const V2f& uv);

// The uv of `use` at a barycentric of the mesh's triangle, its uv_transform applied; {0, 0} where the mesh lacks the
// set, as no mesh that load_gltf() returns does.
V2f uv_at(const Mesh& mesh, int triangle, const V2f& barycentric, const TextureUse& use);

}  // namespace ivory
