// --target-error, --certify and --dry-run of the bakes of all assets but grids, as a script meets them.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/command_test.h"
#include "tests/support/environment_pictures.h"
#include "tests/support/gltf_builder.h"
#include "tracer/image/file.h"

namespace ivory {
namespace {

using Json = nlohmann::json;

class AssetContracts : public CommandTest {
 protected:
  // A sky with a hard sun of one or two texels.
  std::string sunny() const {
    const V3d sun = V3d(0.5, 0.4, -0.6).normalized();
    const Picture picture = make_picture(EnvironmentLayout::latlong, 16, [&](const V3d& w) {
      return w.dot(sun) > 0.998 ? Rgb(900, 800, 600) : Rgb(1, 1.2F, 1.6F) * float(1.2 + w.y);
    });
    Film film;
    film.width = picture.width;
    film.height = picture.height;
    film.pixels = picture.texels;
    write_image(path("sunny.exr"), film, 0, {}, true);
    return path("sunny.exr");
  }
  // A wedge without symmetry.
  std::string wedge() const {
    GltfBuilder gltf;
    const int indices = gltf.add_indices({0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0});
    const int positions =
        gltf.add(std::vector<V3f>{{-0.5F, 0, -0.3F}, {0.6F, 0.1F, -0.2F}, {0, 0.05F, 0.6F}, {0.1F, 0.9F, 0}});
    gltf.add_node({{"mesh", gltf.add_mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}})}});
    return gltf.write("wedge");
  }

  // Bakes to a target, loose, tight and impossible, and looks at all that the contract promises. `knob` of a result
  // says how fine the asset is. Returns the results.
  std::vector<Json> check(const std::string& bake, const std::string& output, const std::vector<std::string>& targets,
                          const std::function<double(const Json&)>& knob) {
    std::vector<Json> results;
    std::string first;
    for (const std::string& target : targets) {
      const std::string asked = bake + " --target-error " + target;
      const bool impossible = &target == &targets.back();
      const Json result = run(asked + " -f --threads 2 -o " + path(output));
      const Json certificate = result["certificate"];
      EXPECT_EQ(certificate["met"], !impossible) << target << certificate;
      EXPECT_EQ(certificate["met"], certificate["error"] <= certificate["target"]);
      EXPECT_LE(certificate["low"], certificate["error"]);
      EXPECT_GE(certificate["high"], certificate["error"]);
      EXPECT_GT(certificate["error"], 0);
      EXPECT_NE(certificate["measure"].get<std::string>(), "");
      const Json warnings = result["warnings"];
      const std::string last = warnings.empty() ? "" : warnings.back().get<std::string>();
      EXPECT_EQ(last.find("misses the asked-for") != std::string::npos, impossible) << warnings;
      if (!results.empty()) {
        EXPECT_GE(knob(result), knob(results.back())) << target;
      }
      if (results.empty()) first = bytes_of(path(output));
      results.push_back(result);
      // The file says the same.
      EXPECT_EQ(run("info " + path(output))["certificate"], certificate);
      EXPECT_NE(run_ivory("info " + path(output)).output.find(impossible ? "MISSES" : "within the asked-for"),
                std::string::npos);
    }
    // A plan is what was done, and leaves nothing behind.
    const std::string asked = bake + " --target-error " + targets.front();
    const Json plan = run(asked + " --dry-run -o " + path("absent/planned_" + output))["plan"];
    EXPECT_TRUE(plan["meets"]) << plan;
    for (const char* key : {"seconds", "memory_bytes", "file_bytes", "error"}) {
      EXPECT_LE(plan[key]["low"], plan[key]["expected"]) << key;
      EXPECT_GE(plan[key]["high"], plan[key]["expected"]) << key;
    }
    EXPECT_FALSE(std::filesystem::exists(path("absent")));
    const auto size = double(first.size());
    EXPECT_GE(size, plan["file_bytes"]["low"]);
    EXPECT_LE(size, plan["file_bytes"]["high"]);
    run(asked + " -f --threads 3 -o " + path("three_" + output));
    EXPECT_TRUE(first == bytes_of(path("three_" + output))) << "threads leave a trace";
    return results;
  }
};

// E of a probe at 800 normals of its own, against that of the map summed over all of its texels: RMS ÷ mean.
TEST_F(AssetContracts, IrradianceOfASunnySky) {
  const std::string map = sunny();
  const auto size = [](const Json& result) { return result["size"].get<double>(); };
  const auto baked = check("bake difmap " + map + " --size 24", "e.exr", {"8%", "0.02", "0.0001%"}, size);
  EXPECT_LT(baked[0]["size"], baked[1]["size"]);
  EXPECT_LT(baked[1]["size"], 24);
  const auto order = [](const Json& result) { return result["order"].get<double>(); };
  const auto sh9 = check("bake sh9 " + map, "e.json", {"90%", "25%", "1%"}, order);
  EXPECT_LT(sh9[0]["order"], 2);
  EXPECT_EQ(sh9[2]["enough"], false);

  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  {
    std::ofstream points(path("p.csv"));
    points << "x,y,z,nx,ny,nz\n";
    for (int i = 0; i < 800; ++i) {
      const V3d n = V3d(normal(random), normal(random), normal(random)).normalized();
      points << "0,0,0," << n.x << "," << n.y << "," << n.z << "\n";
    }
  }
  const auto probed = [&](const std::string& source) {
    run("probe " + source + " --points " + path("p.csv") + " -f -o " + path("e.csv"));
    std::ifstream file(path("e.csv"));
    std::string line;
    std::getline(file, line);
    std::vector<double> e;
    while (std::getline(file, line)) {
      std::istringstream cells(line);
      std::string cell;
      for (int i = 0; i < 9 && std::getline(cells, cell, ','); ++i) {
        if (i >= 6) e.push_back(std::stod(cell));
      }
    }
    return e;
  };
  const std::vector<double> truth = probed(map);
  run("bake difmap " + map + " --target-error 3% -f -o " + path("e.exr"));
  for (const std::string& asset : {path("e.exr"), path("e.json")}) {
    const std::vector<double> e = probed(asset);
    ASSERT_EQ(e.size(), truth.size());
    double squares = 0;
    double sum = 0;
    for (std::size_t i = 0; i < e.size(); ++i) {
      squares += (e[i] - truth[i]) * (e[i] - truth[i]);
      sum += truth[i];
    }
    const double error = std::sqrt(squares / double(e.size())) / (sum / double(e.size()));
    const Json certificate = run("info " + asset)["certificate"];
    // The interval, a little wider: 800 normals have some 5 % of their own.
    EXPECT_GT(error, 0.9 * certificate["low"].get<double>()) << asset;
    EXPECT_LT(error, 1.1 * certificate["high"].get<double>()) << asset;
  }
}

TEST_F(AssetContracts, LobeTables) {
  const auto nodes = [](const Json& result) { return result["bytes"].get<double>(); };
  const std::string bake = "bake lobes --error-samples 100 --exponent-nodes 9 --angle-nodes 17";
  const auto baked = check(bake, "l.exr", {"5%", "0.5%", "0.001%"}, nodes);
  EXPECT_LT(baked[0]["bytes"], baked[1]["bytes"]);
  EXPECT_EQ(baked[2]["exponent_nodes"], 9);  // as far as it may go
  EXPECT_EQ(baked[2]["angle_nodes"], 17);
}

TEST_F(AssetContracts, SphereSets) {
  const auto count = [](const Json& result) { return result["count"].get<double>(); };
  const std::string bake = "bake spheres " + wedge() + " --resolution 20 --count 24";
  const auto baked = check(bake, "s.json", {"40%", "20%", "0.1%"}, count);
  EXPECT_LT(baked[0]["count"], baked[1]["count"]);
}

TEST_F(AssetContracts, OccluderTables) {
  const auto bytes = [](const Json& result) { return result["table_bytes"].get<double>(); };
  const std::string bake =
      "bake fiv " + wedge() + " --env " + sunny() + " --samples 16,9,6 --silhouette 64 --parts 512";
  const auto baked = check(bake, "t.exr", {"20%", "1.4%"}, bytes);
  EXPECT_LT(baked[0]["table_bytes"], baked[1]["table_bytes"]);
}

TEST_F(AssetContracts, CubeMaps) {
  const auto size = [](const Json& result) { return result["size"].get<double>(); };
  const std::string bake =
      "bake cubemap " + scene("room_boxes_rotated.gltf") + " --at 0.2,1,0.8 --capture 16 --samples 4 --size 4";
  const auto baked = check(bake, "c.exr", {"60%", "5%"}, size);
  EXPECT_LE(baked[0]["size"], baked[1]["size"]);
}

// What is measured without being asked for changes nothing but what the file says of it.
TEST_F(AssetContracts, CertifyChoosesNothing) {
  const std::string map = sunny();
  const Json plain = run("bake difmap " + map + " --size 8 -o " + path("plain.exr"));
  const Json certified = run("bake difmap " + map + " --size 8 --certify -o " + path("certified.exr"));
  EXPECT_FALSE(plain.contains("certificate"));
  EXPECT_FALSE(run("info " + path("plain.exr")).contains("certificate"));
  EXPECT_EQ(certified["size"], 8);
  EXPECT_FALSE(certified["certificate"].contains("target"));
  EXPECT_GT(certified["certificate"]["error"], 0);
  EXPECT_EQ(run("info " + path("certified.exr"))["certificate"], certified["certificate"]);
  const Json plan = run("bake difmap " + map + " --size 8 --dry-run -o " + path("x.exr"))["plan"];
  EXPECT_EQ(plan["knobs"]["size"], 8);
  // Both are of the same map at normals of their own.
  EXPECT_NEAR(plan["error"]["expected"].get<double>() / certified["certificate"]["error"].get<double>(), 1, 0.3);
  // A knob that is given bounds the choice.
  EXPECT_EQ(run("bake difmap " + map + " --size 6 --target-error 0.01% -o " + path("six.exr"))["size"], 6);
  expect_one_line("bake difmap " + map + " --target-error 2 -o " + path("y.exr"), 2, "--target-error");
  expect_one_line("bake sh9 " + map + " --target-error 2% --max-error 0.1 -o " + path("y.json"), 2, "--max-error");
  EXPECT_FALSE(std::filesystem::exists(path("y.exr")));
}

}  // namespace
}  // namespace ivory
