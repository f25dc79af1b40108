// For the runtime's own .cpp files: OpenGL itself, with every call checked.
#pragma once

#include <epoxy/gl.h>

#include "runtime/gl/gl.h"

// The call, then Error naming it where OpenGL refused it: IVORY_GL(glBindTexture, target, id).
#define IVORY_GL(function, ...)    \
  do {                             \
    function(__VA_ARGS__);         \
    ::ivory::gl::check(#function); \
  } while (false)
