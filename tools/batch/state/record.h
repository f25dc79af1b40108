// What a batch knows of its earlier runs: the file LEVEL.batch.json in the folder of what it bakes.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "grid/base/types.h"
#include "tools/batch/job/job.h"
#include "tracer/core/content.h"

namespace ivory {

// What a scene's file holds, and by what bytes that is known.
struct SceneFacts {
  std::vector<std::pair<std::string, std::string>> files;  // name and hash of all that were read
  std::vector<ContentPart> parts;
  std::vector<NodeBox> nodes;
};

// All that an asset was made from, in words and hashes: "option voxel_size" is "0.25", "environment sky.hdr" a hash.
struct AssetInputs {
  std::vector<std::pair<std::string, std::string>> entries;  // name and value, each name once
  // The parts of scenes that it depends on, by the scene's name: what "scene level.glb" among the entries sums up.
  std::map<std::string, std::vector<ContentPart>> parts;
};

struct AssetRecord {
  AssetInputs inputs;
  std::vector<std::pair<std::string, std::string>> outputs;  // file and hash
  double seconds = 0;
  double memory_bytes = 0;  // at most, as its bake has planned; 0 where it does not
  bool finished = false;    // false: it was being made when the batch ended
};

struct BatchRecord {
  std::map<std::string, SceneFacts> scenes;   // by file and how it is loaded
  std::map<std::string, AssetRecord> assets;  // by name
};

// Empty where there is no such file. Throws Error where there is one that is no record of a batch.
BatchRecord read_record(const std::string& path);
// Whole or not at all.
void write_record(const std::string& path, const BatchRecord& record);

}  // namespace ivory
