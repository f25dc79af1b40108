#include "tools/view/run.h"

#include <cmath>
#include <filesystem>
#include <regex>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "tools/view/draw/debug.h"
#include "tools/view/session/default_grid.h"
#include "tools/view/session/light.h"
#include "tracer/image/file.h"

namespace ivory {

namespace {

using Json = nlohmann::ordered_json;

// What a user who names no method expects: the best of what was given.
ViewMethod best_method(const ViewSession& session) {
  // Of a grid that cannot be read as asked choose_method() says so: nothing else stands in for it.
  if (find_asset(session.assets, FileKind::grid) != nullptr) return ViewMethod::grid;
  for (const ViewMethod method :
       {ViewMethod::fiv, ViewMethod::lobes, ViewMethod::cubemap, ViewMethod::difmap, ViewMethod::sh9}) {
    if (lacks(session, method).empty()) return method;
  }
  return ViewMethod::none;
}

void choose_methods(ViewSession& session, const ViewRun& run) {
  const std::string all = run.method.empty() ? std::string(name_of(best_method(session))) : run.method;
  for (std::size_t i = 0; i < session.world.objects.size(); ++i) choose_lights(session, i, all);
  // As ivory render has it: the cube map is for what moves near it, the rest keeps its grid.
  if (all == name_of(ViewMethod::cubemap) && session.world.objects.size() > 1 &&
      find_asset(session.assets, FileKind::grid) != nullptr)
    choose_method(session, 0, ViewMethod::grid);
  for (const std::string& text : run.methods_of) {
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos) throw UsageError("--method-of: '" + text + "' is not OBJECT=METHOD");
    const std::string object = text.substr(0, equals);
    bool found = false;
    for (std::size_t i = 0; i < session.world.objects.size(); ++i) {
      if (session.world.objects[i].name != object && !(i == 0 && object == "scene")) continue;
      choose_lights(session, i, std::string_view(text).substr(equals + 1));
      found = true;
    }
    if (!found) throw UsageError("--method-of: there is no object '" + object + "'");
  }
}

// Without a value of the user's a constant source is as bright as what it stands for.
Rgb default_constant(const ViewSession& session) {
  if (const ViewAsset* grid = find_asset(session.assets, FileKind::grid); grid != nullptr)
    return std::get<GridAsset>(grid->data).mean_e_lux;
  if (const ViewAsset* difmap = find_asset(session.assets, FileKind::difmap); difmap != nullptr)
    return std::get<DifMapAsset>(difmap->data).mean_e_lux;
  return {1, 1, 1};
}

Json vector_json(const V3f& v) { return {shortest(v.x), shortest(v.y), shortest(v.z)}; }

// From where the object's file has it.
Json offset_json(const ViewObject& object, double time_s, const V3d& anchor_m) {
  const V3f now = place(object, time_s).offset_m;
  if (object.scene->anchor_m == anchor_m) return vector_json(now);
  const V3d offset = offset_in_world(object, now, anchor_m);
  return {offset.x, offset.y, offset.z};
}

// %d, or with a width: %04d.
const std::regex& number_pattern() {
  static const std::regex pattern("%(0?[1-9]?)d");
  return pattern;
}

}  // namespace

ViewSession start_session(const ViewRun& run, const CommonOptions& common) {
  ViewSession session = open_session(run.input);
  session.settings = run.settings;
  if (is_black(run.settings.constant_e_lux)) session.settings.constant_e_lux = default_constant(session);
  if (!run.reference.empty()) set_reference(session, run.reference, run.input.size);
  if (run.method.empty() && run.methods_of.empty() && !is_lit_by_assets(session)) {
    bake_default_grid(session, run.save_grid, common);
  } else if (!run.save_grid.empty()) {
    throw UsageError("--save-grid: no grid is baked where an asset or a method is given");
  }
  choose_methods(session, run);
  for (const std::string& note : session.notes) print_note(common, note);
  session.notes.clear();
  return session;
}

float find_exposure(ViewFrame& frame, ViewSession& session, ViewTarget& target) {
  const DebugView view = session.settings.debug;
  struct Restore {
    DebugView& debug;
    DebugView before;
    ~Restore() { debug = before; }
  } const restore{session.settings.debug, view};
  const bool is_irradiance = view == DebugView::irradiance || view == DebugView::stored;
  if (!is_irradiance) session.settings.debug = DebugView::none;
  target.reset();
  frame.draw_point(session, target, 0);
  target.reset();
  return auto_exposure(target.read_mean()) + (is_irradiance ? std::log2(pi) : 0.0F);
}

void require_linear_form(const std::string& path, const ViewSession& session) {
  if (is_linear_image(path) && session.settings.debug == DebugView::difference && session.reference &&
      session.reference->is_display)
    throw UsageError("--debug difference with a display reference has no linear form; give an .exr reference");
}

void write_picture(const std::string& path, const ViewSession& session, const ViewTarget& target, bool force) {
  require_linear_form(path, session);
  Metadata metadata;
  metadata["version"] = std::string(IVORY_VERSION);
  metadata["scene"] = session.world.objects.front().name;
  metadata["method"] = lights_text(session.world.objects.front());
  metadata["light"] = std::string(session.settings.direct ? "all" : "indirect");
  if (session.settings.debug != DebugView::none) metadata["debug"] = std::string(name_of(session.settings.debug));
  if (is_linear_image(path)) {
    Film film = target.read_mean();
    if (session.settings.debug == DebugView::difference) {
      for (std::size_t i = 0; i < film.pixels.size(); ++i) film.pixels[i] -= session.reference->film.pixels[i];
    }
    const std::string unit = unit_of(session.settings.debug);
    metadata["units"] = unit.empty() ? std::string("nits") : unit;
    write_image(path, film, 0, metadata, force);
    return;
  }
  metadata["tone"] = std::string(name_of(session.settings.tone.curve));
  metadata["exposure_stops"] = double(session.settings.tone.exposure_stops);
  write_display_image(path, target.read_display(), metadata, force);
}

std::string legend_title(const ViewSession& session) {
  const DebugView view = session.settings.debug;
  const std::string unit = view != DebugView::difference   ? unit_of(view)
                           : session.reference->is_display ? "of white"
                                                           : "nits";
  return fmt::format("{}, {}", name_of(view), unit);
}

bool has_number(const std::string& path) { return std::regex_search(path, number_pattern()); }

std::string numbered(const std::string& path, std::uint64_t number) {
  std::smatch match;
  if (!std::regex_search(path, match, number_pattern())) return path;
  const std::string form = match[1].str();
  const std::string digits = form.empty() ? fmt::format("{}", number)
                             : form.front() == '0'
                                 ? fmt::format("{:0{}}", number, form.size() > 1 ? std::stoi(form.substr(1)) : 1)
                                 : fmt::format("{:{}}", number, std::stoi(form));
  return match.prefix().str() + digits + match.suffix().str();
}

std::string screenshot_name(const std::vector<std::string>& outputs, const std::string& extension) {
  std::string pattern = "ivory_%04d" + extension;
  for (const std::string& output : outputs) {
    if (std::filesystem::path(output).extension() == extension) pattern = output;
  }
  if (!has_number(pattern)) return pattern;
  std::uint64_t number = 1;
  while (std::filesystem::exists(numbered(pattern, number))) ++number;
  return numbered(pattern, number);
}

Json describe(const ViewSession& session) {
  const ViewWorld& world = session.world;
  const V3d& anchor_m = world.scene().anchor_m;
  Json json;
  json["camera"] = {{"position_m", shortest(eye(world.camera), anchor_m)},
                    {"forward", vector_json(forward(world.camera))},
                    {"pivot_m", shortest(pivot(world.camera), anchor_m)}};
  json["objects"] = Json::array();
  for (const ViewObject& object : world.objects) {
    Json entry{{"name", object.name},
               {"offset_m", offset_json(object, world.time_s, anchor_m)},
               {"method", lights_text(object)}};
    const Placement at = place(object, world.time_s);
    if (at.turn_deg != V3f(0, 0, 0)) entry["turn_deg"] = vector_json(at.turn_deg);
    if (at.scale != 1) entry["scale"] = shortest(at.scale);
    std::vector<std::string> labels;
    for (const ObjectLight& light : object.lights) {
      if (light.asset != nullptr) labels.push_back(light.asset->label());
    }
    if (!labels.empty()) entry["asset"] = fmt::format("{}", fmt::join(labels, "+"));
    json["objects"].push_back(std::move(entry));
  }
  json["assets"] = Json::array();
  for (const auto& asset : session.assets)
    json["assets"].push_back({{"file", asset->label()}, {"kind", name_of(asset->kind())}, {"bytes", asset->bytes()}});
  if (!session.environment.empty()) json["environment"] = session.environment;
  if (session.environment_turn_deg != 0) json["environment_turn_deg"] = session.environment_turn_deg;
  json["exposure_stops"] = shortest(session.settings.tone.exposure_stops);
  json["debug"] = name_of(session.settings.debug);
  return json;
}

}  // namespace ivory
