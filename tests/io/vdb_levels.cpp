// .vdb files of grids of several spacings: round trips, what other programs find in them, and what cannot be.
#include <algorithm>
#include <functional>

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include "grid/base/error.h"
#include "grid/io/vdb/vdb.h"
#include "tests/support/io_random.h"
#include "tests/support/paths.h"
#include "tests/support/random_lattice.h"

namespace ivory {
namespace {

using namespace ivory::test;

// What random_grid() and random_sums() hold, on a lattice.
template <typename Grid>
void put_on(const Lattice& lattice, std::uint32_t seed, Grid& grid) {
  std::mt19937 rng(seed);
  static_cast<Lattice&>(grid) = lattice;
  grid.visible_fraction = random_visibility(rng, lattice.vertex_count());
  grid.guard = random_guard(rng, grid.visible_fraction);
}

IrradianceGrid lattice_grid(const Lattice& lattice, std::uint32_t seed, Basis basis) {
  IrradianceGrid grid = random_grid(seed, basis);
  put_on(lattice, seed, grid);
  std::mt19937 rng(seed);
  std::normal_distribution<float> normal(0, 10);
  const std::size_t count = lattice.vertex_count();
  grid.moments.assign(count * std::size_t(grid.stride()), 0);
  grid.variance.assign(count, Rgb(0, 0, 0));
  for (std::size_t v = 0; v < count; ++v) {
    if (grid.visible_fraction[v] == 0) continue;
    for (int i = 0; i < grid.stride(); ++i) grid.moments[v * std::size_t(grid.stride()) + std::size_t(i)] = normal(rng);
    grid.variance[v] = Rgb(1, 2, std::abs(normal(rng)));
  }
  return grid;
}

GridAccumulator lattice_sums(const Lattice& lattice, std::uint32_t seed) {
  GridAccumulator sums = random_sums(seed, Basis::sh4, Estimator::track);
  put_on(lattice, seed, sums);
  std::mt19937_64 bits(seed);
  const auto stride = std::size_t(sum_layout(sums.basis, sums.estimator).stride());
  sums.sums.assign(lattice.vertex_count() * stride, 0);
  for (std::size_t v = 0; v < lattice.vertex_count(); ++v) {
    if (sums.visible_fraction[v] == 0) continue;
    for (std::size_t i = 0; i < stride; ++i) sums.sums[v * stride + i] = std::int64_t(bits()) >> 2;
  }
  return sums;
}

Lattice some_lattice(std::uint32_t seed = 1) { return random_lattice(V3i(6, 10, 8), 3, 0.01, seed); }

TEST(VdbLevels, GridsReadBackAsWritten) {
  const auto folder = scratch_folder("vdb_levels");
  for (const Basis basis : {Basis::ambient_cube, Basis::vectors}) {
    for (const double far_m : {0.0, 4e6}) {
      IrradianceGrid out = lattice_grid(some_lattice(), 3, basis);
      out.anchor_m = V3d(far_m, 0, -far_m);
      write_vdb(folder / "a.vdb", out, true);
      const IrradianceGrid in = read_grid_vdb(folder / "a.vdb");
      EXPECT_EQ(static_cast<const Lattice&>(in), static_cast<const Lattice&>(out));
      EXPECT_EQ(in.anchor_m, out.anchor_m);
      EXPECT_EQ(in.visible_fraction, out.visible_fraction);
      EXPECT_EQ(in.guard, out.guard);
      EXPECT_EQ(in.metadata, out.metadata);
      ASSERT_EQ(in.moments.size(), out.moments.size());
      // To an eighth of the standard error and, where that is fine, to a half: see vdb.cpp. Values lie below 64.
      const auto stride = std::size_t(out.stride());
      for (std::size_t i = 0; i < in.moments.size(); ++i) {
        const float variance = out.variance[i / stride][unsigned(i % 3)];
        ASSERT_NEAR(in.moments[i], out.moments[i], std::sqrt(variance) / 8 + 2 * 64 * 0x1p-12F);
        ASSERT_NEAR(in.variance[i / stride][unsigned(i % 3)], variance, 0x1p-7F * variance);
      }
      write_vdb(folder / "b.vdb", out, true);
      EXPECT_EQ(read_bytes(folder / "a.vdb"), read_bytes(folder / "b.vdb"));
    }
  }
}

TEST(VdbLevels, SumsReadBackAsWritten) {
  const std::string path = scratch_folder("vdb_levels_sums") / "part.vdb";
  const GridAccumulator out = lattice_sums(some_lattice(), 4);
  write_vdb(path, out, true);
  const GridAccumulator in = read_accumulator_vdb(path);
  EXPECT_EQ(static_cast<const Lattice&>(in), static_cast<const Lattice&>(out));
  EXPECT_EQ(in.sums, out.sums);
  EXPECT_EQ(in.visible_fraction, out.visible_fraction);
  EXPECT_EQ(in.guard, out.guard);
}

using Grids = openvdb::GridPtrVec;
using Edit = std::function<void(Grids&, openvdb::MetaMap&)>;

openvdb::GridBase::Ptr& find(Grids& grids, const std::string& name) {
  return *std::find_if(grids.begin(), grids.end(), [&](const auto& grid) { return grid->getName() == name; });
}

// A file of levels that OpenVDB saved again after `edit`.
struct Resaved {
  explicit Resaved(const Edit& edit) {
    const auto folder =
        scratch_folder(std::string("vdb_levels_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    path = folder / "edited.vdb";
    write_vdb(folder / "ivory.vdb", lattice_grid(some_lattice(), 5, Basis::sh4), true);
    original = read_grid_vdb(folder / "ivory.vdb");  // rounded
    openvdb::initialize();
    openvdb::io::File in(folder / "ivory.vdb");
    in.open(false);
    Grids grids = *in.getGrids();
    openvdb::MetaMap metadata = *in.getMetadata();
    edit(grids, metadata);
    openvdb::io::File(path).write(grids, metadata);
  }
  IrradianceGrid original;
  std::string path;
};

// As Houdini does it: tiles for equal values, file metadata gone, all grids moved together.
TEST(VdbLevels, ReadWhereOtherProgramsMovedThem) {
  const Resaved file([](Grids& grids, openvdb::MetaMap& metadata) {
    metadata.clearMetadata();
    for (auto& grid : grids) {
      grid->pruneGrid();
      const auto transform = grid->transform().copy();
      transform->postScale(2.0);
      transform->postRotate(0.6, openvdb::math::Y_AXIS);
      transform->postTranslate(openvdb::Vec3d(5, 1, -3));
      grid->setTransform(transform);
    }
  });
  const IrradianceGrid in = read_grid_vdb(file.path);
  EXPECT_EQ(in.moments, file.original.moments);
  ASSERT_EQ(in.levels(), 3);
  openvdb::Mat4d motion = openvdb::Mat4d::identity();
  motion.postScale(openvdb::Vec3d(2.0));
  motion.postRotate(openvdb::math::Y_AXIS, 0.6);
  motion.postTranslate(openvdb::Vec3d(5, 1, -3));
  for (std::uint32_t v = 0; v < in.vertex_count(); v += 7) {
    const V3f before = file.original.position_of(v);
    const openvdb::Vec3d moved = motion.transform(openvdb::Vec3d(before.x, before.y, before.z));
    // Positions of some 20 m.
    EXPECT_LT((in.position_of(v) - V3f(float(moved.x()), float(moved.y()), float(moved.z()))).length(), 2e-5F);
  }
}

// One transform a level, and names that say which.
TEST(VdbLevels, GridsStandWhereTheirLevelsDo) {
  const Resaved file([](Grids& grids, openvdb::MetaMap& /*metadata*/) {
    for (const char* name : {"L00", "L11", "variance", "visible_fraction", "guard_0", "guard_1"}) {
      const auto& coarse = find(grids, name);
      const auto& middle = find(grids, std::string(name) + "_level1");
      const auto& fine = find(grids, std::string(name) + "_level2");
      EXPECT_TRUE((coarse->voxelSize() / 2).eq(middle->voxelSize(), 1e-6));
      EXPECT_TRUE((coarse->voxelSize() / 4).eq(fine->voxelSize(), 1e-6));
      // Corner to corner.
      const openvdb::Vec3d corner(-0.5, -0.5, -0.5);
      EXPECT_TRUE(coarse->indexToWorld(corner).eq(fine->indexToWorld(corner), 1e-5));
      EXPECT_TRUE(coarse->indexToWorld(corner + openvdb::Vec3d(6, 10, 8))
                      .eq(middle->indexToWorld(corner + openvdb::Vec3d(12, 20, 16)), 1e-5));
    }
    EXPECT_EQ(grids.size(), 8U * 3);
  });
  const Metadata info = read_vdb_info(file.path);
  EXPECT_EQ(std::get<std::int64_t>(info.at("levels")), 3);
  const auto stored = std::count_if(file.original.visible_fraction.begin(), file.original.visible_fraction.end(),
                                    [](float fraction) { return fraction > 0; });
  EXPECT_EQ(std::get<std::int64_t>(info.at("active_vertices")), stored);
}

TEST(VdbLevels, RefuseWhatDoesNotFitTogether) {
  const auto levels = [](std::int64_t count) -> Edit {
    return [count](Grids& /*grids*/, openvdb::MetaMap& metadata) {
      metadata.removeMeta("ivory_file_levels");
      metadata.insertMeta("ivory_file_levels", openvdb::Int64Metadata(count));
    };
  };
  const auto erase = [](const std::string& name) -> Edit {
    return [name](Grids& grids, openvdb::MetaMap& /*metadata*/) {
      std::erase_if(grids, [&](const auto& grid) { return grid->getName() == name; });
    };
  };
  const auto set_brick = [](const std::string& name, const openvdb::Coord& brick, bool on, int voxels = 64) -> Edit {
    return [=](Grids& grids, openvdb::MetaMap& /*metadata*/) {
      const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(find(grids, name));
      auto accessor = grid->getAccessor();
      for (int i = 0; i < voxels; ++i) {
        const openvdb::Coord at(4 * brick.x() + i % 4, 4 * brick.y() + i / 4 % 4, 4 * brick.z() + i / 16);
        if (on)
          accessor.setValueOn(at, 0.0F);
        else
          accessor.setValueOff(at);
      }
    };
  };
  const Lattice lattice = some_lattice();
  const auto coord = [](const V3i& b) { return openvdb::Coord(b.x, b.y, b.z); };
  // A finer brick whose coarser surroundings are not there, and one of them taken away.
  const auto absent = [&] {
    const BrickLevel& fine = lattice.finer[1];
    for (int z = 0; z < fine.bricks.z; ++z) {
      for (int x = 0; x < fine.bricks.x; ++x) {
        if (const V3i at(x, 0, z); fine.table[fine.brick_index(at)] > no_brick + 3) return at;
      }
    }
    return V3i(-1, -1, -1);
  }();
  ASSERT_GE(absent.x, 0);
  const V3i parent = lattice.finer[1].stored[0] / 2;
  const std::vector<std::pair<std::string, Edit>> cases{
      {"ivory_file_levels", levels(0)},
      {"ivory_file_levels", levels(1)},
      {"ivory_file_levels", levels(-3)},
      {"ivory_file_levels", levels(std::int64_t(1) << 40U)},
      {"visible_fraction_level3", levels(4)},
      {"visible_fraction_level1", erase("visible_fraction_level1")},
      {"L10_level2", erase("L10_level2")},
      {"guard_1_level2", erase("guard_1_level2")},
      {"variance_level1", erase("variance_level1")},
      {"brick that is not whole", set_brick("visible_fraction_level2", coord(absent), true, 63)},
      {"brick that is not whole", set_brick("visible_fraction_level2", coord(lattice.finer[1].stored[0]), false, 1)},
      {"levels disagree", set_brick("visible_fraction_level2", coord(absent), true)},
      {"levels disagree", set_brick("visible_fraction_level1", coord(parent), false)},
      {"larger than the file states", set_brick("visible_fraction_level2", openvdb::Coord(6, 0, 0), true)},
      {"larger than the file states", set_brick("visible_fraction_level1", openvdb::Coord(0, -1, 0), true)},
      {"bricks of level 2",
       [](Grids& grids, auto&) {
         openvdb::gridPtrCast<openvdb::FloatGrid>(find(grids, "visible_fraction_level2"))->clear();
       }},
      {"transforms that disagree",
       [](Grids& grids, auto&) {
         for (auto& grid : grids) {
           if (!grid->getName().ends_with("_level2")) continue;
           const auto moved = grid->transform().copy();
           moved->postTranslate(openvdb::Vec3d(0.05, 0, 0));
           grid->setTransform(moved);
         }
       }},
      {"transforms that disagree",
       [](Grids& grids, auto&) {
         find(grids, "visible_fraction_level1")->setTransform(find(grids, "visible_fraction")->transform().copy());
       }},
      {"different transforms",
       [](Grids& grids, auto&) { find(grids, "L00_level1")->setTransform(find(grids, "L00")->transform().copy()); }},
      {"ivory_file_size",
       [](Grids& grids, openvdb::MetaMap& metadata) {
         metadata.removeMeta("ivory_file_size");
         metadata.insertMeta("ivory_file_size", openvdb::Vec3IMetadata({7, 10, 8}));
         (void)grids;
       }},
  };
  for (const auto& [what, edit] : cases) {
    const Resaved file(edit);
    std::string message;
    try {
      read_grid_vdb(file.path);
    } catch (const Error& error) {
      message = error.what();
    }
    EXPECT_TRUE(message.starts_with(file.path + ": ")) << what << ": " << message;
    EXPECT_NE(message.find(what), std::string::npos) << what << ": " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace ivory
