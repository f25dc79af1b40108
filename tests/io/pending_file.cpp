// Files that appear whole or not at all.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "grid/base/error.h"
#include "grid/io/file.h"
#include "tests/support/folder_test.h"
#include "tests/support/full_disk.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

class PendingFiles : public FolderTest {
 protected:
  void SetUp() override {
    FolderTest::SetUp();
    fs::create_directories(folder_ / "store");
  }
  static void write(const std::string& path, const std::string& text) { std::ofstream(path) << text; }
  static std::string read(const std::string& path) {
    std::ifstream in(path);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::size_t files_in(const std::string& name) const {
    return std::size_t(std::distance(fs::directory_iterator(folder_ / name), fs::directory_iterator()));
  }
};

TEST_F(PendingFiles, AppearOnCommitAndLeaveNothingOtherwise) {
  {
    PendingFile file(path("store/a.vdb"), false);
    write(file.temporary(), "whole");
    EXPECT_FALSE(fs::exists(path("store/a.vdb")));
    EXPECT_TRUE(file.temporary().ends_with(".vdb"));
    file.commit();
  }
  EXPECT_EQ(read(path("store/a.vdb")), "whole");
  { const PendingFile dropped(path("store/b.vdb"), false); }
  EXPECT_EQ(files_in("store"), 1U);
  EXPECT_THROW(PendingFile(path("store/a.vdb"), false), Error);
  EXPECT_THROW(PendingFile(path("store"), true), Error);
  EXPECT_THROW(PendingFile(path("nowhere/a.vdb"), true), Error);
}

TEST_F(PendingFiles, LinksStayAndTheirTargetsAreWritten) {
  write(path("store/real.exr"), "old");
  fs::create_symlink("store/real.exr", path("near.exr"));  // relative to the link's folder
  fs::create_symlink(path("near.exr"), path("far.exr"));   // a link to a link
  EXPECT_THROW(PendingFile(path("far.exr"), false), Error);
  PendingFile file(path("far.exr"), true);
  EXPECT_EQ(fs::path(file.temporary()).parent_path(), folder_ / "store");
  write(file.temporary(), "new");
  file.commit();
  EXPECT_TRUE(fs::is_symlink(path("far.exr")));
  EXPECT_TRUE(fs::is_symlink(path("near.exr")));
  EXPECT_FALSE(fs::is_symlink(path("store/real.exr")));
  EXPECT_EQ(read(path("store/real.exr")), "new");

  // A link to what does not exist yet makes it.
  fs::create_symlink("store/later.exr", path("ahead.exr"));
  PendingFile ahead(path("ahead.exr"), false);
  write(ahead.temporary(), "made");
  ahead.commit();
  EXPECT_TRUE(fs::is_symlink(path("ahead.exr")));
  EXPECT_EQ(read(path("store/later.exr")), "made");

  // One that leads round in a circle leads to no file.
  fs::create_symlink("round.exr", path("round.exr"));
  EXPECT_THROW(PendingFile(path("round.exr"), true), Error);
}

// Two writers of one file, be they of one process or of two machines with equal process numbers.
TEST_F(PendingFiles, WritersOfOneFileDoNotMeet) {
  PendingFile first(path("a.csv"), true);
  PendingFile second(path("a.csv"), true);
  EXPECT_NE(first.temporary(), second.temporary());
  write(first.temporary(), "first");
  write(second.temporary(), "second, which is longer");
  second.commit();
  first.commit();
  EXPECT_EQ(read(path("a.csv")), "first");
}

// Without force nothing is written over, though it came later; and nothing is lost.
TEST_F(PendingFiles, WhatAnotherHasMadeMeanwhileStays) {
  std::string kept;
  {
    PendingFile slow(path("store/a.csv"), false);
    write(slow.temporary(), "slow");
    write(path("store/a.csv"), "quick");
    kept = slow.temporary();
    try {
      slow.commit();
      FAIL() << "written over";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(kept), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(read(path("store/a.csv")), "quick");
  EXPECT_EQ(read(kept), "slow");
}

// File systems hold names of 255 bytes; the temporary one is no longer than the target's.
TEST_F(PendingFiles, NamesMayBeAsLongAsTheFileSystemBears) {
  const std::string umlauts = [] {
    std::string text;
    for (int i = 0; i < 125; ++i) text += "\u00e4";
    return text;
  }();
  for (const std::string& name : {std::string(250, 'x') + ".exr", umlauts + ".vdb", "x." + std::string(250, 'y')}) {
    write_file(path("store/" + name), "whole", false);
    EXPECT_EQ(read(path("store/" + name)), "whole") << name;
  }
  EXPECT_EQ(files_in("store"), 3U);
  try {
    PendingFile(path("store/" + std::string(260, 'x') + ".exr"), false);
    FAIL() << "a name of 264 bytes";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("give a shorter name"), std::string::npos) << error.what();
  }
}

TEST_F(PendingFiles, DevicesAndPipesAreNoFiles) {
  ASSERT_EQ(::mkfifo(path("pipe.csv").c_str(), 0600), 0);
  for (const std::string& name : {std::string("/dev/null"), std::string("/dev/full"), path("pipe.csv")}) {
    try {
      write_file(name, "x", true);
      FAIL() << name;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("a device or a pipe"), std::string::npos) << error.what();
    }
  }
}

// The cause is the system's, and the remedy goes with it.
TEST_F(PendingFiles, SayWhyTheyCannotBeWritten) {
  const auto message = [](const std::string& name) -> std::string {
    try {
      write_file(name, std::string(100'000, 'x'), true);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message(path("nowhere/a.csv")).find("(No such file or directory); make its folder"), std::string::npos);
  const std::string too_large = [&] {
    const FullDisk limit(5000);
    return message(path("store/a.csv"));
  }();
  EXPECT_NE(too_large.find("(File too large); raise the limit"), std::string::npos) << too_large;
  EXPECT_EQ(files_in("store"), 0U);
}

TEST(LowerExtension, IsThatOfTheLastComponent) {
  EXPECT_EQ(lower_extension("A/b.tar.GLB"), ".glb");
  EXPECT_EQ(lower_extension("a.b/c"), "");
}

}  // namespace
}  // namespace ivory
