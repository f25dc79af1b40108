#include "tools/batch/state/freshness.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "grid/base/error.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

// What the command's programmer does not count as an input: how it is done, where it goes.
bool matters(const AssetKind& kind, const JobOption& option) {
  if (find_input(kind, option.name) != nullptr) return true;
  return option.name != "checkpoint" && option.name != "report";
}

bool is_used(const SceneUse& use, ContentKind kind) {
  switch (kind) {
    case ContentKind::shape:
      return use.shape;
    case ContentKind::look:
      return use.look;
    case ContentKind::light:
      return use.light;
    case ContentKind::camera:
      return use.cameras;
    case ContentKind::name:
      return use.names;
  }
  return true;
}

// Names matter where something asks for them.
SceneUse use_of(const JobAsset& asset) {
  SceneUse use = asset.kind->use;
  if (asset.kind->name != "grid") return use;
  use.names = std::any_of(asset.options.begin(), asset.options.end(),
                          [](const JobOption& option) { return option.name == "groups"; });
  return use;
}

std::string words_of(const JobOption& option) {
  return option.flag ? "given" : fmt::format("{}", fmt::join(option.values, " "));
}

const std::string* find_value(const AssetInputs& inputs, const std::string& name) {
  for (const auto& [known, value] : inputs.entries) {
    if (known == name) return &value;
  }
  return nullptr;
}

// "material 'wall' changed, object 'Chair' is new", of two lists of parts that differ.
std::string difference(const std::vector<ContentPart>& before, const std::vector<ContentPart>& now) {
  using Key = std::pair<ContentKind, std::string>;
  const auto index = [](const std::vector<ContentPart>& parts) {
    std::map<Key, std::uint64_t> hashes;
    for (const ContentPart& part : parts) hashes[{part.kind, part.name}] = part.hash;
    return hashes;
  };
  const auto was = index(before);
  const auto is = index(now);
  std::vector<std::string> causes;
  std::vector<std::string> objects;  // that are made of them
  const auto add = [&](const Key& key, const char* what) {
    const bool of_object = key.second.starts_with("material of object") || key.second.starts_with("lamp");
    (of_object ? objects : causes).push_back(key.second + what);
  };
  for (const auto& [key, hash] : is) {
    const auto found = was.find(key);
    if (found == was.end()) add(key, " is new");
    if (found != was.end() && found->second != hash) add(key, " changed");
  }
  for (const auto& [key, hash] : was) {
    if (!is.contains(key)) add(key, " is gone");
  }
  const std::vector<std::string>& changes = causes.empty() ? objects : causes;
  if (changes.empty()) return "the order of its parts changed";
  constexpr std::size_t most = 12;
  if (changes.size() <= most) return fmt::format("{}", fmt::join(changes, ", "));
  return fmt::format("{} and {} more", fmt::join(changes.begin(), changes.begin() + most, ", "), changes.size() - most);
}

std::string shown(const std::string& name, const std::string& value) {
  return name.starts_with("option ") || name.starts_with("baking version") ? fmt::format(" '{}'", value) : "";
}

}  // namespace

AssetInputs inputs_of(const JobAsset& asset, Sources& sources, const std::vector<bool>& to_come) {
  AssetInputs inputs;
  const AssetKind& kind = *asset.kind;
  inputs.entries.emplace_back("baking version of " + kind.name, std::to_string(kind.baking_version));
  for (const JobOption& option : asset.options) {
    if (matters(kind, option)) inputs.entries.emplace_back("option " + key_of_option(option.name), words_of(option));
  }
  const SceneUse use = use_of(asset);
  for (const JobInput& input : asset.inputs) {
    if (input.kind == InputKind::scene) {
      std::vector<ContentPart> parts;
      for (const ContentPart& part : sources.scene(input.path, input.load).parts) {
        if (is_used(use, part.kind)) parts.push_back(part);
      }
      const std::string name = fmt::format("{} {}", input.option, input.path);
      if (inputs.parts.contains(name)) continue;  // placed several times
      inputs.entries.emplace_back(name, fmt::format("{:016x}", hash_of(parts)));
      inputs.parts[name] = std::move(parts);
    } else {
      const std::string name = fmt::format("{} {}", input.option, input.path);
      if (find_value(inputs, name) != nullptr) continue;
      const bool there = input.asset < 0 || !to_come[std::size_t(input.asset)];
      inputs.entries.emplace_back(name, there ? sources.hash(input.path) : std::string());
    }
  }
  return inputs;
}

std::vector<std::string> reasons_to_bake(const JobAsset& asset, const AssetInputs& now, const AssetRecord* record,
                                         Sources& sources) {
  if (record == nullptr) return {"it was never baked by this job"};
  if (!record->finished) return {"its last bake did not end"};
  std::vector<std::string> reasons;
  for (const auto& [name, value] : now.entries) {
    if (value.empty()) continue;
    const std::string* before = find_value(record->inputs, name);
    if (before == nullptr) {
      reasons.push_back(fmt::format("{}{} is new", name, shown(name, value)));
    } else if (*before != value) {
      const auto was = record->inputs.parts.find(name);
      const auto is = now.parts.find(name);
      if (was != record->inputs.parts.end() && is != now.parts.end()) {
        reasons.push_back(fmt::format("{}: {}", name, difference(was->second, is->second)));
      } else {
        const bool words = !shown(name, value).empty();
        reasons.push_back(words ? fmt::format("{} changed from '{}' to '{}'", name, *before, value)
                                : name + " changed");
      }
    }
  }
  for (const auto& [name, value] : record->inputs.entries) {
    if (find_value(now, name) == nullptr) reasons.push_back(fmt::format("{}{} is gone", name, shown(name, value)));
  }
  for (const std::string& output : asset.outputs) {
    const auto known = std::find_if(record->outputs.begin(), record->outputs.end(),
                                    [&](const auto& file) { return file.first == output; });
    std::error_code error;
    if (known == record->outputs.end()) {
      reasons.push_back(output + " was not among what it wrote");
    } else if (!fs::exists(output, error)) {
      reasons.push_back(output + " is missing");
    } else if (sources.hash(output) != known->second) {
      reasons.push_back(output + " is not what was written");
    }
  }
  return reasons;
}

void check_ownership(const JobAsset& asset, const AssetRecord* record, Sources& sources) {
  for (const std::string& output : asset.outputs) {
    std::error_code error;
    if (!fs::exists(output, error)) continue;
    if (record != nullptr && !record->finished) continue;  // half of a bake of this job
    bool own = false;
    if (record != nullptr) {
      for (const auto& [file, hash] : record->outputs) own = own || (file == output && hash == sources.hash(output));
    }
    if (!own)
      throw Error(output, "is there and is not what this job has written",
                  "give --force to overwrite it, or move it away");
  }
}

}  // namespace ivory
