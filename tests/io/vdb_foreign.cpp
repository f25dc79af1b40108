// .vdb files that have been through other programs: saved again, moved, or never ivory's at all.
// OpenVDB itself plays the other program.
#include <cstdio>

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <sys/resource.h>
#include <tbb/task_arena.h>

#include "grid/base/error.h"
#include "grid/io/vdb/vdb.h"
#include "tests/support/io_random.h"
#include "tests/support/paths.h"

namespace ivory {
namespace {

using namespace ivory::test;

using Edit = std::function<void(openvdb::GridPtrVec&, openvdb::MetaMap&)>;

// Writes a random grid with ivory, and again with OpenVDB after `edit`. `original` is what ivory's file holds: rounded.
struct Resaved {
  explicit Resaved(const std::string& test_name, const Edit& edit, Basis basis = Basis::vectors) {
    const auto folder = scratch_folder("foreign_" + test_name);
    const std::string source = folder / "ivory.vdb";
    path = folder / "resaved.vdb";
    write_vdb(source, random_grid(21, basis), false);
    original = read_grid_vdb(source);
    openvdb::initialize();
    openvdb::io::File in(source);
    in.open(false);
    openvdb::GridPtrVec grids = *in.getGrids();
    openvdb::MetaMap metadata = *in.getMetadata();
    edit(grids, metadata);
    openvdb::io::File(path).write(grids, metadata);
  }
  std::string error() const {
    try {
      read_grid_vdb(path);
    } catch (const Error& e) {
      const std::string message = e.what();
      EXPECT_TRUE(message.starts_with(path + ": ")) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      return message;
    }
    return {};
  }
  IrradianceGrid original;
  std::string path;
};

void nothing(openvdb::GridPtrVec& /*grids*/, openvdb::MetaMap& /*metadata*/) {}

openvdb::GridBase::Ptr& find(openvdb::GridPtrVec& grids, const std::string& name) {
  return *std::find_if(grids.begin(), grids.end(), [&](const auto& grid) { return grid->getName() == name; });
}

// An edit of every grid's transform.
Edit each(const std::function<void(openvdb::math::Transform&)>& change) {
  return [change](openvdb::GridPtrVec& grids, openvdb::MetaMap& /*metadata*/) {
    for (auto& grid : grids) {
      const auto transform = grid->transform().copy();  // grids may share theirs
      change(*transform);
      grid->setTransform(transform);
    }
  };
}

void expect_same_content(const IrradianceGrid& a, const IrradianceGrid& b) {
  EXPECT_EQ(a.visible_fraction, b.visible_fraction);
  EXPECT_EQ(a.guard, b.guard);
  EXPECT_EQ(a.variance, b.variance);
  ASSERT_EQ(a.moments.size(), b.moments.size());
  // See the round trip in vdb.cpp: values to some 50 keep better than 1e-4 in the file's form.
  for (std::size_t i = 0; i < a.moments.size(); ++i) ASSERT_NEAR(a.moments[i], b.moments[i], 1e-4F);
}

TEST(VdbForeign, SavedAgainReadsTheSame) {
  const Resaved file("again", nothing);
  const IrradianceGrid in = read_grid_vdb(file.path);
  expect_same_content(in, file.original);
  EXPECT_EQ(in.metadata, file.original.metadata);
  EXPECT_EQ(in.frame.origin_m, file.original.frame.origin_m);
  EXPECT_EQ(in.frame.local_to_world, file.original.frame.local_to_world);
}

// Houdini keeps grids, not the file's metadata.
TEST(VdbForeign, ReadsWithoutFileMetadata) {
  const Resaved file("no_metadata", [](auto&, openvdb::MetaMap& metadata) { metadata.clearMetadata(); });
  expect_same_content(read_grid_vdb(file.path), file.original);
}

TEST(VdbForeign, IgnoresGridsOfOthers) {
  const Resaved file("extra", [](openvdb::GridPtrVec& grids, auto&) {
    const auto density = openvdb::FloatGrid::create();
    density->setName("density");
    density->tree().setValueOn(openvdb::Coord(1000, 0, 0), 1.0F);
    grids.insert(grids.begin(), density);
  });
  expect_same_content(read_grid_vdb(file.path), file.original);
}

TEST(VdbForeign, ReadsHalfFloats) {
  const Resaved file("half", [](openvdb::GridPtrVec& grids, auto&) {
    for (auto& grid : grids) {
      if (grid->getName().starts_with("I_")) grid->setSaveFloatAsHalf(true);
    }
  });
  const IrradianceGrid in = read_grid_vdb(file.path);
  // 11 bits of sums of up to six values below 64.
  for (std::size_t i = 0; i < in.moments.size(); ++i)
    ASSERT_NEAR(in.moments[i], file.original.moments[i], 6 * 64 * 0x1p-11F);
}

// Moved, turned and scaled by another program: p and n carried along give the same E.
TEST(VdbForeign, ReadsWhereItWasMovedTo) {
  constexpr double angle_rad = 0.7;
  const openvdb::Vec3d shift(3, -2, 11);
  constexpr double scale = 2.5;
  const Resaved file("moved", each([&](openvdb::math::Transform& transform) {
                       transform.postScale(scale);
                       transform.postRotate(angle_rad, openvdb::math::Y_AXIS);
                       transform.postTranslate(shift);
                     }));
  const IrradianceGrid in = read_grid_vdb(file.path);
  openvdb::Mat4d motion = openvdb::Mat4d::identity();
  motion.postScale(openvdb::Vec3d(scale));
  motion.postRotate(openvdb::math::Y_AXIS, angle_rad);
  motion.postTranslate(shift);

  std::mt19937 rng(5);
  std::uniform_real_distribution<float> unit(0, 1);
  std::normal_distribution<float> normal(0, 1);
  for (int i = 0; i < 200; ++i) {
    const V3f index(unit(rng) * 4, unit(rng) * 8, unit(rng) * 11);
    const V3f p = file.original.frame.to_world(index);
    const V3f n = V3f(normal(rng), normal(rng), normal(rng)).normalized();
    const openvdb::Vec3d p_moved = motion.transform(openvdb::Vec3d(p.x, p.y, p.z));
    const openvdb::Vec3d n_moved = motion.transform3x3(openvdb::Vec3d(n.x, n.y, n.z)) / scale;
    const V3f p2(float(p_moved.x()), float(p_moved.y()), float(p_moved.z()));
    const V3f n2(float(n_moved.x()), float(n_moved.y()), float(n_moved.z()));
    const auto e = [](const IrradianceGrid& grid, const V3f& at, const V3f& facing) {
      return irradiance(grid, make_footprint(grid.frame, at, Interpolation::trilinear), facing,
                        Reconstruction::optimal);
    };
    const Rgb a = e(file.original, p, n);
    const Rgb b = e(in, p2, n2);
    // Positions of some 10 m in float move by 1e-6 of a metre, and moments change by up to 100 lux over 0.1 m.
    for (unsigned c = 0; c < 3; ++c) ASSERT_NEAR(a[c], b[c], 5e-3F);
  }
}

TEST(VdbForeign, RefusesOtherTransforms) {
  using openvdb::math::Transform;
  const std::vector<std::pair<std::string, Edit>> cases{
      {"sheared", each([](Transform& t) { t.postShear(0.1, openvdb::math::X_AXIS, openvdb::math::Y_AXIS); })},
      {"mirrored", each([](Transform& t) { t.postScale(openvdb::Vec3d(-1, 1, 1)); })},
      {"stretched unevenly", each([](Transform& t) { t.preScale(openvdb::Vec3d(1, 2, 1)); })},
      {"not linear",
       [](openvdb::GridPtrVec& grids, auto&) {
         for (auto& grid : grids)
           grid->setTransform(Transform::createFrustumTransform(openvdb::BBoxd({0, 0, 0}, {5, 9, 12}), 0.5, 3));
       }},
      {"different transforms",
       [](openvdb::GridPtrVec& grids, auto&) {
         const auto moved = grids[3]->transform().copy();
         moved->postTranslate(openvdb::Vec3d(1, 0, 0));
         grids[3]->setTransform(moved);
       }},
  };
  for (const auto& [what, edit] : cases) {
    const std::string error = Resaved("transform", edit).error();
    EXPECT_NE(error.find(what), std::string::npos) << what << ": " << error;
  }
}

TEST(VdbForeign, RefusesOtherContent) {
  const auto set = [](const std::string& grid_name, const openvdb::Coord& at, float value) -> Edit {
    return [=](openvdb::GridPtrVec& grids, auto&) {
      const auto& grid = find(grids, grid_name);
      if (const auto scalar = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) scalar->tree().setValueOn(at, value);
      if (const auto vector = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grid))
        vector->tree().setValueOn(at, openvdb::Vec3s(value, 0, 0));
    };
  };
  const auto meta = [](const std::string& key, const openvdb::Metadata& value) -> Edit {
    return [key, copy = value.copy()](auto&, openvdb::MetaMap& metadata) {
      metadata.removeMeta(key);
      metadata.insertMeta(key, *copy);
    };
  };
  const openvdb::Coord inside(1, 1, 1);
  const openvdb::Coord outside(5, 0, 0);
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const std::vector<std::pair<std::string, Edit>> cases{
      {"not finite", set("I_px_g", inside, nan)},
      {"not finite", set("I_mz_b", inside, -infinity)},
      {"variance", set("variance", inside, -1)},
      {"visible_fraction", set("visible_fraction", inside, 1.5F)},
      {"visible_fraction", set("visible_fraction", inside, nan)},
      {"guard_0", set("guard_0", inside, 0.5F)},
      {"guard_1", set("guard_1", inside, -1)},
      {"larger than the file states", set("I_px_g", outside, 1)},
      {"larger than the file states", set("visible_fraction", outside, 1)},
      {"grid I_py_r", [](openvdb::GridPtrVec& grids, auto&) { find(grids, "I_py_r")->setName("I_py_other"); }},
      {"grid visible_fraction",
       [](openvdb::GridPtrVec& grids, auto&) { find(grids, "visible_fraction")->setName("v"); }},
      {"grid guard_1", [](openvdb::GridPtrVec& grids, auto&) { find(grids, "guard_1")->setName("g"); }},
      {"another type",
       [](openvdb::GridPtrVec& grids, auto&) {
         const auto other = openvdb::FloatGrid::create();
         other->setName("I_pz_b");
         find(grids, "I_pz_b") = other;
       }},
      {"version 2", meta("ivory_file_format_version", openvdb::Int64Metadata(2))},
      {"ivory_file_format_version", meta("ivory_file_format_version", openvdb::StringMetadata("1"))},
      {"ivory_file_kind", meta("ivory_file_kind", openvdb::StringMetadata("something"))},
      {"ivory_file_basis", meta("ivory_file_basis", openvdb::StringMetadata("something"))},
      {"ivory_file_size", meta("ivory_file_size", openvdb::Vec3IMetadata({5, 9, 1}))},
      {"ivory_file_size", meta("ivory_file_size", openvdb::Vec3IMetadata({5, 9, -12}))},
      {"memory", meta("ivory_file_size", openvdb::Vec3IMetadata({65536, 65536, 65536}))},
      {"ivory_file_spacing_m", meta("ivory_file_spacing_m", openvdb::Vec3SMetadata({1, 0, 1}))},
      {"ivory_file_origin_m", meta("ivory_file_origin_m", openvdb::Vec3SMetadata({nan, 0, 1}))},
      {"ivory_file_axis_y", meta("ivory_file_axis_y", openvdb::Vec3SMetadata({0, 7, 0}))},
      {"not written by ivory",
       [](openvdb::GridPtrVec& grids, openvdb::MetaMap& metadata) {
         metadata.clearMetadata();
         find(grids, "visible_fraction")->clearMetadata();
         grids[0]->setName("density");
       }},
  };
  for (const auto& [what, edit] : cases) {
    const std::string error = Resaved("content", edit).error();
    EXPECT_NE(error.find(what), std::string::npos) << what << ": " << error;
  }
}

// A vertex of six hemispheres takes 392 bytes at the reader's peak: 216 as stored, 144 as moments, 32 of visibility,
// guard and OpenVDB's grid. 256 x 256 x 128 of them are 3.06 GiB, more than three quarters of 4; no part is.
TEST(VdbForeign, ThePeakOfReadingIsWeighed) {
  const Resaved file("peak", [](openvdb::GridPtrVec& /*grids*/, openvdb::MetaMap& metadata) {
    metadata.removeMeta("ivory_file_size");
    metadata.insertMeta("ivory_file_size", openvdb::Vec3IMetadata({256, 256, 128}));
  });
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  rlimit lowered = before;
  lowered.rlim_cur = rlim_t{4} << 30U;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &lowered), 0);
  std::string error;
  tbb::task_arena(1).execute([&] { error = file.error(); });  // each thread more has a grid of its own
  setrlimit(RLIMIT_AS, &before);
  EXPECT_NE(error.find("needs 3.06 GiB of memory, and 3 GiB may be used"), std::string::npos) << error;
}

TEST(VdbForeign, ReadableByPython) {
  const auto run = [](const std::string& command) {
    std::string output;
    FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    std::array<char, 4096> buffer{};
    while (std::fgets(buffer.data(), int(buffer.size()), pipe) != nullptr) output += buffer.data();
    return std::pair(::pclose(pipe), output);
  };
  const std::string python = "/usr/bin/python3";  // Debian's own, which python3-openvdb serves
  if (run(python + " -c 'import pyopenvdb'").first != 0) GTEST_SKIP() << "python3-openvdb is not installed";
  const auto folder = scratch_folder("foreign_python");
  for (const Basis basis : all_bases)
    write_vdb(folder / (std::string(name_of(basis)) + ".vdb"), random_grid(3, basis), false);
  write_bytes(folder / "check.py", R"(
import sys, pyopenvdb
for basis, expected in (('vectors', 'I_px_r'), ('vectors9', 'C_b'), ('sh9', 'L2m1'), ('ambient_cube', 'E_mz'), ('sh4', 'L11')):
    grids, metadata = pyopenvdb.readAll(sys.argv[1] + '/' + basis + '.vdb')
    assert metadata['ivory_file_basis'] == basis and metadata['ivory_photons'] == 123456789012345, metadata
    grids = {grid.name: grid for grid in grids}
    vector = grids[expected]
    assert vector.valueTypeName == 'vec3s' and vector.activeVoxelCount() == grids['visible_fraction'].activeVoxelCount()
    if basis == 'vectors':
        assert vector.metadata['vector_type'] == 'contravariant relative' and vector.metadata['is_local_space']
    else:
        assert basis == 'vectors9' or vector.metadata['vector_type'] == 'invariant', vector.metadata
print('fine')
)");
  const auto [status, output] = run(python + " " + (folder / "check.py").string() + " " + folder.string());
  EXPECT_EQ(status, 0) << output;
  EXPECT_EQ(output, "fine\n");
}

}  // namespace
}  // namespace ivory
