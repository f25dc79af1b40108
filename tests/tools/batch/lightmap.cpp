// Lightmaps in batches.
#include "tests/support/gltf_builder.h"
#include "tests/tools/batch/batch_test.h"

namespace ivory {
namespace {

// Charts that no texture asks for count for lightmaps alone.
TEST_F(BatchTest, LightmapsAreBakedAgainForTheirCharts) {
  const std::vector<V3f> floor{{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}};
  const auto write_floor = [&](float edge) {
    GltfBuilder file;
    file.add_mesh(
        {{"attributes",
          {{"POSITION", file.add(floor)},
           {"TEXCOORD_1", file.add(std::vector<V2f>{{0.1F, 0.1F}, {edge, 0.1F}, {edge, edge}, {0.1F, edge}})}}},
         {"indices", file.add_indices({0, 1, 2, 0, 2, 3})}});
    file.add_node({{"mesh", 0}});
    std::filesystem::copy_file(file.write("floor"), path("floor.gltf"),
                               std::filesystem::copy_options::overwrite_existing);
  };
  write_floor(0.9F);
  write("job.toml", R"(
[default.grid]
env = "sky.hdr"
photons = "2k"
resolution = 4
bounds = [[-1, 0, -1], [1, 1, 1]]
[grid.floor]
scene = "floor.gltf"
[lightmap.floor]
scene = "floor.gltf"
env = "sky.hdr"
grid = "floor"
size = "8x8"
samples = 1
gather = 0
)");
  EXPECT_EQ(states(), (States{{"grid.floor", "baked"}, {"lightmap.floor", "baked"}}));
  EXPECT_TRUE(std::filesystem::exists(path("floor.lightmap.exr")));
  EXPECT_EQ(states(), (States{{"grid.floor", "fresh"}, {"lightmap.floor", "fresh"}}));
  write_floor(0.8F);
  EXPECT_EQ(states(), (States{{"grid.floor", "fresh"}, {"lightmap.floor", "baked"}}));
}

}  // namespace
}  // namespace ivory
