// ivory render --method fiv: an environment's light among moving occluders.
#include "grid/io/fiv.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/base/placement.h"
#include "tools/input/ambient.h"
#include "tools/input/objects.h"
#include "tools/render/method.h"
#include "tracer/bake/fiv/occluder.h"
#include "tracer/render/fiv.h"

namespace ivory {

namespace {

struct FivOptions {
  std::vector<std::string> occluders;  // NODE=TABLE.exr
  std::string ambient;
  FivLightParams params;
};

struct NamedTable {
  std::string node;
  std::string path;
};

NamedTable parse_occluder(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw UsageError(fmt::format("--occluder: '{}' is not NODE=TABLE.exr", text));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

// The table of each node that is an occluder: by --occluder, or by extras.ivory_occluder.
std::map<int, std::string> tables_of_nodes(const FivOptions& options, const Scene& scene) {
  std::map<int, std::string> tables;
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const SceneNode& node = scene.nodes[i];
    if (!node.fiv_table.empty()) tables[int(i)] = node.fiv_table;
  }
  for (const std::string& text : options.occluders) {
    const NamedTable named = parse_occluder(text);
    bool any = false;
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
      if (scene.nodes[i].name != named.node) continue;
      tables[int(i)] = named.path;
      any = true;
    }
    if (!any) throw UsageError(fmt::format("--occluder: {} has no node '{}'", scene.name, named.node));
  }
  return tables;
}

Film render(const FivOptions& options, const RenderRequest& request) {
  const SceneInput& input = request.input;
  const Scene& scene = *input.lit.scene;
  const std::map<int, std::string> table_of_node = tables_of_nodes(options, scene);
  struct OneTable {
    FivSet set;
    float most_hidden = 0;  // of any turn
  };
  std::map<std::string, OneTable> tables;
  FivScene fiv;
  double environment_rad = 0;  // its turn, against the tables'
  fiv.occluder_of.assign(scene.instances.size(), -1);
  for (const auto& [node, path] : table_of_node) {
    if (!tables.contains(path)) {
      FivSet set = read_fiv_set(path);
      const Metadata& metadata = set.turns.front().metadata;
      check_environment(path, metadata, input, EnvironmentTurn::free);
      const double turn_deg = environment_turn_deg(input.origin) - environment_turn_deg(metadata);
      const double turn_rad = std::remainder(turn_deg, 360.0) * radians_a_degree;
      if (tables.empty()) environment_rad = turn_rad;
      if (turn_rad != environment_rad) {
        throw Error(path, "was baked with another --env-turn than " + tables.begin()->first,
                    "bake all tables of a picture with the same");
      }
      float most = 0;
      for (const FivTable& table : set.turns) most = std::max(most, most_hidden(table));
      tables[path] = {std::move(set), most};
    }
    const FivSet& set = tables[path].set;
    const std::vector<bool> part = instances_below(scene, node);
    const std::optional<TurnedPlacement> found = find_turned_placement(set.turns.front(), scene, part);
    if (!found) {
      throw Error(
          path,
          fmt::format("does not belong to node '{}': it was baked from another mesh, or the node is turned otherwise "
                      "than about +Y",
                      scene.nodes[std::size_t(node)].name),
          "bake the node's own mesh, turned as it stands; moving and even scaling need no new table");
    }
    std::optional<FivPlacement> placement = turned_placement(set, found->at, found->turn_rad - environment_rad);
    if (!placement) {
      const bool by_sky = std::abs(found->turn_rad) < std::abs(environment_rad);
      throw Error(path,
                  fmt::format("holds one turn of the mesh, and {} turned by {:.4g} degrees against it",
                              by_sky ? "the environment is" : "node '" + scene.nodes[std::size_t(node)].name + "' is",
                              (by_sky ? environment_rad : found->turn_rad) * (1 / radians_a_degree)),
                  "bake it with ivory bake fiv --turns 24");
    }
    placement->center_m = placement->center_m * turn_about_y(-environment_rad);
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (part[i]) fiv.occluder_of[i] = int(fiv.occluders.size());
    }
    placement->most_hidden = tables[path].most_hidden;
    fiv.occluders.push_back(*placement);
  }
  if (fiv.occluders.empty())
    print_note(request.common, "note: no occluders; mark nodes by --occluder NODE=TABLE.exr or extras.ivory_occluder");
  if (!scene.lights.empty() || !scene.sphere_lights.empty())
    print_note(request.common, "note: --method fiv leaves out all lights but the environment");
  fiv.from_world = turn_about_y(-environment_rad);
  fiv.unshadowed = load_ambient(options.ambient, input, request.common);
  return render_fiv(fiv, input.lit, request.view, request.params, options.params);
}

}  // namespace

RenderMethod make_fiv_method(Command command) {
  auto options = std::make_shared<FivOptions>();
  command
      .add_option("--occluder", options->occluders,
                  "FIV table of the scene's or an object's node of that name, wherever it stands; may be repeated;\n"
                  "nodes with extras.ivory_occluder need none")
      .repeated()
      .type_name("NODE=TABLE.exr");
  command
      .add_option("--ambient", options->ambient,
                  "Unshadowed irradiance of --env, by ivory bake difmap or sh9 [found at start]")
      .type_name("DIFMAP.exr|SH9.json");
  command.add_choice("--overlap", options->params.overlap,
                     "How light that several occluders hide is counted once: discs is the published rule");
  command.add_choice("--straddling", options->params.straddling,
                     "Occluders that reach below a receiver's plane: bound, or the published scale");
  RenderMethod method;
  method.name = "fiv";
  method.summary = "diffuse light of --env, shadowed by --occluder tables";
  method.options = {"--occluder", "--ambient", "--overlap", "--straddling"};
  method.needs_environment = true;
  method.direct_only = true;
  method.noise_note = "of edges inside pixels: tables have no noise, and what they are off by is not in it";
  method.files = [options] {
    std::vector<std::string> files;
    for (const std::string& occluder : options->occluders) files.push_back(parse_occluder(occluder).path);
    if (!options->ambient.empty()) files.push_back(options->ambient);
    return files;
  };
  method.check = [options] {
    for (const std::string& text : options->occluders) parse_occluder(text);
  };
  method.render = [options](const RenderRequest& request) { return render(*options, request); };
  method.describe = [options](Metadata& m) {
    m["overlap"] = std::string(name_of(options->params.overlap));
    m["straddling"] = std::string(name_of(options->params.straddling));
    if (!options->ambient.empty()) m["ambient"] = options->ambient.substr(options->ambient.find_last_of('/') + 1);
    for (std::size_t i = 0; i < options->occluders.size(); ++i)
      m[fmt::format("occluder_{}", i)] = options->occluders[i];
  };
  return method;
}

}  // namespace ivory
