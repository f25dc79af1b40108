// A job in a folder of its own, run as a script runs it.
#pragma once

#include <map>
#include <sstream>
#include <vector>

#include "tests/support/command_test.h"

namespace ivory {

class BatchTest : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    std::filesystem::copy_file(scene("cornell_box.gltf"), path("cornell_box.gltf"));
    std::filesystem::copy_file(scene("furnace_box.gltf"), path("tile.gltf"));
    // Radiance's picture format without compression: 16 x 8 pixels of 1 nit, and a brighter one.
    std::string sky = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n";
    for (int i = 0; i < 16 * 8; ++i) sky += i == 20 ? "\x80\x80\x80\x88" : "\x80\x80\x80\x81";
    write("sky.hdr", sky);
  }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
    std::ofstream(path(name), std::ios::binary) << text;
  }

  // `arguments` after "batch job.toml".
  RunResult batch(const std::string& arguments = "", bool with_errors = true) const {
    return run_ivory("batch " + path("job.toml") + " " + arguments, with_errors);
  }
  // Its lines, by asset.
  std::map<std::string, nlohmann::json> lines(const std::string& arguments = "") const {
    std::map<std::string, nlohmann::json> found;
    std::istringstream text(batch("--json " + arguments, false).output);
    for (std::string line; std::getline(text, line);) {
      nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
      EXPECT_TRUE(json.is_object()) << line;
      found[json.value("asset", "")] = json;
    }
    return found;
  }
  // asset -> state
  std::map<std::string, std::string> states(const std::string& arguments = "") const {
    std::map<std::string, std::string> found;
    for (const auto& [asset, line] : lines(arguments)) found[asset] = line.value("state", "");
    return found;
  }

  nlohmann::json read_scene() const { return nlohmann::json::parse(bytes_of(path("cornell_box.gltf"))); }
  void write_scene(const nlohmann::json& scene) const { write("cornell_box.gltf", scene.dump(3)); }

  using States = std::map<std::string, std::string>;
};

}  // namespace ivory
