// ivory bench cubemap: what reading E(p, n) from a localized cube map costs.
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <time.h>

#include "grid/cube_edges.h"
#include "grid/io_localized_cube.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tracer/sampler.h"
#include "tracer/sampling.h"

namespace ivory {
namespace {

constexpr std::array<CubeMethod, 3> methods{CubeMethod::point, CubeMethod::polygon_paper, CubeMethod::polygon};

// E(origin, n) for a few thousand normals, which `convolved` finds anew for each: what an engine would store.
CubeMap convolve(const LocalizedCube& cube) {
  CubeMap map;
  map.size = 32;
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < map.size; ++row) {
      for (int column = 0; column < map.size; ++column)
        map.texels.push_back(
            irradiance(cube, CubeMethod::convolved, cube.origin_m, cube_texel_direction(map.size, face, row, column)));
    }
  }
  return map;
}

// The thread's own time, so that other work on the machine does not count.
double thread_time_ns() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) * 1e9 + double(now.tv_nsec);
}

struct Point {
  V3f p;
  V3f n;
};

// Evenly along all directions, from the reference point to the shell; under the sky within a metre.
std::vector<Point> make_points(const LocalizedCube& cube, int count) {
  RandomStream random(1, StreamPurpose::test, 0);
  std::vector<Point> points;
  for (int i = 0; i < count; ++i) {
    const V3f w = sample_sphere(random.next2());
    const V3f edge = inside_shell(cube, w * 1e6F);
    const float reach = std::min(edge.length(), 1e3F);
    points.push_back({cube.origin_m + w * (reach * random.next()), sample_sphere(random.next2())});
  }
  return points;
}

// Median of several rounds, on one thread.
template <typename Evaluate>
double evaluation_ns(const std::vector<Point>& points, const Evaluate& evaluate) {
  constexpr std::size_t rounds = 7;
  std::vector<double> times;
  std::vector<Rgb> results(points.size());  // kept, so that the compiler keeps the work
  for (std::size_t round = 0; round < rounds; ++round) {
    const double start = thread_time_ns();
    for (std::size_t i = 0; i < points.size(); ++i) results[i] = evaluate(points[i]);
    times.push_back((thread_time_ns() - start) / double(points.size()));
  }
  std::nth_element(times.begin(), times.begin() + rounds / 2, times.end());
  return times[rounds / 2];
}

void run(const std::vector<std::string>& paths, const CommonOptions& common) {
  nlohmann::ordered_json maps = nlohmann::ordered_json::array();
  std::string text;
  for (const std::string& path : paths) {
    const LocalizedCube cube = read_localized_cube(path);
    const int size = cube.radiance.size;
    const std::vector<Point> points = make_points(cube, std::max(10, 100'000 / (size * size)));
    nlohmann::ordered_json map{{"file", path}, {"size", size}};
    const CubeEdges edges = make_cube_edges(cube);
    const CubeMap convolved = convolve(cube);
    const double lookup = evaluation_ns(points, [&](const Point& point) { return bilinear(convolved, point.n); });
    map["convolved_ns"] = lookup;
    text += fmt::format("{}: 6x{}x{} texels, convolved {:.0f} ns,", path, size, size, lookup);
    for (const CubeMethod method : methods) {
      const double ns =
          evaluation_ns(points, [&](const Point& point) { return irradiance(cube, edges, method, point.p, point.n); });
      map[std::string(name(method)) + "_ns"] = ns;
      text += fmt::format(" {} {:.0f} ns{}", name(method), ns, method == methods.back() ? "\n" : ",");
    }
    maps.push_back(map);
  }
  print_result(common, {{"maps", maps}}, text);
}

}  // namespace

void add_bench_cubemap_command(CLI::App& bench, CommonOptions& common) {
  CLI::App* command =
      bench.add_subcommand("cubemap", "Time of one reading of a localized cube map on one thread, in each way.");
  auto paths = std::make_shared<std::vector<std::string>>();
  command->add_option("MAPS", *paths, "Localized cube maps to read")->required()->type_name("MAP.exr");
  command->footer("Example:\n  ivory bench cubemap room_2.exr room_4.exr room_8.exr");
  set_action(*command, common, Output::none, [paths, &common] { run(*paths, common); });
}

}  // namespace ivory
