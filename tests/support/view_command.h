// For tests of ivory view --headless: a room and its baked grid.
#pragma once

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/baked_once.h"
#include "tests/support/command_test.h"
#include "tests/support/paths.h"
#include "tracer/image/file.h"

namespace ivory {

class ViewCommand : public CommandTest {
 protected:
  // Walls at an angle to the grid, a light in the middle, purely Lambertian.
  static std::string room() { return scene("room_boxes_rotated.gltf"); }
  static std::string grid() {
    return baked_once("view_room.vdb",
                      "bake grid " + room() + " --resolution 20,12,16 --photons 300k --guard planes --threads 2");
  }

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
