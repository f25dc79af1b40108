// ivory bake grid --checkpoint: killed, stopped and gone on from, to the bytes of a bake that nothing stopped.
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "tests/tools/background_run.h"

namespace ivory::script {

namespace {

const std::string room = std::string(source_folder) + "/scenes/room_boxes.gltf";

// Photons in the checkpoint.
std::int64_t done(const fs::path& folder) {
  const Outcome outcome = ivory(folder, "info x.checkpoint.vdb --json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  if (outcome.exit_code != 0) return 0;
  const Json info = Json::parse(outcome.out);
  return info["photon_end"].get<std::int64_t>() - info["photon_begin"].get<std::int64_t>();
}

// SIGKILL whenever a new checkpoint is there, and at random moments after that; each time some photons further. 4 ms
// between two: as often as their cost allows.
void kill_and_go_on(const fs::path& folder, const std::string& bake, unsigned seed) {
  const std::string often = bake + " -o x.vdb -q --checkpoint 0.00007";
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> delay_ms(0, 150);
  std::int64_t last = 0;
  for (int kills = 0; kills < 3; ++kills) {
    const fs::path checkpoint = folder / "x.checkpoint.vdb";
    const auto before = written(checkpoint);
    BackgroundRun run(folder, often + (kills % 2 == 0 ? " --threads 1" : ""));
    wait_for_checkpoint(run, checkpoint, before);
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms(random)));
    run.signal(SIGKILL);
    if (const int code = run.end(); code == 0) break;  // it was faster
    EXPECT_FALSE(fs::exists(folder / "x.vdb"));
    const std::int64_t now = done(folder);
    EXPECT_GT(now, last);
    last = now;
  }
  if (fs::exists(folder / "x.vdb")) return;
  const Outcome outcome = ivory(folder, bake + " -o x.vdb --json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(Json::parse(outcome.out)["checkpoint"]["resumed_photons"], last);
  EXPECT_NE(outcome.err.find("going on from " + std::to_string(last)), std::string::npos) << outcome.err;
}

TEST(BakeCheckpoint, KilledAndGoneOnFrom) {
  const std::string base = "bake grid " + room + " --resolution 8 --seed 3 ";
  unsigned seed = 0;
  for (const std::string options :
       {"--photons 600k", "--photons 400k --levels 2 --groups extras", "--photons 600k --photon-range 100k:500k"}) {
    SCOPED_TRACE(options);
    const fs::path folder = scratch_folder("checkpoint");
    ASSERT_EQ(ivory(folder, base + options + " -o whole.vdb -q --checkpoint 0").exit_code, 0);
    kill_and_go_on(folder, base + options, ++seed);
    EXPECT_EQ(read_file(folder / "x.vdb"), read_file(folder / "whole.vdb"));
    EXPECT_FALSE(fs::exists(folder / "x.checkpoint.vdb"));
  }
}

// Pilots are baked again, and what was measured between the rounds is not.
TEST(BakeCheckpoint, OfABakeToAnError) {
  const fs::path folder = scratch_folder("checkpoint_error");
  const std::string bake = "bake grid " + scene + " --target-error 8% ";
  ASSERT_EQ(ivory(folder, bake + "-o whole.vdb -q").exit_code, 0);
  kill_and_go_on(folder, bake, 5);
  EXPECT_EQ(read_file(folder / "x.vdb"), read_file(folder / "whole.vdb"));
  EXPECT_FALSE(fs::exists(folder / "x.checkpoint.vdb"));
}

TEST(BakeCheckpoint, SignalsLeaveOne) {
  const fs::path folder = scratch_folder("checkpoint_signals");
  const fs::path checkpoint = folder / "x.checkpoint.vdb";
  const std::string bake = "bake grid " + room + " --resolution 8 --photons 1m ";
  ASSERT_EQ(ivory(folder, bake + "-o whole.vdb -q").exit_code, 0);
  for (const int signal : {SIGINT, SIGTERM}) {
    // At a moment when photons fly, which a checkpoint shows; it is written anew then.
    const auto before = written(checkpoint);
    BackgroundRun run(folder, bake + "-o x.vdb -f --checkpoint 0.00007");
    wait_for_checkpoint(run, checkpoint, before);
    run.signal(signal);
    ASSERT_EQ(run.end(), 128 + signal) << run.said();
    const std::string said = run.said();
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), signal == SIGINT ? 1 : 2) << said;
    EXPECT_NE(said.find("the same command goes on from x.checkpoint.vdb"), std::string::npos) << said;
    EXPECT_FALSE(fs::exists(folder / "x.vdb"));
  }
  ASSERT_EQ(ivory(folder, bake + "-o x.vdb").exit_code, 0);
  EXPECT_EQ(read_file(folder / "x.vdb"), read_file(folder / "whole.vdb"));
  // A job in the background ignores Ctrl-C, and goes on doing so.
  BackgroundRun job(folder, bake + "-o x.vdb -f -q --checkpoint 0.00007", SIGINT);
  wait_for_checkpoint(job, checkpoint, fs::file_time_type::min());
  job.signal(SIGINT);
  job.signal(SIGINT);
  job.signal(SIGTERM);
  EXPECT_EQ(job.end(), 128 + SIGTERM);
}

TEST(BakeCheckpoint, OthersAndDamageAreRefused) {
  const fs::path folder = scratch_folder("checkpoint_foreign");
  const std::string bake = "bake grid " + room + " --resolution 8 -o x.vdb ";
  {
    BackgroundRun run(folder, bake + "--photons 1m --checkpoint 0.00007 -q");
    wait_for(run, [&] { return fs::exists(folder / "x.checkpoint.vdb"); });
    run.signal(SIGKILL);
    run.end();
  }
  const std::string checkpoint = read_file(folder / "x.checkpoint.vdb");
  const auto expect_refused = [&](const std::string& arguments, const std::string& text) {
    const Outcome outcome = ivory(folder, arguments);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find("x.checkpoint.vdb"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "x.vdb"));
    EXPECT_EQ(read_file(folder / "x.checkpoint.vdb"), checkpoint);
  };
  expect_refused(bake + "--photons 20k", "photons is 1000000, here 20000");
  expect_refused(bake + "--photons 1m --seed 2", "seed is 1, here 2");
  expect_refused("bake grid " + scene + " --resolution 8 -o x.vdb --photons 1m", "another command");
  expect_refused(bake + "--target-error 20%", "its scene or options differ");

  // Given up where files may be overwritten; left alone where no checkpoint is asked for.
  const Outcome anew = ivory(folder, bake + "--photons 20k --force --json");
  ASSERT_EQ(anew.exit_code, 0) << anew.err;
  EXPECT_NE(anew.err.find("warning: x.checkpoint.vdb: is not gone on from"), std::string::npos) << anew.err;
  const Outcome without = ivory(folder, bake + "--photons 20k --force --json --checkpoint 0");
  ASSERT_EQ(without.exit_code, 0) << without.err;
  EXPECT_NE(without.err.find("warning: x.checkpoint.vdb"), std::string::npos) << without.err;
  EXPECT_EQ(read_file(folder / "x.checkpoint.vdb"), checkpoint);

  // It is a part, and a preview.
  fs::remove(folder / "x.vdb");
  const std::string rest = std::to_string(done(folder)) + ":1m";
  ASSERT_EQ(ivory(folder, "bake grid " + room + " --resolution 8 --photons 1m --photon-range " + rest + " -o rest.vdb")
                .exit_code,
            0);
  ASSERT_EQ(ivory(folder, "merge rest.vdb x.checkpoint.vdb -o merged.vdb").exit_code, 0);
  ASSERT_EQ(ivory(folder, bake + "--photons 1m").exit_code, 0);
  EXPECT_EQ(read_file(folder / "merged.vdb"), read_file(folder / "x.vdb"));
  fs::remove(folder / "x.vdb");

  write_file(folder / "x.checkpoint.vdb", checkpoint.substr(0, checkpoint.size() - 100));
  const Outcome damaged = ivory(folder, bake + "--photons 1m");
  EXPECT_EQ(damaged.exit_code, 1);
  EXPECT_NE(damaged.err.find("x.checkpoint.vdb: is damaged or cut short"), std::string::npos) << damaged.err;
}

// Before photons fly there is nothing to keep, and nobody waits: half a million vertices of which each is to find what
// it sees take far longer than that.
TEST(BakeCheckpoint, LeavesBeforeTheFirstPhoton) {
  const fs::path folder = scratch_folder("checkpoint_early");
  BackgroundRun run(folder, "bake grid " + room + " --resolution 128,64,128 --photons 1g -o x.vdb --threads 1");
  std::this_thread::sleep_for(std::chrono::milliseconds(700));  // it loads, or finds what vertices see
  run.signal(SIGTERM);
  const int code = run.end();
  EXPECT_TRUE(code == 128 + SIGTERM || code == -SIGTERM) << code << run.said();
  EXPECT_FALSE(fs::exists(folder / "x.vdb"));
}

TEST(BakeCheckpoint, OthersKeepNone) {
  const fs::path folder = scratch_folder("checkpoint_none");
  for (const std::string words : {"bake lobes", "bake spheres m.glb", "bake difmap e.hdr", "bake sh9 e.hdr",
                                  "bake fiv m.glb --env e.hdr", "bake cubemap m.glb --at 0,0,0"}) {
    const Outcome outcome = ivory(folder, words + " -o x.exr --checkpoint 5");
    EXPECT_EQ(outcome.exit_code, 2) << words;
    EXPECT_NE(outcome.err.find("keeps none; only 'ivory bake grid' does"), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(ivory(folder, "bake grid " + scene + " -o x.vdb --target-error 5% --max-time 9 --checkpoint 1").exit_code,
            2);
  EXPECT_EQ(ivory(folder, "bake grid " + scene + " -o x.vdb --checkpoint -1").exit_code, 2);
  EXPECT_EQ(ivory(folder, "bake grid " + scene + " -o x.vdb --checkpoint nan").exit_code, 2);
}

}  // namespace

}  // namespace ivory::script
