# Every third party of what is built, found as a Debian 12 package.
include(IvoryRuntimeDependencies)

pkg_check_modules(webp REQUIRED IMPORTED_TARGET libwebp)

if(IVORY_BUILD_TRACER)
  find_package(embree 3 CONFIG REQUIRED)
  find_package(TinyGLTF CONFIG REQUIRED)
  find_package(meshoptimizer CONFIG REQUIRED)
  find_package(nanoflann CONFIG REQUIRED)
  pkg_check_modules(draco REQUIRED IMPORTED_TARGET draco)
  # Random123 is headers only and ships no CMake package.
  find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED)
endif()
if(IVORY_BUILD_RUNTIME AND (IVORY_BUILD_TOOLS OR IVORY_BUILD_TESTS))
  pkg_check_modules(egl REQUIRED IMPORTED_TARGET egl)
endif()
if(IVORY_BUILD_TOOLS)
  find_package(CLI11 CONFIG REQUIRED)
  find_package(glfw3 CONFIG REQUIRED)
  find_package(tomlplusplus CONFIG REQUIRED)
  pkg_check_modules(imgui REQUIRED IMPORTED_TARGET imgui)
endif()
