// For tests of ivory view --headless: a room and its baked grid.
#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command_test.h"
#include "tests/support/paths.h"
#include "tracer/image/file.h"

namespace ivory {

class ViewCommand : public CommandTest {
 protected:
  static void SetUpTestSuite() {
    std::filesystem::create_directories(output_folder);
    const RunResult bake = run_ivory("bake grid " + room() + " -o " + grid() +
                                     " --resolution 20,12,16 --photons 300k --guard planes --threads 2 --force");
    ASSERT_EQ(bake.exit_code, 0) << bake.output;
  }
  // Walls at an angle to the grid, a light in the middle, purely Lambertian.
  static std::string room() { return scene("room_boxes_rotated.gltf"); }
  static std::string grid() { return (std::filesystem::path(output_folder) / "view_room.vdb").string(); }

  static nlohmann::json view(const std::string& arguments) {
    return run("view --headless --size 160x120 --force " + arguments);
  }
  // The picture that the arguments draw, as linear light or numbers.
  Film film(const std::string& arguments) const {
    const std::string output = path("film.exr");
    view(arguments + " -o " + output);
    return read_image(output);
  }
};

}  // namespace ivory
