#include "grid/io/export/probe_volumes.h"

#include <array>
#include <filesystem>

#include <ImathMatrixAlgo.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/half.h"
#include "grid/export/texel.h"
#include "grid/io/file.h"

namespace ivory {

namespace {

constexpr std::array<const char*, 6> side_names{"+x", "-x", "+y", "-y", "+z", "-z"};
constexpr std::array<const char*, 9> coefficient_names{"L00",  "L1-1", "L10", "L11", "L2-2",
                                                       "L2-1", "L20",  "L21", "L22"};

float alpha_of(ProbeState state) {
  switch (state) {
    case ProbeState::measured:
      return 1;
    case ProbeState::filled:
      return 0.5F;
    default:
      return 0;
  }
}

// What the light is divided by so that the format holds it: 1 where it does anyway with all its bits.
float scale_for(float largest, Ktx2Format format) {
  constexpr float dim = 0.01F;  // below, halves lose bits
  const float most = format == Ktx2Format::e5b9g9r9 ? largest_shared_exponent : largest_half;
  return largest > most || (largest > 0 && largest < dim) ? half_scale(largest) : 1;
}

void divide(Atlas& atlas, float scale) {
  for (V4f& texel : atlas.texels) texel = V4f(texel.x / scale, texel.y / scale, texel.z / scale, texel.w);
}

void write_json(const std::string& path, const Json& json, bool force) {
  write_file(beside(path, ".json"), json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n', force);
}

std::map<std::string, std::string> notes_of(const ProbeExport& about) {
  return {{"ivory", "probe volume for " + about.target + "; the .json file beside says where it stands"}};
}

std::string loader_of_three_js(const ProbeVolume& volume, const std::string& texture) {
  const V3d center = volume.center_m();
  const V3f& h = volume.frame.spacing_m;
  const V3i& n = volume.frame.size;
  return fmt::format(R"(// Written by ivory {0}. For three.js r184 and later:
//   import {{ LightProbeGridWebGL }} from 'three/addons/lighting/LightProbeGridWebGL.js';
//   scene.add( await loadProbeGrid( renderer, LightProbeGridWebGL ) );
// With WebGPURenderer, and up to r185, the class is LightProbeGrid of 'three/addons/lighting/LightProbeGrid.js'.
import {{ LinearFilter, REVISION }} from 'three';
import {{ KTX2Loader }} from 'three/addons/loaders/KTX2Loader.js';

export async function loadProbeGrid( renderer, Grid, url = new URL( '{1}', import.meta.url ).href ) {{

	const texture = await new KTX2Loader().detectSupport( renderer ).loadAsync( url );
	return makeProbeGrid( texture, Grid );

}}

export function makeProbeGrid( texture, Grid ) {{

	texture.minFilter = texture.magFilter = LinearFilter;
	texture.needsUpdate = true;
	const [ nx, ny, nz ] = [ {2}, {3}, {4} ];
	// Since r187 the outermost probes stand half a cell inside the box, before that on it.
	const cells = ( n ) => parseInt( REVISION ) >= 187 ? n : n - 1;
	const grid = new Grid( cells( nx ) * {5}, cells( ny ) * {6}, cells( nz ) * {7}, nx, ny, nz );
	grid.position.set( {8}, {9}, {10} );
	grid.updateBoundingBox();
	grid.texture = texture;
	return grid;

}}
)",
                     IVORY_VERSION, std::filesystem::path(texture).filename().string(), n.x, n.y, n.z, h.x, h.y, h.z,
                     center.x, center.y, center.z);
}

// With its texels divided by what the format needs to hold them.
TextureResult write_scaled(const std::string& path, Atlas atlas, Ktx2Format format, const ProbeExport& about,
                           bool force) {
  check_texture_size(atlas);
  const TextureResult out{format, scale_for(largest_channel(atlas), format)};
  divide(atlas, out.scale);
  write_atlas(path, atlas, format, notes_of(about), force);
  return out;
}

}  // namespace

TextureResult write_three_js_atlas(const std::string& path, const ProbeVolume& volume, const ProbeExport& about,
                                   bool force) {
  // LightProbeGridWebGL.js: the 27 numbers of a probe, coefficient by coefficient, four a texel.
  const Atlas atlas = padded_atlas(volume.frame.size, 7, [&](int block, std::size_t probe) {
    V4f texel(0, 0, 0, 0);
    for (int i = 0; i < 4; ++i) {
      const int number = 4 * block + i;
      if (number < 27) texel[unsigned(i)] = volume.sh[probe][std::size_t(number / 3)][unsigned(number % 3)];
    }
    return texel;
  });
  check_texture_size(atlas);
  TextureResult out;
  float largest = largest_channel(atlas);
  for (const V4f& texel : atlas.texels) largest = std::max(largest, std::abs(texel.w));
  // The WebGL version of the class knows no intensity that could scale halves.
  out.format = scale_for(largest, Ktx2Format::rgba16f) == 1 ? Ktx2Format::rgba16f : Ktx2Format::rgba32f;
  write_atlas(path, atlas, out.format, notes_of(about), force);
  return out;
}

TextureResult write_three_js_volume(const std::string& path, const ProbeVolume& volume, const ProbeExport& about,
                                    bool force) {
  const TextureResult out = write_three_js_atlas(path, volume, about, force);
  write_file(beside(path, ".js"), loader_of_three_js(volume, path), force);
  Json json = probe_json(volume, about, path);
  json["layout"] = "LightProbeGrid's atlas: 27 radiance coefficients a probe, four a texel, seven blocks along z";
  write_json(path, json, force);
  return out;
}

TextureResult write_bevy_volume(const std::string& path, const ProbeVolume& volume, const ProbeExport& about,
                                Ktx2Format format, bool force) {
  // irradiance_volume.wesl adds it to the diffuse light as radiance: E / pi, times the component's intensity.
  Atlas atlas = bevy_atlas(volume.frame.size, [&](std::size_t side, std::size_t probe) {
    const Rgb& e = volume.sides[probe][side];
    return V4f(e.x / pi, e.y / pi, e.z / pi, 1);
  });
  const TextureResult out = write_scaled(path, std::move(atlas), format, about, force);
  Json json = probe_json(volume, about, path);
  json["layout"] =
      "IrradianceVolume's: size x by 2 y by 3 z; E / pi / intensity, positive sides first along y, axes along z";
  // The entity's unit cube is the box of all cells, each voxel's centre in the middle of its own.
  const V3d center = volume.center_m();
  const V3f extent = volume.extent_m();
  const M33f& m = volume.frame.local_to_world;
  const Imath::Quatf q = Imath::extractQuat(
      M44f(m[0][0], m[0][1], m[0][2], 0, m[1][0], m[1][1], m[1][2], 0, m[2][0], m[2][1], m[2][2], 0, 0, 0, 0, 1));
  json["intensity"] = out.scale;
  json["transform"] = {{"translation", {center.x, center.y, center.z}},
                       {"rotation", {q.v.x, q.v.y, q.v.z, q.r}},
                       {"scale", {extent.x, extent.y, extent.z}}};
  write_json(path, json, force);
  return out;
}

TextureResult write_sides_volume(const std::string& path, const ProbeVolume& volume, const ProbeExport& about,
                                 Ktx2Format format, bool force) {
  Atlas atlas = padded_atlas(volume.frame.size, 6, [&](int side, std::size_t probe) {
    const Rgb& e = volume.sides[probe][std::size_t(side)];
    return V4f(e.x, e.y, e.z, alpha_of(volume.states[probe]));
  });
  const TextureResult out = write_scaled(path, std::move(atlas), format, about, force);
  Json json = probe_json(volume, about, path);
  json["layout"] =
      "E / scale in lux at the normals of `sides`, in the world's axes; block b has its slice k at z = b (nz + "
      "2) + 1 + k, copies of its outer slices around it; alpha 1 measured, 0.5 filled, 0 dark";
  json["sides"] = side_names;
  json["scale"] = out.scale;
  write_json(path, json, force);
  return out;
}

TextureResult write_sh9_volume(const std::string& path, const ProbeVolume& volume, const ProbeExport& about,
                               bool force) {
  Atlas atlas = padded_atlas(volume.frame.size, 9, [&](int i, std::size_t probe) {
    const V3f& c = volume.sh[probe][std::size_t(i)];
    return V4f(c.x, c.y, c.z, alpha_of(volume.states[probe]));
  });
  const TextureResult out = write_scaled(path, std::move(atlas), Ktx2Format::rgba16f, about, force);
  Json json = probe_json(volume, about, path);
  json["layout"] =
      "radiance coefficients / scale (Ramamoorthi & Hanrahan 2001, all-positive basis) in the world's axes, in "
      "the order of `coefficients`; block b has its slice k at z = b (nz + 2) + 1 + k, copies of its outer "
      "slices around it; alpha 1 measured, 0.5 filled, 0 dark";
  json["coefficients"] = coefficient_names;
  json["scale"] = out.scale;
  write_json(path, json, force);
  return out;
}

}  // namespace ivory
