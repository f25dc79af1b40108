// Look-ups in a grid on the GPU against the same on the CPU.
#include <tuple>

#include <gtest/gtest.h>

#include "tests/support/grid_twin.h"
#include "tests/support/inner_edge.h"

namespace ivory {

namespace {

constexpr int points = 4'000;

struct Kind {
  Basis basis;
  GridForm form;
  Reconstruction reconstruction;
};
std::vector<Kind> all_kinds() {
  std::vector<Kind> kinds;
  for (const Basis basis : all_bases) kinds.push_back({basis, GridForm::moments, Reconstruction::optimal});
  kinds.push_back({Basis::vectors, GridForm::moments, Reconstruction::paper});
  kinds.push_back({Basis::vectors, GridForm::norms_and_directions, Reconstruction::optimal});
  kinds.push_back({Basis::vectors, GridForm::norms_and_directions, Reconstruction::paper});
  return kinds;
}

// Positions and normals: anywhere in the grid and a voxel and a half around it; every tenth exactly on a vertex, every
// tenth on a cell's face, every tenth far away; every seventh normal along an axis of the grid or of the world.
struct Inputs {
  std::vector<V4f> p;
  std::vector<V4f> ng;
  std::vector<V4f> n;  // the shading normal, up to a half or so off
};
Inputs random_inputs(const GridFrame& frame, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  Inputs inputs;
  for (int i = 0; i < points; ++i) {
    V3f index;
    for (int axis = 0; axis < 3; ++axis) {
      index[axis] = uniform(random) * float(frame.size[axis] + 2) - 1.5F;
      if (i % 10 == 3 || (i % 10 == 5 && axis == i / 10 % 3))
        index[axis] = std::floor(uniform(random) * float(frame.size[axis]));
      // So far that float's steps matter inside the grid, and so never inside it.
      if (i % 10 == 7) index[axis] = (uniform(random) < 0.5F ? -1.0F : 1.0F) * (1e3F + uniform(random) * 1e6F);
    }
    V3f n = random_direction(random);
    if (i % 7 == 0) {
      n = V3f(0, 0, 0);
      n[i / 7 % 3] = i / 21 % 2 == 0 ? 1.0F : -1.0F;
      if (i / 42 % 2 == 0) n = frame.direction_to_world(n);
    }
    inputs.p.push_back(to_v4(frame.to_world(index)));
    inputs.ng.push_back(to_v4((n + random_direction(random) * 0.5F).normalized()));
    inputs.n.push_back(to_v4(n));
  }
  return inputs;
}

std::string source(const std::string& defines) {
  return defines +
         "#include \"ambient/grid.glsl\"\n"
         "vec4 evaluate(int i) { return vec4(ivory_ambient(input0(i).xyz, input1(i).xyz, input2(i).xyz), 1.0); }\n";
}

class RuntimeGrid : public GlTest, public testing::WithParamInterface<std::tuple<Interpolation, Guard, bool>> {};

std::string case_name(const testing::TestParamInfo<RuntimeGrid::ParamType>& info) {
  return std::string(std::get<0>(info.param) == Interpolation::trilinear ? "trilinear_" : "tricubic_") +
         std::string(name_of(std::get<1>(info.param))) + (std::get<2>(info.param) ? "_rotated" : "");
}
INSTANTIATE_TEST_SUITE_P(Lookups, RuntimeGrid,
                         testing::Combine(testing::Values(Interpolation::trilinear, Interpolation::tricubic),
                                          testing::Values(Guard::off, Guard::planes), testing::Bool()),
                         case_name);

// Compares E at the inputs, read by a shader with those #defines, with the CPU's. The CPU reads values rounded as the
// texture's are, so what differs is float arithmetic:
//   1e-3 of E                        the bound that is asked for;
//   2e-5 of the largest moment       E is a sum of up to 48 products of either sign, each rounded to 6e-8, of weights
//                                    good to 1e-6 (asin's 2e-8 times 4.2 / (4.2 - 2.7) is well within);
//   voxel error / weight kept        the filter finds its texel from a coordinate near the texture's extent, to
//                                    extent 2^-23, and so weights, which then are divided by what is kept of them.
void expect_equal(const IrradianceGrid& grid, const GpuGrid& gpu, const LookupParams& params, const Inputs& inputs,
                  const std::string& defines, double most_loose, const std::string& what) {
  const StoredGrid stored(grid, gpu);
  const std::vector<V4f> result = evaluate_on_gpu(source(defines), {inputs.p, inputs.ng, inputs.n},
                                                  [&](gl::Program& program) { bind(gpu, program, 0, params); });
  const V3i extent = gpu.volumes.size;
  const float voxel_error = float(std::max({extent.x, extent.y, extent.z})) * 0x1p-23F + 1e-6F;
  int undecided = 0;
  int wrong = 0;
  int loose = 0;
  for (std::size_t i = 0; i < inputs.p.size(); ++i) {
    const V3f p = xyz(inputs.p[i]);
    const V3f n = xyz(inputs.n[i]);
    const V3f ng = xyz(inputs.ng[i]);
    const V3f nudged = p + ng * nudge_m(grid.frame, params);
    const LookupMargin at = margin(grid, params.guard, nudged, ng, nudge_m(grid.frame, params), params.interpolation);
    if (at.undecided) {
      ++undecided;
      continue;
    }
    const Footprint footprint = lookup_footprint(grid, p, ng, params);
    if (footprint.count == 0) {  // no vertex sees the point
      EXPECT_EQ(xyz(result[i]), V3f(0, 0, 0)) << what << ": point " << i;
      continue;
    }
    const TwinIrradiance twin = irradiance_of(grid, stored, nudged, footprint, n, params.reconstruction);
    for (unsigned c = 0; c < 3; ++c) {
      const float tolerance =
          1e-3F * twin.e[c] + twin.largest * 2e-5F + twin.around * 3 * voxel_error / std::max(at.kept, 1e-4F);
      loose += tolerance > 1e-3F * (twin.e[c] + twin.largest) ? 1 : 0;
      if (std::abs(result[i][c] - twin.e[c]) <= tolerance) continue;
      if (++wrong <= 3) {
        ADD_FAILURE() << what << ": point " << i << " channel " << c << ": " << result[i][c] << ", CPU " << twin.e[c]
                      << " +- " << tolerance << ", kept " << at.kept;
      }
    }
  }
  EXPECT_EQ(wrong, 0) << what;
  // One point in twenty for each place that a look-up may be decided at: by planes there are two.
  EXPECT_LT(undecided, points / (params.guard == Guard::planes ? 10 : 20)) << what;
  // Else the tolerances would hide what they are for. (Points that rest on little weight are loose: of those that a
  // wide footprint does not see, the eight vertices answer.)
  EXPECT_LT(loose, most_loose * 3 * points) << what;
}

TEST_P(RuntimeGrid, ReadsAsTheCpuDoes) {
  const auto& [interpolation, guard, rotated] = GetParam();
  std::uint32_t seed = 1;
  for (const Kind& kind : all_kinds()) {
    for (const bool uneven : {false, true}) {
      const IrradianceGrid grid = random_grid(V3i(5, 4, 6), kind.basis, rotated, uneven, ++seed);
      const GpuGrid gpu = upload(grid, {kind.form});
      const LookupParams params{guard, interpolation, kind.reconstruction, 0.25F};
      const std::string defines = grid_defines(gpu, params);
      expect_equal(grid, gpu, params, random_inputs(grid.frame, seed), defines, uneven ? 0.9 : 0.36, defines);
    }
  }
}

// One program for all grids, which reads their kind from uniforms.
TEST_P(RuntimeGrid, UniformsChooseAsDefinesDo) {
  const auto& [interpolation, guard, rotated] = GetParam();
  for (const Kind& kind : all_kinds()) {
    const IrradianceGrid grid = random_grid(V3i(3, 4, 2), kind.basis, rotated, false, 77);
    const GpuGrid gpu = upload(grid, {kind.form});
    const LookupParams params{guard, interpolation, kind.reconstruction, 0};
    expect_equal(grid, gpu, params, random_inputs(grid.frame, 78), "", 0.27,
                 grid_defines(gpu, params) + " as uniforms");
  }
}

// Even light in a room, beside whose edge four planes do not tell the vertices outside of it.
TEST_F(GlTest, GridHasNoSeamAlongInnerEdges) {
  for (const float outside_lux : {0.0F, 5.0F}) {
    const IrradianceGrid grid = inner_edge(outside_lux);
    const GpuGrid gpu = upload(grid);
    const LookupParams params;
    std::vector<V4f> p;
    std::vector<V4f> ng;
    for (const SurfacePoint& at : inner_edge_points()) {
      p.push_back(to_v4(at.p));
      ng.push_back(to_v4(at.n));
    }
    const std::vector<V4f> result = evaluate_on_gpu(source(grid_defines(gpu, params)), {p, ng, ng},
                                                    [&](gl::Program& program) { bind(gpu, program, 0, params); });
    for (std::size_t i = 0; i < p.size(); ++i)
      EXPECT_NEAR(result[i].x, 1, 1e-3) << xyz(p[i]) << " " << xyz(ng[i]) << " " << outside_lux;  // half's rounding
  }
}

// As Lookup.WallsNearerThanTheNudgeStayBehind on the CPU.
TEST_F(GlTest, GridKeepsWallsNearerThanTheNudgeBehind) {
  for (const float thickness : {0.02F, 1.5F}) {
    const IrradianceGrid grid = before_a_wall(thickness);
    const GpuGrid gpu = upload(grid);
    for (const Interpolation interpolation : {Interpolation::trilinear, Interpolation::tricubic}) {
      const LookupParams params{.interpolation = interpolation};
      std::vector<V4f> p;
      std::vector<V4f> ng;
      for (float off = 0.053F; off < 0.5F; off += 0.01F) {
        for (const V3f& n : {V3f(1, 0, 0), V3f(0.8F, 0, 0.6F), V3f(-1, 0, 0)}) {
          p.push_back(to_v4(V3f(1.4F - off, 1.3F, 1.6F)));
          ng.push_back(to_v4(n));
          p.push_back(to_v4(V3f(1.4F + 0.02F + off, 1.3F, 1.6F)));
          ng.push_back(to_v4(-n));
        }
      }
      const std::vector<V4f> result = evaluate_on_gpu(source(grid_defines(gpu, params)), {p, ng, ng},
                                                      [&](gl::Program& program) { bind(gpu, program, 0, params); });
      for (std::size_t i = 0; i < p.size(); ++i) {
        if (i % 2 == 1 && thickness > 1) continue;          // in the wall
        EXPECT_NEAR(result[i].x, i % 2 == 0 ? 1 : 0, 1e-3)  // half's rounding
            << xyz(p[i]) << xyz(ng[i]) << " " << thickness << " " << name_of(interpolation);
      }
    }
  }
}

}  // namespace

}  // namespace ivory
