// What a file is, from its name and its first bytes: who drops it or passes it need not say.
#pragma once

#include <string>

#include "grid/base/names.h"

namespace ivory {

enum class FileKind { scene, grid, sh9, difmap, fiv, cubemap, lobes, spheres, image };
template <>
inline constexpr auto name_table<FileKind> = make_name_table<FileKind>("kind of file", {{FileKind::scene, "scene"},
                                                                                        {FileKind::grid, "grid"},
                                                                                        {FileKind::sh9, "sh9"},
                                                                                        {FileKind::difmap, "difmap"},
                                                                                        {FileKind::fiv, "fiv"},
                                                                                        {FileKind::cubemap, "cubemap"},
                                                                                        {FileKind::lobes, "lobes"},
                                                                                        {FileKind::spheres, "spheres"},
                                                                                        {FileKind::image, "image"}});

// .gltf and .glb are scenes, .vdb grids, .json sphere sets or SH9; OpenEXR files by ivory say what they are; all else
// counts as an image. Throws Error where there is no such file, or it is an asset that ivory does not know. What the
// kind's own reader finds wrong shows when it reads.
FileKind file_kind(const std::string& path);

}  // namespace ivory
