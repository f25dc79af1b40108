#include "tools/input/file_kind.h"

#include <filesystem>

#include "grid/base/error.h"
#include "grid/io/exr.h"
#include "grid/io/file.h"
#include "grid/io/json.h"
#include "grid/io/sh9.h"
#include "tools/input/scene.h"

namespace ivory {

FileKind file_kind(const std::string& path) {
  std::error_code unreadable;
  if (!std::filesystem::exists(path, unreadable)) throw Error(path, "does not exist", "check the name");
  if (std::filesystem::is_directory(path, unreadable)) throw Error(path, "is a folder", "name a file");
  if (is_scene_name(path)) return FileKind::scene;
  if (lower_extension(path) == ".vdb") return FileKind::grid;
  if (const std::string kind = json_asset_kind(path); !kind.empty()) return from_name<FileKind>(kind);
  if (is_sh9_name(path)) return FileKind::sh9;
  const std::string kind = exr_asset_kind(path);
  // Of 'ivory render --checkpoint': a picture, with more in it.
  if (kind.empty() || kind == "render_checkpoint") return FileKind::image;
  if (const auto known = find_by_name<FileKind>(kind)) return *known;
  throw Error(path, "holds an asset of kind '" + kind + "', which is unknown", "use a newer ivory");
}

}  // namespace ivory
