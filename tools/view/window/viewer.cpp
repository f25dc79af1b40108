#include "tools/view/window/viewer.h"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "runtime/gl/headless_context.h"
#include "tools/view/draw/legend.h"
#include "tracer/image/file.h"

namespace ivory {

namespace {

std::string title(const ViewRun& run) {
  return "ivory - " + std::filesystem::path(run.input.scene).filename().string();
}

}  // namespace

Viewer::Viewer(const ViewRun& run, const CommonOptions& common)
    : run_(run), common_(common), window_(run.input.size.x, run.input.size.y, title(run)) {
  session_.emplace(start_session(run, common));
  frame_.emplace();
  timer_.emplace();
  first_camera_ = session_->world.camera;
  state_.samples = run.samples;
  resize();
  if (target_) find_exposure_now();
  state_.animates = run.input.plays;
  if (run.exposure_stops) session_->settings.tone.exposure_stops = *run.exposure_stops;
}

void Viewer::run_until_closed() {
  double last = window_.seconds();
  while (!window_.should_close() && (run_.frames == 0 || frames_ < run_.frames)) {
    for (const WindowEvent& event : window_.take_events(!target_ || idle() ? 0.05 : 0))
      std::visit([&](const auto& e) { on(e); }, event);
    const double now = window_.seconds();
    if (controls_.advance(session_->world, float(now - last), fast_)) dirty_ = true;
    if (moving()) {
      session_->world.time_s += now - last;
      dirty_ = true;
    }
    animate(now - last);
    last = now;
    resize();
    if (!target_) continue;  // an icon draws nothing
    draw();
  }
}

nlohmann::ordered_json Viewer::result() const {
  nlohmann::ordered_json json{{"frames", frames_},
                              {"renderer", gl_description()},
                              {"gpu_bytes", bytes()},
                              {"cpu_ms", shortest(state_.cpu_ms)},
                              {"gpu_ms", shortest(timer_->milliseconds())},
                              {"screenshots", screenshots_}};
  json.update(describe(*session_));
  return json;
}

std::size_t Viewer::bytes() const { return session_->bytes() + frame_->bytes() + (target_ ? target_->bytes() : 0); }
bool Viewer::moving() const {
  if (!state_.playing) return false;
  for (const ViewObject& object : session_->world.objects) {
    if (object.path.kind != ObjectPath::Kind::none) return true;
  }
  return false;
}

// The scene at its animation's time, which goes on where it plays, over and over. What cannot be posed stays as it is.
void Viewer::animate(double seconds) {
  if (!session_->animation) return;
  SceneAnimation& animation = *session_->animation;
  if (state_.animates) {
    const double begin_s = animation.span().begin_s;
    const double length_s = animation.span().end_s - begin_s;
    animation.time_s += seconds;
    if (animation.time_s > animation.span().end_s)
      animation.time_s = length_s > 0 ? begin_s + std::fmod(animation.time_s - begin_s, length_s) : begin_s;
  }
  if (!animates() && !animation.posed && animation.time_s == animation.shown_s) return;  // as it is stored
  if (animation.posed && animation.time_s == animation.shown_s && animation.chosen == animation.shown) return;
  attempt([&] {
    try {
      pose_scene(*session_);
      dirty_ = true;
    } catch (...) {
      state_.animates = false;
      animation.time_s = animation.shown_s;
      animation.chosen = animation.shown;
      throw;
    }
  });
}

bool Viewer::animates() const { return session_->animation && state_.animates; }

bool Viewer::idle() const {
  return !dirty_ && !controls_.flies() && !moving() && !animates() && target_ &&
         (!failure_.empty() || target_->samples() >= state_.samples);
}

void Viewer::say(const std::string& message) {
  print_note(common_, message);
  state_.messages.push_back(message);
  if (state_.messages.size() > 5) state_.messages.pop_front();
}

void Viewer::resize() {
  const Imath::V2i size = window_.size();
  if (size.x < 1 || size.y < 1) {
    target_.reset();
    return;
  }
  if (target_ && target_->width() == size.x && target_->height() == size.y) return;
  target_.emplace(size.x, size.y);
  dirty_ = true;
}

void Viewer::find_exposure_now() {
  attempt([&] { session_->settings.tone.exposure_stops = find_exposure(*frame_, *session_, *target_); });
  dirty_ = true;
}

// What changed since the last frame makes its points worthless.
void Viewer::draw_points(int up_to) {
  if (dirty_) target_->reset();
  dirty_ = false;
  while (target_->samples() < up_to) frame_->draw_point(*session_, *target_, target_->samples());
}

// What cannot be drawn is said once, and tried again when something has changed.
void Viewer::draw_picture() {
  try {
    if (dirty_ || target_->samples() < state_.samples) draw_points(dirty_ ? 1 : target_->samples() + 1);
    frame_->draw_display(*session_, *target_);
    failure_.clear();
  } catch (const ParameterError& error) {
    // A view that lacks what it shows, after a resize or a removal.
    session_->settings.debug = DebugView::none;
    session_->settings.lookup.reconstruction = Reconstruction::optimal;
    dirty_ = is_news(error);
    if (dirty_) throw;
  } catch (const Error& error) {
    if (is_news(error)) throw;
  }
}

bool Viewer::is_news(const std::exception& error) {
  const bool known = failure_ == error.what();
  failure_ = error.what();
  return !known;
}

void Viewer::draw() {
  const double start = window_.seconds();
  const bool was_idle = idle();
  timer_->begin();
  if (dirty_ || failure_.empty()) attempt([&] { draw_picture(); });
  timer_->end();
  ++frames_;
  target_->show();
  if (!was_idle) {
    state_.cpu_ms = float(1000 * (window_.seconds() - start));
    state_.gpu_ms = timer_->milliseconds();
  }
  draw_panel();
  if (screenshot_with_panel_) {
    screenshot_with_panel_ = false;
    attempt([&] { write_window(); });
  }
  window_.swap();
}

void Viewer::draw_panel() {
  state_.gpu_bytes = bytes();
  state_.width = target_->width();
  state_.height = target_->height();
  state_.selected = controls_.selected();
  window_.begin_gui();
  if (ViewFrame::is_false_color(session_->settings) && target_->samples() > 0) {
    const ColorRange range = frame_->color_range(*session_, *target_);
    draw_legend(*ImGui::GetBackgroundDrawList(), range, legend_title(*session_), int(ImGui::GetIO().DisplaySize.y));
  }
  GuiRequest request;
  attempt([&] { request = draw_gui(*session_, state_); });
  window_.end_gui();
  controls_.select(state_.selected);
  obey(request);
}

void Viewer::obey(const GuiRequest& request) {
  dirty_ = dirty_ || request.redraw || request.redisplay;
  if (request.find_exposure) find_exposure_now();
  if (request.frame_all) frame_all();
  if (request.reset_camera) reset_camera();
  if (request.camera >= 0) {
    const Camera& camera = session_->world.scene().cameras[std::size_t(request.camera)];
    session_->world.camera = make_view_camera(camera, session_->world.center_m, session_->world.radius_m);
    dirty_ = true;
  }
  if (request.removed > 0) remove(std::size_t(request.removed));
  if (request.screenshot) attempt([&] { screenshot(".png"); });
}

void Viewer::frame_all() {
  ViewWorld& world = session_->world;
  world.camera =
      frame_sphere(world.camera, world.center_m, world.radius_m, float(target_->width()) / float(target_->height()));
  dirty_ = true;
}

void Viewer::reset_camera() {
  session_->world.camera = first_camera_;
  dirty_ = true;
}

void Viewer::remove(std::size_t object) {
  attempt([&] { remove_object(*session_, object); });
  controls_.release_all();
  controls_.select(0);
  dirty_ = true;
}

void Viewer::screenshot(const std::string& extension) {
  const std::string path = screenshot_name(run_.outputs, extension);
  require_linear_form(path, *session_);
  draw_points(state_.samples);
  frame_->draw_display(*session_, *target_);
  write_picture(path, *session_, *target_, common_.force);
  screenshots_.push_back(path);
  say(path + " written");
}

// As the window shows it, with the panel.
void Viewer::write_window() {
  const std::string path = screenshot_name(run_.outputs, ".png");
  write_display_image(path, window_.read(), {}, common_.force);
  screenshots_.push_back(path);
  say(path + " written");
}

void run_window(const ViewRun& run, const CommonOptions& common) {
  Viewer viewer(run, common);
  viewer.run_until_closed();
  const nlohmann::ordered_json result = viewer.result();
  print_result(common, result, fmt::format("{} frames\n", result["frames"].get<std::uint64_t>()));
}

}  // namespace ivory
