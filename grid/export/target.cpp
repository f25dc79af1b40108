#include "grid/export/target.h"

#include <array>

namespace ivory {

namespace {

using enum ExportTarget;
constexpr ExportAsset distant = ExportAsset::distant;
constexpr ExportAsset grid = ExportAsset::grid;
constexpr ExportAsset scene = ExportAsset::scene;

constexpr auto formats = std::to_array<ExportFormat>({
    {three_js, distant, ".json", "", "LightProbe, for ObjectLoader"},
    {babylon_js, distant, ".json", "", "SphericalHarmonics, for a texture's sphericalPolynomial"},
    {playcanvas, distant, ".json", "", "StandardMaterial.ambientSH"},
    {filament, distant, ".txt", "", "irradiance as cmgen writes it (sh.txt)"},
    {filament, distant, ".ktx", "", "KTX1 with the same as metadata, and a cube map for rough reflections"},
    {unity, distant, ".json", "", "SphericalHarmonicsL2, for RenderSettings.ambientProbe"},
    {godot, distant, ".tres", "", "LightmapGIData with the same light everywhere, for moving objects"},
    {gltf, distant, ".gltf", "", "the scene of --scene with EXT_lights_image_based"},
    {gltf, distant, ".glb", "", "the same for a binary scene"},
    {bevy, distant, ".ktx2", "", "cube map for EnvironmentMapLight"},
    {three_js, grid, ".ktx2", ".js .json", "LightProbeGrid's atlas, and a module that loads it"},
    {unity, grid, ".asset", "", "LightProbes: light probes"},
    {godot, grid, ".tres", "", "LightmapGIData: light probes for moving objects"},
    {bevy, grid, ".ktx2", ".json", "IrradianceVolume"},
    {ExportTarget::sides, grid, ".ktx2", ".json", "plain 3D texture: E at six normals"},
    {ExportTarget::sh9, grid, ".ktx2", ".json", "plain 3D texture: nine coefficients"},
    {nanovdb, grid, ".nvdb", "", "NanoVDB: E at six normals"},
    {usd, grid, ".usda", "", "a Volume of OpenVDBAsset fields, which names the .vdb file"},
    {vrc, grid, ".asset", ".1.asset .2.asset .json", "VRC Light Volumes' LightVolume: its three textures"},
    {web, scene, "", "", "a folder: a page that shows the scene lit by --grid, in three.js"},
});

}  // namespace

std::span<const ExportFormat> export_formats() { return formats; }

const ExportFormat& export_format(ExportTarget target, ExportAsset asset, std::string_view extension) {
  std::string known;
  for (const ExportFormat& format : formats) {
    if (format.target != target || format.asset != asset) continue;
    if (format.extension == extension) return format;
    if (format.extension.empty())
      throw ParameterError("output", std::string(name_of(target)) + " writes a folder: give a name without extension");
    known += (known.empty() ? "" : ", ") + std::string(format.extension);
  }
  if (!known.empty())
    throw ParameterError("output", std::string(name_of(target)) + " takes a file that ends in " + known);
  for (const ExportFormat& format : formats) {
    if (format.asset == asset && known.find(name_of(format.target)) == std::string::npos)
      known += (known.empty() ? "" : ", ") + std::string(name_of(format.target));
  }
  throw ParameterError(
      "to", std::string(name_of(target)) + " takes no " + std::string(name_of(asset)) + "; what does: " + known);
}

std::string export_format_lines(ExportAsset asset) {
  constexpr std::size_t name_width = 19;
  constexpr std::size_t extension_width = 7;
  std::string lines;
  for (const ExportFormat& format : formats) {
    if (format.asset != asset) continue;
    std::string line(name_of(format.target));
    line.resize(std::max(name_width, line.size() + 1), ' ');
    line += format.extension;
    line.resize(std::max(name_width + extension_width, line.size() + 1), ' ');
    lines += "  " + line + std::string(format.holds) + "\n";
  }
  return lines;
}

}  // namespace ivory
