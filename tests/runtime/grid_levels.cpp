// Look-ups in a grid of several spacings on the GPU against the same on the CPU.
#include <tuple>

#include <gtest/gtest.h>

#include "tests/support/grid_twin.h"
#include "tests/support/random_lattice.h"

namespace ivory {

namespace {

constexpr int points = 6'000;

struct Inputs {
  std::vector<V4f> p;
  std::vector<V4f> ng;
  std::vector<V4f> n;
};

// Anywhere in the grid and a voxel around it; every tenth point on a vertex of some level, every tenth far away; every
// seventh normal along an axis, every eleventh point in space.
Inputs random_inputs(const Lattice& lattice, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  Inputs inputs;
  for (int i = 0; i < points; ++i) {
    const GridFrame& frame = lattice.frame_of(i % lattice.levels());
    V3f index;
    for (int axis = 0; axis < 3; ++axis) {
      index[axis] = uniform(random) * float(frame.size[axis] + 2) - 1.5F;
      if (i % 10 == 3) index[axis] = std::floor(uniform(random) * float(frame.size[axis]));
      if (i % 10 == 7) index[axis] = (uniform(random) < 0.5F ? -1.0F : 1.0F) * (1e3F + uniform(random) * 1e4F);
    }
    V3f n = random_direction(random);
    if (i % 7 == 0) {
      n = V3f(0, 0, 0);
      n[i / 7 % 3] = i / 21 % 2 == 0 ? 1.0F : -1.0F;
      if (i / 42 % 2 == 0) n = frame.direction_to_world(n);
    }
    inputs.p.push_back(to_v4(frame.to_world(index)));
    inputs.ng.push_back(to_v4(i % 11 == 0 ? V3f(0, 0, 0) : (n + random_direction(random) * 0.5F).normalized()));
    inputs.n.push_back(to_v4(n));
  }
  return inputs;
}

class RuntimeGridLevels : public GlTest, public testing::WithParamInterface<std::tuple<Interpolation, Guard>> {};

INSTANTIATE_TEST_SUITE_P(Lookups, RuntimeGridLevels,
                         testing::Combine(testing::Values(Interpolation::trilinear, Interpolation::tricubic),
                                          testing::Values(Guard::off, Guard::planes)),
                         [](const auto& test) {
                           return std::string(name_of(std::get<0>(test.param))) + "_" +
                                  std::string(name_of(std::get<1>(test.param)));
                         });

// Tolerances as in tests/runtime/grid.cpp.
void expect_equal(const IrradianceGrid& grid, const GpuGrid& gpu, const LookupParams& params, const Inputs& inputs,
                  const std::string& defines, const std::string& what) {
  const StoredGrid stored(grid, gpu);
  const std::vector<V4f> result = evaluate_on_gpu(
      defines +
          "#include \"ambient/grid.glsl\"\n"
          "vec4 evaluate(int i) { return vec4(ivory_ambient(input0(i).xyz, input1(i).xyz, input2(i).xyz), 1.0); }\n",
      {inputs.p, inputs.ng, inputs.n}, [&](gl::Program& program) { bind(gpu, program, 0, params); });
  const V3i extent = gpu.volumes.size;
  const float voxel_error = float(std::max({extent.x, extent.y, extent.z})) * 0x1p-23F + 2e-6F;
  int undecided = 0;
  int wrong = 0;
  int compared = 0;
  std::array<int, 3> mixed{};  // points by the number of levels read
  for (std::size_t i = 0; i < inputs.p.size(); ++i) {
    const V3f p = xyz(inputs.p[i]);
    const V3f n = xyz(inputs.n[i]);
    const V3f ng = xyz(inputs.ng[i]);
    const float off_m = nudge_m(grid.frame, params);
    const LookupMargin at = margin(grid, params.guard, p + ng * off_m, ng, off_m, params.interpolation);
    const Footprint footprint = lookup_footprint(grid, p, ng, params);
    if (at.undecided || (params.guard == Guard::off && footprint.count > 0 && at.kept < 1e-3F)) {
      ++undecided;
      continue;
    }
    const LevelShares shares = level_shares(grid, {.p = p, .ng = ng, .nudge_voxels = params.nudge_voxels});
    ++mixed[shares.share[1] > 0 ? 2 : 1];
    ++compared;
    if (footprint.count == 0) {
      EXPECT_EQ(xyz(result[i]), V3f(0, 0, 0)) << what << ": point " << i;
      continue;
    }
    const TwinIrradiance twin = irradiance_of(grid, stored, p + ng * off_m, footprint, n, params.reconstruction);
    for (unsigned c = 0; c < 3; ++c) {
      const float tolerance =
          1e-3F * twin.e[c] + twin.largest * 2e-5F + twin.around * 3 * voxel_error / std::max(at.kept, 1e-4F);
      if (std::abs(result[i][c] - twin.e[c]) <= tolerance) continue;
      if (++wrong <= 3) {
        ADD_FAILURE() << what << ": point " << i << " channel " << c << ": " << result[i][c] << ", CPU " << twin.e[c]
                      << " +- " << tolerance << ", kept " << at.kept << ", levels " << shares.level[0] << " "
                      << shares.share[0] << " " << shares.level[1];
      }
    }
  }
  EXPECT_EQ(wrong, 0) << what;
  EXPECT_LT(undecided, points / 10) << what;
  EXPECT_GT(mixed[1], points / 10) << what;
  EXPECT_GT(mixed[2], points / 10) << what;
}

TEST_P(RuntimeGridLevels, ReadAsTheCpuDoes) {
  const auto& [interpolation, guard] = GetParam();
  std::uint32_t seed = 1;
  struct Kind {
    Basis basis;
    GridForm form;
    bool by_uniforms;
  };
  for (const Kind kind : {Kind{Basis::vectors, GridForm::moments, false}, Kind{Basis::sh4, GridForm::moments, true},
                          Kind{Basis::vectors, GridForm::norms_and_directions, false}}) {
    // Odd numbers of coarsest vertices do not fill their blocks; sizes differ along the axes.
    ++seed;
    const Lattice lattice =
        random_lattice(V3i(6, 4, 10), 2 + int(seed % 3), seed % 3 == 0 ? 0.2 : 0.03, seed, seed % 2 == 0);
    std::mt19937 random(seed);
    const IrradianceGrid grid = random_grid_on(lattice, kind.basis, false, random);
    const GpuGrid gpu = upload(grid, {kind.form});
    const LookupParams params{.guard = guard, .interpolation = interpolation, .nudge_voxels = 0.25F};
    const std::string defines = kind.by_uniforms ? "" : grid_defines(gpu, params);
    expect_equal(grid, gpu, params, random_inputs(lattice, seed), defines,
                 std::string(name_of(kind.basis)) + " on " + std::to_string(lattice.levels()) + " levels");
  }
}

TEST_F(GlTest, GridLevelsTakeTheMemoryTheyState) {
  const Lattice lattice = random_lattice(V3i(8, 8, 8), 4, 0.1, 9);
  std::mt19937 random(1);
  const IrradianceGrid grid = random_grid_on(lattice, Basis::vectors, false, random);
  const GpuGrid gpu = upload(grid);
  // Of the atlas' last slice a part may be empty, and the tables end in a slice of their own.
  const double vertices = double(lattice.vertex_count());
  EXPECT_GT(double(gpu.volume_bytes()), 72 * vertices);
  EXPECT_LT(double(gpu.volume_bytes()), 1.1 * 72 * vertices);
  EXPECT_LT(double(gpu.bytes()), 1.1 * 90 * vertices + 1.1 * table_bytes(lattice.frame, lattice.levels()) + 1e5);
}

}  // namespace

}  // namespace ivory
