#include "grid/io/export/sh9_dialect.h"

#include <bit>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/io/file.h"
#include "grid/io/json.h"

namespace ivory {

namespace {

Json flat(const std::array<V3d, 9>& values) {
  Json list = Json::array();
  for (const V3d& v : values)
    for (int c = 0; c < 3; ++c) list.push_back(v[c]);
  return list;
}

// Three.js wants one for each object; of the same light the same one (FNV-1a of the numbers' bits).
std::string uuid_of(const std::array<V3d, 9>& values) {
  std::uint64_t hash = 0xCBF29CE484222325U;
  for (const V3d& v : values) {
    for (int c = 0; c < 3; ++c) {
      const auto bits = std::bit_cast<std::uint64_t>(v[c]);
      for (unsigned byte = 0; byte < 8; ++byte) hash = (hash ^ (bits >> (8 * byte) & 0xFFU)) * 0x100000001B3U;
    }
  }
  const std::uint64_t mixed = hash * 0x9E3779B97F4A7C15U;
  return fmt::format("{:08x}-{:04x}-4{:03x}-8{:03x}-{:012x}", std::uint32_t(hash >> 32U), hash >> 16U & 0xFFFFU,
                     hash & 0xFFFU, mixed >> 52U, mixed & 0xFFFFFFFFFFFFU);
}

Json three_js_object(const std::array<V3d, 9>& values) {
  // What Object3D.toJSON() and ObjectLoader agree on; version 4.7 of three.js r187.
  return {{"metadata", {{"version", 4.7}, {"type", "Object"}, {"generator", "ivory"}}},
          {"object",
           {{"uuid", uuid_of(values)},
            {"type", "LightProbe"},
            {"name", "ivory"},
            {"layers", 1},
            {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
            {"intensity", 1},
            {"sh", flat(values)}}},
          {"type", "LightProbe"},
          {"intensity", 1},
          {"sh", flat(values)}};
}

constexpr const char* babylon_world =
    "E_lm in the basis and the left-handed world of Babylon.js: signs + - + - + - + - +, and x mirrored as its glTF "
    "loader mirrors it; ";

}  // namespace

void write_sh9_dialect(const std::string& path, const Sh9Asset& asset, Sh9Dialect dialect, bool force) {
  const std::array<V3d, 9> values = in_dialect(asset.sh, dialect);
  Json extras{{"generator", std::string("ivory ") + IVORY_VERSION},
              {"order", asset.order},
              {"window", {1, asset.window.band1, asset.window.band2}},
              {"average_error", asset.error.average},
              {"maximum_error", asset.error.maximum}};
  extras.update(to_json(asset.metadata));
  Json json;
  switch (dialect) {
    case Sh9Dialect::ivory:
      write_sh9(path, asset, force);
      return;
    case Sh9Dialect::filament:
      extras["use"] =
          "IndirectLight::Builder().irradiance(3, irradiance).intensity(1): already in lux over pi, world +Y up";
      json = {{"irradiance", to_json(values)}};
      break;
    case Sh9Dialect::three_js:
      extras["use"] = "new THREE.ObjectLoader().load(url, probe => scene.add(probe)), or .parse(this)";
      json = three_js_object(values);
      break;
    case Sh9Dialect::ext_lights_image_based:
      extras["use"] = std::string(babylon_world) + "in a right-handed scene, turn the light by pi about Y";
      json = {{"intensity", 1}, {"irradianceCoefficients", to_json(values)}};
      break;
    case Sh9Dialect::babylon_js:
      extras["use"] = std::string(babylon_world) +
                      "sh = SphericalHarmonics.FromArray(irradianceCoefficients); "
                      "sh.convertIrradianceToLambertianRadiance(); scene.environmentTexture.sphericalPolynomial = "
                      "SphericalPolynomial.FromHarmonics(sh)";
      json = {{"irradianceCoefficients", to_json(values)}};
      break;
    case Sh9Dialect::playcanvas:
      extras["use"] = "material.ambientSH = new Float32Array(ambientSH); material.update()";
      json = {{"ambientSH", flat(values)}};
      break;
    case Sh9Dialect::unity: {
      extras["use"] =
          "SphericalHarmonicsL2 probe; probe[c, i] = sh[9 * c + i]; RenderSettings.ambientProbe = probe; x mirrored as "
          "glTF importers mirror it";
      Json channels = Json::array();
      for (int c = 0; c < 3; ++c)
        for (const V3d& v : values) channels.push_back(v[c]);
      json = {{"sh", channels}};
      break;
    }
  }
  json["extras"] = extras;
  write_file(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n', force);
}

}  // namespace ivory
