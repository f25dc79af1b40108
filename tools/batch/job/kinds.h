// What a job file may hold, one row a kind: the command that makes it, and what of the options' values is read.
#pragma once

#include <string>
#include <vector>

namespace ivory {

// What an option's value names.
enum class InputKind {
  scene,        // [scene.NAME] or a .gltf, .glb file: by its content
  environment,  // [environment.NAME] or an image
  asset,        // another asset of the job, or a file
  file,         // any file, by its bytes; a scene's name stands for its file
  object,       // FILE.glb[@X,Y,Z], SCENE[@X,Y,Z], or a node of the scene
  occluder,     // NODE=TABLE
  placed,       // ASSET[@X,Y,Z]
};

struct InputOption {
  std::string option;  // as the command line has it: "error-points"
  InputKind kind;
  std::vector<std::string> asset_kinds;  // whose names may be given without their kind
};

// What of a scene a kind of asset depends on.
struct SceneUse {
  bool shape = true;  // triangles where they stand, and where they let light through
  bool look = true;   // materials
  bool light = true;  // lights and what is emitted
  bool cameras = false;
  bool names = false;  // of nodes
};

struct AssetKind {
  std::string name;                  // "grid"
  std::vector<std::string> command;  // {"bake", "grid"}
  std::string extension;             // of its output where the job names none; empty: it must
  std::vector<InputOption> inputs;
  std::vector<std::string> outputs;  // options that name files to write, the main one first
  SceneUse use;
  // Raised with every change that gives other values from the same input: `ivory batch` bakes again by it.
  int baking_version;
  bool check;                     // may its options be checked before its inputs are there?
  bool predicts;                  // has it --dry-run?
  double heft;                    // how long it takes beside others, where nothing better is known
  std::vector<int> uv_sets = {};  // of the scene that it reads though no texture asks for them
};

const std::vector<AssetKind>& asset_kinds();
// nullptr where there is none.
const AssetKind* find_kind(const std::string& name);
const InputOption* find_input(const AssetKind& kind, const std::string& option);

// "target_error" of "target-error", and back.
std::string key_of_option(const std::string& option);
std::string option_of_key(const std::string& key);

}  // namespace ivory
