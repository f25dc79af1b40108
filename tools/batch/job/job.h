// A job as it is to be run: assets with the command lines that make them, and what each reads.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "grid/base/types.h"
#include "tools/batch/job/kinds.h"
#include "tools/batch/job/tree.h"
#include "tracer/gltf/loader.h"

namespace ivory {

struct JobOption {
  std::string name;                 // as the command line has it, without dashes
  bool by_place = false;            // an argument
  bool flag = false;                // has no values
  std::vector<std::string> values;  // one but for repeated options
  JobPlace place;
};

// What an asset reads.
struct JobInput {
  InputKind kind;
  std::string option;  // that names it
  std::string path;    // relative to the job's folder
  LoadParams load;     // of a scene
  int asset = -1;      // of the job, whose output it is; -1: a file that is there
  JobPlace place;
};

struct JobAsset {
  std::string name;  // "grid.hall"
  const AssetKind* kind = nullptr;
  std::vector<JobOption> options;    // outputs included
  std::vector<std::string> outputs;  // files, relative to the job's folder
  std::vector<JobInput> inputs;
  std::vector<int> needs;  // assets, each once
  JobPlace place;
};

struct Job {
  std::string file;    // as it was given
  std::string origin;  // the folder that it was given in, absolute
  std::string folder;  // the job file's, absolute; paths in assets are relative to it
  std::string output;  // folder of assets, relative to that
  std::vector<JobAsset> assets;
};

// A node of a scene that has triangles below it, and what these fill of the world.
struct NodeBox {
  std::string name;
  Imath::Box3d bounds_m;
  std::string fiv_table;  // file that extras.ivory_occluder names; empty: none
};
// The nodes of a scene's file; asked for where a job has patterns over nodes.
using NodeReader = std::function<std::vector<NodeBox>(const std::string& path, const LoadParams& params)>;

// The job that the tree of `file` describes, which was given in the folder `origin`. To be called in the job's own
// folder. Every option is checked as the command that takes it does, as far as that can be without its inputs;
// `check_files`: files that are to be read must be there. Throws JobError.
Job make_job(const std::string& file, const std::string& origin, const JobTree& tree, const NodeReader& nodes,
             bool check_files);

// The folder that [job] names for assets, relative to the job's own; empty: that itself.
std::string output_folder(const std::string& file, const std::string& origin, const JobTree& tree);

// The command line of an asset, after "ivory".
std::vector<std::string> arguments_of(const JobAsset& asset);

// The kinds that sections may be of: those of assets, "scene", "environment".
std::vector<std::string> section_kinds();

}  // namespace ivory
