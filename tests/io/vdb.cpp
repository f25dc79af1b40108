// The .vdb file: what is written is what is read, to the bit where the format allows; equal content
// gives equal bytes; and no damaged file gets further than one line.
#include "grid/io/vdb/vdb.h"

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "tests/support/io_random.h"
#include "tests/support/paths.h"

namespace ivory {
namespace {

using namespace ivory::test;
namespace fs = std::filesystem;

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

void expect_same_frame(const GridFrame& a, const GridFrame& b) {
  EXPECT_EQ(a.size, b.size);
  EXPECT_EQ(a.origin_m, b.origin_m);
  EXPECT_EQ(a.spacing_m, b.spacing_m);
  EXPECT_EQ(a.local_to_world, b.local_to_world);
}

class VdbGrid : public testing::TestWithParam<Basis> {};

TEST_P(VdbGrid, ReadsBackWhatWasWritten) {
  const std::string path = scratch_folder("vdb_grid_" + std::string(name_of(GetParam()))) / "grid.vdb";
  for (const bool guarded : {true, false}) {
    const IrradianceGrid out = random_grid(7, GetParam(), guarded);
    write_vdb(path, out, true);
    const IrradianceGrid in = read_grid_vdb(path);
    expect_same_frame(in.frame, out.frame);
    EXPECT_EQ(in.basis, out.basis);
    EXPECT_EQ(in.light, out.light);
    EXPECT_EQ(in.visible_fraction, out.visible_fraction);
    EXPECT_EQ(in.guard, out.guard);
    EXPECT_EQ(in.metadata, out.metadata);
    ASSERT_EQ(in.moments.size(), out.moments.size());
    // Moments to half a step of at most a quarter of the standard error, and where that is fine some are rounded to
    // halves besides, by 2^-12 of what is stored: for vectors (F + D) / 2 and (F - D) / 2, whose sums have up to twice
    // the error of the largest of F and D_x, D_y, D_z.
    const auto stride = std::size_t(out.stride());
    for (std::size_t vertex = 0; vertex < out.visible_fraction.size(); ++vertex) {
      const float* a = in.at(vertex);
      const float* b = out.at(vertex);
      for (unsigned c = 0; c < 3; ++c) {
        const float variance = out.variance[vertex][c];
        ASSERT_NEAR(in.variance[vertex][c], variance, 0x1p-7F * variance);
        float largest = 0;
        for (std::size_t i = c; i < stride; i += 3) largest = std::max(largest, std::abs(b[i]));
        for (std::size_t i = c; i < stride; i += 3)
          ASSERT_NEAR(a[i], b[i], std::sqrt(variance) / 8 + 2 * 0x1p-12F * largest);
      }
    }
  }
}

// The bound that rounding.h states: errors of rounding against the variance of E that the grid states, over random
// vertices and normals. 4,000 of them tell the ratio to 3 %.
TEST_P(VdbGrid, RoundingIsLostInTheNoise) {
  const std::string path = scratch_folder("vdb_rounding_" + std::string(name_of(GetParam()))) / "grid.vdb";
  IrradianceGrid out = random_grid(9, GetParam());
  std::mt19937 rng(2);
  std::normal_distribution<float> normal(0, 1);
  // Light of 100 lux and more, known to 5 lux: no reconstruction is clamped at 0.
  for (std::size_t vertex = 0; vertex < out.variance.size(); ++vertex) {
    if (out.visible_fraction[vertex] == 0) continue;
    std::array<float, max_functions> light{};
    for (const V3f& w : {V3f(1, 0, 0), V3f(0, 1, 0), V3f(0, 0, 1), V3f(-1, 0, 0), V3f(0, -1, 0), V3f(0, 0, -1)}) {
      const auto f = eval(GetParam(), w);
      const float power = 150 + 10 * normal(rng);
      for (std::size_t i = 0; i < light.size(); ++i) light[i] += power * f[i];
    }
    for (std::size_t i = 0; i < std::size_t(out.stride()); ++i)
      out.moments[vertex * std::size_t(out.stride()) + i] = light[i / 3] * (1 + 0.01F * normal(rng));
    out.variance[vertex] = Rgb(25, 25, 25);
  }
  write_vdb(path, out, false);
  const IrradianceGrid in = read_grid_vdb(path);
  EXPECT_TRUE(in.moments != out.moments);
  double squares = 0;
  int count = 0;
  for (int i = 0; i < 6000; ++i) {
    const auto vertex = std::size_t(rng()) % out.variance.size();
    if (out.visible_fraction[vertex] == 0) continue;
    const V3f n = V3f(normal(rng), normal(rng), normal(rng)).normalized();
    const Rgb off = irradiance(GetParam(), Reconstruction::optimal, in.at(vertex), n) -
                    irradiance(GetParam(), Reconstruction::optimal, out.at(vertex), n);
    squares += double(off.dot(off)) / 3;
    ++count;
  }
  EXPECT_LT(squares / count, 0.01 * 25);
  EXPECT_GT(squares / count, 0);
}

// Nothing is rounded where no error is stated, and halves hold nothing but what they bear.
TEST_P(VdbGrid, KeepsWhatHasNoNoise) {
  const std::string path = scratch_folder("vdb_exact_" + std::string(name_of(GetParam()))) / "grid.vdb";
  IrradianceGrid out = random_grid(7, GetParam());
  for (Rgb& variance : out.variance) variance = Rgb(0, 0, 0);
  for (const float scale : {1.0F, 1e-7F, 1e7F}) {
    for (float& x : out.moments) x *= scale;
    write_vdb(path, out, true);
    const IrradianceGrid in = read_grid_vdb(path);
    if (GetParam() != Basis::vectors) {
      EXPECT_EQ(in.moments, out.moments);
      continue;
    }
    // (F + D) / 2 and (F - D) / 2 are each rounded once, and reading adds up to six of them: a few half units in the
    // last place of the largest of F and D_x, D_y, D_z.
    for (std::size_t vertex = 0; vertex < out.visible_fraction.size(); ++vertex) {
      for (std::size_t i = 0; i < 9; ++i) {
        const float* a = in.at(vertex) + i;
        const float* b = out.at(vertex) + i;
        const float largest = std::max({std::abs(b[0]), std::abs(b[9]), std::abs(b[18]), std::abs(b[27])});
        for (int f = 0; f < 4; ++f) ASSERT_NEAR(a[9 * f], b[9 * f], 6 * 0x1p-24F * largest);
      }
    }
  }
}

TEST_P(VdbGrid, SameContentGivesTheSameBytes) {
  const auto folder = scratch_folder("vdb_bytes_" + std::string(name_of(GetParam())));
  write_vdb(folder / "a.vdb", random_grid(3, GetParam()), false);
  write_vdb(folder / "b.vdb", random_grid(3, GetParam()), false);
  write_vdb(folder / "c.vdb", random_grid(4, GetParam()), false);
  EXPECT_EQ(read_bytes(folder / "a.vdb"), read_bytes(folder / "b.vdb"));
  EXPECT_NE(read_bytes(folder / "a.vdb"), read_bytes(folder / "c.vdb"));
}

INSTANTIATE_TEST_SUITE_P(AllBases, VdbGrid, testing::ValuesIn(all_bases),
                         [](const auto& test) { return std::string(name_of(test.param)); });

TEST(VdbSums, ReadBackWhatWasWritten) {
  const std::string path = scratch_folder("vdb_sums") / "part.vdb";
  for (const Basis basis : all_bases) {
    for (const Estimator estimator : {Estimator::track, Estimator::face, Estimator::face_paper}) {
      if (estimator != Estimator::track && basis != Basis::vectors) continue;
      const GridAccumulator out = random_sums(11, basis, estimator);
      write_vdb(path, out, true);
      const GridAccumulator in = read_accumulator_vdb(path);
      expect_same_frame(in.frame, out.frame);
      EXPECT_EQ(in.basis, out.basis);
      EXPECT_EQ(in.estimator, out.estimator);
      EXPECT_EQ(in.sums, out.sums);
      EXPECT_EQ(in.counters, out.counters);
      EXPECT_EQ(in.quantum, out.quantum);
      EXPECT_EQ(in.quantum_squared, out.quantum_squared);
      EXPECT_EQ(in.visible_fraction, out.visible_fraction);
      EXPECT_EQ(in.guard, out.guard);
      EXPECT_EQ(in.photon_begin, out.photon_begin);
      EXPECT_EQ(in.photon_end, out.photon_end);
      EXPECT_EQ(in.metadata, out.metadata);
    }
  }
}

// A part may hold sums at a vertex that sees nothing; they must not get lost.
TEST(VdbSums, KeepSumsOfBlindVertices) {
  const std::string path = scratch_folder("vdb_sums_blind") / "part.vdb";
  GridAccumulator out = random_sums(12, Basis::sh4, Estimator::track);
  out.visible_fraction.assign(out.visible_fraction.size(), 0);
  out.guard.clear();
  write_vdb(path, out, true);
  EXPECT_EQ(read_accumulator_vdb(path).sums, out.sums);
}

TEST(VdbFile, RefusesTheOtherKind) {
  const auto folder = scratch_folder("vdb_kind");
  write_vdb(folder / "grid.vdb", random_grid(1, Basis::sh4), false);
  write_vdb(folder / "part.vdb", random_sums(1, Basis::sh4, Estimator::track), false);
  EXPECT_NE(error_of([&] { read_grid_vdb(folder / "part.vdb"); }).find("ivory merge"), std::string::npos);
  EXPECT_NE(error_of([&] { read_accumulator_vdb(folder / "grid.vdb"); }).find("finished grid"), std::string::npos);
}

TEST(VdbFile, OverwritesOnlyWhenForced) {
  const auto folder = scratch_folder("vdb_force");
  const std::string path = folder / "grid.vdb";
  write_vdb(path, random_grid(1, Basis::sh4), false);
  const std::string before = read_bytes(path);
  EXPECT_NE(error_of([&] { write_vdb(path, random_grid(2, Basis::sh4), false); }).find("already exists"),
            std::string::npos);
  EXPECT_EQ(read_bytes(path), before);
  write_vdb(path, random_grid(2, Basis::sh4), true);
  EXPECT_NE(read_bytes(path), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1) << "a temporary file was left behind";
}

TEST(VdbFile, InfoTellsWhatItHolds) {
  const std::string path = scratch_folder("vdb_info") / "grid.vdb";
  const IrradianceGrid grid = random_grid(1, Basis::vectors);
  write_vdb(path, grid, false);
  const Metadata info = read_vdb_info(path);
  EXPECT_EQ(std::get<std::string>(info.at("basis")), "vectors");
  EXPECT_EQ(std::get<std::int64_t>(info.at("photons")), 123456789012345);
  EXPECT_EQ(std::get<double>(info.at("albedo")), 0.1);
  EXPECT_EQ(std::get<std::int64_t>(info.at("format_version")), 1);
  const auto active = std::count_if(grid.visible_fraction.begin(), grid.visible_fraction.end(),
                                    [](float fraction) { return fraction > 0; });
  EXPECT_EQ(std::get<std::int64_t>(info.at("active_vertices")), active);
  const auto& grids = std::get<std::string>(info.at("grids"));
  for (const char* expected : {"I_px_r", "I_mz_b", "visible_fraction", "variance", "guard_1"})
    EXPECT_NE(grids.find(expected), std::string::npos) << expected;
}

// ---- damage: every answer is an Error of one line that names the file ----

void expect_refused(const std::string& path) {
  for (const auto& read :
       {std::function<void()>([&] { read_grid_vdb(path); }), std::function<void()>([&] { read_accumulator_vdb(path); }),
        std::function<void()>([&] { read_vdb_info(path); })}) {
    const std::string message = error_of(read);
    ASSERT_TRUE(message.starts_with(path + ": ")) << message;
    ASSERT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST(VdbDamage, MissingEmptyFolderAndForeignText) {
  const auto folder = scratch_folder("vdb_damage_simple");
  expect_refused(folder / "missing.vdb");
  expect_refused(folder);
  write_bytes(folder / "empty.vdb", "");
  expect_refused(folder / "empty.vdb");
  write_bytes(folder / "text.vdb", std::string(1000, 'x'));
  expect_refused(folder / "text.vdb");
}

TEST(VdbDamage, CutShortAnywhere) {
  const auto folder = scratch_folder("vdb_damage_cut");
  write_vdb(folder / "whole.vdb", random_grid(5, Basis::sh4), false);
  const std::string bytes = read_bytes(folder / "whole.vdb");
  const std::string path = folder / "cut.vdb";
  for (std::size_t length = 1; length < bytes.size(); length += length < 200 ? 1 : bytes.size() / 300) {
    write_bytes(path, bytes.substr(0, length));
    expect_refused(path);
  }
  write_bytes(path, bytes + "x");
  expect_refused(path);
}

// A flipped bit is either refused or, in the 20 characters that mark the checksum as ivory's,
// harmless: then the file is read as one that another program saved.
TEST(VdbDamage, FlippedBitAnywhere) {
  const auto folder = scratch_folder("vdb_damage_flip");
  const IrradianceGrid grid = random_grid(5, Basis::sh4);
  write_vdb(folder / "whole.vdb", grid, false);
  const std::string bytes = read_bytes(folder / "whole.vdb");
  const std::vector<float> stored = read_grid_vdb(folder / "whole.vdb").moments;
  const std::string path = folder / "flipped.vdb";
  std::mt19937 rng(1);
  for (std::size_t at = 0; at < bytes.size(); at += at < 200 ? 1 : bytes.size() / 300) {
    std::string damaged = bytes;
    damaged[at] = char(damaged[at] ^ (1 << (rng() % 8)));
    write_bytes(path, damaged);
    if (at >= 21 && at < 41) {
      const std::string message = error_of([&] { EXPECT_EQ(read_grid_vdb(path).moments, stored); });
      EXPECT_TRUE(message.empty() || message.starts_with(path)) << message;
    } else {
      expect_refused(path);
    }
  }
}

}  // namespace
}  // namespace ivory
