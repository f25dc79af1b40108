// Probes that know nothing: what they are given lights the side that it belongs to, and no other.
#include "grid/export/fill.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/env/sh9.h"
#include "grid/export/reader.h"
#include "grid/export/sphere_rule.h"
#include "grid/field/guard.h"

namespace ivory {
namespace {

constexpr double pi_d = 3.14159265358979323846;

SixSides all_sides(float e) {
  SixSides sides;
  sides.fill(Rgb(e, e, e));
  return sides;
}

// 3 x 5 x 3 probes 1 m apart in two rooms, one over the other: `above` lux in the upper two layers, `below` in the
// lower two, and nothing known in the layer between.
ProbeVolume two_rooms(float above, float below) {
  ProbeVolume volume;
  volume.frame.size = V3i(3, 5, 3);
  for (std::size_t i = 0; i < volume.frame.vertex_count(); ++i) {
    const int y = volume.frame.vertex_coordinates(i).y;
    const float e = y == 2 ? 0 : (y > 2 ? above : below);
    volume.sides.push_back(all_sides(e));
    volume.states.push_back(e > 0 ? ProbeState::measured : ProbeState::dark);
    volume.trust.push_back(e > 0 ? 1.0F : 0.0F);
  }
  return volume;
}

TEST(Fill, ASlabHasALitAndADarkSide) {
  ProbeVolume volume = two_rooms(1000, 2);
  fill_unknown(volume, {});
  const std::size_t slab = volume.frame.vertex_index(1, 2, 1);
  EXPECT_EQ(volume.states[slab], ProbeState::filled);
  EXPECT_FLOAT_EQ(volume.sides[slab][2].x, 1000);  // +y: the upper room
  EXPECT_FLOAT_EQ(volume.sides[slab][3].x, 2);     // -y: the lower one, and nothing of 1000
  // Sides that both rooms lie in front of have the darker one's light: weights of 1 / E^2 give 2 (1 + 2 / 1000).
  for (const std::size_t side : {0, 1, 4, 5}) EXPECT_NEAR(volume.sides[slab][side].x, 2, 0.01);
  // At a surface of the slab's underside, and of its upper one, readers see their own room.
  const ProbeReader reader = sides_reader(volume);
  EXPECT_NEAR(reader(V3f(1, 1.5F, 1), V3f(0, -1, 0)).x, 2, 1e-4);
  EXPECT_NEAR(reader(V3f(1, 2.5F, 1), V3f(0, 1, 0)).x, 1000, 1e-2);
}

// Rooms of like brightness leave no seam.
TEST(Fill, LikeRoomsMeet) {
  ProbeVolume volume = two_rooms(10, 9);
  fill_unknown(volume, {});
  const std::size_t slab = volume.frame.vertex_index(1, 2, 1);
  for (const Rgb& e : volume.sides[slab]) {
    EXPECT_GE(e.x, 9 * 0.9999F);
    EXPECT_LE(e.x, 10 * 1.0001F);
  }
}

// Where the room below is unlit, nothing goes through the slab: probes that have no lit neighbour stay dark, and those
// that have one are lit from where it is alone.
TEST(Fill, StaysOnTheLitSide) {
  ProbeVolume volume = two_rooms(1000, 0);
  fill_unknown(volume, {});
  const std::size_t slab = volume.frame.vertex_index(1, 2, 1);
  EXPECT_FLOAT_EQ(volume.sides[slab][2].x, 1000);
  const std::size_t cellar = volume.frame.vertex_index(1, 1, 1);
  EXPECT_EQ(volume.states[cellar], ProbeState::dark);
  EXPECT_EQ(volume.sides[cellar], all_sides(0));
  const ProbeReader reader = sides_reader(volume);
  EXPECT_EQ(reader(V3f(1, 1.5F, 1), V3f(0, 1, 0)).x, 500);  // an object under the ceiling that looks up at it: a leak
  // In the outermost layer of the volume a probe in a wall has light from both sides: nothing is behind it.
  ProbeVolume open = two_rooms(1000, 0);
  for (const int y : {0, 1}) open.states[open.frame.vertex_index(0, y, 0)] = ProbeState::dark;
  fill_unknown(open, {});
  EXPECT_FLOAT_EQ(open.sides[open.frame.vertex_index(0, 2, 1)][0].x, 1000);  // +x, into the room
  EXPECT_FLOAT_EQ(open.sides[open.frame.vertex_index(0, 2, 1)][1].x, 1000);  // -x, out of the volume
}

// Planes part rooms that are next to each other: a probe beside both has the darker one's light where it cannot tell.
TEST(Fill, PlanesPartRooms) {
  ProbeVolume volume = two_rooms(1000, 1000);
  std::vector<GuardRecord> guard(volume.sides.size());
  // The right half is another room of 10 lux, behind a thin wall at x = 1.5; the probe asked for lies in the slab.
  for (std::size_t i = 0; i < volume.sides.size(); ++i) {
    const V3i at = volume.frame.vertex_coordinates(i);
    if (at.y == 2) continue;
    if (at.x == 2) volume.sides[i] = all_sides(10);
    if (at.x == 1) guard[i].words[0] = pack({V3f(1, 0, 0), 0.5F});
    if (at.x == 2) guard[i].words[0] = pack({V3f(-1, 0, 0), 0.5F});
  }
  const std::size_t slab = volume.frame.vertex_index(1, 2, 1);
  ProbeVolume known = volume;
  fill_unknown(known, guard);
  EXPECT_LT(known.sides[slab][2].x, 12);
  fill_unknown(volume, {});  // without planes all of it is one room
  EXPECT_GT(volume.sides[slab][2].x, 500);
}

TEST(Fill, LittleTrustedProbesLeanOnWhatTheySee) {
  ProbeVolume volume = two_rooms(100, 100);
  for (ProbeState& state : volume.states) state = ProbeState::measured;
  for (std::size_t i = 0; i < volume.sides.size(); ++i) {
    volume.sides[i] = all_sides(100);
    volume.trust[i] = 1;
  }
  const std::size_t probe = volume.frame.vertex_index(1, 2, 1);
  volume.sides[probe] = all_sides(20);
  volume.trust[probe] = 0.25F;
  fill_unknown(volume, {});
  EXPECT_NEAR(volume.sides[probe][0].x, 0.25 * 20 + 0.75 * 100, 1e-3);
  EXPECT_EQ(volume.states[probe], ProbeState::measured);
}

TEST(Fill, CoefficientsGiveTheSixSides) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(1, 2);
  SixSides sides;
  for (Rgb& e : sides) e = Rgb(uniform(random), uniform(random), uniform(random));
  const ProbeSh9 sh = sh9_of_sides(sides);
  for (std::size_t i = 0; i < 6; ++i)
    for (unsigned c = 0; c < 3; ++c) EXPECT_NEAR(irradiance(sh, side_normal(i))[c], sides[i][c], 1e-5);
}

// A grid's own basis of nine comes through as it is, turned or not, and a volume that is read where its probes stand is
// the grid.
TEST(ProbeVolumes, HoldTheGrid) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  for (const bool rotated : {false, true}) {
    for (const Basis basis : {Basis::sh9, Basis::vectors}) {
      IrradianceGrid grid;
      grid.basis = basis;
      grid.frame.size = V3i(3, 4, 2);
      grid.frame.origin_m = V3f(1, 2, 3);
      grid.frame.spacing_m = V3f(0.5F, 0.25F, 1);
      grid.anchor_m = V3d(1000, 0, 0);
      if (rotated) grid.frame.local_to_world = M33f(0.8F, 0, -0.6F, 0, 1, 0, 0.6F, 0, 0.8F);
      for (std::size_t v = 0; v < grid.frame.vertex_count(); ++v) {
        std::array<float, 36> moments{};
        for (int light = 0; light < 30; ++light) {  // spread wide, so that no basis falls below zero
          const V3f w = V3f(normal(random), normal(random), normal(random)).normalized();
          const auto f = eval(basis, w);
          for (std::size_t k = 0; k < std::size_t(function_count(basis)); ++k)
            for (std::size_t c = 0; c < 3; ++c) moments[3 * k + c] += f[k] * float(c + 1);
        }
        grid.moments.insert(grid.moments.end(), moments.begin(), moments.begin() + grid.stride());
        grid.visible_fraction.push_back(1);
        grid.variance.emplace_back(0.0F, 0.0F, 0.0F);
      }
      const ProbeVolume volume = make_probe_volume(grid, {.can_rotate = true, .with_sh = true, .voxel_size_m = {}});
      EXPECT_FALSE(volume.resampled);
      EXPECT_EQ(volume.count(ProbeState::measured), grid.frame.vertex_count());
      const ProbeReader reader = sh9_reader(volume, 0);
      const ReaderLoss loss = measure_reader(grid, volume, reader, 0, 200, 5);
      EXPECT_EQ(loss.points_in_the_open, 200);
      EXPECT_EQ(loss.points_on_surfaces, 0);  // nothing is known of walls
      // Floats through a sum of 288 directions; six vectors hold what nine coefficients do not.
      if (basis == Basis::sh9) {
        EXPECT_LT(loss.in_the_open, 1e-5);
      } else {
        EXPECT_LT(loss.in_the_open, 0.03);
        EXPECT_GT(loss.in_the_open, 1e-4);
      }
      const V3d center = volume.center_m();
      const V3f middle = grid.frame.to_world(V3f(1, 1.5F, 0.5F));
      EXPECT_LT((center - (V3d(middle) + grid.anchor_m)).length(), 1e-4);
      for (std::size_t v = 0; v < grid.frame.vertex_count(); ++v) {
        for (std::size_t side = 0; side < 6; ++side) {
          Footprint one;
          one.count = 1;
          one.vertex[0] = std::uint32_t(v);
          one.weight[0] = 1;
          EXPECT_EQ(volume.sides[v][side], irradiance(grid, one, side_normal(side), Reconstruction::optimal));
        }
      }
      // Resampled along the world's axes: a field that is the same everywhere stays so.
      IrradianceGrid even = grid;
      for (std::size_t v = 1; v < even.frame.vertex_count(); ++v)
        std::copy_n(even.moments.begin(), even.stride(), even.moments.begin() + std::ptrdiff_t(v) * even.stride());
      const ProbeVolume world = make_probe_volume(even, {.can_rotate = false, .with_sh = true, .voxel_size_m = 0.3F});
      EXPECT_TRUE(world.resampled);
      EXPECT_EQ(world.frame.local_to_world, M33f());
      const V3f n = V3f(0.36F, 0.48F, 0.8F);
      Footprint one;
      one.count = 1;
      one.vertex[0] = 0;
      one.weight[0] = 1;
      const Rgb truth = irradiance(even, one, n, Reconstruction::optimal);
      const Rgb read = sh9_reader(world, 0)(middle, n);
      for (unsigned c = 0; c < 3; ++c) EXPECT_NEAR(read[c] / truth[c], 1, basis == Basis::sh9 ? 1e-5 : 0.05);
      // The box around all cells.
      for (int corner = 0; corner < 8; ++corner) {
        const V3f index((corner & 1) != 0 ? 2.5F : -0.5F, (corner & 2) != 0 ? 3.5F : -0.5F,
                        (corner & 4) != 0 ? 1.5F : -0.5F);
        EXPECT_TRUE(world.frame.covers(grid.frame.to_world(index)));
      }
      EXPECT_THROW(make_probe_volume(even, {.can_rotate = false, .with_sh = false, .voxel_size_m = 0.001F}),
                   ParameterError);
    }
  }
}

TEST(ProbeVolumes, SphereRuleIsExact) {
  double sum = 0;
  double z4 = 0;
  double xy2 = 0;
  for (const SphereNode& node : sphere_rule()) {
    const V3d& w = node.direction;
    sum += node.weight;
    z4 += node.weight * w.z * w.z * w.z * w.z;
    xy2 += node.weight * w.x * w.x * w.y * w.y;
  }
  EXPECT_NEAR(sum, 4 * pi_d, 1e-12);
  EXPECT_NEAR(z4, 4 * pi_d / 5, 1e-12);
  EXPECT_NEAR(xy2, 4 * pi_d / 15, 1e-12);
}

}  // namespace
}  // namespace ivory
