// ivory bench cubemap: what reading E(p, n) from a localized cube map costs.
#include "grid/io/cubemap.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <time.h>

#include "grid/cubemap/reader.h"
#include "tools/bench/median.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tracer/core/sampler.h"
#include "tracer/core/sampling.h"

namespace ivory {
namespace {

constexpr std::array<CubeMethod, 4> methods{CubeMethod::convolved, CubeMethod::point, CubeMethod::polygon_paper,
                                            CubeMethod::polygon};

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
  return median(times);
}

void run(const std::vector<std::string>& paths, const CommonOptions& common) {
  nlohmann::ordered_json maps = nlohmann::ordered_json::array();
  std::string text;
  for (const std::string& path : paths) {
    const LocalizedCube cube = read_localized_cube(path);
    const int size = cube.radiance.size;
    const std::vector<Point> points = make_points(cube, std::max(10, 100'000 / (size * size)));
    nlohmann::ordered_json map{{"file", path}, {"size", size}};
    text += fmt::format("{}: 6x{}x{} texels\n", path, size, size);
    for (const CubeMethod method : methods) {
      const CubeReader reader = make_cube_reader(cube, method);
      const double ns = evaluation_ns(points, [&](const Point& point) { return irradiance(reader, point.p, point.n); });
      const std::string key(name_of(method));
      map[key + "_ns"] = ns;
      map[key + "_bytes"] = reader.bytes;
      text += fmt::format("  {:<13} {:>9.0f} ns  {:>9}\n", key, ns, format_bytes(reader.bytes));
    }
    maps.push_back(map);
  }
  print_result(common, {{"maps", maps}}, text);
}

}  // namespace

void add_bench_cubemap_command(Command bench, CommonOptions& common) {
  Command command =
      bench.add_subcommand("cubemap",
                           "Time of one reading of a localized cube map on one thread, and the memory that "
                           "it reads from, for each --lookup of ivory probe and render.");
  auto paths = std::make_shared<std::vector<std::string>>();
  command.add_option("MAPS", *paths, "Localized cube maps to read").required().type_name("MAP.exr");
  command.footer(
      "--json: for each map <lookup>_ns, the median of seven rounds in the thread's own time, and <lookup>_bytes:\n"
      "  convolved      the irradiance map of 6x16x16 texels convolved at the reference point\n"
      "  point, polygon_paper   radiance and distances: the map as stored\n"
      "  polygon        these and the walk over the texels' edges that is made of them\n"
      "\nExample:\n"
      "  ivory bench cubemap room_2.exr room_4.exr room_8.exr");
  set_action(command, common, Output::none, [paths, &common] { run(*paths, common); });
}

}  // namespace ivory
