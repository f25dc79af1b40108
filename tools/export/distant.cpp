#include "tools/export/distant.h"

#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/export/distant.h"
#include "grid/export/probe_tetrahedra.h"
#include "grid/io/difmap.h"
#include "grid/io/export/environment_cube.h"
#include "grid/io/export/filament.h"
#include "grid/io/export/gltf_light.h"
#include "grid/io/export/godot.h"
#include "grid/io/export/sh9_dialect.h"
#include "tools/cli/common.h"
#include "tools/export/export.h"

namespace ivory {

namespace {

using Json = nlohmann::ordered_json;

// Godot's probes fill a box: one so large that whatever is lit lies in it, and so small that floats tell its points.
constexpr float godot_half_extent_m = 1000;

Sh9Dialect dialect_of(ExportTarget target) {
  switch (target) {
    case ExportTarget::babylon_js:
      return Sh9Dialect::babylon_js;
    case ExportTarget::playcanvas:
      return Sh9Dialect::playcanvas;
    case ExportTarget::unity:
      return Sh9Dialect::unity;
    default:
      return Sh9Dialect::three_js;
  }
}

void write_godot(const std::string& path, const DistantLight& light, bool force) {
  const std::vector<float> ends{-godot_half_extent_m, godot_half_extent_m};
  const ProbeTetrahedra probes =
      probe_tetrahedra({ends, ends, ends}, V3f(0, 0, 0), {V3f(1, 0, 0), V3f(0, 1, 0), V3f(0, 0, 1)});
  ProbeSh9 sh;
  for (std::size_t i = 0; i < 9; ++i) sh[i] = V3f(light.sh.coefficients[i]);
  write_godot_probes(path, probes, std::vector<ProbeSh9>(probes.points.size(), sh), light.metadata, force);
}

}  // namespace

void export_distant(const ExportOptions& options, FileKind kind, const ExportFormat& format,
                    const CommonOptions& common) {
  Sh9Asset asset;
  DistantLight light;
  if (kind == FileKind::sh9) {
    asset = read_sh9(options.asset);
    light = distant_light(asset.sh, asset.metadata);
  } else {
    const DifMap map = read_difmap(options.asset);
    light = distant_light(map);
    asset.sh = light.sh;
    // The light of the whole sphere is four times the mean of E over all normals.
    asset.error = sh9_error(light.sh, map.e, V3d(mean_radiance(light)) * (4 * double(pi)));
    asset.metadata = light.metadata;
  }
  Json result{{"file", options.output},
              {"kind", "export"},
              {"target", name_of(format.target)},
              {"asset", name_of(kind)},
              {"source", options.asset}};
  std::string text = fmt::format("{}: {}\n", options.output, format.holds);
  bool by_nine = true;
  switch (format.target) {
    case ExportTarget::filament: {
      if (format.extension == ".txt") {
        write_filament_text(options.output, light, common.force);
        break;
      }
      const float scale = write_filament_ktx(options.output, light, common.force);
      result["cube_scale"] = scale;
      if (scale != 1) text += fmt::format("its cube map is divided by {:g}: brighter than the format holds\n", scale);
      text += "its cube map holds E / pi, what a rough mirror shows: the asset knows no sharp reflections\n";
      break;
    }
    case ExportTarget::gltf:
      write_gltf_with_light(options.output, options.scene, light, common.force);
      text +=
          "its reflections hold the mean light: the asset knows no sharp ones; for Babylon.js' left-handed scene "
          "(in a right-handed one, turn the light by pi about Y)\n";
      break;
    case ExportTarget::godot:
      write_godot(options.output, light, common.force);
      result["half_extent_m"] = godot_half_extent_m;
      text += fmt::format("for objects with gi_mode dynamic within {:g} m of the node\n", godot_half_extent_m);
      break;
    case ExportTarget::bevy: {
      const EnvironmentCube cube = write_bevy_cube(options.output, light, common.force);
      by_nine = false;
      result["size"] = cube.size;
      result["intensity"] = cube.intensity;
      text += fmt::format("EnvironmentMapLight {{ intensity: {:g}, .. }}, faces of {} x {} texels\n", cube.intensity,
                          cube.size, cube.size);
      break;
    }
    default:
      write_sh9_dialect(options.output, asset, dialect_of(format.target), common.force);
  }
  result["loss"] = by_nine ? light.sh_loss : 0;
  result["bytes"] = std::filesystem::file_size(options.output);
  if (by_nine && kind == FileKind::difmap)
    text += fmt::format("nine coefficients lose {:.3g} % of E (RMS over normals, of the mean)\n", 100 * light.sh_loss);
  print_result(common, result, text);
}

}  // namespace ivory
