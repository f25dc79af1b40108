#include "tracer/lights/emission/covered_cell.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tracer/core/texture.h"

namespace ivory {

bool is_textured(const Scene& scene, const TextureUse& use) { return texture_size(scene, use).x > 0; }

bool same_coordinates(const Scene& scene, const TextureUse& a, const TextureUse& b) {
  const Texture& s = scene.textures[std::size_t(a.texture)];
  const Texture& t = scene.textures[std::size_t(b.texture)];
  return a.uv_set == b.uv_set && a.uv_transform == b.uv_transform && s.wrap_s == t.wrap_s && s.wrap_t == t.wrap_t;
}

namespace {

// One covered cell, at the coordinates of `map`, by the texture's own filters.
class CoveredCell {
 public:
  CoveredCell(const EmissionMap& map, int i, int j)
      : map_(map),
        material_(map.scene->materials[std::size_t(map.material)]),
        i_(i),
        j_(j),
        by_emission_(is_textured(*map.scene, material_.emission_texture)) {
    by_alpha_ =
        is_textured(*map.scene, material_.base_color_texture) &&
        (!by_emission_ || same_coordinates(*map.scene, material_.emission_texture, material_.base_color_texture));
  }

  CoveredLight light() const {
    const std::array<float, 2> alphas =
        by_alpha_ ? alpha_range() : std::array<float, 2>{material_.alpha, material_.alpha};
    const double covered =
        by_alpha_ || !is_textured(*map_.scene, material_.base_color_texture) ? coverage(alphas[1]) : 1;
    const double most = brightest() * covered;
    if (most == 0) return {V3d(0, 0, 0), 0};
    // Gauss' points are exact where both are bilinear in the cell. A coarser texture may have a kink in it; where the
    // cut-off runs through it, many points are taken.
    const bool cut = material_.alpha_mode == AlphaMode::mask && coverage(alphas[0]) != coverage(alphas[1]);
    const bool kinked = by_alpha_ && by_emission_ &&
                        texture_size(*map_.scene, material_.emission_texture) !=
                            texture_size(*map_.scene, material_.base_color_texture);
    constexpr std::array<double, 2> gauss{0.21132486540518713, 0.78867513459481287};  // (1 -+ 1 / sqrt 3) / 2
    const int n = cut ? 8 : kinked ? 4 : 2;
    const auto point = [&](int k) {
      if (cut) return (k + 0.5) / n;
      return kinked ? (k / 2 + gauss[std::size_t(k % 2)]) / 2 : gauss[std::size_t(k)];
    };
    V3d total(0, 0, 0);
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b) total += at(point(a), point(b));
    return {total / double(n * n), most};
  }

 private:
  double coverage(float alpha) const {
    if (material_.alpha_mode == AlphaMode::mask) return alpha >= material_.alpha_cutoff ? 1 : 0;
    return double(std::clamp(alpha, 0.0F, 1.0F));
  }
  V2f uv(double x, double y) const {
    return {float((i_ + x - map_.x.shift) / map_.texels.x), float((j_ + y - map_.y.shift) / map_.texels.y)};
  }
  V3d at(double x, double y) const {
    const V2f here = uv(x, y);
    V3d light{double(material_.emission.x), double(material_.emission.y), double(material_.emission.z)};
    if (by_emission_) {
      const V4f t = sample(*map_.scene, material_.emission_texture, here, true);
      light *= V3d(double(t.x), double(t.y), double(t.z));
    }
    if (by_alpha_) {
      light *= coverage(material_.alpha * sample(*map_.scene, material_.base_color_texture, here, true).w);
    } else if (!is_textured(*map_.scene, material_.base_color_texture)) {
      light *= coverage(material_.alpha);
    }
    return light;
  }
  // Over all texels of a use that touch the cell.
  template <typename Visit>
  void visit_texels(const TextureUse& use, const Visit& visit) const {
    const Imath::V2i size = texture_size(*map_.scene, use);
    const double half = map_.scene->textures[std::size_t(use.texture)].nearest ? 0 : 0.5;
    const auto range = [&](double low, double high, int texels, int of) {
      constexpr double rounding = 1e-3;  // of float coordinates
      const double first = low / of * texels - half;
      const double last = high / of * texels - half;
      return std::array<int, 2>{int(std::floor(first + rounding)),
                                half > 0 ? int(std::ceil(last - rounding)) : int(std::ceil(last - rounding)) - 1};
    };
    const auto across = range(i_ - map_.x.shift, i_ + 1 - map_.x.shift, size.x, map_.texels.x);
    const auto down = range(j_ - map_.y.shift, j_ + 1 - map_.y.shift, size.y, map_.texels.y);
    for (int y = down[0]; y <= down[1]; ++y)
      for (int x = across[0]; x <= across[1]; ++x) visit(texel(*map_.scene, use, x, y, true));
  }
  std::array<float, 2> alpha_range() const {
    std::array<float, 2> range{1, 0};
    visit_texels(material_.base_color_texture, [&](const V4f& t) {
      range[0] = std::min(range[0], t.w);
      range[1] = std::max(range[1], t.w);
    });
    return {material_.alpha * range[0], material_.alpha * range[1]};
  }
  double brightest() const {
    const Rgb& e = material_.emission;
    if (!by_emission_) return double(e.x) + double(e.y) + double(e.z);
    V3d most(0, 0, 0);
    visit_texels(material_.emission_texture, [&](const V4f& t) {
      most = V3d(std::max(most.x, double(t.x)), std::max(most.y, double(t.y)), std::max(most.z, double(t.z)));
    });
    return most.x * double(e.x) + most.y * double(e.y) + most.z * double(e.z);
  }

  const EmissionMap& map_;
  const Material& material_;
  int i_;
  int j_;
  bool by_emission_;
  bool by_alpha_ = false;
};

}  // namespace

CoveredLight covered_light(const EmissionMap& map, int i, int j) { return CoveredCell(map, i, j).light(); }

}  // namespace ivory
