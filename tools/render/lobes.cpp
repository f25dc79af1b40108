// ivory render --method lobes.
#include "grid/io/lobes.h"

#include <memory>

#include <fmt/format.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/io/sphere_set.h"
#include "tools/render/method.h"
#include "tracer/render/lobes.h"

namespace ivory {

namespace {

struct LobeOptions {
  std::string table;
  std::vector<std::string> sphere_sets;
  LobeParams params;
};

// Of the @ of "FILE.json@X,Y,Z"; an @ before the extension belongs to the name.
std::size_t place_of(const std::string& text) {
  return text.ends_with(".json") ? std::string::npos : text.find_last_of('@');
}

// "FILE.json" or "FILE.json@X,Y,Z". Relative to the anchor.
std::vector<Sphere> load_placed(const std::string& text, const V3d& anchor_m) {
  const std::size_t at = place_of(text);
  V3d offset(0, 0, 0);
  if (at != std::string::npos) offset = parse_vector3("--spheres", std::string_view(text).substr(at + 1));
  SphereSet set = read_spheres(text.substr(0, at));
  const V3f by = to_local(set.anchor_m + offset, anchor_m);
  for (Sphere& sphere : set.spheres) sphere.center += by;
  return std::move(set.spheres);
}

Film render(const LobeOptions& options, const RenderRequest& request) {
  const Scene& scene = *request.input.lit.scene;
  if (scene.sphere_lights.empty()) {
    throw Error(scene.name, "has no spherical light, the only kind that --method lobes lights by",
                "give --sphere-light X,Y,Z,RADIUS,R,G,B, or extras.ivory_sphere_light in the scene");
  }
  LobeScene lobes;
  lobes.table = options.table.empty() ? make_lobe_table() : read_lobes(options.table).table;
  lobes.lights = scene.sphere_lights;
  std::vector<Sphere> occluders;
  for (const std::string& text : options.sphere_sets) {
    const std::vector<Sphere> placed = load_placed(text, scene.anchor_m);
    occluders.insert(occluders.end(), placed.begin(), placed.end());
  }
  for (const SphereLight& light : scene.sphere_lights) occluders.push_back({light.center, light.radius_m});
  lobes.occluders = make_sphere_groups(std::move(occluders));
  if (!scene.lights.empty() || scene.environment) {
    print_note(request.common,
               "note: --method lobes leaves out point, spot and directional lights and the environment");
  }
  return render_lobes(lobes, request.input.lit, request.view, request.params, options.params);
}

}  // namespace

RenderMethod make_lobes_method(Command command) {
  auto options = std::make_shared<LobeOptions>();
  command.add_option("--lobes", options->table, "Table of lobe products [built at start, in a second]")
      .type_name("LOBES.exr");
  command
      .add_option("--spheres", options->sphere_sets, "Sphere set that casts shadows, moved by X,Y,Z; may be repeated")
      .repeated()
      .type_name("SET.json[@X,Y,Z]");
  command.add_choice("--shadows", options->params.shadows,
                     "lobes: masks of sphere sets; spheres, mesh: Monte Carlo on the sets or on the triangles; none");
  command.add_count("--shadow-rays", options->params.shadow_rays, 1,
                    "Rays a light and sample, stratified (with --shadows spheres or mesh)");
  command.add_option("--mask-depth", options->params.mask_depth, "Depth of the visibility mask's quad-tree")
      .within(0, max_mask_depth);
  command.add_choice("--mask", options->params.mask_rule,
                     "What of a mask's cell must lie behind a sphere: its center, its inside, or be touched");
  command
      .add_option("--threshold", options->params.threshold,
                  "Lobe products under this fraction of the unshadowed light are dropped")
      .within(0.0, 1.0);
  command
      .add_option("--split", options->params.max_split_level,
                  "A light wider than a highlight is taken as up to 4^SPLIT lobes")
      .within(0, max_mask_depth);
  RenderMethod method;
  method.name = "lobes";
  method.summary = "direct light of spherical lights by cosine lobes";
  method.options = {"--lobes",      "--spheres", "--shadows",   "--shadow-rays",
                    "--mask-depth", "--mask",    "--threshold", "--split"};
  method.direct_only = true;
  method.noise_note =
      "the noise of samples: lobes have none but that of edges inside pixels, and what they are off by is not in it";
  method.files = [options] {
    std::vector<std::string> files;
    if (!options->table.empty()) files.push_back(options->table);
    for (const std::string& set : options->sphere_sets) files.push_back(set.substr(0, place_of(set)));
    return files;
  };
  method.check = [options] {
    if (options->params.shadows != LobeShadows::mesh && options->params.shadows != LobeShadows::none) {
      for (const std::string& text : options->sphere_sets) load_placed(text, V3d(0, 0, 0));
    }
  };
  method.render = [options](const RenderRequest& request) { return render(*options, request); };
  method.describe = [options](Metadata& m) {
    const LobeParams& params = options->params;
    m["shadows"] = std::string(name_of(params.shadows));
    m["mask_depth"] = std::int64_t(params.mask_depth);
    m["mask"] = std::string(name_of(params.mask_rule));
    m["threshold"] = double(params.threshold);
    m["split"] = std::int64_t(params.max_split_level);
    if (params.shadows == LobeShadows::spheres || params.shadows == LobeShadows::mesh)
      m["shadow_rays"] = std::int64_t(params.shadow_rays);
  };
  return method;
}

}  // namespace ivory
