// The installed package: found by CMake, built against, run.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>

#include "tests/support/command_test.h"
#include "tests/support/paths.h"

namespace ivory {

namespace {

class Package : public CommandTest {
 protected:
  // Exit code of a shell command; its output goes to a file that a failure shows.
  int shell(const std::string& command) const {
    return std::system((command + " >" + path("log") + " 2>&1 </dev/null").c_str());
  }
};

TEST_F(Package, ExampleBuildsAgainstItAndDraws) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the installed libraries need a program built with the same sanitizers";
#endif
  const std::string prefix = path("prefix");
  ASSERT_EQ(shell(std::string("cmake --install ") + build_folder + " --component runtime --prefix " + prefix), 0)
      << bytes_of(path("log"));
  ASSERT_EQ(shell(std::string("cmake -S ") + source_folder + "/runtime/example -B " + path("build") +
                  " -DCMAKE_BUILD_TYPE=Release" + " -DCMAKE_PREFIX_PATH=" + prefix),
            0)
      << bytes_of(path("log"));
  ASSERT_EQ(shell("cmake --build " + path("build")), 0) << bytes_of(path("log"));
  if (shell("command -v xvfb-run") != 0) GTEST_SKIP() << "built; running it needs xvfb-run (Debian package xvfb)";

  run("bake grid " + scene("cornell_box.gltf") + " -o " + path("room.vdb") + " --resolution 8 --photons 100k");
  const std::string xvfb = "xvfb-run -a -s '-screen 0 800x600x24' ";
  std::ofstream(path("foreign.vdb")) << "not a grid";
  for (const char* program : {"build/ivory_example ", "build/ivory_c_example "}) {
    ASSERT_EQ(shell(xvfb + path(program) + path("room.vdb") + " 3"), 0) << bytes_of(path("log"));
    // The ball hangs in the middle of the box, under its white light: neither black nor white, red and green near
    // alike.
    float red = 0;
    float green = 0;
    float blue = 0;
    ASSERT_EQ(std::sscanf(bytes_of(path("log")).c_str(), "%f %f %f", &red, &green, &blue), 3) << bytes_of(path("log"));
    for (const float channel : {red, green, blue}) {
      EXPECT_GT(channel, 0.05F) << program;
      EXPECT_LE(channel, 1.0F) << program;
    }
    // A file that is no grid: one line and exit code 1.
    EXPECT_NE(shell(xvfb + path(program) + path("foreign.vdb") + " 3"), 0);
    EXPECT_NE(bytes_of(path("log")).find("foreign.vdb"), std::string::npos) << bytes_of(path("log"));
  }
}

// Another project adds ivory's folder to its own: it gets the libraries under their names, no tools and no tests.
TEST_F(Package, IsPartOfAnotherProject) {
  std::ofstream(path("CMakeLists.txt")) << "set(ivory " << source_folder << ")"
                                        << R"(
    cmake_minimum_required(VERSION 3.25)
    project(engine LANGUAGES CXX)
    add_subdirectory(${ivory} ivory EXCLUDE_FROM_ALL)
    if(TARGET ivory OR TARGET grid_tests OR NOT TARGET ivory::ivory_tracer)
      message(FATAL_ERROR "not what another project wants")
    endif()
    add_executable(engine engine.cpp)
    target_link_libraries(engine PRIVATE ivory::ivory_grid))";
  std::ofstream(path("engine.cpp")) << R"(
    #include <cstdio>
    #include "grid/base/half.h"
    int main() { std::printf("%g", ivory::rounded_to_half(1e6F)); })";
  ASSERT_EQ(shell("cmake -G Ninja -S " + path("") + " -B " + path("build") + " -DCMAKE_CXX_FLAGS=-O0"), 0)
      << bytes_of(path("log"));
  ASSERT_EQ(shell("cmake --build " + path("build") + " --target engine"), 0) << bytes_of(path("log"));
  ASSERT_EQ(shell(path("build/engine")), 0);
  EXPECT_EQ(bytes_of(path("log")), "inf");
}

// The runtime alone needs nothing that traces, opens windows or reads command lines.
TEST_F(Package, RuntimeAloneNeedsNoTracer) {
  std::ofstream(path("pkg-config")) << R"(#!/bin/sh
    case "$*" in *draco* | *egl* | *imgui*) exit 1 ;; esac
    exec pkg-config "$@")";
  std::filesystem::permissions(path("pkg-config"), std::filesystem::perms::owner_all);
  std::string hidden;
  for (const char* name : {"embree", "TinyGLTF", "meshoptimizer", "nanoflann", "CLI11", "glfw3", "GTest"})
    hidden += std::string(" -DCMAKE_DISABLE_FIND_PACKAGE_") + name + "=ON";
  ASSERT_EQ(shell(std::string("cmake -G Ninja -S ") + source_folder + " -B " + path("build") +
                  " -DIVORY_BUILD_TRACER=OFF -DIVORY_BUILD_TOOLS=OFF -DIVORY_BUILD_TESTS=OFF -DCMAKE_BUILD_TYPE=Debug" +
                  " -DCMAKE_OPTIMIZE_DEPENDENCIES=ON -DPKG_CONFIG_EXECUTABLE=" + path("pkg-config") + hidden),
            0)
      << bytes_of(path("log"));
  // Its own files only: grid/ and its files are built elsewhere often enough.
  EXPECT_EQ(shell("cmake --build " + path("build") + " --target runtime/libivory_runtime.a"), 0)
      << bytes_of(path("log"));
}

// For every command a man page, and a word that bash completes.
TEST_F(Package, CommandsHaveManPagesAndCompletion) {
  if (shell("command -v help2man") != 0) GTEST_SKIP() << "needs help2man (Debian package help2man)";
  const std::string prefix = path("prefix");
  ASSERT_EQ(shell(std::string("cmake --install ") + build_folder + " --component tools --prefix " + prefix), 0)
      << bytes_of(path("log"));
  // It finds the module that reads images, too.
  EXPECT_EQ(shell(prefix + "/bin/ivory info " + source_folder + "/docs/two_rooms.png"), 0) << bytes_of(path("log"));
  EXPECT_TRUE(bytes_of(prefix + "/share/ivory/blender/ivory_blender.zip").starts_with("PK"));
  std::ofstream(path("complete.bash")) << "source " << prefix << "/share/bash-completion/completions/ivory\n"
                                       << "COMP_WORDS=(" << ivory_binary << " \"$@\" ''); COMP_CWORD=$(($# + 1))\n"
                                       << "_ivory; printf '%s\\n' \"${COMPREPLY[@]}\"\n";
  std::size_t pages = 0;
  const std::function<void(const std::string&)> check = [&](const std::string& command) {
    std::string name = "ivory" + command;
    std::replace(name.begin(), name.end(), ' ', '-');
    const std::string page = bytes_of(prefix + "/share/man/man1/" + name + ".1");
    EXPECT_NE(page.find("\n.SH NAME\n"), std::string::npos) << name;
    ++pages;
    std::string expected;
    for (const std::string& below : listed_commands(run_ivory(command + " --help").output)) {
      expected += below + "\n";
      EXPECT_NE(page.find(below), std::string::npos) << name << " does not list " << below;
      check(command + " " + below);
    }
    if (expected.empty()) return;
    EXPECT_EQ(shell("bash " + path("complete.bash") + command), 0);
    EXPECT_EQ(bytes_of(path("log")), expected);
  };
  check("");
  EXPECT_GE(pages, 20);
}

}  // namespace

}  // namespace ivory
