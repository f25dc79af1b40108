#include "tools/view/draw/frame.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/view/draw/debug.h"
#include "tools/view/session/light.h"

namespace ivory {

namespace {

// Of parts of an object that stands so.
class Mover {
 public:
  explicit Mover(const Placement& at)
      : offset_m_(at.offset_m), slides_(at.turn_deg == V3f(0, 0, 0) && at.scale == 1), matrix_(to_matrix(at)) {}
  M44f operator()(const M44f& to_world) const {
    if (!slides_) return to_world * matrix_;
    M44f out = to_world;
    for (unsigned c = 0; c < 3; ++c) out[3][c] += offset_m_[c];
    return out;
  }

 private:
  V3f offset_m_;
  bool slides_;
  M44f matrix_;
};

float radians(double degrees) { return float(std::remainder(degrees, 360.0) * radians_a_degree); }

RuntimeCamera runtime_camera(const ViewSession& session, const ViewTarget& target, const V2f& shift) {
  const ViewWorld& world = session.world;
  const Camera& camera = world.camera.camera;
  // Objects may have left the sphere that they were measured in.
  float radius_m = world.radius_m;
  for (const ViewObject& object : world.objects) {
    const Placement at = place(object, world.time_s);
    const V3f center = placed(at, object.center_m);
    radius_m = std::max(radius_m, (center - world.center_m).length() + at.scale * object.radius_m);
  }
  const ViewMatrices m =
      view_matrices(world.scene().name, camera, target.width(), target.height(), shift, world.center_m, radius_m);
  RuntimeCamera out;
  out.clip_from_world = m.world_to_eye * m.projection;
  out.position_m = eye(world.camera);
  out.perspective = camera.perspective;
  out.forward = forward(world.camera);
  return out;
}

void require_inputs(const ViewSession& session, const ViewTarget& target) {
  const DebugView view = session.settings.debug;
  if (const std::string lack = lacks(session, view); !lack.empty())
    throw ParameterError("debug", fmt::format("{}: {}", name_of(view), lack));
  if (view != DebugView::difference) return;
  const Film& film = session.reference->film;
  if (film.width != target.width() || film.height != target.height()) {
    throw ParameterError("debug", fmt::format("difference: the reference is {} x {}, the picture {} x {}", film.width,
                                              film.height, target.width(), target.height()));
  }
}

// The value that nearly all of the picture stays under, so that a few outliers do not make the rest dark.
float greatest_value(const Film& film) {
  std::vector<float> values;
  values.reserve(film.pixels.size());
  for (const Rgb& pixel : film.pixels) {
    if (const float value = std::abs(luminance(pixel)); value > 0) values.push_back(value);
  }
  if (values.empty()) return 1;
  const auto at = values.begin() + std::ptrdiff_t((values.size() - 1) * 99 / 100);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Differences of display values where the reference has such.
Film difference(const ViewSession& session, const Film& mean) {
  Film out = mean;
  if (session.reference->is_display) return out;
  for (std::size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] -= session.reference->film.pixels[i];
  return out;
}

}  // namespace

// The R2 sequence (Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018), from the middle on.
V2f pixel_point(int i) {
  const float x = 0.5F + 0.7548777F * float(i);
  const float y = 0.5F + 0.5698403F * float(i);
  return {x - std::floor(x) - 0.5F, y - std::floor(y) - 0.5F};
}

std::size_t ViewFrame::bytes() const {
  std::size_t sum = punctual_.lights.bytes();
  for (const auto& [kind, shadows] : extended_) sum += shadows.lights.bytes();
  return sum;
}

bool ViewFrame::update(Shadows& shadows, const ViewSession& session, int size, int sample,
                       const std::function<std::vector<RuntimeLight>(std::span<const Placement>)>& lights) {
  std::vector<Placement> places;
  for (const ViewObject& object : session.world.objects) places.push_back(place(object, session.world.time_s));
  if (shadows.lights.updated() && places == shadows.places && size == shadows.size && sample == shadows.sample &&
      session.lights_version == shadows.version && session.environment_turn_deg == shadows.sky_deg)
    return false;
  std::vector<ShadowCaster> casters;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const GpuModel& model = session.world.objects[i].model;
    const Mover moved(places[i]);
    for (const ModelPart& part : model.parts)
      casters.push_back({&model.meshes[part.mesh], moved(part.to_world), &model.materials[part.material]});
  }
  ShadowParams params;
  params.size = size;
  shadows.lights.update(lights(places), casters, params);
  shadows.places = std::move(places);
  shadows.size = size;
  shadows.version = session.lights_version;
  shadows.sample = sample;
  shadows.sky_deg = session.environment_turn_deg;
  return true;
}

void ViewFrame::update_punctual(ViewSession& session) {
  if (!update(punctual_, session, session.settings.shadow_size, 0,
              [&](std::span<const Placement>) { return session.direct; }))
    return;
  // Said again where it changes, not in every frame of what moves.
  if (const int without = punctual_.lights.unshadowed(); without != unshadowed_) {
    unshadowed_ = without;
    if (without > 0) {
      session.notes.push_back(
          fmt::format("note: {} of the {} lights cast no shadow: shadow maps have {} layers, of "
                      "which a point light takes six",
                      without, session.direct.size(), max_shadow_layers));
    }
  }
}

// Light adds up: each kind has a picture of its own, with as many small lights as one takes.
void ViewFrame::add_extended(const ViewSession& session, ViewTarget& target, int i, FrameParams frame,
                             std::vector<DrawItem> items, std::span<const std::size_t> objects) {
  std::vector<HeldLight> held;
  for (const ViewObject& object : session.world.objects) held.push_back(held_light(session, object));
  frame.emission = false;
  frame.sky = nullptr;
  for (const ExtendedLights& extended : session.extended) {
    bool lights_any = false;
    for (std::size_t k = 0; k < items.size(); ++k) {
      items[k].ambient = nullptr;
      items[k].direct = !held[objects[k]].holds(extended.kind);
      lights_any = lights_any || items[k].direct;
    }
    if (!lights_any) continue;
    // Shadows that are averaged over many lights may be coarser.
    const int size = std::max(16, session.settings.shadow_size / 2);
    Shadows& shadows = extended_[extended.kind];
    const M33f sky = turn_about_y(double(radians(session.environment_turn_deg)));
    update(shadows, session, size, i,
           [&](std::span<const Placement> places) { return small_lights(extended, i, places, sky); });
    frame.lights = &shadows.lights;
    frame.items = items;
    target.begin();
    renderer_.draw(frame);
    target.add_light();
  }
}

void ViewFrame::draw_point(ViewSession& session, ViewTarget& target, int i) {
  require_inputs(session, target);
  place_lights_and_occluders(session);
  const ViewSettings& settings = session.settings;
  const std::string output = surface_debug_shader(settings.debug);
  const bool lit = settings.direct && output.empty();
  if (lit) update_punctual(session);

  std::vector<AmbientSource> sources;
  for (std::size_t object = 0; object < session.world.objects.size(); ++object) {
    const bool from_grid = !output.empty() && needs_grid(settings.debug);
    sources.push_back(from_grid ? grid_source(*session.debug_grid, settings) : ambient_source(session, object));
  }
  std::vector<DrawItem> items;
  std::vector<std::size_t> objects;  // of the items
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const ViewObject& object = session.world.objects[k];
    const GpuModel& model = object.model;
    const Mover moved(place(object, session.world.time_s));
    const bool direct = !held_light(session, object).punctual;
    for (const ModelPart& part : model.parts) {
      items.push_back(
          {&model.meshes[part.mesh], &model.materials[part.material], moved(part.to_world), &sources[k], direct});
      objects.push_back(k);
    }
  }
  FrameParams frame;
  frame.camera = runtime_camera(session, target, pixel_point(i));
  frame.items = items;
  frame.lights = &punctual_.lights;
  frame.direct = lit;
  frame.output_shader = output;
  if (lit && session.sky) frame.sky = &*session.sky;
  frame.sky_turn_rad = radians(session.environment_turn_deg);
  target.begin();
  renderer_.draw(frame);
  if (needs_grid(settings.debug) && output.empty())
    overlay_.draw(std::get<GridAsset>(session.debug_grid->data), frame.camera, settings);
  target.add();
  if (lit && !needs_grid(settings.debug)) add_extended(session, target, i, frame, items, objects);
}

bool ViewFrame::is_false_color(const ViewSettings& settings) {
  return is_number(settings.debug) ||
         (settings.false_color && (settings.debug == DebugView::irradiance || settings.debug == DebugView::stored));
}

ColorRange ViewFrame::color_range(const ViewSession& session, const ViewTarget& target) const {
  const ViewSettings& settings = session.settings;
  ColorRange range;
  range.is_signed = is_signed(settings.debug);
  if (settings.range) {
    range.greatest = *settings.range;
  } else if (settings.debug != DebugView::kept && settings.debug != DebugView::bracket) {
    const Film mean = target.read_mean();
    if (settings.debug == DebugView::difference && session.reference->is_display) {
      range.greatest = 0.1F;
    } else {
      range.greatest = greatest_value(settings.debug == DebugView::difference ? difference(session, mean) : mean);
    }
  }
  range.least = range.is_signed ? -range.greatest : 0;
  return range;
}

void ViewFrame::draw_display(const ViewSession& session, ViewTarget& target) {
  const ViewSettings& settings = session.settings;
  ToneParams tone = settings.tone;
  if (is_false_color(settings)) {
    const ColorRange range = color_range(session, target);
    target.begin_display();
    if (settings.debug == DebugView::difference) {
      display_.draw_difference(target.mean(), session.reference->texture, session.reference->is_display, tone, range);
    } else {
      display_.draw_false_color(target.mean(), range);
    }
    return;
  }
  // E on a white surface leaves as E / pi.
  if (settings.debug == DebugView::irradiance || settings.debug == DebugView::stored)
    tone.exposure_stops -= std::log2(pi);
  target.begin_display();
  display_.draw_tone_mapped(target.mean(), tone);
}

}  // namespace ivory
