// A scene's file with all that it refers to, as one .glb: what can be sent elsewhere.
#pragma once

#include <string>
#include <vector>

namespace ivory {

struct PackedScene {
  std::string bytes;                    // of the .glb
  bool needs_draco = false;             // its readers must know KHR_draco_mesh_compression
  std::vector<std::string> warnings{};  // of names of files that had to be mended, one line each
};

// Buffers and images, of files and data: URIs, become parts of one binary chunk; views of EXT_meshopt_compression are
// stored unpacked. All else stays as the file has it: nodes, materials and lights keep their indices. The same for the
// same files. Throws Error as load_gltf() does, and for what would be larger than a .glb can be (4 GB).
PackedScene pack_glb(const std::string& path);

}  // namespace ivory
