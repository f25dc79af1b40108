#include "grid/base/memory.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>

#include "grid/base/error.h"

namespace ivory {
namespace {

namespace fs = std::filesystem;

TEST(Memory, RefusesWhatNoMachineHas) {
  EXPECT_THROW(check_memory("f", 1e18, "do less"), Error);
  EXPECT_NO_THROW(check_memory("f", 1e6, "do less"));
  try {
    check_memory("f", 0x1p60, "do less");
  } catch (const Error& error) {
    char expected[100];
    std::snprintf(expected, sizeof(expected), "f: needs 1.07e+09 GiB of memory, and %.3g GiB may be used; do less",
                  0.75 * available_memory_bytes() / 0x1p30);
    EXPECT_STREQ(error.what(), expected);
  }
}

TEST(Memory, MindsTheLimitOnAddressSpace) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  rlimit lowered = before;
  lowered.rlim_cur = rlim_t{1} << 30U;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &lowered), 0);
  const double available = available_memory_bytes();
  setrlimit(RLIMIT_AS, &before);
  EXPECT_EQ(available, 0x1p30);
}

TEST(Memory, ProcessorsAreThoseOfTheAffinity) {
  cpu_set_t before;
  ASSERT_EQ(sched_getaffinity(0, sizeof(before), &before), 0);
  cpu_set_t one;
  CPU_ZERO(&one);
  for (std::size_t i = 0; CPU_COUNT(&one) == 0; ++i)
    if (CPU_ISSET(i, &before)) CPU_SET(i, &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof(one), &one), 0);
  const int processors = available_processors();
  sched_setaffinity(0, sizeof(before), &before);
  EXPECT_EQ(processors, 1);
  EXPECT_LE(available_processors(), CPU_COUNT(&before));
}

// Trees of control groups as Linux shows them, made of ordinary files.
class ControlGroups : public testing::Test {
 protected:
  void SetUp() override {
    root_ = testing::TempDir() + "/groups_" + testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(root_);
  }
  void TearDown() override { fs::remove_all(root_); }
  void write(const std::string& path, const std::string& text) const {
    fs::create_directories(fs::path(root_ + path).parent_path());
    std::ofstream(root_ + path) << text << "\n";
  }

  std::string root_;
};

TEST_F(ControlGroups, NoneLimitNothing) {
  EXPECT_TRUE(std::isinf(control_group_limits(root_).memory_bytes));
  EXPECT_TRUE(std::isinf(control_group_limits(root_).processors));
  write("/proc/self/cgroup", "0::/user.slice");
  write("/sys/fs/cgroup/user.slice/memory.max", "max");
  write("/sys/fs/cgroup/user.slice/cpu.max", "max 100000");
  EXPECT_TRUE(std::isinf(control_group_limits(root_).memory_bytes));
  EXPECT_TRUE(std::isinf(control_group_limits(root_).processors));
}

TEST_F(ControlGroups, VersionTwoTakesTheLeastOfTheBranch) {
  write("/proc/self/cgroup", "0::/batch/job7/step");
  write("/sys/fs/cgroup/batch/memory.max", "8589934592");
  write("/sys/fs/cgroup/batch/job7/memory.max", "1073741824");
  write("/sys/fs/cgroup/batch/job7/step/memory.max", "max");
  write("/sys/fs/cgroup/batch/job8/memory.max", "1");  // another's
  write("/sys/fs/cgroup/batch/cpu.max", "250000 100000");
  write("/sys/fs/cgroup/batch/job7/cpu.max", "max 100000");
  EXPECT_EQ(control_group_limits(root_).memory_bytes, 0x1p30);
  EXPECT_EQ(control_group_limits(root_).processors, 2.5);
}

// Inside a container the group's own folder is the root of what is seen.
TEST_F(ControlGroups, ContainersSeeTheirOwnAsTheRoot) {
  write("/proc/self/cgroup", "0::/");
  write("/sys/fs/cgroup/memory.max", "2147483648");
  write("/sys/fs/cgroup/cpu.max", "50000 100000");
  EXPECT_EQ(control_group_limits(root_).memory_bytes, 0x1p31);
  EXPECT_EQ(control_group_limits(root_).processors, 0.5);
}

TEST_F(ControlGroups, VersionOne) {
  write("/proc/self/cgroup", "5:devices:/\n4:memory:/docker/abc\n2:cpu,cpuacct:/docker/abc\n0::/");
  write("/sys/fs/cgroup/memory/docker/abc/memory.limit_in_bytes", "4294967296");
  write("/sys/fs/cgroup/cpu/docker/abc/cpu.cfs_quota_us", "300000");
  write("/sys/fs/cgroup/cpu/docker/abc/cpu.cfs_period_us", "100000");
  write("/sys/fs/cgroup/cpu/cpu.cfs_quota_us", "-1");
  write("/sys/fs/cgroup/cpu/cpu.cfs_period_us", "100000");
  EXPECT_EQ(control_group_limits(root_).memory_bytes, 0x1p32);
  EXPECT_EQ(control_group_limits(root_).processors, 3);
}

}  // namespace
}  // namespace ivory
