// Volumes of probes as KTX2 textures, with a JSON file beside that says where they stand and how they are read.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "grid/export/atlas.h"
#include "grid/export/reader.h"
#include "grid/io/json.h"
#include "grid/io/ktx/ktx2.h"

namespace ivory {

// What the files beside say of an export besides the volume.
struct ProbeExport {
  std::string target;  // its name
  StoredLight light = StoredLight::indirect;
  ReaderLoss loss;
  std::size_t thin_walls = 0;
  Metadata source;  // of the grid
};

// Is every dimension within what WebGL 2, WebGPU and Vulkan promise for 3D textures, 2048 texels a side at least?
// Throws ParameterError (voxel_size) where not.
void check_texture_size(const Atlas& atlas);

// The atlas in that format, zstd; `notes` are kept in the file. Channels beyond what the format holds are clamped: to
// be asked beforehand by largest_channel(). Throws Error as write_file() does.
void write_atlas(const std::string& path, const Atlas& atlas, Ktx2Format format,
                 const std::map<std::string, std::string>& notes, bool force);

// "room.json" beside "room.ktx2".
std::string beside(const std::string& path, const std::string& extension);

// Where the probes stand and what they are, in the world; `texture` is the file's name. Lists are x, y, z.
Json probe_json(const ProbeVolume& volume, const ProbeExport& about, const std::string& texture);

}  // namespace ivory
