#include "grid/base/error.h"

#include <string>

#include <gtest/gtest.h>

namespace ivory {
namespace {

// Names and what libraries say may hold line ends: OpenEXR names a channel in its message as the file does.
TEST(Error, IsOneLineWhateverIsInIt) {
  EXPECT_EQ(std::string(Error("a\n.exr", "channel \"D\r\n\"\x01", "bake it\tagain\x7f").what()),
            "a .exr: channel \"D  \" ; bake it again ");
}

}  // namespace
}  // namespace ivory
