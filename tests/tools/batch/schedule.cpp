// In which order assets are baked, which side by side, and what a failure stops.
#include "tools/batch/work/schedule.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace ivory {
namespace {

TEST(BatchSchedule, StartsWithTheLongestWayToTheEnd) {
  // 0 (1 s) leads to 1 (10 s); 2 takes 9 s and 3 takes 5 s alone.
  Schedule schedule({{{}, 1, 0}, {{0}, 10, 0}, {{}, 9, 0}, {{}, 5, 0}}, 2, 1);
  EXPECT_EQ(schedule.start(), 0);
  EXPECT_EQ(schedule.start(), 2);
  EXPECT_EQ(schedule.start(), std::nullopt);  // two at a time
  EXPECT_TRUE(schedule.finish(0, true).empty());
  EXPECT_EQ(schedule.start(), 1);
  EXPECT_TRUE(schedule.finish(2, true).empty());
  EXPECT_EQ(schedule.start(), 3);
  schedule.finish(1, true);
  EXPECT_FALSE(schedule.over());
  schedule.finish(3, true);
  EXPECT_TRUE(schedule.over());
}

TEST(BatchSchedule, KeepsWithinMemory) {
  Schedule schedule({{{}, 3, 60}, {{}, 2, 60}, {{}, 1, 30}, {{}, 0.5, 500}}, 4, 100);
  EXPECT_EQ(schedule.start(), 0);
  EXPECT_EQ(schedule.start(), 2);  // 1 does not fit beside 0
  EXPECT_EQ(schedule.start(), std::nullopt);
  schedule.finish(2, true);
  EXPECT_EQ(schedule.start(), std::nullopt);
  schedule.finish(0, true);
  EXPECT_EQ(schedule.start(), 1);
  EXPECT_EQ(schedule.start(), std::nullopt);
  schedule.finish(1, true);
  EXPECT_EQ(schedule.start(), 3);  // more than there is, but alone
}

TEST(BatchSchedule, AFailureSkipsWhatNeedsItAndNothingElse) {
  // 0 -> 1 -> 2, and 3 -> 4; 5 needs both ends.
  Schedule schedule({{{}, 9, 0}, {{0}, 1, 0}, {{1}, 1, 0}, {{}, 5, 0}, {{3}, 1, 0}, {{2, 4}, 1, 0}}, 1, 1);
  EXPECT_EQ(schedule.start(), 0);
  std::vector<int> skipped = schedule.finish(0, false);
  std::sort(skipped.begin(), skipped.end());
  EXPECT_EQ(skipped, (std::vector<int>{1, 2, 5}));
  EXPECT_EQ(schedule.start(), 3);
  EXPECT_TRUE(schedule.finish(3, true).empty());
  EXPECT_EQ(schedule.start(), 4);
  schedule.finish(4, true);
  EXPECT_TRUE(schedule.over());
  EXPECT_EQ(schedule.state(5), TaskState::skipped);
}

}  // namespace
}  // namespace ivory
