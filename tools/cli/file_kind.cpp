#include "tools/cli/file_kind.h"

#include <array>
#include <filesystem>
#include <utility>

#include "grid/base/error.h"
#include "grid/io/exr.h"
#include "grid/io/file.h"
#include "grid/io/lobes.h"
#include "grid/io/sh9.h"
#include "grid/io/sphere_set.h"
#include "tools/cli/scene_input.h"

namespace ivory {

namespace {

using Named = std::pair<FileKind, std::string_view>;
constexpr std::array<Named, 9> names{{{FileKind::scene, "scene"},
                                      {FileKind::grid, "grid"},
                                      {FileKind::sh9, "sh9"},
                                      {FileKind::difmap, "difmap"},
                                      {FileKind::fiv, "fiv"},
                                      {FileKind::cubemap, "cubemap"},
                                      {FileKind::lobes, lobes_kind},
                                      {FileKind::spheres, "spheres"},
                                      {FileKind::image, "image"}}};

}  // namespace

std::string_view name(FileKind kind) {
  for (const auto& [of_kind, text] : names) {
    if (of_kind == kind) return text;
  }
  return "";
}

FileKind file_kind(const std::string& path) {
  std::error_code unreadable;
  if (!std::filesystem::exists(path, unreadable)) throw Error(path, "does not exist", "check the name");
  if (std::filesystem::is_directory(path, unreadable)) throw Error(path, "is a folder", "name a file");
  if (is_scene_name(path)) return FileKind::scene;
  if (lower_extension(path) == ".vdb") return FileKind::grid;
  if (is_sphere_set(path)) return FileKind::spheres;
  if (is_sh9_name(path)) return FileKind::sh9;
  const std::string kind = exr_asset_kind(path);
  if (kind.empty()) return FileKind::image;
  for (const auto& [of_kind, text] : names) {
    if (text == kind) return of_kind;
  }
  throw Error(path, "holds an asset of kind '" + kind + "', which is unknown", "use a newer ivory");
}

}  // namespace ivory
