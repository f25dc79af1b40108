#include "tools/batch/job/job.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "tools/batch/job/each.h"
#include "tools/batch/job/options.h"
#include "tools/batch/job/resolve.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

const std::vector<std::string> scene_keys{"file", "scale", "time", "animation", "without"};
const std::vector<std::string> environment_keys{"file", "layout"};

// "[scene.hall]"'s file, and what else it says, which must be among `keys`.
std::vector<JobEntry> read_named(const JobSection& section, const JobScope& scope, const std::vector<std::string>& keys,
                                 const Job& job, std::string& path) {
  std::vector<JobEntry> options;
  for (const JobEntry& entry : section.entries) {
    if (std::find(keys.begin(), keys.end(), entry.key) == keys.end())
      throw JobError(entry.place,
                     fmt::format("'{}' says nothing of {} {}{}", entry.key, section.kind == "scene" ? "a" : "an",
                                 section.kind, like(entry.key, keys)),
                     fmt::format("known are {}", fmt::join(keys, ", ")));
    JobEntry meant{entry.key, entry.place, substituted(entry.value, scope)};
    if (entry.key == "file") {
      path = from_job_folder(text_of(meant, "file = \"level.glb\""), meant.value.place, job);
      std::error_code error;
      if (!fs::is_regular_file(path, error))
        throw JobError(meant.value.place, fmt::format("there is no file '{}'", path),
                       "paths are relative to the job file");
    } else {
      options.push_back(std::move(meant));
    }
  }
  if (path.empty())
    throw JobError(section.place, fmt::format("[{}.{}] lacks 'file'", section.kind, section.name),
                   "give it file = \"...\"");
  return options;
}

class Builder {
 public:
  Builder(Job& job, const JobTree& tree, const NodeReader& nodes) : job_(job), tree_(tree), nodes_(nodes) {}

  JobNames names;

  void build() {
    const JobScope scope{&tree_.variables};
    for (const JobSection& section : tree_.sections) {
      if (section.kind == "scene") read_scene(section, scope);
      if (section.kind == "environment") {
        NamedEnvironment named;
        named.options = read_named(section, scope, environment_keys, job_, named.path);
        names.environments[section.name] = std::move(named);
      }
    }
    for (const JobSection& section : tree_.sections) {
      if (const AssetKind* kind = find_kind(section.kind)) add_section(*kind, section);
    }
  }

  void check_outputs() const {
    std::map<std::string, const JobAsset*> makers;
    for (const JobAsset& asset : job_.assets) {
      for (const std::string& output : asset.outputs) {
        const auto [known, fresh] = makers.emplace(output, &asset);
        if (!fresh)
          throw JobError(asset.place,
                         fmt::format("[{}] writes '{}', as [{}] does", asset.name, output, known->second->name),
                         "give each an output of its own");
      }
    }
  }

 private:
  void read_scene(const JobSection& section, const JobScope& scope) {
    NamedScene named;
    named.options = read_named(section, scope, scene_keys, job_, named.path);
    // Read as the options of an asset are.
    std::vector<JobOption> options;
    for (const JobEntry& entry : named.options) {
      for (JobOption& option : make_option(*find_kind("grid"), entry)) options.push_back(std::move(option));
    }
    named.load = load_params(options);
    names.scenes[section.name] = std::move(named);
  }

  void add_section(const AssetKind& kind, const JobSection& section) {
    const std::string name = kind.name + "." + plain_name(section.name);
    const JobEntry* each = find_entry(section.entries, "each");
    if (each == nullptr) return add_asset(kind, section, name, {&tree_.variables});
    const JobEntry meant{each->key, each->place, substituted(each->value, {&tree_.variables})};
    const fs::path folder = fs::path(from_job_folder("x", each->value.place, job_)).parent_path();
    for (EachItem& item : find_each(meant, folder.string(), names.scenes, nodes_)) {
      const auto own = item.variables;
      add_asset(kind, section, name + "." + item.name, {&tree_.variables, &own});
    }
  }

  void add_asset(const AssetKind& kind, const JobSection& section, const std::string& name, const JobScope& scope) {
    JobAsset asset;
    asset.name = name;
    asset.kind = &kind;
    asset.place = section.place;
    for (const JobEntry& entry : section.entries) {
      if (entry.key != "each") add_option(asset, entry, scope);
    }
    if (const auto defaults = tree_.defaults.find(kind.name); defaults != tree_.defaults.end()) {
      for (const JobEntry& entry : defaults->second) {
        if (!gives_way(asset, entry)) add_option(asset, entry, scope);
      }
    }
    place_outputs(asset);
    add_named_options(asset, names);
    job_.assets.push_back(std::move(asset));
  }

  static void add_option(JobAsset& asset, const JobEntry& entry, const JobScope& scope) {
    for (JobOption& option : make_option(*asset.kind, {entry.key, entry.place, substituted(entry.value, scope)}))
      asset.options.push_back(std::move(option));
  }

  // A default does where the asset gives the option itself, or another that does not go with it.
  bool gives_way(const JobAsset& asset, const JobEntry& entry) const {
    const OptionFacts* facts = find_option(*asset.kind, option_of_key(entry.key));
    if (facts == nullptr) return false;  // which make_option() refuses
    for (const JobEntry& own : section_of(asset)) {
      const std::string given = option_of_key(own.key);
      if (given == facts->name) return true;
      if (std::find(facts->excludes.begin(), facts->excludes.end(), given) != facts->excludes.end()) return true;
    }
    return false;
  }

  // A flag that is false is given too.
  const JobTable& section_of(const JobAsset& asset) const {
    static const JobTable none;
    for (const JobSection& section : tree_.sections) {
      if (section.place.line == asset.place.line && section.place.file == asset.place.file) return section.entries;
    }
    return none;
  }

  void place_outputs(JobAsset& asset) {
    const AssetKind& kind = *asset.kind;
    if (std::none_of(asset.options.begin(), asset.options.end(),
                     [](const JobOption& o) { return o.name == "output"; })) {
      if (kind.extension.empty())
        throw JobError(asset.place, fmt::format("[{}] lacks 'output'", asset.name),
                       "name the file to write, whose extension says what it is");
      const std::string file = asset.name.substr(kind.name.size() + 1) + "." + kind.name + kind.extension;
      asset.options.push_back({"output", false, false, {file}, asset.place});
    }
    for (const std::string& name : kind.outputs) {
      for (JobOption& option : asset.options) {
        if (option.name != name) continue;
        for (std::string& value : option.values) {
          if (!fs::path(value).is_absolute()) value = (fs::path(job_.output) / value).lexically_normal().string();
          asset.outputs.push_back(value);
        }
      }
    }
  }

  Job& job_;
  const JobTree& tree_;
  const NodeReader& nodes_;
};

// Walks along what assets need; `path` is the way, `done` what leads to no ring.
void find_ring(const Job& job, int index, std::vector<int>& path, std::vector<bool>& done) {
  if (done[std::size_t(index)]) return;
  const auto found = std::find(path.begin(), path.end(), index);
  if (found != path.end()) {
    std::string ring;
    for (auto at = found; at != path.end(); ++at) ring += job.assets[std::size_t(*at)].name + " needs ";
    const JobAsset& asset = job.assets[std::size_t(index)];
    throw JobError(asset.place, ring + asset.name, "no asset may need itself: break the ring");
  }
  path.push_back(index);
  for (const int need : job.assets[std::size_t(index)].needs) find_ring(job, need, path, done);
  path.pop_back();
  done[std::size_t(index)] = true;
}

Job empty_job(const std::string& file, const std::string& origin) {
  Job job;
  job.file = file;
  job.origin = origin;
  job.folder = (fs::path(origin) / file).lexically_normal().parent_path().string();
  return job;
}

}  // namespace

std::string output_folder(const std::string& file, const std::string& origin, const JobTree& tree) {
  const std::vector<std::string> keys{"output"};
  const Job job = empty_job(file, origin);
  std::string folder;
  for (const JobEntry& entry : tree.job) {
    if (entry.key != "output")
      throw JobError(entry.place, fmt::format("'{}' is no setting of a job{}", entry.key, like(entry.key, keys)),
                     "known is output, the folder of what is baked");
    const JobValue value = substituted(entry.value, {&tree.variables});
    folder =
        from_job_folder(text_of(JobEntry{entry.key, entry.place, value}, "output = \"baked\""), entry.value.place, job);
  }
  return folder;
}

Job make_job(const std::string& file, const std::string& origin, const JobTree& tree, const NodeReader& nodes,
             bool check_files) {
  Job job = empty_job(file, origin);
  job.output = output_folder(file, origin, tree);
  Builder builder(job, tree, nodes);
  builder.build();
  if (job.assets.empty())
    throw JobError({std::make_shared<const std::string>(file), 1, 1}, "names nothing to bake",
                   "add a section such as [grid.hall] with scene = \"level.glb\"");
  resolve_inputs(job, builder.names, nodes, check_files);
  builder.check_outputs();
  for (JobAsset& asset : job.assets) expand_node_patterns(asset, nodes);
  std::vector<bool> done(job.assets.size(), false);
  for (std::size_t i = 0; i < job.assets.size(); ++i) {
    std::vector<int> path;
    find_ring(job, int(i), path, done);
  }
  for (const JobAsset& asset : job.assets) check_options(asset);
  return job;
}

std::vector<std::string> arguments_of(const JobAsset& asset) {
  std::vector<std::string> arguments = asset.kind->command;
  for (const JobOption& option : asset.options) {
    if (!option.by_place) continue;
    arguments.insert(arguments.end(), option.values.begin(), option.values.end());
  }
  for (const JobOption& option : asset.options) {
    if (option.by_place) continue;
    if (option.flag) arguments.push_back("--" + option.name);
    // In one word: values may begin with a '-'.
    for (const std::string& value : option.values) arguments.push_back("--" + option.name + "=" + value);
  }
  return arguments;
}

std::vector<std::string> section_kinds() {
  std::vector<std::string> names{"scene", "environment"};
  for (const AssetKind& kind : asset_kinds()) names.push_back(kind.name);
  return names;
}

}  // namespace ivory
