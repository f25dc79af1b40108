#include <gtest/gtest.h>

#include "grid/error.h"
#include "grid/memory.h"

namespace ivory {
namespace {

TEST(Memory, RefusesWhatNoMachineHas) {
  EXPECT_THROW(check_memory("f", 1e18, "do less"), Error);
  EXPECT_NO_THROW(check_memory("f", 1e6, "do less"));
  try {
    check_memory("f", 0x1p60, "do less");
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "f: needs 1073741824 GiB of memory, more than can be had; do less");
  }
}

}  // namespace
}  // namespace ivory
