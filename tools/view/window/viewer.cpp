// ivory view with its window.
#include <cmath>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <imgui.h>
#include <nlohmann/json.hpp>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "grid/base/error.h"
#include "tools/view/draw/gl_context.h"
#include "tools/view/draw/legend.h"
#include "tools/view/draw/timer.h"
#include "tools/view/run.h"
#include "tools/view/window/gui.h"
#include "tools/view/window/keys.h"
#include "tools/view/window/window.h"
#include "tools/view/world/controls.h"
#include "tracer/core/camera.h"
#include "tracer/image/file.h"

namespace ivory {

namespace {

class Viewer {
 public:
  Viewer(const ViewRun& run, const CommonOptions& common)
      : run_(run), common_(common), window_(run.input.size.x, run.input.size.y, title(run)) {
    session_.emplace(start_session(run, common));
    frame_.emplace();
    timer_.emplace();
    first_camera_ = session_->world.camera;
    state_.samples = run.samples;
    resize();
    if (target_) find_exposure_now();
    if (run.exposure_stops) session_->settings.tone.exposure_stops = *run.exposure_stops;
  }

  void run_until_closed() {
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
      last = now;
      resize();
      if (!target_) continue;  // an icon draws nothing
      draw();
    }
  }

  nlohmann::ordered_json result() const {
    nlohmann::ordered_json json{{"frames", frames_},
                                {"renderer", gl_description()},
                                {"gpu_bytes", bytes()},
                                {"cpu_ms", shortest(state_.cpu_ms)},
                                {"gpu_ms", shortest(timer_->milliseconds())},
                                {"screenshots", screenshots_}};
    json.update(describe(*session_));
    return json;
  }

 private:
  static std::string title(const ViewRun& run) {
    return "ivory - " + std::filesystem::path(run.input.scene).filename().string();
  }
  std::size_t bytes() const { return session_->bytes() + frame_->bytes() + (target_ ? target_->bytes() : 0); }
  bool moving() const {
    if (!state_.playing) return false;
    for (const ViewObject& object : session_->world.objects) {
      if (object.path.kind != ObjectPath::Kind::none) return true;
    }
    return false;
  }
  bool idle() const {
    return !dirty_ && !controls_.flies() && !moving() && target_ &&
           (!failure_.empty() || target_->samples() >= state_.samples);
  }
  void say(const std::string& message) {
    print_note(common_, message);
    state_.messages.push_back(message);
    if (state_.messages.size() > 5) state_.messages.pop_front();
  }

  // What the user asks for may be impossible; then a line says so and all stays as it was.
  template <typename Action>
  void attempt(const Action& action) {
    try {
      action();
    } catch (const Error& error) {
      say(error.what());
    } catch (const UsageError& error) {
      say(error.what());
    }
    for (const std::string& note : session_->notes) say(note);
    session_->notes.clear();
  }

  void resize() {
    const Imath::V2i size = window_.size();
    if (size.x < 1 || size.y < 1) {
      target_.reset();
      return;
    }
    if (target_ && target_->width() == size.x && target_->height() == size.y) return;
    target_.emplace(size.x, size.y);
    dirty_ = true;
  }

  void find_exposure_now() {
    attempt([&] { session_->settings.tone.exposure_stops = find_exposure(*frame_, *session_, *target_); });
    dirty_ = true;
  }

  // What changed since the last frame makes its points worthless.
  void draw_points(int up_to) {
    if (dirty_) target_->reset();
    dirty_ = false;
    while (target_->samples() < up_to) frame_->draw_point(*session_, *target_, pixel_point(target_->samples()));
  }

  // What cannot be drawn is said once, and tried again when something has changed.
  void draw_picture() {
    try {
      if (dirty_ || target_->samples() < state_.samples) draw_points(dirty_ ? 1 : target_->samples() + 1);
      frame_->draw_display(*session_, *target_);
      failure_.clear();
    } catch (const UsageError& error) {
      // A view that lacks what it shows, after a resize or a removal.
      session_->settings.debug = DebugView::none;
      session_->settings.lookup.reconstruction = Reconstruction::optimal;
      dirty_ = is_news(error);
      if (dirty_) throw;
    } catch (const Error& error) {
      if (is_news(error)) throw;
    }
  }
  bool is_news(const std::exception& error) {
    const bool known = failure_ == error.what();
    failure_ = error.what();
    return !known;
  }

  void draw() {
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

  void draw_panel() {
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

  void obey(const GuiRequest& request) {
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

  void frame_all() {
    ViewWorld& world = session_->world;
    world.camera =
        frame_sphere(world.camera, world.center_m, world.radius_m, float(target_->width()) / float(target_->height()));
    dirty_ = true;
  }
  void reset_camera() {
    session_->world.camera = first_camera_;
    dirty_ = true;
  }
  void remove(std::size_t object) {
    attempt([&] { remove_object(*session_, object); });
    controls_.release_all();
    controls_.select(0);
    dirty_ = true;
  }

  void screenshot(const std::string& extension) {
    const std::string path = screenshot_name(run_.outputs, extension);
    require_linear_form(path, *session_);
    draw_points(state_.samples);
    frame_->draw_display(*session_, *target_);
    write_picture(path, *session_, *target_, common_.force);
    screenshots_.push_back(path);
    say(path + " written");
  }
  // As the window shows it, with the panel.
  void write_window() {
    const std::string path = screenshot_name(run_.outputs, ".png");
    write_display_image(path, window_.read(), {}, common_.force);
    screenshots_.push_back(path);
    say(path + " written");
  }

  void on(const MouseButtonEvent& e) {
    const std::optional<MouseButton> button = mouse_button(e.button);
    if (!button || !target_) return;
    if (!e.down) {
      controls_.release(*button);
    } else if (!(state_.shown && ImGui::GetIO().WantCaptureMouse)) {
      controls_.press(session_->world, *button, e.pixel, window_.size(), e.shift);
    }
  }
  void on(const MouseMoveEvent& e) { dirty_ = controls_.move(session_->world, e.pixel, window_.size()) || dirty_; }
  void on(const ScrollEvent& e) {
    if (!(state_.shown && ImGui::GetIO().WantCaptureMouse))
      dirty_ = controls_.scroll(session_->world, e.notches) || dirty_;
  }
  void on(const FocusLostEvent&) { controls_.release_all(); }
  void on(const DropEvent& e) {
    for (const std::string& path : e.paths) {
      attempt([&] {
        // A model stands where it was let go.
        const View view = make_view(title(run_), session_->world.camera.camera, window_.size().x, window_.size().y);
        const std::optional<Pick> under = pick(session_->world, make_ray(view, e.pixel));
        say(add_file(*session_, path, under ? under->point_m : pivot(session_->world.camera), window_.size()));
      });
    }
    dirty_ = true;
  }
  void on(const KeyEvent& e) {
    if (const std::optional<FlyKey> key = fly_key(e.key); key && (!e.control || !e.down)) {
      fast_ = e.shift;
      if (!e.down)
        controls_.release(*key);
      else if (!ImGui::GetIO().WantTextInput)
        dirty_ = controls_.press(session_->world, *key) || dirty_;
      return;
    }
    if (!e.down || ImGui::GetIO().WantTextInput) return;
    press(e);
  }
  void press(const KeyEvent& e) {
    ViewSettings& s = session_->settings;
    switch (e.key) {
      case GLFW_KEY_ESCAPE:
        window_.close();
        return;
      case GLFW_KEY_P:
        if (e.control)
          screenshot_with_panel_ = true;
        else
          attempt([&] { screenshot(e.shift ? ".exr" : ".png"); });
        return;
      case GLFW_KEY_H:
        state_.shown = !state_.shown;
        return;
      case GLFW_KEY_F:
        frame_all();
        return;
      case GLFW_KEY_HOME:
        reset_camera();
        return;
      case GLFW_KEY_X:
        find_exposure_now();
        return;
      case GLFW_KEY_SPACE:
        state_.playing = !state_.playing;
        return;
      case GLFW_KEY_DELETE:
        if (controls_.selected() > 0) remove(controls_.selected());
        return;
      case GLFW_KEY_G:
        s.guard = s.guard == Guard::planes ? Guard::off : Guard::planes;
        break;
      case GLFW_KEY_C:
        s.lookup.interpolation =
            s.lookup.interpolation == Interpolation::trilinear ? Interpolation::tricubic : Interpolation::trilinear;
        break;
      case GLFW_KEY_V:
        s.debug = next_view();
        break;
      default:
        return;
    }
    dirty_ = true;
  }
  // The next one that can be shown.
  DebugView next_view() const {
    std::size_t i = std::size_t(session_->settings.debug);
    do i = (i + 1) % all_debug_views.size();
    while (!lacks(*session_, all_debug_views[i]).empty());
    return all_debug_views[i];
  }

  const ViewRun& run_;
  const CommonOptions& common_;
  Window window_;  // first: the context that all below lives in
  std::optional<ViewSession> session_;
  std::optional<ViewFrame> frame_;
  std::optional<ViewTarget> target_;
  std::optional<GpuTimer> timer_;
  ViewCamera first_camera_;
  ViewControls controls_;
  GuiState state_;
  bool dirty_ = true;
  std::string failure_;  // why the picture cannot be drawn; empty: it can
  bool fast_ = false;
  bool screenshot_with_panel_ = false;
  std::uint64_t frames_ = 0;
  std::vector<std::string> screenshots_;
};

}  // namespace

void run_window(const ViewRun& run, const CommonOptions& common) {
  Viewer viewer(run, common);
  viewer.run_until_closed();
  const nlohmann::ordered_json result = viewer.result();
  print_result(common, result, fmt::format("{} frames\n", result["frames"].get<std::uint64_t>()));
}

}  // namespace ivory
