// ivory view with its window: draws whenever something changes, and does what mouse, keys and panel ask for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "grid/base/error.h"
#include "tools/view/draw/frame.h"
#include "tools/view/draw/target.h"
#include "tools/view/draw/timer.h"
#include "tools/view/run.h"
#include "tools/view/window/gui.h"
#include "tools/view/window/window.h"
#include "tools/view/world/controls.h"

namespace ivory {

class Viewer {
 public:
  // Opens the window and loads all. Throws UsageError and Error as the parts do. Both must outlive the viewer.
  Viewer(const ViewRun& run, const CommonOptions& common);

  void run_until_closed();

  // Frames, times, screenshots and where everything is now.
  nlohmann::ordered_json result() const;

 private:
  // Drawing: viewer.cpp.
  std::size_t bytes() const;  // on the GPU
  bool moving() const;
  bool idle() const;
  bool animates() const;
  void animate(double seconds);
  void say(const std::string& message);
  template <typename Action>
  void attempt(const Action& action);
  void resize();
  void find_exposure_now();
  void draw_points(int up_to);
  void draw_picture();
  bool is_news(const std::exception& error);
  void draw();
  void draw_panel();
  void obey(const GuiRequest& request);
  void frame_all();
  void reset_camera();
  void remove(std::size_t object);
  void screenshot(const std::string& extension);
  void write_window();

  // Events: viewer_input.cpp.
  void on(const MouseButtonEvent& e);
  void on(const MouseMoveEvent& e);
  void on(const ScrollEvent& e);
  void on(const KeyEvent& e);
  void on(const DropEvent& e);
  void on(const FocusLostEvent& e);
  void press(const KeyEvent& e);
  void show_next_view();
  ViewObject* selected_object();  // null: none that moves
  bool turn_selected(float degrees);
  bool scale_selected(float factor);

  const ViewRun& run_;
  const CommonOptions& common_;
  Window window_;  // first: the context that all below lives in
  std::optional<ViewSession> session_;
  std::optional<ViewFrame> frame_;
  std::optional<ViewTarget> target_;  // empty while the window is an icon
  std::optional<GpuTimer> timer_;
  ViewCamera first_camera_;
  ViewControls controls_;
  GuiState state_;
  bool dirty_ = true;    // does the picture no longer show what it should?
  std::string failure_;  // why the picture cannot be drawn; empty: it can
  bool fast_ = false;    // does the camera fly fast?
  bool screenshot_with_panel_ = false;
  std::uint64_t frames_ = 0;
  std::vector<std::string> screenshots_;
};

// What the user asks for may be impossible; then a line says so and all stays as it was.
template <typename Action>
void Viewer::attempt(const Action& action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    say(error.what());
  }
  for (const std::string& note : session_->notes) say(note);
  session_->notes.clear();
}

// Runs until the window is closed, or for as many frames as asked for, and prints the result. Throws as Viewer does.
void run_window(const ViewRun& run, const CommonOptions& common);

}  // namespace ivory
