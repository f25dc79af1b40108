// Batches that are stopped and killed, and go on.
#include <random>

#include "tests/tools/background_run.h"

namespace ivory::script {

namespace {

// A grid of a second of one thread, which keeps checkpoints; one beside it; a picture that never ends before it is
// stopped, and reads nothing of either.
const std::string grids = R"(
[job]
output = "baked"
[scene.room]
file = "room_boxes.gltf"
[default.grid]
scene = "room"
resolution = 8
checkpoint = 0.00007
[grid.one]
photons = "1m"
[grid.two]
photons = "600k"
seed = 2
)";
const std::string picture = R"(
[render.slow]
scene = "room"
size = "640x480"
samples = 4096
)";
constexpr const char* checkpoints[] = {"baked/one.grid.checkpoint.vdb", "baked/two.grid.checkpoint.vdb"};

fs::path job_folder(const std::string& name, const std::string& job) {
  const fs::path folder = scratch_folder(name);
  fs::copy_file(std::string(source_folder) + "/scenes/room_boxes.gltf", folder / "room_boxes.gltf");
  write_file(folder / "job.toml", job);
  return folder;
}

// The least time of all where there is none.
fs::file_time_type newest_checkpoint(const fs::path& folder) {
  fs::file_time_type newest = fs::file_time_type::min();
  for (const char* file : checkpoints) {
    std::error_code gone;  // renamed at this moment
    const fs::file_time_type time = fs::last_write_time(folder / file, gone);
    if (!gone) newest = std::max(newest, time);
  }
  return newest;
}

bool has_checkpoint(const fs::path& folder) { return newest_checkpoint(folder) != fs::file_time_type::min(); }

void expect_same_grids(const fs::path& a, const fs::path& b) {
  for (const char* file : {"baked/one.grid.vdb", "baked/two.grid.vdb"}) {
    ASSERT_TRUE(fs::exists(a / file)) << file;
    EXPECT_EQ(read_file(a / file), read_file(b / file)) << file;
  }
}

TEST(BatchStop, SignalsLeaveCheckpointsToGoOnFrom) {
  const fs::path whole = job_folder("batch_whole", grids);
  ASSERT_EQ(ivory(whole, "batch job.toml -q").exit_code, 0);
  const fs::path folder = job_folder("batch_stopped", grids + picture);
  for (const int signal : {SIGINT, SIGTERM}) {
    const fs::file_time_type before = newest_checkpoint(folder);
    BackgroundRun run(folder, "batch job.toml -q --side-by-side 3");
    wait_for(run, [&] { return newest_checkpoint(folder) > before; });
    run.signal(signal);
    ASSERT_EQ(run.end(), 128 + signal) << run.said();
    const std::string said = run.said();
    EXPECT_EQ(said, "ivory: stopped; the same command goes on from there, grids from their checkpoints\n");
    EXPECT_TRUE(has_checkpoint(folder));
    EXPECT_FALSE(fs::exists(folder / "baked/slow.render.png"));
    const std::string log = read_file(folder / "baked/job.batch.log");
    EXPECT_NE(log.find("stopped with"), std::string::npos) << log;
    EXPECT_NE(log.find("stopped; the same command goes on"), std::string::npos) << log;
    EXPECT_EQ(log.find("failed"), std::string::npos) << log;
  }
  const Outcome outcome = ivory(folder, "batch job.toml --only 'grid.*'");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(read_file(folder / "baked/job.batch.log").find("going on from"), std::string::npos);
  expect_same_grids(folder, whole);
  EXPECT_FALSE(has_checkpoint(folder));
}

// A picture keeps nothing and asks nothing: the batch does not wait for it.
TEST(BatchStop, WhatKeepsNothingIsNotWaitedFor) {
  const fs::path folder = job_folder("batch_unasked", grids + picture);
  BackgroundRun run(folder, "batch job.toml -q --only render.slow");
  wait_for(run, [&] { return fs::exists(folder / "baked/job.batch.json"); });
  run.signal(SIGTERM);
  EXPECT_EQ(run.end(), 128 + SIGTERM) << run.said();
  EXPECT_EQ(run.said(), "ivory: stopped; the same command goes on from there, grids from their checkpoints\n");
  EXPECT_FALSE(fs::exists(folder / "baked/slow.render.png"));
}

TEST(BatchStop, KilledAtRandomMomentsAndGoneOnFrom) {
  const fs::path whole = job_folder("batch_whole", grids);
  ASSERT_EQ(ivory(whole, "batch job.toml -q").exit_code, 0);
  const fs::path folder = job_folder("batch_killed", grids);
  std::mt19937 random(7);
  std::uniform_int_distribution<int> moment_ms(0, 900);
  for (int kills = 0; kills < 8; ++kills) {
    BackgroundRun run(folder, "batch job.toml -q");
    std::this_thread::sleep_for(std::chrono::milliseconds(moment_ms(random)));
    run.signal(SIGKILL);
    run.end();
  }
  const Outcome outcome = ivory(folder, "batch job.toml");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  expect_same_grids(folder, whole);
}

}  // namespace

}  // namespace ivory::script
