// How long OpenGL works on a frame, without waiting for it.
#pragma once

#include <array>

#include "runtime/gl/gl.h"

namespace ivory {

class GpuTimer {
 public:
  // Around a frame's calls. Times are only taken while fewer than four frames are under way.
  void begin();
  void end();
  // Of the latest frame whose time is known; 0 before the first.
  float milliseconds() const { return milliseconds_; }

 private:
  struct Span {
    gl::Query begin;
    gl::Query end;
    bool pending = false;
  };
  std::array<Span, 4> spans_;
  std::size_t next_ = 0;
  bool running_ = false;
  float milliseconds_ = 0;
};

}  // namespace ivory
