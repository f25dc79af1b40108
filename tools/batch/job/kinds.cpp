#include "tools/batch/job/kinds.h"

#include <algorithm>

namespace ivory {

namespace {

constexpr SceneUse lit{};
constexpr SceneUse shape_only{true, false, false, false, false};
constexpr SceneUse seen{true, true, true, true, true};

const std::vector<std::string> grids{"grid", "mix", "merge"};
const std::vector<std::string> distant{"sh9", "difmap"};

std::vector<AssetKind> make_kinds() {
  const InputOption scene{"scene", InputKind::scene, {}};
  const InputOption mesh{"mesh", InputKind::scene, {}};
  const InputOption env{"env", InputKind::environment, {}};
  const InputOption environment{"environment", InputKind::environment, {}};
  const InputOption grid{"grid", InputKind::asset, grids};
  std::vector<AssetKind> kinds;
  // Groups take lights by the names of their nodes.
  kinds.push_back({"grid",
                   {"bake", "grid"},
                   ".vdb",
                   {scene, env, {"error-points", InputKind::file, {"points"}}},
                   {"output", "report"},
                   {true, true, true, false, true},
                   2,  // 2: photons scatter off plain surfaces by sines and cosines in float
                   true,
                   true,
                   30});
  kinds.push_back({"cubemap", {"bake", "cubemap"}, ".exr", {scene, env, grid}, {"output"}, lit, 2, true, true, 5});
  kinds.push_back(
      {"lightmap", {"bake", "lightmap"}, ".exr", {scene, env, grid}, {"output"}, lit, 2, true, false, 20, {1}});
  kinds.push_back({"fiv", {"bake", "fiv"}, ".exr", {mesh, env}, {"output"}, shape_only, 1, true, true, 8});
  kinds.push_back({"sh9", {"bake", "sh9"}, ".json", {environment}, {"output"}, lit, 1, true, true, 1});
  kinds.push_back({"difmap", {"bake", "difmap"}, ".exr", {environment}, {"output"}, lit, 1, true, true, 2});
  kinds.push_back({"spheres", {"bake", "spheres"}, ".json", {mesh}, {"output"}, shape_only, 1, true, true, 4});
  kinds.push_back({"lobes", {"bake", "lobes"}, ".exr", {}, {"output"}, lit, 1, false, true, 2});
  kinds.push_back(
      {"merge", {"merge"}, ".vdb", {{"parts", InputKind::asset, grids}}, {"output"}, lit, 1, false, false, 1});
  kinds.push_back({"mix", {"mix"}, ".vdb", {grid}, {"output"}, lit, 1, false, false, 1});
  kinds.push_back({"render",
                   {"render"},
                   ".png",
                   {scene,
                    env,
                    grid,
                    {"cubemap", InputKind::asset, {"cubemap"}},
                    {"occluder", InputKind::occluder, {"fiv"}},
                    {"ambient", InputKind::asset, distant},
                    {"lobes", InputKind::asset, {"lobes"}},
                    {"spheres", InputKind::placed, {"spheres"}},
                    {"object", InputKind::object, {}}},
                   {"output"},
                   seen,
                   2,
                   true,
                   false,
                   10});
  kinds.push_back(
      {"export",
       {"export"},
       "",
       {{"asset", InputKind::asset, {"sh9", "difmap", "grid", "mix", "merge"}}, {"scene", InputKind::file, {}}},
       {"output"},
       lit,
       1,
       false,
       false,
       2});
  kinds.push_back({"probe",
                   {"probe"},
                   ".csv",
                   {{"source", InputKind::asset, {"grid", "mix", "merge", "cubemap", "fiv", "sh9", "difmap"}},
                    {"points", InputKind::file, {"points"}},
                    scene,
                    env},
                   {"output"},
                   lit,
                   1,
                   false,
                   false,
                   3});
  kinds.push_back({"points", {"points"}, ".csv", {scene, env}, {"output"}, lit, 1, false, false, 3});
  return kinds;
}

}  // namespace

const std::vector<AssetKind>& asset_kinds() {
  static const std::vector<AssetKind> kinds = make_kinds();
  return kinds;
}

const AssetKind* find_kind(const std::string& name) {
  for (const AssetKind& kind : asset_kinds()) {
    if (kind.name == name) return &kind;
  }
  return nullptr;
}

const InputOption* find_input(const AssetKind& kind, const std::string& option) {
  for (const InputOption& input : kind.inputs) {
    if (input.option == option) return &input;
  }
  return nullptr;
}

std::string key_of_option(const std::string& option) {
  std::string key = option;
  std::replace(key.begin(), key.end(), '-', '_');
  return key;
}

std::string option_of_key(const std::string& key) {
  std::string option = key;
  std::replace(option.begin(), option.end(), '_', '-');
  return option;
}

}  // namespace ivory
