// From the names in an asset's options to the files and assets that it reads.
#pragma once

#include <map>
#include <string>

#include "tools/batch/job/each.h"
#include "tools/batch/job/job.h"

namespace ivory {

struct NamedEnvironment {
  std::string path;
  std::vector<JobEntry> options;  // layout
};

struct JobNames {
  std::map<std::string, NamedScene> scenes;
  std::map<std::string, NamedEnvironment> environments;
};

// `path` as a job file says it, relative to the job's folder instead of to that file.
std::string from_job_folder(const std::string& path, const JobPlace& place, const Job& job);

// How scenes are loaded by the options of an asset or scene.
LoadParams load_params(const std::vector<JobOption>& options);

// Options that scenes and environments bring along by their names: added where the asset does not give them itself.
void add_named_options(JobAsset& asset, const JobNames& names);

// Puts names of nodes in place of patterns over them (`without`, `object`).
void expand_node_patterns(JobAsset& asset, const NodeReader& nodes);

// Puts files in place of names in the options of each asset, and finds what it reads and which assets it needs. Names
// of nodes are left. `check_files`: files must be there. Throws JobError.
void resolve_inputs(Job& job, const JobNames& names, const NodeReader& nodes, bool check_files);

}  // namespace ivory
