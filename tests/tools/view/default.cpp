// ivory view SCENE alone, what it adds up, and that it draws no light twice.
#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/view_command.h"
#include "tracer/image/file.h"

namespace ivory {
namespace {

using Json = nlohmann::json;

// Root of the mean square difference of blocks of 8 x 8 pixels over the reference's mean, of blocks that see no lamp:
// at a lamp's edge, hundreds of times brighter than all else, the points of a pixel decide.
double block_error(const Film& a, const Film& reference, float brightest_nits) {
  double square = 0;
  double mean = 0;
  int count = 0;
  for (int y0 = 0; y0 + 8 <= a.height; y0 += 8) {
    for (int x0 = 0; x0 + 8 <= a.width; x0 += 8) {
      Rgb sum(0, 0, 0);
      Rgb sum_reference(0, 0, 0);
      bool lamp = false;
      for (int i = 0; i < 64; ++i) {
        const Rgb& p = reference.at(x0 + i % 8, y0 + i / 8);
        sum += a.at(x0 + i % 8, y0 + i / 8) / 64;
        sum_reference += p / 64;
        lamp = lamp || std::max({p.x, p.y, p.z}) > brightest_nits;
      }
      if (lamp) continue;
      for (unsigned c = 0; c < 3; ++c) {
        square += double(sum[int(c)] - sum_reference[int(c)]) * double(sum[int(c)] - sum_reference[int(c)]);
        mean += double(sum_reference[int(c)]);
        ++count;
      }
    }
  }
  return std::sqrt(square / count) / (mean / count);
}

class ViewDefault : public ViewCommand {};

TEST_F(ViewDefault, IsWhatRenderDirectDraws) {
  struct Case {
    std::string scene;
    float brightest_nits;
  };
  for (const Case& c :
       {Case{scene("cornell_box.gltf"), 5}, Case{scene("two_rooms.gltf") + " --camera 1", 20},
        Case{scene("plaza.gltf") + " --env " + scene("sky.hdr") + " --object " + scene("knot.glb"), 1e9F}}) {
    const std::string kept = path("kept.vdb");
    const std::string picture = path("v.exr");
    const Json viewed = view(c.scene + " --threads 2 --save-grid " + kept + " -o " + picture);
    EXPECT_EQ(viewed.at("objects").at(0).at("method"), "grid") << c.scene;
    run("render " + c.scene + " --method direct --guard planes --grid " + kept +
        " --size 160x120 --samples 64 --threads 2 --force -o " + path("r.exr"));
    // What the issue asks for; measured 0.4 to 2 %. Without the light of the lamp or sky it is 60 % and more away.
    EXPECT_LT(block_error(read_image(picture), read_image(path("r.exr")), c.brightest_nits), 0.04) << c.scene;
  }
}

TEST_F(ViewDefault, IsTheSameEachTime) {
  const std::string cornell = scene("plaza.gltf") + " --env " + scene("sky.hdr") + " --samples 2 ";
  view(cornell + "-o " + path("one.exr") + " --threads 1");
  view(cornell + "-o " + path("two.exr") + " --threads 2");
  EXPECT_TRUE(bytes_of(path("one.exr")) == bytes_of(path("two.exr")));
}

double mean_of(const Film& film) {
  double sum = 0;
  for (const Rgb& pixel : film.pixels) sum += double(pixel.x + pixel.y + pixel.z);
  return sum / (3 * double(film.pixels.size()));
}

// What a grid holds of direct light is not drawn once more, whichever kinds it holds.
TEST_F(ViewDefault, LightThatAGridHoldsIsNotDrawnTwice) {
  const std::string room = scene("two_rooms.gltf") + " --camera 1 ";
  const std::string bake = "bake grid " + scene("two_rooms.gltf") + " --voxel-size 0.3 --photons 1m --threads 2 -o ";
  run(bake + path("indirect.vdb"));
  EXPECT_EQ(run(bake + path("area.vdb") + " --direct-of area").at("parameters").at("light"),
            "indirect, direct of area");
  EXPECT_EQ(run(bake + path("none.vdb") + " --direct-of punctual,sky").at("parameters").at("light"),
            "indirect, direct of punctual and sky");
  const double drawn = mean_of(film(room + path("indirect.vdb") + " --samples 8"));
  const double held = mean_of(film(room + path("area.vdb") + " --samples 8"));
  // The lamp is the scene's only light: twice its direct light would be 40 % more. The grid smooths it near the lamp.
  EXPECT_NEAR(held / drawn, 1, 0.05);
  // Neither kind is there, so that the lamp is drawn still.
  EXPECT_NEAR(mean_of(film(room + path("none.vdb") + " --samples 8")) / drawn, 1, 1e-3);
  expect_one_line(
      "render " + scene("two_rooms.gltf") + " --method direct --grid " + path("area.vdb") + " -o " + path("r.exr"), 1,
      "holds direct light");
  expect_one_line("bake grid " + scene("room_boxes.gltf") + " -o " + path("x.vdb") + " --direct-of area", 2,
                  "--direct-of");
  expect_one_line("bake grid " + scene("room_boxes.gltf") + " -o " + path("x.vdb") + " --direct-of lamps", 2,
                  "none of punctual");
}

// Lists of sources, with weights; two assets of one kind.
TEST_F(ViewDefault, SourcesAddUp) {
  const std::string dark = room() + " " + grid() + " --indirect-only --samples 1 --method ";
  const Film one = film(dark + "grid");
  const Film many = film(dark + "grid*0.5+constant*0.25+grid*2 --constant 4,8,12 " + grid());
  const Film even = film(dark + "constant --constant 1,2,3");
  double largest = 0;
  for (std::size_t i = 0; i < one.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const float expected = 2.5F * one.pixels[i][c] + even.pixels[i][c];
      largest = std::max(largest, double(std::abs(many.pixels[i][c] - expected) / std::max(expected, 1e-3F)));
    }
  }
  EXPECT_LT(largest, 1e-3);  // what the issue asks for; files of halves keep 5e-4
  for (const auto& [text, says] : {std::pair{"grid+grid+grid", "3 assets"}, std::pair{"grid*x", "weight"},
                                   std::pair{"grid+", "method"}, std::pair{"grid*-1", "weight"}})
    expect_one_line("view --headless -o " + path("x.png") + " " + dark + text + " " + grid(), 2, says);
}

}  // namespace
}  // namespace ivory
