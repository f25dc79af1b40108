// For tests of ivory view --headless: a room and its baked grid.
#pragma once

#include <fstream>
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

  // A sky of 32 by 16 pixels, lighter on one side, with a small bright patch; turned by so many columns, to -X first.
  std::string small_sky(const std::string& name, int columns) const {
    std::ofstream file(path(name), std::ios::binary);
    file << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16 +X 32\n";
    for (int row = 0; row < 16; ++row) {
      for (int column = 0; column < 32; ++column) {
        const int before = (column + columns + 64) % 32;
        const bool patch = row == 4 && before == 5;
        file << char(row < 8 ? 120 : 60) << char(130) << char(before < 16 ? 200 : 120) << char(patch ? 137 : 128);
      }
    }
    return path(name);
  }
  // film() of 80 by 60 pixels.
  Film small(const std::string& arguments) const {
    run("view --headless --shadow-size 128 --size 80x60 --force " + arguments + " -o " + path("film.exr"));
    return read_image(path("film.exr"));
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
