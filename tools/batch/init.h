// A first job file, from what a scene holds.
#pragma once

#include <string>

#include "tools/cli/common.h"

namespace ivory {

// Looks into `scene` and writes `job`, a job file with comments that bakes it: rooms that nodes are called after, its
// cameras, marked occluders and groups of lights, environments beside it. Throws Error as load_gltf() does, and where
// `job` is there and not --force.
void write_first_job(const std::string& scene, const std::string& job, const CommonOptions& common);

// The text of such a file. `scene_path`: as the job file is to name it.
std::string first_job_text(const std::string& scene, const std::string& scene_path);

}  // namespace ivory
