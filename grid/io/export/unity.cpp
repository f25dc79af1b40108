#include "grid/io/export/unity.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/base/half.h"
#include "grid/export/dialect.h"
#include "grid/export/texel.h"
#include "grid/io/file.h"

namespace ivory {

namespace {

// A text asset's beginning; `id` is that of its class.
std::string asset_head(int id, const std::string& kind, const std::string& name) {
  return fmt::format(
      "%YAML 1.1\n%TAG !u! tag:unity3d.com,2011:\n--- !u!{} &{}00000\n{}:\n  m_ObjectHideFlags: 0\n  "
      "m_CorrespondingSourceObject: {{fileID: 0}}\n  m_PrefabInstance: {{fileID: 0}}\n  m_PrefabAsset: {{fileID: 0}}\n "
      " "
      "m_Name: {}\n",
      id, id, kind, Json(name).dump(-1, ' ', true));
}

std::string stem_of(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  const std::string name = slash == std::string::npos ? path : path.substr(slash + 1);
  return name.substr(0, name.find_last_of('.'));
}

// SphericalHarmonicsL2 of a probe: [coefficient], RGB.
std::array<V3d, 9> in_unity(const ProbeSh9& probe) {
  Sh9 sh;
  for (std::size_t i = 0; i < 9; ++i) sh.coefficients[i] = V3d(probe[i]);
  return in_dialect(sh, Sh9Dialect::unity);
}

// Mean and direction of E / pi, in a right-handed world.
struct Linear {
  V3d l0{0, 0, 0};
  std::array<V3d, 3> l1;  // [channel], as a vector of the world
};
Linear linear_of(const ProbeSh9& probe) {
  const std::array<V3d, 9> sh = in_unity(probe);
  Linear out;
  out.l0 = sh[0];
  for (unsigned c = 0; c < 3; ++c) {
    V3d v(-sh[3][c], sh[1][c], sh[2][c]);
    // LVUtils.LinearizeSingleSH(): nothing shows negative light.
    const double length = v.length();
    const double most = std::max(sh[0][c], 0.0);
    out.l1[c] = length > most ? v * (most / length) : v;
  }
  return out;
}

constexpr int class_light_probes = 258;
constexpr int class_texture_3d = 117;

std::string hex_of_halves(const std::vector<V4f>& texels) {
  constexpr const char* digits = "0123456789abcdef";
  std::string out;
  out.reserve(texels.size() * 16);
  for (const V4f& texel : texels) {
    for (const float channel : {texel.x, texel.y, texel.z, texel.w}) {
      const std::uint16_t word = pack_half(channel);
      for (const unsigned shift : {4U, 0U, 12U, 8U}) out.push_back(digits[word >> shift & 15U]);
    }
  }
  return out;
}

void write_texture(const std::string& path, const V3i& size, const std::vector<V4f>& texels, bool force) {
  const std::size_t bytes = texels.size() * 8;
  std::string text = asset_head(class_texture_3d, "Texture3D", stem_of(path));
  text += fmt::format(
      "  m_ImageContentsHash:\n    serializedVersion: 2\n    Hash: 00000000000000000000000000000000\n"
      "  m_ForcedFallbackFormat: 4\n  m_DownscaleFallback: 0\n  serializedVersion: 4\n  m_ColorSpace: 0\n"
      "  m_Format: 48\n  m_Width: {}\n  m_Height: {}\n  m_Depth: {}\n  m_MipCount: 1\n  m_DataSize: {}\n"
      "  m_TextureSettings:\n    serializedVersion: 2\n    m_FilterMode: 1\n    m_Aniso: 0\n    m_MipBias: 0\n"
      "    m_WrapU: 1\n    m_WrapV: 1\n    m_WrapW: 1\n  m_UsageMode: 0\n  m_IsReadable: 1\n"
      "  image data: {}\n  _typelessdata: {}\n  m_StreamData:\n    serializedVersion: 2\n    offset: 0\n    size: 0\n"
      "    path: \n",
      size.x, size.y, size.z, bytes, bytes, hex_of_halves(texels));
  write_file(path, text, force);
}

}  // namespace

std::size_t write_unity_probes(const std::string& path, const ProbeVolume& volume, bool force) {
  std::vector<std::size_t> probes;
  for (std::size_t i = 0; i < volume.states.size(); ++i)
    if (volume.states[i] != ProbeState::dark) probes.push_back(i);
  if (probes.size() > most_unity_probes) {
    throw ParameterError("voxel_size",
                         fmt::format("there would be {} probes, and {} are what a text asset is good for; "
                                     "ask for a larger one",
                                     probes.size(), most_unity_probes));
  }
  std::string text = asset_head(class_light_probes, "LightProbes", stem_of(path));
  text +=
      "  m_Data:\n    m_Tetrahedralization:\n      m_Tetrahedra: []\n      m_HullRays: []\n    m_ProbeSets: []\n"
      "    m_Positions:\n";
  for (const std::size_t i : probes) {
    const V3d p = to_world(volume.frame.to_world(V3f(volume.frame.vertex_coordinates(i))), volume.anchor_m);
    text += fmt::format("    - {{x: {}, y: {}, z: {}}}\n", float(-p.x), float(p.y), float(p.z));
  }
  text += "    m_NonTetrahedralizedProbeSetIndexMap: []\n  m_BakedCoefficients:\n";
  for (const std::size_t i : probes) {
    const std::array<V3d, 9> sh = in_unity(volume.sh[i]);
    for (unsigned number = 0; number < 27; ++number) {
      text += fmt::format("  {} sh[{:2}]: {}\n", number == 0 ? "-" : " ", number, float(sh[number % 9][number / 9]));
    }
  }
  // Nothing of it is baked for mixed lights: they are all there.
  text += "  m_BakedLightOcclusion: []\n";
  write_file(path, text, force);
  return probes.size();
}

float write_vrc_volume(const std::string& path, const ProbeVolume& volume, const ProbeExport& about, bool force) {
  const V3i& n = volume.frame.size;
  const std::size_t count = volume.frame.vertex_count();
  std::array<std::vector<V4f>, 3> textures;
  for (auto& texture : textures) texture.resize(count);
  double largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const V3i at = volume.frame.vertex_coordinates(i);
    const std::size_t texel = volume.frame.vertex_index(n.x - 1 - at.x, at.y, at.z);
    const Linear light = linear_of(volume.sh[i]);
    const auto& [r, g, b] = light.l1;
    textures[0][texel] = V4f(float(light.l0.x), float(light.l0.y), float(light.l0.z), float(r.z));
    textures[1][texel] = V4f(float(-r.x), float(-g.x), float(-b.x), float(g.z));
    textures[2][texel] = V4f(float(r.y), float(g.y), float(b.y), float(b.z));
    largest = std::max({largest, light.l0.x, light.l0.y, light.l0.z});
  }
  const float scale = largest > double(largest_half) ? half_scale(float(largest)) : 1;
  for (auto& texture : textures)
    for (V4f& texel : texture) texel /= scale;
  write_texture(path, n, textures[0], force);
  write_texture(beside(path, ".1.asset"), n, textures[1], force);
  write_texture(beside(path, ".2.asset"), n, textures[2], force);
  Json json = probe_json(volume, about, path);
  json["layout"] =
      "LightVolume's Texture0 to 2: L0.rgb L1r.z; L1r.x L1g.x L1b.x L1g.z; L1r.y L1g.y L1b.y L1b.z; of E / pi / "
      "intensity, x mirrored";
  json["intensity"] = scale;
  const V3d center = volume.center_m();
  const V3f extent = volume.extent_m();
  json["transform"] = {{"position", {-center.x, center.y, center.z}}, {"scale", {extent.x, extent.y, extent.z}}};
  write_file(beside(path, ".json"), json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n', force);
  return scale;
}

ProbeReader vrc_reader(const ProbeVolume& volume) {
  return [&volume](const V3f& p, const V3f& n) {
    const Footprint footprint = probe_footprint(volume, p);
    V3d e(0, 0, 0);
    for (std::size_t i = 0; i < std::size_t(footprint.count); ++i) {
      const Linear light = linear_of(volume.sh[footprint.vertex[i]]);
      for (unsigned c = 0; c < 3; ++c)
        e[c] += (light.l0[c] + light.l1[c].dot(V3d(n))) * double(footprint.weight[i]) * double(pi);
    }
    return Rgb(float(std::max(e.x, 0.0)), float(std::max(e.y, 0.0)), float(std::max(e.z, 0.0)));
  };
}

}  // namespace ivory
