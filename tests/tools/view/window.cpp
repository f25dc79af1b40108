// The viewer's window under a display that nobody sees, moved by real events of a mouse and a keyboard.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "grid/base/types.h"
#include "tests/support/command_test.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/paths.h"
#include "tracer/image/compare.h"
#include "tracer/image/file.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

bool has_program(const std::string& name) {
  return std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0;
}

V3f vector_of(const Json& json) { return {json.at(0).get<float>(), json.at(1).get<float>(), json.at(2).get<float>()}; }

class ViewWindow : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    for (const char* program : {"xvfb-run", "Xvfb", "xauth", "xdotool"}) {
      if (!has_program(program)) GTEST_SKIP() << program << " is not installed (Debian: xvfb xauth xdotool)";
    }
  }

  // A matt octahedron of half a metre's radius around the origin.
  static std::string write_octahedron() {
    GltfBuilder gltf;
    const std::vector<V3f> corners{{0.5F, 0, 0},  {-0.5F, 0, 0}, {0, 0.5F, 0},
                                   {0, -0.5F, 0}, {0, 0, 0.5F},  {0, 0, -0.5F}};
    const int positions = gltf.add(corners);
    const int indices = gltf.add_indices({0, 2, 4, 4, 2, 1, 1, 2, 5, 5, 2, 0, 4, 3, 0, 1, 3, 4, 5, 3, 1, 0, 3, 5});
    gltf.root["materials"].push_back({{"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
    gltf.add_node(
        {{"mesh", gltf.add_mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", 0}})}});
    return gltf.write("view_octahedron");
  }

  // Runs the viewer with `arguments` while `events` (a shell script; $W is the window) go to it. Its result, and what
  // it printed on stderr. Files that screenshots leave say when the events before them have been obeyed: no step waits
  // for a time.
  Json run_window(const std::string& arguments, const std::string& events) const {
    std::ofstream(path("session.sh"))
        << "cd '" << folder_.string() << "'\n"
        << ivory_binary << " view " << arguments << " --json > result.json 2> errors &\n"
        << "viewer=$!\n"
           "trap 'kill $viewer 2>/dev/null' EXIT\n"
           "W=$(timeout 60 xdotool search --sync --onlyvisible --name '^ivory - ' | head -1)\n"
           "[ -n \"$W\" ] || exit 3\n"
           "arrived() { for i in $(seq 600); do [ -s $1 ] && return; sleep 0.1; done; exit 4; }\n"
           "xdotool mousemove --window $W 400 300\n"
           "xdotool windowfocus $W\n"
        << events << "xdotool key Escape\nwait $viewer\ncode=$?\ntrap - EXIT\nexit $code\n";
    const int status = std::system(("timeout 200 xvfb-run -a -s '-screen 0 1024x768x24' bash '" + path("session.sh") +
                                    "' > '" + path("log") + "' 2>&1")
                                       .c_str());
    EXPECT_EQ(status, 0) << bytes_of(path("log")) << bytes_of(path("errors"));
    return Json::parse(bytes_of(path("result.json")), nullptr, false);
  }
};

TEST_F(ViewWindow, MouseAndKeysMoveCameraAndObject) {
  const std::string octahedron = write_octahedron();
  const std::string room = scene("room_boxes_rotated.gltf");
  const Json first = run("view --headless " + room + " --method none --samples 1 -o " + path("first.png")).at("camera");
  // In the middle of the picture, a metre and a half ahead: beside the panel.
  const V3f ahead = vector_of(first.at("position_m")) + vector_of(first.at("forward")) * 1.5F;
  const std::string object =
      octahedron + "@" + std::to_string(ahead.x) + "," + std::to_string(ahead.y) + "," + std::to_string(ahead.z);
  const Json result =
      run_window(room + " --method constant --constant 1,1,1 --object " + object +
                     " --size 800x600 --samples 1 -o shot_%d.png -o shot_%d.exr",
                 "xdotool key p; arrived shot_1.png\n"
                 // The object, to the right.
                 "xdotool mousemove --window $W 400 300 mousedown 1 mousemove --window $W 430 305\n"
                 "xdotool mousemove --window $W 480 310 mouseup 1 key p; arrived shot_2.png\n"
                 // The background: the camera orbits; then looks, comes closer and flies.
                 "xdotool mousemove --window $W 700 60 mousedown 1 mousemove --window $W 730 75 mouseup 1\n"
                 "xdotool key p; arrived shot_3.png\n"
                 "xdotool mousemove --window $W 700 60 mousedown 3 mousemove --window $W 690 80 mouseup 3\n"
                 "xdotool click 4 key w key p; arrived shot_4.png\n"
                 "xdotool key shift+p; arrived shot_1.exr\n");
  ASSERT_TRUE(result.is_object()) << bytes_of(path("errors"));
  EXPECT_EQ(result.at("screenshots").size(), 5U);

  // What was grabbed lay 1.5 m or less ahead; a pixel there is about 3 mm, and it was dragged 80 of them.
  const V3f moved = vector_of(result.at("objects").at(1).at("offset_m")) - ahead;
  EXPECT_GT(moved.length(), 0.08F);
  EXPECT_LT(moved.length(), 0.8F);
  EXPECT_NEAR(moved.y, 0, 1e-4F);  // over the ground
  const V3f right = vector_of(first.at("forward")).cross(V3f(0, 1, 0));
  EXPECT_GT(moved.dot(right), 0.05F);
  EXPECT_EQ(vector_of(result.at("objects").at(0).at("offset_m")), V3f(0, 0, 0));

  const Json& last = result.at("camera");
  EXPECT_GT((vector_of(last.at("position_m")) - vector_of(first.at("position_m"))).length(), 0.05F);
  EXPECT_GT((vector_of(last.at("forward")) - vector_of(first.at("forward"))).length(), 0.02F);
  for (const auto& [a, b] :
       {std::pair{"shot_1.png", "shot_2.png"}, {"shot_2.png", "shot_3.png"}, {"shot_3.png", "shot_4.png"}})
    EXPECT_TRUE(bytes_of(path(a)) != bytes_of(path(b))) << a << " " << b;
}

TEST_F(ViewWindow, KeysAndMouseTurnAndScaleObjects) {
  const std::string octahedron = write_octahedron();
  const std::string room = scene("room_boxes_rotated.gltf");
  const Json first = run("view --headless " + room + " --method none --samples 1 -o " + path("first.png")).at("camera");
  const V3f ahead = vector_of(first.at("position_m")) + vector_of(first.at("forward")) * 1.5F;
  const std::string object =
      octahedron + "@" + std::to_string(ahead.x) + "," + std::to_string(ahead.y) + "," + std::to_string(ahead.z);
  const Json result = run_window(
      room + " --method constant --constant 1,1,1 --object " + object + " --size 800x600 --samples 1 -o shot_%d.png",
      "xdotool mousemove --window $W 400 300 click 1 key comma key comma key period key equal key p; arrived "
      "shot_1.png\n"
      "xdotool mousemove --window $W 400 300 keydown ctrl mousedown 1 mousemove --window $W 430 300\n"
      "xdotool mousemove --window $W 460 300 mouseup 1 keyup ctrl key p; arrived shot_2.png\n");
  ASSERT_TRUE(result.is_object()) << bytes_of(path("errors"));
  const Json& moved = result.at("objects").at(1);
  // Five degrees by the keys, and 60 of the 600 pixels that make half a turn.
  const V3f turn_deg = vector_of(moved.at("turn_deg"));
  EXPECT_NEAR(turn_deg.y, 5 + 180 * 60 / 600.0F, 1);
  EXPECT_EQ(V3f(turn_deg.x, 0, turn_deg.z), V3f(0, 0, 0));
  EXPECT_NEAR(moved.at("scale").get<float>(), 1.1F, 1e-6F);
  EXPECT_LT((vector_of(moved.at("offset_m")) - ahead).length(), 1e-4F);  // Ctrl turns, and moves nothing
  EXPECT_TRUE(bytes_of(path("shot_1.png")) != bytes_of(path("shot_2.png")));
}

TEST_F(ViewWindow, PathsPlayAndKeysSwitchViews) {
  const std::string octahedron = write_octahedron();
  const std::string room = scene("room_boxes_rotated.gltf");
  const RunResult bake =
      run_ivory("bake grid " + room + " -o " + path("g.vdb") + " --resolution 8 --photons 50k --guard planes");
  ASSERT_EQ(bake.exit_code, 0) << bake.output;
  const Json result = run_window(
      room + " g.vdb --object " + octahedron + " --path line:1,0,0,1000 --size 400x300 " + "--samples 1 -o shot_%d.png",
      "xdotool key h key p; arrived shot_1.png\n"
      "xdotool key v key p; arrived shot_2.png\n"
      "xdotool key g key c key p; arrived shot_3.png\n"
      "xdotool key ctrl+p; arrived shot_4.png\n");
  ASSERT_TRUE(result.is_object()) << bytes_of(path("errors"));
  EXPECT_EQ(result.at("debug"), "irradiance");
  EXPECT_GT(result.at("objects").at(1).at("offset_m").at(0).get<double>(), 0);
  EXPECT_GT(result.at("gpu_bytes").get<double>(), 400 * 300 * 40);
  EXPECT_GT(result.at("gpu_ms").get<double>(), 0);
  EXPECT_TRUE(bytes_of(path("shot_1.png")) != bytes_of(path("shot_2.png")));
  EXPECT_TRUE(bytes_of(path("shot_2.png")) != bytes_of(path("shot_3.png")));
}

TEST_F(ViewWindow, OccludersStayWithTheirObjectsWhenOneIsRemoved) {
  const std::string octahedron = write_octahedron();
  const std::string plaza = scene("plaza.gltf");
  const std::string sky = scene("sky.hdr");
  run("bake fiv " + octahedron + " --env " + sky + " -o " + path("o.exr") + " --samples 16,9,8");
  const std::string common =
      plaza + " --env " + sky + " " + path("o.exr") + " --method fiv --samples 1 --size 800x600 ";
  const Json first = run("view --headless " + common + "-o " + path("first.png")).at("camera");
  const V3f forward = vector_of(first.at("forward"));
  const V3f ahead = vector_of(first.at("position_m")) + forward * 3;
  const V3f beside = ahead + forward.cross(V3f(0, 1, 0)).normalized() * 1.2F - V3f(0, 0.3F, 0);
  const auto at = [&](const V3f& p) {
    return "--object " + octahedron + "@" + std::to_string(p.x) + "," + std::to_string(p.y) + "," +
           std::to_string(p.z) + " ";
  };
  // Both hide light from what is around them; without the nearer the picture is that of a run without it.
  const Json result = run_window(common + at(ahead) + at(beside) + "-o shot_%d.exr",
                                 "xdotool key shift+p; arrived shot_1.exr\n"
                                 "xdotool mousemove --window $W 400 300 click 1 key Delete\n"
                                 "xdotool key shift+p; arrived shot_2.exr\n");
  ASSERT_TRUE(result.is_object()) << bytes_of(path("errors"));
  ASSERT_EQ(result.at("objects").size(), 2U);
  EXPECT_LT((vector_of(result.at("objects").at(1).at("offset_m")) - beside).length(), 1e-4F);
  run("view --headless " + common + at(beside) + "-o " + path("one.exr"));
  const Film one = read_image(path("one.exr"));
  // Depth ranges differ, by which an edge may fall to another surface in a pixel here and there.
  EXPECT_LT(compare_images(read_image(path("shot_2.exr")), one).nrmse, 2e-3);
  EXPECT_GT(compare_images(read_image(path("shot_1.exr")), one).nrmse, 0.02);
}

}  // namespace
}  // namespace ivory
