// Grids from files to textures: baked ones, what they cost, and what cannot be loaded.
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/io/vdb/vdb.h"
#include "tests/support/folder_test.h"
#include "tests/support/grid_twin.h"
#include "tests/support/paths.h"
#include "tests/support/run_ivory.h"

namespace ivory {

namespace {

class RuntimeGridFile : public GlTest {
 protected:
  void SetUp() override { folder_ = fresh_test_folder(); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string bake(const std::string& scene, const std::string& options) const {
    const std::string out = path("grid.vdb");
    const RunResult result = run_ivory("bake grid '" + std::string(source_folder) + "/scenes/" + scene + "' -o '" +
                                       out + "' --photons 200k --quiet --force " + options);
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return out;
  }

  std::filesystem::path folder_;
};

// Points along random paths through the grid, E on the GPU and from the full floats of the file.
//
// Half rounds to 2^-11 of each stored number, at most: E is half a sum of 12 of them (F by n, nine D by coefficients of
// at most one), so it moves by at most 6 * 2^-11 of the largest, and as roundings are independent by far less on the
// whole: their root mean square is 2^-11 / sqrt(3) / sqrt(2) or so of each, below 2^-11 of the largest E altogether.
TEST_F(RuntimeGridFile, BakedGridsLoseHalfRoundingOnlyAsMoments) {
  for (const char* scene : {"room_boxes_rotated.gltf", "cornell_box.gltf"}) {
    const std::string file = bake(scene, "--resolution 16 --guard planes");
    const IrradianceGrid grid = read_grid_vdb(file);
    const GpuGrid moments = load_grid(file);
    const GpuGrid norms = load_grid(file, {GridForm::norms_and_directions});
    ASSERT_TRUE(moments.guarded);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<V4f> p;
    std::vector<V4f> n;
    for (int i = 0; i < 10'000; ++i) {
      const V3f last(grid.frame.size - V3i(1, 1, 1));
      p.push_back(to_v4(grid.frame.to_world(V3f(uniform(random), uniform(random), uniform(random)) * last)));
      n.push_back(to_v4(random_direction(random)));
    }
    for (const Guard guard : {Guard::off, Guard::planes}) {
      const LookupParams params{.guard = guard};
      const auto evaluate = [&](const GpuGrid& gpu) {
        return evaluate_on_gpu(grid_defines(gpu, params) +
                                   "#include \"ambient/grid.glsl\"\n"
                                   "vec4 evaluate(int i) { return vec4(ivory_ambient(input0(i).xyz, input1(i).xyz, "
                                   "input1(i).xyz), 1.0); }",
                               {p, n}, [&](gl::Program& program) { bind(gpu, program, 0, params); });
      };
      const std::vector<V4f> result = evaluate(moments);
      const std::vector<V4f> norms_result = evaluate(norms);
      double squares = 0;
      double difference_squares = 0;
      double norms_squares = 0;
      int undecided = 0;
      for (std::size_t i = 0; i < p.size(); ++i) {
        const V3f nudged = xyz(p[i]) + xyz(n[i]) * nudge_m(grid.frame, params);
        if (margin(grid, guard, nudged, xyz(n[i]), nudge_m(grid.frame, params), Interpolation::trilinear).undecided) {
          ++undecided;
          continue;
        }
        const Footprint footprint = lookup_footprint(grid, xyz(p[i]), xyz(n[i]), params);
        float largest = 0;
        for (int e = 0; e < footprint.count; ++e) {
          for (int k = 0; k < 36; ++k)
            largest = std::max(largest, std::abs(grid.at(footprint.vertex[std::size_t(e)])[k]));
        }
        const Rgb e = irradiance(grid, footprint, xyz(n[i]), Reconstruction::optimal);
        for (unsigned c = 0; c < 3; ++c) {
          const double off = double(result[i][c]) - double(e[c]);
          ASSERT_LE(std::abs(off), 6 * 0x1p-11 * double(largest) + 1e-6) << scene << " point " << i;
          squares += double(e[c]) * double(e[c]);
          difference_squares += off * off;
          norms_squares += std::pow(double(norms_result[i][c]) - double(e[c]), 2);
        }
      }
      EXPECT_LT(undecided, 1000);
      const double added = std::sqrt(difference_squares / squares);
      const double added_by_norms = std::sqrt(norms_squares / squares);
      EXPECT_LT(added, 0x1p-11) << scene;
      // Why moments are the default. A tenth is what channels of different directions cost in a room with coloured
      // walls.
      EXPECT_GT(added_by_norms, 2 * added) << scene;
      EXPECT_LT(added_by_norms, 0.1) << scene;
      std::printf("%s, guard %s: relative RMSE %.1e of moments, %.1e of norms and directions\n", scene,
                  std::string(name_of(guard)).c_str(), added, added_by_norms);
    }
  }
}

TEST_F(RuntimeGridFile, TakesTheMemoryItStates) {
  const IrradianceGrid grid = random_grid(V3i(16, 16, 16), Basis::vectors, false, false, 1);
  for (const GridForm form : {GridForm::moments, GridForm::norms_and_directions}) {
    const GpuGrid gpu = upload(grid, {form});
    EXPECT_EQ(gpu.volume_bytes(), 288U * 1024);  // RR-6983: 16 x 16 x 16 vertices of twelve RGB16F
    EXPECT_EQ(gpu.bytes(), (288U + 64 + 8) * 1024);
  }
  EXPECT_EQ(upload(random_grid(V3i(16, 16, 16), Basis::sh9, false, false, 1)).volume_bytes(), 216U * 1024);
}

// What vertices store, as debug views read it.
TEST_F(RuntimeGridFile, VerticesAreReadBack) {
  for (const GridForm form : {GridForm::moments, GridForm::norms_and_directions}) {
    const IrradianceGrid grid = random_grid(V3i(3, 4, 5), Basis::vectors, true, true, 4);
    const GpuGrid gpu = upload(grid, {form});
    const StoredGrid stored(grid, gpu);
    std::vector<V4f> which;
    for (int v = 0; v < 60; ++v) {
      for (int f = 0; f < 12; ++f) which.emplace_back(float(v % 3), float(v / 3 % 4), float(v / 12), float(f));
    }
    const std::vector<V4f> result = evaluate_on_gpu(
        "#include \"ambient/grid.glsl\"\n"
        "vec4 evaluate(int i) { vec3 m[12]; ivec4 which = ivec4(input0(i));\n"
        "  ivory_vertex_moments(ivory_grid, ivory_grid_volumes, ivory_grid_trust, which.xyz, vec3(0.6, 0.0, 0.8), m);\n"
        "  vec3 p = ivory_grid_vertex_position(ivory_grid, which.xyz);\n"
        "  return vec4(m[which.w], p.x + 2.0 * p.y + 3.0 * p.z); }",
        {which}, [&](gl::Program& program) { bind(gpu, program, 0); });
    for (std::size_t i = 0; i < which.size(); ++i) {
      const std::size_t v = i / 12;
      const V3f n(0.6F, 0, 0.8F);
      std::array<float, 36> m{};
      std::copy_n(stored.values.begin() + std::ptrdiff_t(v * 36), 36, m.begin());
      if (form == GridForm::norms_and_directions) m = moments_from_compact(m, grid.frame.direction_to_local(n));
      float largest = 0;
      for (const float value : m) largest = std::max(largest, std::abs(value));
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(result[i][int(c)], m[3 * (i % 12) + c], 1e-5F * largest) << i;  // a few float operations
      const V3f at = grid.frame.to_world(V3f(which[i].x, which[i].y, which[i].z));
      EXPECT_NEAR(result[i].w, at.x + 2 * at.y + 3 * at.z, 1e-4F);  // numbers of order 10
    }
  }
}

TEST(GridArrangement, FitsWheneverAnyOneDoes) {
  EXPECT_EQ(arrange_volumes({64, 64, 64}, 12, 2048), V3i(1, 1, 12));
  EXPECT_EQ(arrange_volumes({10, 300, 200}, 12, 2048), V3i(12, 1, 1));
  EXPECT_EQ(arrange_volumes({200, 200, 200}, 12, 1000), V3i(2, 2, 3));
  EXPECT_EQ(arrange_volumes({200, 200, 200}, 9, 600), V3i(1, 3, 3));
  EXPECT_EQ(arrange_volumes({2, 2, 2049}, 4, 2048), V3i(0, 0, 0));
  EXPECT_EQ(arrange_volumes({200, 200, 200}, 12, 599), V3i(0, 0, 0));
  // Every volume has a place of its own within the texture.
  const V3i tiles(2, 2, 3);
  std::set<std::array<int, 3>> places;
  for (int f = 0; f < 12; ++f) {
    const V3i at = volume_place({5, 6, 7}, tiles, f);
    EXPECT_TRUE(at.x % 5 == 0 && at.x < 10 && at.y % 6 == 0 && at.y < 12 && at.z % 7 == 0 && at.z < 21) << at;
    places.insert({at.x, at.y, at.z});
  }
  EXPECT_EQ(places.size(), 12U);
}

// A grid too long for its volumes to lie side by side along z has them along another axis, and reads the same.
TEST_F(RuntimeGridFile, LongGridsFitByArrangement) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limit);
  const IrradianceGrid grid = random_grid(V3i(2, 3, limit / 2), Basis::sh4, false, false, 9);
  const GpuGrid gpu = upload(grid);
  for (int axis = 0; axis < 3; ++axis) EXPECT_LE(gpu.volumes.size[axis], limit);
  EXPECT_GT(std::max(gpu.tiles.x, gpu.tiles.y), 1);
  EXPECT_EQ(gpu.volume_bytes(), grid.frame.vertex_count() * 4 * 6);
  const StoredGrid stored(grid, gpu);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<V4f> p;
  for (int i = 0; i < 1000; ++i) {
    const V3f last(grid.frame.size - V3i(1, 1, 1));
    p.push_back(to_v4(grid.frame.to_world(V3f(uniform(random), uniform(random), uniform(random)) * last)));
  }
  const LookupParams params{.guard = Guard::off, .nudge_voxels = 0};
  const std::vector<V4f> result = evaluate_on_gpu(
      "#include \"ambient/grid.glsl\"\n"
      "vec4 evaluate(int i) { return vec4(ivory_ambient(input0(i).xyz, vec3(0.0), vec3(0.6, 0.0, 0.8)), 1.0); }",
      {p}, [&](gl::Program& program) { bind(gpu, program, 0, params); });
  int compared = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const LookupMargin at = margin(grid, Guard::off, xyz(p[i]), V3f(0, 0, 0), 0, Interpolation::trilinear);
    if (at.kept < 0.2F) continue;
    ++compared;
    const V3f n(0.6F, 0, 0.8F);
    const Footprint footprint = lookup_footprint(grid, xyz(p[i]), n, params);
    const TwinIrradiance twin = irradiance_of(grid, stored, xyz(p[i]), footprint, n, Reconstruction::optimal);
    // Positions of order 1000 m and a coordinate of order `limit` texels place the filter to 2^-12 texel or so.
    ASSERT_NEAR(result[i].x, twin.e.x, 1e-3F * twin.e.x + twin.around * 3 * 0x1p-11F / at.kept) << i;
  }
  EXPECT_GT(compared, 500);
}

// One line that names file, cause and remedy, and no object left behind.
TEST_F(RuntimeGridFile, WhatCannotBeLoadedIsSaid) {
  const std::string good = bake("cornell_box.gltf", "--resolution 8");
  const int before = live_gl_objects();
  std::ifstream in(good, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const auto write = [&](const std::string& name, const std::string& content) {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  };
  const auto expect_refused = [&](const std::string& file, const std::string& cause) {
    const std::string message = error_of([&] { load_grid(file); });
    EXPECT_EQ(message.find(file + ": "), 0U) << message;
    EXPECT_NE(message.find(cause), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_EQ(live_gl_objects(), before) << message;
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR)) << message;
  };
  expect_refused(path("absent.vdb"), "does not exist");
  expect_refused(write("empty.vdb", ""), "is not an OpenVDB file");
  expect_refused(write("foreign.vdb", "solid teapot\nfacet normal 0 0 1\n" + std::string(200, 'x')),
                 "is not an OpenVDB file");
  for (const std::size_t part : {2U, 3U, 10U})
    expect_refused(write("cut.vdb", bytes.substr(0, bytes.size() - bytes.size() / part)), "is damaged or cut short");
  std::string broken = bytes;
  broken[bytes.size() / 2] = char(broken[bytes.size() / 2] ^ 0x10);
  expect_refused(write("broken.vdb", broken), "is damaged");
  ASSERT_EQ(run_ivory("bake grid '" + std::string(source_folder) + "/scenes/cornell_box.gltf' -o '" + path("part.vdb") +
                      "' --resolution 8 --photons 20k --photon-range 0:10k --quiet")
                .exit_code,
            0);
  expect_refused(path("part.vdb"), "partial bake");

  GLint limit = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limit);
  write_vdb(path("oversized.vdb"), random_grid(V3i(2, 2, limit + 1), Basis::sh4, false, false, 1), true);
  expect_refused(path("oversized.vdb"), "do not fit into a 3D texture of");

  EXPECT_THROW(upload(random_grid(V3i(2, 2, 2), Basis::sh9, false, false, 1), {GridForm::norms_and_directions}),
               ParameterError);
  {
    const GpuGrid gpu = load_grid(good);
    EXPECT_EQ(live_gl_objects(), before + 3);
  }
  EXPECT_EQ(live_gl_objects(), before);
}

}  // namespace

}  // namespace ivory
