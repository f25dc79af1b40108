// A window with an OpenGL 3.3 core context, its events in the order they came.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "grid/base/types.h"
#include "tracer/image/file.h"

struct GLFWwindow;

namespace ivory {

struct MouseButtonEvent {
  int button = 0;  // GLFW_MOUSE_BUTTON_LEFT ...
  bool down = false;
  V2f pixel;  // of the picture, from its upper left corner
  bool shift = false;
  bool control = false;
};
struct MouseMoveEvent {
  V2f pixel;
};
struct ScrollEvent {
  float notches = 0;
};
struct KeyEvent {
  int key = 0;  // GLFW_KEY_A ...
  bool down = false;
  bool shift = false;
  bool control = false;
};
struct DropEvent {
  std::vector<std::string> paths;
  V2f pixel;
};
struct FocusLostEvent {};
using WindowEvent = std::variant<MouseButtonEvent, MouseMoveEvent, ScrollEvent, KeyEvent, DropEvent, FocusLostEvent>;

// Dear ImGui hears the same events.
class Window {
 public:
  // Throws Error where there is no display, or no OpenGL 3.3 on it.
  Window(int width, int height, const std::string& title);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  // Events since the last call; waits up to `seconds` for one where that is not 0.
  std::vector<WindowEvent> take_events(double seconds);
  bool should_close() const;
  void close();
  Imath::V2i size() const;  // of its framebuffer, pixels; 0 while it is an icon

  // The panel's frame between the two; end_gui() draws it into the window's framebuffer.
  void begin_gui();
  void end_gui();
  void swap();
  // What was drawn since the last swap(), the panel included.
  DisplayImage read() const;
  double seconds() const;  // since it opened

 private:
  friend struct WindowCallbacks;
  V2f to_pixel(double x, double y) const;

  GLFWwindow* window_ = nullptr;
  std::vector<WindowEvent> events_;
  V2f cursor_{0, 0};  // where the events so far left it: GLFW itself only knows where it is now
};

}  // namespace ivory
