#include "tools/scene_input.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "tracer/gltf_loader.h"

namespace ivory {

bool is_scene_name(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".gltf" || extension == ".glb";
}

std::unique_ptr<SceneInput> load_scene_input(const std::string& path, const EnvironmentChoice& environment,
                                             const CommonOptions& common, const std::function<void(Scene&)>& extend) {
  auto input = std::make_unique<SceneInput>();
  LoadedScene loaded = load_gltf(path);
  input->scene = std::move(loaded.scene);
  input->warnings = std::move(loaded.warnings);
  input->origin["scene"] = std::filesystem::path(path).filename().string();
  input->origin["scene_hash"] = input->scene.content_hash;
  if (!environment.path.empty()) {
    EnvironmentInput map = load_environment_input(environment);
    input->scene.environment = to_latlong(std::move(map.image));
    input->origin.merge(map.origin);
  }
  if (extend) extend(input->scene);
  for (const std::string& warning : input->warnings) print_note(common, "warning: " + warning);
  input->intersector = std::make_unique<Intersector>(input->scene);
  input->lights = std::make_unique<Lights>(input->scene, *input->intersector);
  return input;
}

}  // namespace ivory
