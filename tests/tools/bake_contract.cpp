// ivory bake grid --target-error: the contract from the command line to the file.
#include "tests/support/command_test.h"

namespace ivory {
namespace {

class BakeContract : public CommandTest {};

TEST_F(BakeContract, IsMetAndCertified) {
  const std::string bake = "bake grid " + scene("room_boxes.gltf") + " --target-error ";
  {
    constexpr double share = 0.12;
    const auto result = run(bake + "12% --threads 2 -f -o " + path("room.vdb"));
    const auto& certificate = result["certificate"];
    EXPECT_EQ(certificate["target"], share);
    EXPECT_TRUE(certificate["met"]) << certificate;
    EXPECT_LT(certificate["low"], certificate["error"]);
    EXPECT_GT(certificate["high"], certificate["error"]);
    const double noise = certificate["parts"]["noise"];
    const double resolution = certificate["parts"]["resolution"];
    EXPECT_GT(noise, 0);
    EXPECT_GT(resolution, noise / 10);
    // No more than is needed: what was asked for is nearly used up.
    EXPECT_GT(certificate["error"], 0.4 * share);
    EXPECT_FALSE(certificate["worst"].empty());

    const auto info = run("info " + path("room.vdb"));
    for (const char* key : {"target", "error", "low", "high", "measure", "parts"})
      EXPECT_EQ(info["certificate"][key], certificate[key]) << key;
    EXPECT_EQ(info["certificate"]["worst"].size(), certificate["worst"].size());
    const std::string text = run_ivory("info " + path("room.vdb")).output;
    EXPECT_NE(text.find("certificate"), std::string::npos);
    EXPECT_NE(text.find("within the asked-for"), std::string::npos);
  }
  const std::string bytes = bytes_of(path("room.vdb"));
  run(bake + "0.12 --threads 3 -f -o " + path("again.vdb"));
  EXPECT_TRUE(bytes == bytes_of(path("again.vdb"))) << "threads leave a trace";
}

TEST_F(BakeContract, SaysItsPlanAndWritesNothing) {
  const auto plan =
      run("bake grid " + scene("leak_axis.gltf") + " --target-error 15% --dry-run -o " + path("x.vdb"))["plan"];
  EXPECT_FALSE(std::filesystem::exists(path("x.vdb")));
  EXPECT_TRUE(std::filesystem::is_empty(path("")));
  EXPECT_GT(plan["photons"], 0);
  for (const char* key : {"error", "seconds", "memory_bytes", "file_bytes"}) {
    EXPECT_LE(plan[key]["low"], plan[key]["expected"]) << key;
    EXPECT_LE(plan[key]["expected"], plan[key]["high"]) << key;
    EXPECT_GT(plan[key]["expected"], 0) << key;
  }
}

TEST_F(BakeContract, KeepsWhatIsGiven) {
  const std::string bake = "bake grid " + scene("leak_axis.gltf") + " -f -o " + path("x.vdb") + " ";
  const auto given = run(bake + "--resolution 12,6,9 --photons 5k --target-error 5%");
  EXPECT_EQ(given["resolution"], nlohmann::json({12, 6, 9}));
  EXPECT_EQ(given["photons"], 5'000);
  EXPECT_FALSE(given["certificate"]["met"]);
  EXPECT_NE(given["warnings"].dump().find("misses the asked-for"), std::string::npos);

  const auto small = run(bake + "--max-memory 8m --target-error 2% --dry-run")["plan"];
  EXPECT_LE(small["memory_bytes"]["low"], 8e6);
  EXPECT_NE(small["limited_by"].get<std::string>().find("memory"), std::string::npos);

  const auto quick = run(bake + "--max-time 1 --target-error 3%");
  EXPECT_FALSE(quick["certificate"]["met"]);
  EXPECT_NE(quick["warnings"].dump().find("--max-time"), std::string::npos);
  EXPECT_EQ(run("info " + path("x.vdb"))["contract_max_time_s"], 1);
}

TEST_F(BakeContract, ByPointsOfTheUsers) {
  std::ofstream(path("p.csv"))
      << "x,y,z,nx,ny,nz,weight\n-1.5,1,0,0,1,0,1\n-1,0.5,0.5,0,0,1,2\n1,1,0,0,1,0,0\n-1,1,-0.5,1,0,0,1\n";
  const auto result = run("bake grid " + scene("leak_axis.gltf") + " -o " + path("x.vdb") +
                          " --target-error 15% --resolution 10 --photons 50k --error-points " + path("p.csv"));
  EXPECT_NE(result["certificate"]["measure"].get<std::string>().find("4 given points"), std::string::npos);
}

TEST_F(BakeContract, RefusesWhatDoesNotGoTogether) {
  const std::string bake = "bake grid " + scene("leak_axis.gltf") + " -o " + path("x.vdb") + " ";
  for (const char* share : {"0", "-1%", "2", "101%", "nan", "2%%", "two"})
    expect_one_line(bake + "--target-error " + share, 2, "is no share between 0 and 100 %");
  expect_one_line(bake + "--target-error 2% --photons 2m --photon-range 0:1m", 2, "--photon-range");
  expect_one_line(bake + "--photons 2k --max-time 3", 2, "--target-error");
  expect_one_line(bake + "--photons 2k --error-domain space", 2, "--target-error");
  expect_one_line(bake + "--target-error 2% --max-time 0", 2, "--max-time");
  expect_one_line(bake + "--target-error 2% --max-memory 1", 1, "GiB");
  expect_one_line(bake + "--target-error 2% --error-domain space --dynamic none", 2, "--error-domain");
  std::ofstream(path("one.csv")) << "x,y,z,nx,ny,nz\n0,1,0,0,1,0\n";
  expect_one_line(bake + "--target-error 2% --error-points " + path("one.csv"), 1, "one point");
  EXPECT_FALSE(std::filesystem::exists(path("x.vdb")));
}

}  // namespace
}  // namespace ivory
