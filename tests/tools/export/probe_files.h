// Probe volumes as other engines read them: their look-ups, rewritten from their shaders, on the files alone.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/command_test.h"
#include "tests/tools/export/ktx2_reader.h"

namespace ivory {

// A 3D texture with linear filtering, clamped; u, v, w in 0 to 1 over all texels.
class Texture3d {
 public:
  explicit Texture3d(const std::string& path) : file_(read_ktx2(bytes_of(path))) {
    const std::size_t texels = std::size_t(file_.width) * file_.height * file_.depth;
    for (std::size_t i = 0; i < texels; ++i) texels_.push_back(ktx2_texel(file_, i));
  }
  V4f sample(const V3d& uvw) const {
    const std::array<int, 3> size{int(file_.width), int(file_.height), int(file_.depth)};
    std::array<std::array<int, 2>, 3> index{};
    std::array<double, 3> t{};
    for (unsigned axis = 0; axis < 3; ++axis) {
      const double x = uvw[axis] * size[axis] - 0.5;
      const double base = std::floor(x);
      t[axis] = x - base;
      for (int i = 0; i < 2; ++i) index[axis][std::size_t(i)] = std::clamp(int(base) + i, 0, size[axis] - 1);
    }
    V4f sum(0, 0, 0, 0);
    for (unsigned corner = 0; corner < 8; ++corner) {
      std::array<std::size_t, 3> at{};
      double weight = 1;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const unsigned side = corner >> axis & 1U;
        at[axis] = std::size_t(index[axis][side]);
        weight *= side != 0 ? t[axis] : 1 - t[axis];
      }
      sum += texels_[(at[2] * file_.height + at[1]) * file_.width + at[0]] * float(weight);
    }
    return sum;
  }
  const V4f& texel(int x, int y, int z) const {
    return texels_[(std::size_t(z) * file_.height + std::size_t(y)) * file_.width + std::size_t(x)];
  }
  const Ktx2Read& file() const { return file_; }

 private:
  Ktx2Read file_;
  std::vector<V4f> texels_;
};

// Where the .json file beside says that the probes stand.
struct Placement {
  V3d center, extent;
  V3i size;
  std::array<V3d, 3> axes;
  nlohmann::json json;

  explicit Placement(const std::string& path) : json(nlohmann::json::parse(bytes_of(path))) {
    center = vector(json["center_m"]);
    extent = vector(json["extent_m"]);
    size = V3i(vector(json["size"]));
    for (std::size_t i = 0; i < 3; ++i) axes[i] = vector(json["axes"][i]);
  }
  static V3d vector(const nlohmann::json& list) { return {list[0], list[1], list[2]}; }
  // 0 to 1 over the box of all cells.
  V3d uvw(const V3d& p) const {
    V3d out;
    for (unsigned i = 0; i < 3; ++i) out[i] = (p - center).dot(axes[i]) / extent[i] + 0.5;
    return out;
  }
};

// getLightProbeGridIrradiance() of lightprobes_pars_fragment.glsl.js (r187): E in lux. `moved`: where it reads.
inline V3d read_three_js(const Texture3d& texture, const Placement& at, const V3d& p, const V3d& n) {
  const V3d res(at.size);
  const V3d spacing = at.extent / res;
  V3d uvw = at.uvw(p + n * spacing * 0.5);
  for (unsigned i = 0; i < 3; ++i) uvw[i] = std::clamp(uvw[i], 0.5 / res[i], 1 - 0.5 / res[i]);
  const double padded = res.z + 2;
  const double base = uvw.z * res.z + 1;
  std::array<double, 28> s{};
  for (int t = 0; t < 7; ++t) {
    const V4f texel = texture.sample(V3d(uvw.x, uvw.y, (base + t * padded) / (7 * padded)));
    for (unsigned c = 0; c < 4; ++c) s[std::size_t(4 * t) + c] = texel[c];
  }
  const auto c = [&](std::size_t i) { return V3d(s[3 * i], s[3 * i + 1], s[3 * i + 2]); };
  V3d e = c(0) * 0.886227 + (c(1) * n.y + c(2) * n.z + c(3) * n.x) * (2 * 0.511664);
  e += (c(4) * (n.x * n.y) + c(5) * (n.y * n.z) + c(7) * (n.x * n.z)) * (2 * 0.429043);
  e += c(6) * (0.743125 * n.z * n.z - 0.247708) + c(8) * (0.429043 * (n.x * n.x - n.y * n.y));
  return {std::max(e.x, 0.0), std::max(e.y, 0.0), std::max(e.z, 0.0)};
}

// irradiance_volume_light() of irradiance_volume.wesl (0.20): what it adds to the diffuse light, E / pi, given the
// component's intensity.
inline V3d read_bevy(const Texture3d& texture, const Placement& at, double intensity, const V3d& p, const V3d& n) {
  const V3d res(at.size);
  const V3d atlas(res.x, 2 * res.y, 3 * res.z);
  // unit cube to texels, kept off the borders of the blocks by half a texel
  V3d stp = at.uvw(p);
  for (unsigned i = 0; i < 3; ++i) stp[i] = std::clamp(stp[i] * res[i], 0.5, res[i] - 0.5);
  V3d sum(0, 0, 0);
  for (unsigned axis = 0; axis < 3; ++axis) {
    V3d texel = stp;
    if (n[axis] < 0) texel.y += res.y;
    texel.z += axis * res.z;
    const V4f rgb = texture.sample(texel / atlas);
    sum += V3d(rgb.x, rgb.y, rgb.z) * (n[axis] * n[axis]);
  }
  return sum * intensity;
}

// The plain volumes, by what their .json files say: block b of a padded atlas at p.
inline V3d read_block(const Texture3d& texture, const Placement& at, int block, int blocks, const V3d& p) {
  const V3d res(at.size);
  V3d uvw = at.uvw(p);
  const double z = std::clamp(uvw.z * res.z, 0.5, res.z - 0.5);
  const V4f texel = texture.sample(V3d(uvw.x, uvw.y, (block * (res.z + 2) + 1 + z) / (blocks * (res.z + 2))));
  return V3d(texel.x, texel.y, texel.z) * at.json["scale"].get<double>();
}

}  // namespace ivory
