#include "runtime/gl/headless_context.h"

#include <cstring>
#include <utility>

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include "grid/base/error.h"

namespace ivory {

namespace {

Error missing(const std::string& cause) {
  return {"OpenGL", cause, "install Mesa (Debian: libegl1 libgl1 libegl-mesa0 libgl1-mesa-dri) or the GPU's driver"};
}

bool can_open(const char* library) {
  void* handle = dlopen(library, RTLD_LAZY | RTLD_LOCAL);
  if (handle != nullptr) dlclose(handle);
  return handle != nullptr;
}

// libepoxy ends the process where it cannot open these.
void check_libraries() {
  if (!can_open("libEGL.so.1")) throw missing("libEGL.so.1 is not installed");
  if (!can_open("libOpenGL.so.0") && !can_open("libGL.so.1")) throw missing("libGL.so.1 is not installed");
}

bool has_client_extension(const char* name) {
  // Null where even the list of extensions is unknown (EGL 1.4 without EGL_EXT_client_extensions).
  const char* list = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (list == nullptr) {
    eglGetError();
    return false;
  }
  const std::size_t length = std::strlen(name);
  for (const char* at = std::strstr(list, name); at != nullptr; at = std::strstr(at + length, name)) {
    const bool starts = at == list || at[-1] == ' ';
    if (starts && (at[length] == ' ' || at[length] == '\0')) return true;
  }
  return false;
}

EGLDisplay initialized(EGLDisplay display) {
  if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr)) return display;
  eglGetError();
  return EGL_NO_DISPLAY;
}

// Never terminated: a display is one for the whole process, and other contexts may use it.
EGLDisplay open_display() {
  if (has_client_extension("EGL_EXT_platform_base")) {
    if (has_client_extension("EGL_MESA_platform_surfaceless")) {
      EGLDisplay display =
          initialized(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
      if (display != EGL_NO_DISPLAY) return display;
    }
    if (has_client_extension("EGL_EXT_platform_device") && has_client_extension("EGL_EXT_device_enumeration")) {
      EGLDeviceEXT device = nullptr;
      EGLint count = 0;
      if (eglQueryDevicesEXT(1, &device, &count) && count > 0) {
        EGLDisplay display = initialized(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr));
        if (display != EGL_NO_DISPLAY) return display;
      }
    }
  }
  EGLDisplay display = initialized(eglGetDisplay(EGL_DEFAULT_DISPLAY));
  if (display == EGL_NO_DISPLAY) throw missing("EGL finds no display to draw without a window");
  return display;
}

EGLContext make_context(EGLDisplay display) {
  if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context"))
    throw missing("EGL cannot draw without a surface (EGL_KHR_surfaceless_context)");
  if (!eglBindAPI(EGL_OPENGL_API)) throw missing("EGL offers OpenGL ES alone");
  const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = EGL_NO_CONFIG_KHR;
  EGLint count = 0;
  // A surfaceless context needs a config only where the driver insists on one.
  if (!eglChooseConfig(display, wanted, &config, 1, &count) || count < 1) config = EGL_NO_CONFIG_KHR;
  const EGLint attributes[] = {
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, attributes);
  if (context == EGL_NO_CONTEXT) throw missing("the driver has no OpenGL 3.3 core");
  return context;
}

std::string gl_text(GLenum what) {
  const GLubyte* text = glGetString(what);
  return text == nullptr ? "unknown" : reinterpret_cast<const char*>(text);
}

}  // namespace

HeadlessContext::HeadlessContext() {
  check_libraries();
  display_ = open_display();
  context_ = make_context(display_);
  try {
    make_current();
  } catch (...) {
    eglDestroyContext(display_, context_);
    throw;
  }
}

HeadlessContext::~HeadlessContext() {
  if (context_ == nullptr) return;
  if (eglGetCurrentContext() == context_) eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
}

HeadlessContext::HeadlessContext(HeadlessContext&& other) noexcept
    : display_(std::exchange(other.display_, nullptr)), context_(std::exchange(other.context_, nullptr)) {}

void HeadlessContext::make_current() const {
  if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
    throw missing("the context cannot be made current");
}

std::string gl_description() { return gl_text(GL_RENDERER) + ", OpenGL " + gl_text(GL_VERSION); }

}  // namespace ivory
