// ivory render to a measured error, and its checkpoints: killed, stopped and gone on from, to the same bytes.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>

#include "grid/io/image_codec.h"
#include "tests/tools/background_run.h"

namespace ivory::script {

namespace {

// Grey, so that the error of the three channels alike is that of luminance.
const std::string room = std::string(source_folder) + "/scenes/room_boxes.gltf";
const std::string small = "render " + room + " --size 64x48 ";

Json run(const fs::path& folder, const std::string& arguments) {
  const Outcome outcome = ivory(folder, arguments + " --json");
  EXPECT_EQ(outcome.exit_code, 0) << arguments << "\n" << outcome.err;
  return outcome.exit_code == 0 ? Json::parse(outcome.out) : Json();
}

double true_error(const fs::path& folder, const std::string& picture) {
  const Json found = run(folder, "compare " + picture + " truth.exr");
  return found["rmse"].get<double>() / found["reference_mean"].get<double>();
}

// The reference's noise is a third of the pictures', 5 % more in the sum of squares. 3,072 pixels know an error to 2 %.
TEST(RenderToAnError, IsAsItIsStated) {
  const fs::path folder = scratch_folder("picture_error");
  run(folder, small + "-o truth.exr --samples 1024 --seed 7");
  const Json result = run(folder, small + "-o p.exr --target-error 10%");
  const double stated = result["error"]["pixel"];
  EXPECT_EQ(result["error"]["met"], true);
  EXPECT_LE(stated, 0.1);
  EXPECT_GT(stated, 0.08);
  EXPECT_GT(stated / true_error(folder, "p.exr"), 0.8);
  EXPECT_LT(stated / true_error(folder, "p.exr"), 1.25);
  EXPECT_GE(result["samples_least"], 16);
  EXPECT_LT(result["samples_least"], result["samples_mean"]);
  EXPECT_LT(result["samples_mean"], result["samples_most"]);
  // The file says the same, and no time: that would differ from run to run.
  const Json info = run(folder, "info p.exr");
  EXPECT_NEAR(info["noise"].get<double>(), stated, 1e-6);
  EXPECT_NEAR(info["target_error"].get<double>(), 0.1, 1e-6);
  EXPECT_EQ(info["samples_least"], result["samples_least"]);
  EXPECT_FALSE(info.contains("render_seconds"));
  ASSERT_EQ(ivory(folder, small + "-o q.exr --threads 1 --target-error 0.1").exit_code, 0);
  EXPECT_EQ(read_file(folder / "p.exr"), read_file(folder / "q.exr"));
}

TEST(RenderToAnError, SaysWhatEndedIt) {
  const fs::path folder = scratch_folder("picture_bounds");
  const Json bounded = run(folder, small + "-o p.exr --target-error 1% --max-samples 32");
  EXPECT_EQ(bounded["error"]["met"], false);
  EXPECT_EQ(bounded["samples_most"], 32);
  EXPECT_NE(bounded["warnings"].dump().find("misses the asked-for 1 %, bounded by --max-samples"), std::string::npos)
      << bounded["warnings"];
  const Json timed = run(folder, small + "-o p.exr -f --target-error 0.1% --max-time 0.2");
  EXPECT_EQ(timed["error"]["out_of_time"], true);
  EXPECT_NE(timed["warnings"].dump().find("bounded by --max-time"), std::string::npos) << timed["warnings"];
  EXPECT_TRUE(run(folder, "info p.exr").contains("render_seconds"));
  const Json free = run(folder, small + "-o p.exr -f --max-time 0.2");
  EXPECT_EQ(free["error"]["out_of_time"], true);
  EXPECT_TRUE(free["warnings"].empty());
  // Light without noise is done after the first round.
  const Json still = run(folder, "render " + std::string(source_folder) + "/scenes/furnace_box.gltf --size 64x48 " +
                                     "-o p.exr -f --target-error 1% --max-bounces 0");
  EXPECT_EQ(still["error"]["pixel"], 0.0);
  EXPECT_EQ(still["samples_most"], 16);
}

TEST(RenderToAnError, RefusesWhatDoesNotGoTogether) {
  const fs::path folder = scratch_folder("picture_refusals");
  for (const std::string options :
       {"--samples 64 --target-error 5%", "--samples 64 --max-time 3", "--max-samples 64", "--target-error 0",
        "--target-error 5", "--max-time 0", "--max-time never", "--target-error 5% --max-samples 15",
        "--max-time 3 --checkpoint 1", "--checkpoint -1"}) {
    const Outcome outcome = ivory(folder, small + "-o p.exr " + options);
    EXPECT_EQ(outcome.exit_code, 2) << options;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_FALSE(fs::exists(folder / "p.exr"));
  }
}

// What other programs' denoisers take, and ivory's own.
TEST(RenderFilter, LayersAndFilterAreInTheFile) {
  const fs::path folder = scratch_folder("picture_filter");
  run(folder, small + "-o truth.exr --samples 512 --seed 7");
  run(folder, small + "-o noisy.exr --samples 16");
  const Json result = run(folder, small + "-o p.exr -o p.png --samples 16 --filter --layers");
  EXPECT_LT(result["filter"]["error"], result["filter"]["unfiltered_error"]);
  EXPECT_LE(result["filter"]["error"], result["filter"]["high"]);
  EXPECT_LT(true_error(folder, "p.exr"), 0.5 * true_error(folder, "noisy.exr"));
  const Json info = run(folder, "info p.exr");
  EXPECT_EQ(info["filter"], "non-local means with features");
  EXPECT_TRUE(info.contains("filter_error"));
  std::string cause;
  const auto image = image_codec().open((folder / "p.exr").string(), cause);
  ASSERT_TRUE(image) << cause;
  std::vector<std::string> names = image->header.channel_names;
  std::sort(names.begin(), names.end());
  const std::vector<std::string> expected{"B",       "G",        "N.X",      "N.Y",      "N.Z",     "R",
                                          "Z",       "albedo.B", "albedo.G", "albedo.R", "error.B", "error.G",
                                          "error.R", "noisy.B",  "noisy.G",  "noisy.R"};
  EXPECT_EQ(names, expected);
  const std::size_t count = names.size();
  std::vector<float> pixels(count * 64 * 48);
  ASSERT_EQ(image->read(int(count), PixelType::float32, pixels.data()), "");
  const auto channel = [&](const std::string& name) {
    const std::vector<std::string>& in_file = image->header.channel_names;
    return std::size_t(std::find(in_file.begin(), in_file.end(), name) - in_file.begin());
  };
  // The room is closed and of one albedo, normals are unit vectors but where two faces share a pixel.
  int unit = 0;
  double albedo = 0;
  for (std::size_t i = 0; i < 64 * 48; ++i) {
    const float* pixel = &pixels[i * count];
    const float x = pixel[channel("N.X")];
    const float y = pixel[channel("N.Y")];
    const float z = pixel[channel("N.Z")];
    if (std::abs(x * x + y * y + z * z - 1) < 1e-4F) ++unit;
    EXPECT_GT(pixel[channel("Z")], 0);
    EXPECT_LT(pixel[channel("Z")], 20);
    albedo += double(pixel[channel("albedo.G")]) / (64 * 48);
  }
  EXPECT_GT(unit, 0.8 * 64 * 48);
  EXPECT_NEAR(albedo, 0.7, 0.01);
  const Outcome outcome = ivory(folder, small + "-o q.png --layers");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("only .exr keeps layers"), std::string::npos) << outcome.err;
}

const fs::path checkpoint_name = "p.checkpoint.exr";

double samples_done(const fs::path& folder) {
  const Json info = run(folder, "info " + checkpoint_name.string());
  return info["samples_mean"].get<double>();
}

// Each time some samples further.
TEST(RenderCheckpoint, KilledAndGoneOnFrom) {
  for (const std::string options : {"--samples 128", "--target-error 9%"}) {
    SCOPED_TRACE(options);
    const fs::path folder = scratch_folder("picture_checkpoint");
    const std::string command = small + "-o p.png -o p.exr " + options;
    ASSERT_EQ(ivory(folder, small + "-o whole.png -o whole.exr --checkpoint 0 " + options).exit_code, 0);
    double last = 0;
    for (int kills = 0; kills < 3; ++kills) {
      const auto before = written(folder / checkpoint_name);
      BackgroundRun background(folder, command + " -q --checkpoint 0.00007" + (kills == 1 ? " --threads 1" : ""));
      wait_for_checkpoint(background, folder / checkpoint_name, before);
      std::this_thread::sleep_for(std::chrono::milliseconds(40 * kills));
      background.signal(SIGKILL);
      if (background.end() == 0) break;  // it was faster
      EXPECT_FALSE(fs::exists(folder / "p.png"));
      const double now = samples_done(folder);
      EXPECT_GT(now, last);
      last = now;
    }
    if (!fs::exists(folder / "p.png")) {
      // It is a picture, too.
      EXPECT_EQ(ivory(folder, "compare p.checkpoint.exr whole.exr").exit_code, 0);
      const Json result = run(folder, command);
      EXPECT_TRUE(result["checkpoint"].contains("resumed_samples"));
    }
    EXPECT_EQ(read_file(folder / "p.png"), read_file(folder / "whole.png"));
    EXPECT_EQ(read_file(folder / "p.exr"), read_file(folder / "whole.exr"));
    EXPECT_FALSE(fs::exists(folder / checkpoint_name));
  }
}

TEST(RenderCheckpoint, SignalsLeaveOne) {
  const fs::path folder = scratch_folder("picture_signals");
  const std::string command = small + "-o p.exr --samples 100000 ";
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto before = written(folder / checkpoint_name);
    BackgroundRun background(folder, command + "--checkpoint 0.00007");
    wait_for_checkpoint(background, folder / checkpoint_name, before);
    background.signal(signal);
    ASSERT_EQ(background.end(), 128 + signal) << background.said();
    EXPECT_NE(background.said().find("the same command goes on from p.checkpoint.exr"), std::string::npos)
        << background.said();
    EXPECT_FALSE(fs::exists(folder / "p.exr"));
  }
  // Another picture's is not overwritten unasked, and a damaged one is not read.
  for (const std::string other : {"--samples 10 ", "--samples 100000 --seed 2 "}) {
    const Outcome outcome = ivory(folder, small + "-o p.exr " + other);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.err.find("p.checkpoint.exr: holds the unfinished picture of another command (its "),
              std::string::npos)
        << outcome.err;
  }
  std::string bytes = read_file(folder / checkpoint_name);
  bytes[bytes.size() / 2] = char(bytes[bytes.size() / 2] ^ 1);
  write_file(folder / checkpoint_name, bytes);
  EXPECT_EQ(ivory(folder, command).exit_code, 1);
  const Outcome outcome = ivory(folder, small + "-o p.exr -f --samples 10");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("is not gone on from"), std::string::npos) << outcome.err;
}

}  // namespace

}  // namespace ivory::script
