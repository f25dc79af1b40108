// ivory probe MAP.exr: irradiance read from a localized cube map.
#include "grid/io/cubemap.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "grid/base/error.h"
#include "grid/cubemap/reader.h"
#include "grid/io/exr.h"
#include "tools/probe/source.h"

namespace ivory {

namespace {

ProbeEstimates probe_cubemap(CubeMethod method, const ProbeRequest& request) {
  if (request.indirect_only)
    throw UsageError("--indirect-only: a cube map holds all light that it saw and cannot leave out any");
  const PointsTable& table = request.table;
  const LocalizedCube cube = read_localized_cube(request.source);
  const std::vector<V3f> points = local_points(table, cube.anchor_m);
  const CubeReader reader = make_cube_reader(cube, method);
  ProbeEstimates out;
  out.e.resize(table.p.size());
  out.standard_error.resize(table.p.size(), Rgb(0, 0, 0));  // of the look-up alone: it is exact
  tbb::parallel_for(std::size_t(0), table.p.size(),
                    [&](std::size_t i) { out.e[i] = irradiance(reader, points[i], table.n[i]); });
  const auto outside = std::count_if(points.begin(), points.end(), [&](const V3f& p) {
    const V3f offset = p - cube.origin_m;
    return inside_shell(cube, offset) != offset;
  });
  if (outside > 0) {
    out.doubts.push_back(
        fmt::format("{} of {} points lie outside of what the map has seen and read "
                    "its nearest point towards the reference point",
                    outside, table.p.size()));
  }
  out.facts = {
      {"source", std::string("cubemap")}, {"lookup", std::string(name_of(method))}, {"outside", std::int64_t(outside)}};
  return out;
}

}  // namespace

ProbeSource make_cubemap_source(Command command) {
  auto lookup = std::make_shared<CubeMethod>(CubeMethod::polygon);
  command
      .add_choice("--lookup", *lookup,
                  "How a cube map is read: texels as polygons, polygons as published, points, or by an\n"
                  "irradiance map of 6x16x16 texels convolved at the reference point, distances ignored")
      .group("For cube maps");
  ProbeSource source;
  source.name = "cube maps";
  source.options = {"--lookup"};
  source.matches = [](const std::string& path) { return exr_asset_kind(path) == "cubemap"; };
  source.probe = [lookup](const ProbeRequest& request) { return probe_cubemap(*lookup, request); };
  return source;
}

}  // namespace ivory
