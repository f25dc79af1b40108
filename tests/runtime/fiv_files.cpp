// FIV tables from files, good and bad, to OpenGL.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "grid/base/error.h"
#include "grid/io/fiv.h"
#include "runtime/assets/fiv.h"
#include "tests/runtime/fiv_synthetic.h"
#include "tests/support/folder_test.h"
#include "tests/support/runtime_twin.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

class RuntimeFivFiles : public GlTest {
 protected:
  void SetUp() override {
    folder_ = fresh_test_folder();
    const SyntheticSky sky = synthetic_sky(1);
    write_fiv(path("six.exr"), synthetic_table(sky, {16, 9, 6}, 6, uneven_radii(6, 0.4F, 8), 1), ExrPrecision::float32,
              false);
    write_fiv(path("one.exr"), synthetic_table(sky, {9, 5, 4}, 1, uneven_radii(4, 0.4F, 8), 2), ExrPrecision::float16,
              false);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  std::string read(const char* name) const {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  // One line that begins with the file's name, and nothing left in OpenGL.
  void expect_refused(const std::vector<std::string>& paths, const std::string& bad) const {
    const int before = live_gl_objects();
    try {
      load_fiv_tables(paths);
      ADD_FAILURE() << bad;
    } catch (const Error& error) {
      const std::string line = error.what();
      EXPECT_EQ(line.find(bad), 0U) << line;
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    }
    EXPECT_EQ(live_gl_objects(), before);
  }

 private:
  fs::path folder_;
};

TEST_F(RuntimeFivFiles, LoadAndGoAgain) {
  const int before = live_gl_objects();
  {
    const GpuFivTables gpu = load_fiv_tables(std::vector{path("six.exr"), path("one.exr")});
    EXPECT_EQ(gpu.sets.size(), 2U);
    EXPECT_EQ(live_gl_objects(), before + 4);
    // 3 x 17 by 3 x 9 by 6 texels and 3 x 10 by 5 by 4, of 16 bytes.
    EXPECT_GE(gpu.atlas.bytes(), std::size_t(51 * 27 * 6 + 30 * 5 * 4) * 16);
  }
  EXPECT_EQ(live_gl_objects(), before);
}

TEST_F(RuntimeFivFiles, BadOnesAreRefused) {
  const std::string good = read("six.exr");
  const std::string bad = path("bad.exr");
  for (const std::string& bytes :
       {std::string(), good.substr(0, 3), good.substr(0, 300), good.substr(0, good.size() - 100),
        std::string("glTF and not OpenEXR"), std::string(4096, '\x76')}) {
    std::ofstream(bad, std::ios::binary) << bytes;
    expect_refused({bad}, bad);
    expect_refused({path("six.exr"), bad}, bad);
  }
  expect_refused({path("absent.exr")}, path("absent.exr"));
}

// A picture of 9 million samples is small as a file; its texture is beyond every limit.
TEST_F(RuntimeFivFiles, OversizedOnesNameTheLimit) {
  FivTable table;
  table.size = {1 << 17, 2, 2};
  table.radii = {1, 2};
  table.values.assign(fiv_sample_count(table) * 9, 1.0F);
  const std::string wide = path("wide.exr");
  write_fiv(wide, table, ExrPrecision::float16, false);
  expect_refused({path("one.exr"), wide}, wide + ": its 131072x2x2 samples make a texture of 393219x2x2 texels, and");
}

}  // namespace
}  // namespace ivory
