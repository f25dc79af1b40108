#include "tools/view/session/session.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/env/irradiance.h"
#include "tools/input/objects.h"
#include "tools/view/session/groups.h"
#include "tools/view/session/occluders.h"
#include "tracer/core/camera.h"
#include "tracer/image/file.h"

namespace ivory {

namespace {

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

void append(std::vector<std::string>& to, const std::vector<std::string>& from, const char* prefix) {
  for (const std::string& line : from) to.push_back(prefix + line);
}

void add_object(ViewSession& session, ViewObject object) {
  std::vector<ViewObject>& objects = session.world.objects;
  object.model = upload(*object.scene);
  append(session.notes, object.model.left_out, "note: ");
  if (!objects.empty()) object.lights = objects.front().lights;
  objects.push_back(std::move(object));
}

void set_place(ViewObject& object, const ObjectPlace& place, const V3d& anchor_m) {
  object.offset_m = offset_in_scene(object, place.offset_m, anchor_m);
  object.turn_deg = place.turn_deg;
  object.scale = place.scale;
}

// So in the world, against how its file has it.
ViewObject load_object(ViewSession& session, const std::string& path, const ObjectPlace& place, const V3d& anchor_m) {
  LoadedScene loaded = load_scene(path, object_params(session.load));
  append(session.notes, loaded.warnings, "warning: ");
  if (!loaded.scene.lights.empty() || !loaded.scene.sphere_lights.empty())
    session.notes.push_back(fmt::format("note: the lights of {} are left out", path));
  ViewObject object = make_object(file_name(path), std::move(loaded.scene), V3f(0, 0, 0), true);
  object.pivot_m = pivot_of_file(*object.scene);
  set_place(object, place, anchor_m);
  return object;
}

// Also as a DifMap, by which surfaces are lit without any file baked: a second's work.
void set_environment(ViewSession& session, const EnvironmentChoice& choice) {
  constexpr int difmap_size = 64;
  // What is drawn turns as one looks; what is loaded does not.
  EnvironmentInput input = load_environment_input({choice.path, choice.layout});
  append(session.notes, input.warnings, "warning: ");
  DifMap difmap;
  difmap.e = bake_irradiance(make_irradiance_tree(input.image), difmap_size).e;
  difmap.metadata = input.origin;
  session.environment_facts = input.origin;
  const auto environment = std::make_shared<const EnvironmentMap>(to_latlong(std::move(input.image)));
  const EnvironmentMap& map = *environment;
  gl::Texture sky = gl::make_texture_2d(choice.path, gl::Format::rgb32f, map.width, map.height, map.radiance.data(),
                                        gl::Filter::nearest, gl::Wrap::repeat, gl::Wrap::clamp);
  std::unique_ptr<ViewAsset> asset = make_view_difmap(choice.path, difmap);
  asset->given = false;
  session.environment_hash = asset->environment_hash;
  // It stands before files of another environment, and after none: the latest is what lights.
  session.assets.insert(session.assets.begin(), std::move(asset));
  for (ViewObject& object : session.world.objects) {
    for (ObjectLight& light : object.lights) {
      if (light.method == ViewMethod::difmap || light.method == ViewMethod::fiv)
        light.asset = session.assets.front().get();
    }
  }
  session.sky = std::move(sky);
  session.environment_map = environment;
  session.environment = file_name(choice.path);
}

// A bake that is under way shows the light of its photons so far.
void note_preview(ViewSession& session, const ViewAsset& asset) {
  const auto number = [&](const char* key) { return find_int(asset.metadata, key); };
  const auto begin = number("photon_begin");
  const auto end = number("photon_end");
  const auto photons = number("photons");
  if (!begin || !end || !photons || *end - *begin >= *photons) return;
  session.notes.push_back(
      fmt::format("note: {} is a preview, of {} of {} photons", asset.path, *end - *begin, *photons));
}

// Assets of another environment than the one behind show light that is not there.
void note_environment(ViewSession& session, const ViewAsset& asset) {
  if (!session.environment_hash.empty() && !asset.environment_hash.empty() &&
      asset.environment_hash != session.environment_hash) {
    session.notes.push_back(
        fmt::format("note: {} was baked for another environment than {}", asset.path, session.environment));
  }
}

// Nodes that the file itself calls occluders (extras.ivory_occluder) are objects, and their tables assets.
void add_marked_nodes(const Scene& scene, std::vector<std::string>& objects, std::vector<std::string>& assets) {
  for (const SceneNode& node : scene.nodes) {
    if (node.fiv_table.empty() || node.name.empty()) continue;
    if (std::find(objects.begin(), objects.end(), node.name) == objects.end()) objects.push_back(node.name);
    if (std::find(assets.begin(), assets.end(), node.fiv_table) == assets.end()) assets.push_back(node.fiv_table);
  }
}

// A node of the scene is an object then; one of an object's file belongs to an object already.
void add_occluder(const Scene& scene, const std::string& text, std::vector<std::string>& objects,
                  std::vector<std::string>& assets) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw UsageError(fmt::format("--occluder: '{}' is not NODE=TABLE.exr", text));
  const std::string node = text.substr(0, equals);
  const bool of_scene =
      std::any_of(scene.nodes.begin(), scene.nodes.end(), [&](const SceneNode& n) { return n.name == node; });
  if (of_scene && std::find(objects.begin(), objects.end(), node) == objects.end()) objects.push_back(node);
  const std::string table = text.substr(equals + 1);
  if (std::find(assets.begin(), assets.end(), table) == assets.end()) assets.push_back(table);
}

void place_objects(std::vector<ViewObject>& objects, const std::vector<std::string>& places, const V3d& anchor_m) {
  for (const std::string& text : places) {
    const NamedPlace named = parse_named_place(text);
    bool any = false;
    for (ViewObject& object : objects) {
      if (object.name != named.object) continue;
      set_place(object, named.place, anchor_m);
      any = true;
    }
    if (!any) throw UsageError(fmt::format("--place: there is no object '{}' (--object)", named.object));
  }
}

Camera choose_camera(const SessionInput& input, const ViewWorld& world) {
  const Scene& scene = world.scene();
  if (!input.camera.empty()) return find_camera(scene, input.camera);
  if (!scene.cameras.empty()) return scene.cameras.front();
  return framing_camera(world.center_m, world.radius_m, float(input.size.x) / float(input.size.y));
}

}  // namespace

std::size_t ViewSession::bytes() const {
  std::size_t sum = sky ? sky->bytes() : 0;
  if (fiv_tables) sum += fiv_tables->bytes();
  for (const ViewObject& object : world.objects) sum += object.model.bytes();
  for (const auto& asset : assets) sum += asset->bytes();
  if (reference) sum += reference->texture.bytes();
  return sum;
}

void find_extended_lights(ViewSession& session) {
  session.extended.clear();
  ++session.lights_version;
  const auto add = [&](ExtendedKind kind, std::vector<ExtendedPoint> points) {
    if (!points.empty())
      session.extended.push_back(make_extended_lights(kind, std::move(points), session.world.radius_m));
  };
  for (const ExtendedKind kind : {ExtendedKind::surfaces, ExtendedKind::spheres}) {
    std::vector<ExtendedPoint> points;
    for (std::size_t i = 0; i < session.world.objects.size(); ++i) {
      const ViewObject& object = session.world.objects[i];
      const std::vector<ExtendedPoint> more = surface_points(*object.scene, Lights(traced(object)), kind, i);
      points.insert(points.end(), more.begin(), more.end());
    }
    add(kind, std::move(points));
  }
  if (session.environment_map) add(ExtendedKind::environment, environment_points(*session.environment_map));
}

void look_as_at_first(ViewSession& session, const SessionInput& input) {
  const Camera camera = choose_camera(input, session.world);
  session.world.camera = make_view_camera(camera, session.world.center_m, session.world.radius_m);
}

ViewSession open_session(const SessionInput& input) {
  ViewSession session;
  session.load = input.load;
  session.environment_turn_deg = input.environment.turn_deg;
  LoadedScene loaded = load_scene(input.scene, input.load.load);
  append(session.notes, loaded.warnings, "warning: ");
  session.scene_facts["scene"] = file_name(input.scene);
  session.scene_facts["scene_hash"] = loaded.scene.content_hash;
  describe(input.load, session.scene_facts);
  std::vector<ViewObject> objects;
  if (input.paths.size() > input.objects.size())
    throw UsageError("more --path than --object: each path moves the object of its number");
  std::vector<std::string> names = input.objects;
  std::vector<std::string> files = input.assets;
  add_marked_nodes(loaded.scene, names, files);
  for (const std::string& text : input.occluders) add_occluder(loaded.scene, text, names, files);
  for (const std::string& text : names) {
    if (const std::optional<ObjectFile> file = parse_object(text)) {
      objects.push_back(load_object(session, file->path, file->place, loaded.scene.anchor_m));
    } else {
      const V3f pivot = pivot_of_node(loaded.scene, text);
      objects.push_back(make_object(text, take_node(loaded.scene, text), V3f(0, 0, 0), true));
      objects.back().pivot_m = pivot;
      objects.back().node = text;
    }
  }
  place_objects(objects, input.places, loaded.scene.anchor_m);
  for (std::size_t i = 0; i < input.paths.size(); ++i) objects[i].path = parse_path(input.paths[i]);

  for (const SphereLightOption& light : input.sphere_lights) add_sphere_light(loaded.scene, light, "--sphere-light");
  const std::size_t all_lights = loaded.scene.lights.size();
  prepare_animation(session, input, objects);
  add_object(session, make_object(file_name(input.scene), std::move(loaded.scene), V3f(0, 0, 0), false));
  for (ViewObject& object : objects) add_object(session, std::move(object));
  if (!input.environment.path.empty()) set_environment(session, input.environment);
  measure(session.world);
  session.lamps = lamps_of(session);
  for (const std::string& text : input.lamps) change_lamp(session, text);
  shine(session);
  if (all_lights > max_lights) {
    session.notes.push_back(fmt::format("note: {} of the {} lights are left out: the {} strongest shine",
                                        all_lights - max_lights, all_lights, max_lights));
  }
  look_as_at_first(session, input);
  for (const std::string& path : files) add_file(session, path, std::nullopt, input.size);
  for (const std::string& text : input.spheres) {
    const std::size_t at = text.rfind('@');
    auto asset = load_view_asset(text.substr(0, at), FileKind::spheres, session.world.scene().anchor_m);
    if (at != std::string::npos) {
      std::get<SphereSetAsset>(asset->data).offset_m =
          parse_vector3("--spheres", std::string_view(text).substr(at + 1));
    }
    session.assets.push_back(std::move(asset));
  }
  if (!session.world.scene().sphere_lights.empty() && find_asset(session.assets, FileKind::lobes) == nullptr)
    session.assets.push_back(make_view_lobes());
  find_extended_lights(session);
  session.factors = input.factors;
  if (!session.factors.empty()) {
    try {
      mix_groups(session);
      session.notes.emplace_back("note: emissive surfaces and the environment shine as they are, whatever their group");
    } catch (const ParameterError& error) {
      throw UsageError("--group-scale, --group-tint: " + error.cause());
    }
  }
  return session;
}

std::string add_file(ViewSession& session, const std::string& path, const std::optional<V3f>& at,
                     const Imath::V2i& size) {
  const FileKind kind = file_kind(path);
  if (kind == FileKind::scene) {
    ViewObject object = load_object(session, path, {}, session.world.scene().anchor_m);
    // It stands on the point: the lowest of its sphere's middle.
    if (at) {
      const Box3f box = bounds(*object.scene);
      object.offset_m = *at - V3f(box.center().x, box.min.y, box.center().z);
    }
    add_object(session, std::move(object));
    try {
      session.fiv_tables = find_occluders(session.assets, session.world);
    } catch (...) {
      session.world.objects.pop_back();
      throw;
    }
    measure(session.world);
    find_extended_lights(session);
    return fmt::format("{} is an object now", file_name(path));
  }
  if (kind == FileKind::image) {
    const Film film = read_image(path);
    if (film.width == size.x && film.height == size.y) {
      set_reference(session, path, size);
      return fmt::format("{} is the reference now", file_name(path));
    }
    if (film.width != 2 * film.height) {
      throw Error(path,
                  fmt::format("is {} x {}: neither a reference, of the picture's {} x {}, nor a lat-long map",
                              film.width, film.height, size.x, size.y),
                  "render the reference with the picture's --size; give other environment maps by --env");
    }
    set_environment(session, {path, ""});
    find_extended_lights(session);
    return fmt::format("{} is the environment now", file_name(path));
  }
  std::unique_ptr<ViewAsset> asset = load_view_asset(path, kind, session.world.scene().anchor_m);
  check_scale(path, asset->metadata, session.scene_facts);
  if (kind == FileKind::grid) {
    if (const auto hash = find_text(asset->metadata, "scene_hash"); hash && *hash != session.world.scene().content_hash)
      session.notes.push_back(fmt::format("note: {} was baked from another scene", path));
    note_preview(session, *asset);
    if (session.debug_grid == nullptr) session.debug_grid = asset.get();
  }
  note_environment(session, *asset);
  session.assets.push_back(std::move(asset));
  if (!session.factors.empty()) mix_groups(session);
  if (kind == FileKind::fiv) {
    try {
      session.fiv_tables = find_occluders(session.assets, session.world);
    } catch (...) {
      session.assets.pop_back();
      throw;
    }
  }
  return fmt::format("{}: {}", file_name(path), name_of(kind));
}

void set_reference(ViewSession& session, const std::string& path, const Imath::V2i& size) {
  ReferencePicture reference;
  reference.path = path;
  ImageFile file = read_image_file(path);
  append(session.notes, file.warnings, "warning: ");
  reference.film = std::move(file.film);
  reference.is_display = !is_linear_image(path);
  const Film& film = reference.film;
  if (film.width != size.x || film.height != size.y) {
    throw Error(path, fmt::format("is {} x {}, the picture is {} x {}", film.width, film.height, size.x, size.y),
                "render it with the picture's --size");
  }
  // OpenGL's first row is the lowest.
  std::vector<Rgb> upward;
  upward.reserve(film.pixels.size());
  for (int y = film.height; y-- > 0;)
    for (int x = 0; x < film.width; ++x) upward.push_back(film.at(x, y));
  reference.texture =
      gl::make_texture_2d(path, gl::Format::rgb32f, film.width, film.height, upward.data(), gl::Filter::nearest);
  session.reference = std::move(reference);
}

void remove_object(ViewSession& session, std::size_t object) {
  if (object == 0 || object >= session.world.objects.size()) return;
  session.world.objects.erase(session.world.objects.begin() + std::ptrdiff_t(object));
  find_extended_lights(session);
}

}  // namespace ivory
