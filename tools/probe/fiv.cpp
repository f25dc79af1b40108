// ivory probe TABLE.exr: irradiance that an occluder hides, from its FIV table.
#include "grid/io/fiv.h"

#include <memory>

#include <tbb/parallel_for.h>

#include "grid/base/error.h"
#include "grid/io/exr.h"
#include "tools/probe/source.h"

namespace ivory {

namespace {

ProbeEstimates probe_fiv(Straddling straddling, const ProbeRequest& request) {
  if (request.indirect_only)
    throw UsageError("--indirect-only: an FIV table holds light straight from the environment only");
  const FivSet set = read_fiv_set(request.source);
  const FivTable& table = set.turns.front();
  if (set.turns.size() > 1)
    print_note(request.common, "note: " + request.source + " holds several turns; the mesh unturned is read");
  const PointsTable& points = request.table;
  ProbeEstimates out;
  out.e.resize(points.p.size());
  out.standard_error.resize(points.p.size(), Rgb(0, 0, 0));  // of the look-up alone: it is exact
  tbb::parallel_for(std::size_t(0), points.p.size(), [&](std::size_t i) {
    const V3f q = V3f(points.p[i]) / table.radius_m;
    out.e[i] = hidden_irradiance(table, lookup(table, q), points.n[i], -q.dot(points.n[i]), straddling);
  });
  out.facts = {{"source", std::string("fiv")},
               {"irradiance", std::string("hidden")},
               {"hemispheres", std::int64_t(table.hemispheres)}};
  return out;
}

}  // namespace

ProbeSource make_fiv_source(Command command) {
  auto straddling = std::make_shared<Straddling>(Straddling::bound);
  command
      .add_choice("--straddling", *straddling,
                  "FIV tables: occluders that reach below a point's plane; bound, or the published scale")
      .group("For FIV tables: E that the occluder hides; x,y,z relative to its bounding sphere's centre");
  ProbeSource source;
  source.name = "FIV tables";
  source.options = {"--straddling"};
  source.matches = [](const std::string& path) { return exr_asset_kind(path) == "fiv"; };
  source.probe = [straddling](const ProbeRequest& request) { return probe_fiv(*straddling, request); };
  return source;
}

}  // namespace ivory
