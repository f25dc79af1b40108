// Sections that stand for many assets: one for each file, node or word that `each` finds.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/batch/job/job.h"

namespace ivory {

// One of them: what it is called, and the variables that its section may use.
struct EachItem {
  std::string name;
  std::map<std::string, JobValue> variables;
};

struct NamedScene {
  std::string path;  // relative to the job's folder
  std::vector<JobEntry> options;
  LoadParams load;
};

// What `each` finds:
// - "props/*.glb": ${file} as paths are written in that job file, ${stem} its name without folder and extension;
// - { scene = "level", nodes = "Room*" }: ${node}, ${bounds} its box, ${center}; `margin` metres are added around;
// - ["a", "b"]: ${each}.
// All have ${index}, from 0, and ${name}. `folder`: of the job file that says it. Throws JobError, also where it finds
// nothing.
std::vector<EachItem> find_each(const JobEntry& entry, const std::string& folder,
                                const std::map<std::string, NamedScene>& scenes, const NodeReader& nodes);

// Does `name` match a shell's pattern?
bool matches(const std::string& pattern, const std::string& name);
bool is_pattern(const std::string& text);

// A name that stands in the names of assets and files: letters, digits, '_', '-' and '.'; others become '_'.
std::string plain_name(const std::string& text);

}  // namespace ivory
