#include "grid/base/certificate.h"

#include <gtest/gtest.h>

namespace ivory {
namespace {

TEST(Certificate, ComesBackFromTheMetadata) {
  const Certificate kept{0.02, 0.017, 0.0155, 0.0185, "E at 1000 points", {{"noise", 0.004}, {"resolution", 0.016}}};
  Metadata metadata{{"certificate_seconds", 3.0}, {"method", std::string("grid")}};
  keep_certificate(kept, metadata);
  const auto found = find_certificate(metadata);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->target, kept.target);
  EXPECT_EQ(found->error, kept.error);
  EXPECT_EQ(found->low, kept.low);
  EXPECT_EQ(found->high, kept.high);
  EXPECT_EQ(found->measure, kept.measure);
  EXPECT_EQ(found->parts, kept.parts);
}

TEST(Certificate, HalfOfOneIsNone) {
  Metadata metadata;
  keep_certificate({0.02, 0.017, 0.0155, 0.0185, "", {}}, metadata);
  metadata.erase("certificate_high");
  EXPECT_FALSE(find_certificate(metadata));
}

}  // namespace
}  // namespace ivory
