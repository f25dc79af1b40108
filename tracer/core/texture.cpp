#include "tracer/core/texture.h"

#include <algorithm>
#include <cmath>

// Own code: OpenImageIO's texture system filters files by the width of a footprint; glTF asks for plain bilinear
// texels.

namespace ivory {
namespace {

// IEC 61966-2-1, for all 256 codes.
std::array<float, 256> make_srgb_table() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double s = double(i) / 255;
    table[i] = float(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
  }
  return table;
}

std::array<float, 256> make_linear_table() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) table[i] = float(double(i) / 255);
  return table;
}

const std::array<float, 256> srgb_table = make_srgb_table();
const std::array<float, 256> linear_table = make_linear_table();

// Texel coordinates stay exact integers in float, and far uv of a tiled floor stay finite.
constexpr float max_texel = 8388608;

// Not a number becomes the lower end, by the order of the arguments.
float limited(float x) { return std::max(-max_texel, std::min(x, max_texel)); }

// Texel index of an unbounded one.
int wrap_index(int i, int size, Wrap wrap) {
  switch (wrap) {
    case Wrap::clamp_to_edge:
      return std::clamp(i, 0, size - 1);
    case Wrap::mirrored_repeat: {
      const int period = 2 * size;
      const int r = ((i % period) + period) % period;
      return r < size ? r : period - 1 - r;
    }
    case Wrap::repeat:
      break;
  }
  return ((i % size) + size) % size;
}

V4f decoded(const Image& image, int x, int y, const std::array<float, 256>& table) {
  const std::uint8_t* p = &image.rgba[(std::size_t(y) * std::size_t(image.width) + std::size_t(x)) * 4];
  return {table[p[0]], table[p[1]], table[p[2]], linear_table[p[3]]};
}

}  // namespace

V4f sample(const Scene& scene, const TextureUse& use, const V2f& uv, bool srgb) {
  if (use.texture == no_index) return {1, 1, 1, 1};
  const Texture& texture = scene.textures[std::size_t(use.texture)];
  if (texture.image == no_index) return {1, 1, 1, 1};
  const Image& image = scene.images[std::size_t(texture.image)];
  const auto& table = srgb ? srgb_table : linear_table;

  // (0,0) is the upper left corner of the first texel, whose centre lies at half a texel.
  const V2f at = uv_texels(Imath::V2i(image.width, image.height), uv);
  const float x = at.x;
  const float y = at.y;
  if (texture.nearest) {
    return decoded(image, wrap_index(int(std::floor(x)), image.width, texture.wrap_s),
                   wrap_index(int(std::floor(y)), image.height, texture.wrap_t), table);
  }

  const float left = std::floor(x - 0.5F);
  const float top = std::floor(y - 0.5F);
  const float fx = x - 0.5F - left;
  const float fy = y - 0.5F - top;
  const int x0 = wrap_index(int(left), image.width, texture.wrap_s);
  const int x1 = wrap_index(int(left) + 1, image.width, texture.wrap_s);
  const int y0 = wrap_index(int(top), image.height, texture.wrap_t);
  const int y1 = wrap_index(int(top) + 1, image.height, texture.wrap_t);
  const V4f upper = decoded(image, x0, y0, table) * (1 - fx) + decoded(image, x1, y0, table) * fx;
  const V4f lower = decoded(image, x0, y1, table) * (1 - fx) + decoded(image, x1, y1, table) * fx;
  return upper * (1 - fy) + lower * fy;
}

V4f texel(const Scene& scene, const TextureUse& use, int x, int y, bool srgb) {
  if (use.texture == no_index) return {1, 1, 1, 1};
  const Texture& texture = scene.textures[std::size_t(use.texture)];
  if (texture.image == no_index) return {1, 1, 1, 1};
  const Image& image = scene.images[std::size_t(texture.image)];
  return decoded(image, wrap_index(x, image.width, texture.wrap_s), wrap_index(y, image.height, texture.wrap_t),
                 srgb ? srgb_table : linear_table);
}

Imath::V2i texture_size(const Scene& scene, const TextureUse& use) {
  if (use.texture == no_index) return {0, 0};
  const int image = scene.textures[std::size_t(use.texture)].image;
  if (image == no_index) return {0, 0};
  return {scene.images[std::size_t(image)].width, scene.images[std::size_t(image)].height};
}

V2f uv_texels(const Imath::V2i& size, const V2f& uv) {
  return {limited(uv.x * float(size.x)), limited(uv.y * float(size.y))};
}

V2f uv_at(const Mesh& mesh, int triangle, const V2f& barycentric, const TextureUse& use) {
  if (use.uv_set < 0 || std::size_t(use.uv_set) >= mesh.uvs.size()) return {0, 0};
  const std::vector<V2f>& uvs = mesh.uvs[std::size_t(use.uv_set)];
  if (uvs.empty()) return {0, 0};
  const auto& corners = mesh.triangles[std::size_t(triangle)];
  const V2f uv = uvs[corners.x] * (1 - barycentric.x - barycentric.y) + uvs[corners.y] * barycentric.x +
                 uvs[corners.z] * barycentric.y;
  const auto& m = use.uv_transform;
  return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
}

}  // namespace ivory
