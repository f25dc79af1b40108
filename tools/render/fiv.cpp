// ivory render --method fiv: an environment's light among moving occluders.
#include "grid/io/fiv.h"

#include <filesystem>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "grid/base/error.h"
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
    FivTable table;
    float most_hidden = 0;
  };
  std::map<std::string, OneTable> tables;
  FivScene fiv;
  fiv.occluder_of.assign(scene.instances.size(), -1);
  for (const auto& [node, path] : table_of_node) {
    if (!tables.contains(path)) {
      FivTable table = read_fiv(path);
      check_environment(path, table.metadata, input);
      const float most = most_hidden(table);
      tables[path] = {std::move(table), most};
    }
    const std::vector<bool> part = instances_below(scene, node);
    std::optional<FivPlacement> placement = find_placement(tables[path].table, scene, part);
    if (!placement) {
      throw Error(path,
                  fmt::format("does not belong to node '{}': it was baked from another mesh, or the node is turned",
                              scene.nodes[std::size_t(node)].name),
                  "bake the node's own mesh, turned as it stands; moving and even scaling need no new table");
    }
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
