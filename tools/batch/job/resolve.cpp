#include "tools/batch/job/resolve.h"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include <fmt/format.h>

#include "grid/export/target.h"
#include "grid/io/file.h"
#include "tools/batch/job/options.h"
#include "tools/cli/numbers.h"
#include "tools/input/scene.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

JobOption* find_given(JobAsset& asset, const std::string& name) {
  for (JobOption& option : asset.options) {
    if (option.name == name) return &option;
  }
  return nullptr;
}

// "chair@1,0,2" in its two parts, the second with its '@'.
std::pair<std::string, std::string> split_place(const std::string& text) {
  const std::size_t at = text.rfind('@');
  if (at == std::string::npos) return {text, ""};
  return {text.substr(0, at), text.substr(at)};
}

class Resolver {
 public:
  Resolver(Job& job, const JobNames& names, const NodeReader& nodes, bool check_files)
      : job_(job), names_(names), nodes_(nodes), check_files_(check_files) {
    for (std::size_t i = 0; i < job.assets.size(); ++i) {
      for (const std::string& output : job.assets[i].outputs) by_output_[output] = int(i);
    }
  }

  void resolve(int index) {
    JobAsset& asset = job_.assets[std::size_t(index)];
    LoadParams load = load_params(asset.options);
    load.uv_sets = asset.kind->uv_sets;
    for (JobOption& option : asset.options) {
      const InputOption* input = find_input(*asset.kind, option.name);
      if (input == nullptr) continue;
      std::vector<std::string> values;
      for (const std::string& value : option.values) {
        for (const std::string& one : with_patterns(asset, *input, value, option)) {
          values.push_back(resolved(asset, *input, one, option.place, load));
        }
      }
      option.values = std::move(values);
    }
    add_tables_of_scene(asset);
    if (asset.kind->name == "export") add_files_beside(asset);
    std::sort(asset.needs.begin(), asset.needs.end());
    asset.needs.erase(std::unique(asset.needs.begin(), asset.needs.end()), asset.needs.end());
    if (std::find(asset.needs.begin(), asset.needs.end(), index) != asset.needs.end())
      throw JobError(asset.place, fmt::format("[{}] needs itself", asset.name), "let it read another asset");
  }

 private:
  // What an export writes besides its output; a target that takes no such thing is a mistake.
  static void add_files_beside(JobAsset& asset) {
    const JobOption* target = find_given(asset, "to");
    const auto source = std::find_if(asset.inputs.begin(), asset.inputs.end(),
                                     [](const JobInput& input) { return input.option == "asset"; });
    if (target == nullptr || source == asset.inputs.end()) return;  // which check_options() says
    const auto known = find_by_name<ExportTarget>(target->values.front());
    if (!known) return;  // the same
    const bool of_grid = lower_extension(source->path) == ".vdb";
    const fs::path output = asset.outputs.front();
    try {
      const ExportFormat& format =
          export_format(*known, of_grid ? ExportAsset::grid : ExportAsset::distant, lower_extension(output.string()));
      std::istringstream extensions{std::string(format.beside)};
      for (std::string extension; extensions >> extension;)
        asset.outputs.push_back(fs::path(output).replace_extension(extension).string());
    } catch (const ParameterError& error) {
      throw JobError(target->place, error.parameter() + ": " + error.cause(),
                     "'ivory export --help' lists what there is");
    }
  }

  // Tables of occluders that the scene itself names.
  void add_tables_of_scene(JobAsset& asset) {
    const JobOption* method = find_given(asset, "method");
    if (method == nullptr || method->values.front() != "fiv") return;
    const std::vector<JobInput> inputs = asset.inputs;
    for (const JobInput& input : inputs) {
      if (input.kind != InputKind::scene) continue;
      for (const NodeBox& node : nodes_(input.path, input.load)) {
        const std::string path = fs::path(node.fiv_table).lexically_normal().string();
        const bool known = std::any_of(asset.inputs.begin(), asset.inputs.end(),
                                       [&](const JobInput& other) { return other.path == path; });
        if (path.empty() || known) continue;
        const auto made = by_output_.find(path);
        add(asset,
            {InputKind::asset, input.option, path, {}, made == by_output_.end() ? -1 : made->second, input.place});
      }
    }
  }

  // Of assets, where an option may have several: "grid.rooms.*".
  std::vector<std::string> with_patterns(const JobAsset& asset, const InputOption& input, const std::string& value,
                                         const JobOption& option) const {
    const OptionFacts* facts = find_option(*asset.kind, option.name);
    if (input.kind != InputKind::asset || !facts->repeated || !is_pattern(value)) return {value};
    std::vector<std::string> names;
    for (const JobAsset& other : job_.assets) {
      if (&other != &asset && (matches(value, other.name) || matches_bare(input, value, other)))
        names.push_back(other.name);
    }
    if (names.empty())
      throw JobError(option.place, fmt::format("no asset matches '{}'", value), "patterns are a shell's: grid.rooms.*");
    return names;
  }

  static bool matches_bare(const InputOption& input, const std::string& pattern, const JobAsset& asset) {
    const auto& kinds = input.asset_kinds;
    return std::find(kinds.begin(), kinds.end(), asset.kind->name) != kinds.end() &&
           matches(pattern, asset.name.substr(asset.kind->name.size() + 1));
  }

  // The asset that a text names; -1 for none. Throws JobError where several are meant.
  int asset_named(const InputOption& input, const std::string& text, const JobPlace& place) const {
    int found = -1;
    for (std::size_t i = 0; i < job_.assets.size(); ++i) {
      const JobAsset& asset = job_.assets[i];
      if (asset.name == text) return int(i);
      const auto& kinds = input.asset_kinds;
      if (std::find(kinds.begin(), kinds.end(), asset.kind->name) == kinds.end() ||
          asset.name != asset.kind->name + "." + text)
        continue;
      if (found >= 0)
        throw JobError(place,
                       fmt::format("'{}' may be {} or {}", text, job_.assets[std::size_t(found)].name, asset.name),
                       "give its kind too");
      found = int(i);
    }
    return found;
  }

  // A file that is read: of another asset, or one that must be there.
  std::string file(JobAsset& asset, const InputOption& input, const std::string& text, const JobPlace& place,
                   InputKind kind, const LoadParams& load) {
    const std::string path = from_job_folder(text, place, job_);
    const auto made = by_output_.find(path);
    const int by = made == by_output_.end() ? -1 : made->second;
    add(asset, {kind, input.option, path, load, by, place});
    std::error_code error;
    if (by < 0 && check_files_ && !fs::is_regular_file(path, error)) {
      throw JobError(place,
                     fmt::format("'{}' is neither a file nor a name in this job{}", text, like(text, names_for(input))),
                     fmt::format("'{}' takes {}", key_of_option(input.option), what_for(input)));
    }
    return path;
  }

  static void add(JobAsset& asset, JobInput input) {
    if (input.asset >= 0) asset.needs.push_back(input.asset);
    asset.inputs.push_back(std::move(input));
  }

  std::vector<std::string> names_for(const InputOption& input) const {
    std::vector<std::string> names;
    if (input.kind == InputKind::environment) {
      for (const auto& [name, unused] : names_.environments) names.push_back(name);
    }
    if (input.kind == InputKind::scene || input.kind == InputKind::file) {
      for (const auto& [name, unused] : names_.scenes) names.push_back(name);
    }
    for (const JobAsset& asset : job_.assets) {
      const auto& kinds = input.asset_kinds;
      if (std::find(kinds.begin(), kinds.end(), asset.kind->name) == kinds.end()) continue;
      names.push_back(asset.name);
      names.push_back(asset.name.substr(asset.kind->name.size() + 1));
    }
    return names;
  }

  static std::string what_for(const InputOption& input) {
    if (input.kind == InputKind::scene) return "the name of a [scene.NAME] or a .gltf or .glb file";
    if (input.kind == InputKind::environment) return "the name of an [environment.NAME] or an image file";
    if (input.asset_kinds.empty()) return "a file";
    return fmt::format("an asset of the job ({}) or a file", fmt::join(input.asset_kinds, ", "));
  }

  std::string resolved(JobAsset& asset, const InputOption& input, const std::string& text, const JobPlace& place,
                       const LoadParams& load) {
    switch (input.kind) {
      case InputKind::scene:
        if (const auto named = names_.scenes.find(text); named != names_.scenes.end()) {
          add(asset, {InputKind::scene, input.option, named->second.path, load, -1, place});
          return named->second.path;
        }
        return file(asset, input, text, place, InputKind::scene, load);
      case InputKind::environment:
        if (const auto named = names_.environments.find(text); named != names_.environments.end()) {
          add(asset, {InputKind::environment, input.option, named->second.path, {}, -1, place});
          return named->second.path;
        }
        return file(asset, input, text, place, InputKind::environment, {});
      case InputKind::file:
      case InputKind::asset:
        return asset_or_file(asset, input, text, place, load);
      case InputKind::object: {
        const auto [name, where] = split_place(text);
        LoadParams own;
        own.scale = load.scale;  // as object_params() has it
        if (const auto named = names_.scenes.find(name); named != names_.scenes.end()) {
          add(asset, {InputKind::scene, input.option, named->second.path, own, -1, place});
          return named->second.path + where;
        }
        if (!is_scene_name(name)) return text;  // a node
        return file(asset, input, name, place, InputKind::scene, own) + where;
      }
      case InputKind::occluder: {
        const std::size_t equals = text.rfind('=');
        if (equals == std::string::npos || equals + 1 == text.size()) return text;  // which the command refuses
        return text.substr(0, equals + 1) + asset_or_file(asset, input, text.substr(equals + 1), place, {});
      }
      case InputKind::placed: {
        const auto [name, where] = split_place(text);
        return asset_or_file(asset, input, name, place, {}) + where;
      }
    }
    return text;
  }

  std::string asset_or_file(JobAsset& asset, const InputOption& input, const std::string& text, const JobPlace& place,
                            const LoadParams& load) {
    if (const int by = asset_named(input, text, place); by >= 0) {
      const std::string& path = job_.assets[std::size_t(by)].outputs.front();
      add(asset, {InputKind::asset, input.option, path, {}, by, place});
      return path;
    }
    const bool scenes = input.kind == InputKind::file || find_kind("probe") == asset.kind;
    if (const auto named = names_.scenes.find(text); scenes && named != names_.scenes.end()) {
      add(asset, {input.kind == InputKind::file ? InputKind::file : InputKind::scene, input.option, named->second.path,
                  load, -1, place});
      return named->second.path;
    }
    const bool is_scene = input.kind == InputKind::asset && is_scene_name(text);
    return file(asset, input, text, place, is_scene ? InputKind::scene : InputKind::file, load);
  }

  Job& job_;
  const JobNames& names_;
  const NodeReader& nodes_;
  bool check_files_;
  std::map<std::string, int> by_output_;
};

}  // namespace

std::string from_job_folder(const std::string& path, const JobPlace& place, const Job& job) {
  const fs::path whole = (fs::path(job.origin) / *place.file).parent_path() / path;
  if (fs::path(path).is_absolute()) return fs::path(path).lexically_normal().string();
  return whole.lexically_normal().lexically_relative(job.folder).string();
}

LoadParams load_params(const std::vector<JobOption>& options) {
  LoadParams params;
  for (const JobOption& option : options) {
    if (option.values.empty()) continue;
    if (option.name == "scale") params.scale = parse_number(option.values.front()).value_or(1);
    if (option.name == "time") params.time_s = parse_number(option.values.front());
    if (option.name == "animation") params.animation = option.values.front();
    if (option.name == "without") params.without = option.values;
  }
  return params;
}

void add_named_options(JobAsset& asset, const JobNames& names) {
  const auto add = [&](const std::vector<JobEntry>& entries) {
    for (const JobEntry& entry : entries) {
      if (find_given(asset, option_of_key(entry.key)) != nullptr) continue;
      for (JobOption& option : make_option(*asset.kind, entry)) asset.options.push_back(std::move(option));
    }
  };
  const std::vector<JobOption> given = asset.options;
  for (const JobOption& option : given) {
    const InputOption* input = find_input(*asset.kind, option.name);
    if (input == nullptr || option.values.empty()) continue;
    if (input->kind == InputKind::scene || input->kind == InputKind::asset) {
      const auto named = names.scenes.find(option.values.front());
      if (named != names.scenes.end()) add(named->second.options);
    }
    if (input->kind == InputKind::environment) {
      const auto named = names.environments.find(option.values.front());
      if (named != names.environments.end()) add(named->second.options);
    }
  }
}

void expand_node_patterns(JobAsset& asset, const NodeReader& nodes) {
  std::string scene;
  for (const char* name : {"scene", "mesh"}) {
    const JobOption* option = find_given(asset, name);
    if (option != nullptr && !option->values.empty()) scene = option->values.front();
  }
  LoadParams whole = load_params(asset.options);
  whole.without.clear();
  for (const char* name : {"without", "object"}) {
    JobOption* option = find_given(asset, name);
    if (option == nullptr) continue;
    std::vector<std::string> values;
    for (const std::string& value : option->values) {
      if (!is_pattern(value) || scene.empty()) {
        values.push_back(value);
        continue;
      }
      const std::size_t before = values.size();
      for (const NodeBox& node : nodes(scene, whole)) {
        if (matches(value, node.name)) values.push_back(node.name);
      }
      if (values.size() == before)
        throw JobError(option->place, fmt::format("no node with triangles of {} matches '{}'", scene, value),
                       "patterns are a shell's: Chair*");
    }
    option->values = std::move(values);
  }
}

void resolve_inputs(Job& job, const JobNames& names, const NodeReader& nodes, bool check_files) {
  Resolver resolver(job, names, nodes, check_files);
  for (std::size_t i = 0; i < job.assets.size(); ++i) resolver.resolve(int(i));
}

}  // namespace ivory
