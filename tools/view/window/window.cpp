#include "tools/view/window/window.h"

#include <algorithm>
#include <utility>

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <imgui.h>
// After epoxy, which brings OpenGL's own declarations.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "grid/base/error.h"

namespace ivory {

namespace {

std::string last_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text == nullptr ? "for no reason it tells" : text;
}

Error no_window(const std::string& cause) {
  return {"window", "cannot be opened (" + cause + ")",
          "start it on a desktop, or draw without a window by --headless"};
}

}  // namespace

// GLFW calls back with its window, which knows ours.
struct WindowCallbacks {
  static Window& of(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }
  static void button(GLFWwindow* window, int button, int action, int mods) {
    of(window).events_.push_back(MouseButtonEvent{button, action == GLFW_PRESS, of(window).cursor_,
                                                  (mods & GLFW_MOD_SHIFT) != 0, (mods & GLFW_MOD_CONTROL) != 0});
  }
  static void move(GLFWwindow* window, double x, double y) {
    of(window).cursor_ = of(window).to_pixel(x, y);
    of(window).events_.push_back(MouseMoveEvent{of(window).cursor_});
  }
  static void scroll(GLFWwindow* window, double, double y) { of(window).events_.push_back(ScrollEvent{float(y)}); }
  static void key(GLFWwindow* window, int key, int, int action, int mods) {
    if (action == GLFW_REPEAT) return;
    of(window).events_.push_back(
        KeyEvent{key, action == GLFW_PRESS, (mods & GLFW_MOD_SHIFT) != 0, (mods & GLFW_MOD_CONTROL) != 0});
  }
  static void drop(GLFWwindow* window, int count, const char** paths) {
    of(window).events_.push_back(DropEvent{std::vector<std::string>(paths, paths + count), of(window).cursor_});
  }
  static void focus(GLFWwindow* window, int focused) {
    if (focused == 0) of(window).events_.push_back(FocusLostEvent{});
  }
};

Window::Window(int width, int height, const std::string& title) {
  if (glfwInit() != GLFW_TRUE) throw no_window(last_error());
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    const std::string cause = last_error();
    glfwTerminate();
    throw no_window(cause);
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(window_, this);
  glfwSetMouseButtonCallback(window_, WindowCallbacks::button);
  glfwSetCursorPosCallback(window_, WindowCallbacks::move);
  glfwSetScrollCallback(window_, WindowCallbacks::scroll);
  glfwSetKeyCallback(window_, WindowCallbacks::key);
  glfwSetDropCallback(window_, WindowCallbacks::drop);
  glfwSetWindowFocusCallback(window_, WindowCallbacks::focus);
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // no file beside the user's
  ImGui::StyleColorsDark();
  ImGui::GetStyle().Colors[ImGuiCol_WindowBg].w = 0.85F;
  // It puts itself in front of the callbacks above and calls them.
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

V2f Window::to_pixel(double x, double y) const {
  int width = 1;
  int height = 1;
  glfwGetWindowSize(window_, &width, &height);
  const Imath::V2i pixels = size();
  return {float(x * pixels.x / std::max(width, 1)), float(y * pixels.y / std::max(height, 1))};
}

std::vector<WindowEvent> Window::take_events(double seconds) {
  if (seconds > 0) {
    glfwWaitEventsTimeout(seconds);
  } else {
    glfwPollEvents();
  }
  return std::exchange(events_, {});
}

bool Window::should_close() const { return glfwWindowShouldClose(window_) != 0; }
void Window::close() { glfwSetWindowShouldClose(window_, GLFW_TRUE); }

Imath::V2i Window::size() const {
  Imath::V2i pixels(0, 0);
  glfwGetFramebufferSize(window_, &pixels.x, &pixels.y);
  return pixels;
}

void Window::begin_gui() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void Window::end_gui() {
  ImGui::Render();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  const Imath::V2i pixels = size();
  glViewport(0, 0, pixels.x, pixels.y);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

DisplayImage Window::read() const {
  const Imath::V2i pixels = size();
  const std::size_t row = std::size_t(pixels.x) * 3;
  std::vector<std::uint8_t> upward(row * std::size_t(pixels.y));
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glReadBuffer(GL_BACK);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, pixels.x, pixels.y, GL_RGB, GL_UNSIGNED_BYTE, upward.data());
  DisplayImage image{pixels.x, pixels.y, {}};
  for (std::size_t y = std::size_t(pixels.y); y-- > 0;) {
    image.rgb.insert(image.rgb.end(), upward.begin() + std::ptrdiff_t(y * row),
                     upward.begin() + std::ptrdiff_t((y + 1) * row));
  }
  return image;
}

void Window::swap() { glfwSwapBuffers(window_); }

double Window::seconds() const { return glfwGetTime(); }

}  // namespace ivory
