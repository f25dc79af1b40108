// An OpenGL context without window or display, for work that only reads its pictures back.
#pragma once

#include <string>

namespace ivory {

// OpenGL 3.3 core through EGL, with no surface: draw into framebuffer objects. Current on the thread that made it
// from construction to destruction; GL objects must not outlive it. On machines without a GPU Mesa draws in software.
//
// Throws Error where EGL or OpenGL 3.3 is missing.
class HeadlessContext {
 public:
  HeadlessContext();
  ~HeadlessContext();
  HeadlessContext(HeadlessContext&& other) noexcept;
  HeadlessContext& operator=(HeadlessContext&&) = delete;

  // On the calling thread; it must not be current on another.
  void make_current() const;

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
};

// What draws in the current context: "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 3.3 (Core Profile) Mesa 22.3.6".
std::string gl_description();

}  // namespace ivory
