// A job file with all that it includes, and its variables.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/batch/job/value.h"

namespace ivory {

// [kind.name] of a job file: an asset, a scene, an environment, defaults.
struct JobSection {
  std::string kind;
  std::string name;
  JobPlace place;
  JobTable entries;
};

struct JobTree {
  std::vector<JobSection> sections;           // in order, those of included files first; no two of one name
  std::map<std::string, JobTable> defaults;   // [default.KIND]
  std::map<std::string, JobValue> variables;  // [variables] and --set
  JobTable job;                               // [job]
  std::vector<std::string> files;             // all that were read
};

// Reads `path` and what its `include` names, relative to the file that says it. Where two files say the same, of
// [variables], [default.KIND] and [job] the including file's is kept; a section twice is a mistake. `set`: NAME=VALUE,
// which replaces a variable's value. `sections`: the kinds that may be there. Throws JobError and Error; UsageError for
// `set`.
JobTree read_job_tree(const std::string& path, const std::vector<std::string>& set,
                      const std::vector<std::string>& kinds);

// Names and what they stand for; those asked last stand before the others.
using JobScope = std::vector<const std::map<std::string, JobValue>*>;

// `value` with each ${NAME} in its texts replaced; a text that is nothing but one becomes the variable's value. $${ is
// a
// ${ that stays. Throws JobError for unknown names, and for variables that stand for each other in a ring.
JobValue substituted(const JobValue& value, const JobScope& scope);

// " (did you mean 'voxel_size'?)", or nothing where no name is like it.
std::string like(const std::string& name, const std::vector<std::string>& names);

}  // namespace ivory
