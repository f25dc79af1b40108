// ivory probe on SH9 and DifMap: an environment's irradiance for the points' normals, unshadowed.
#include <tbb/parallel_for.h>

#include "grid/error.h"
#include "grid/io_difmap.h"
#include "grid/io_sh9.h"
#include "tools/probe_source.h"

namespace ivory {

namespace {

template <typename Irradiance>
ProbeEstimates probe_normals(const ProbeRequest& request, const char* source, const Irradiance& irradiance_of) {
  // All of it is light straight from its source.
  if (request.indirect_only) throw UsageError("--indirect-only serves grids and scenes only");
  ProbeEstimates out;
  out.e.resize(request.table.n.size());
  out.standard_error.assign(request.table.n.size(), Rgb(0, 0, 0));
  tbb::parallel_for(std::size_t(0), out.e.size(), [&](std::size_t i) { out.e[i] = irradiance_of(request.table.n[i]); });
  out.facts = {{"source", std::string(source)}};
  return out;
}

}  // namespace

ProbeSource make_sh9_source() {
  ProbeSource source;
  source.name = "SH9 files";
  source.matches = is_sh9_name;
  source.probe = [](const ProbeRequest& request) {
    const Sh9MatricesF matrices = to_float(sh9_matrices(read_sh9(request.source).sh));
    return probe_normals(request, "sh9", [&](const V3f& n) { return irradiance(matrices, n); });
  };
  return source;
}

ProbeSource make_difmap_source() {
  ProbeSource source;
  source.name = "DifMaps";
  source.matches = is_difmap;
  source.probe = [](const ProbeRequest& request) {
    const DifMap map = read_difmap(request.source);
    return probe_normals(request, "difmap", [&](const V3f& n) { return irradiance(map, n); });
  };
  return source;
}

}  // namespace ivory
