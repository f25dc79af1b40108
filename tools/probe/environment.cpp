// ivory probe on SH9, DifMaps and environment maps themselves: an environment's irradiance for the points' normals,
// unshadowed.
#include "grid/io/environment.h"

#include <algorithm>
#include <utility>

#include <tbb/parallel_for.h>

#include "grid/base/error.h"
#include "grid/env/irradiance/sum.h"
#include "grid/io/difmap.h"
#include "grid/io/sh9.h"
#include "tools/input/file_kind.h"
#include "tools/probe/source.h"

namespace ivory {

namespace {

// All of an environment is light straight from its source.
void refuse_indirect_only(const ProbeRequest& request) {
  if (request.indirect_only) throw UsageError("--indirect-only serves grids and scenes only");
}

template <typename Irradiance>
ProbeEstimates probe_normals(const ProbeRequest& request, const char* source, const Irradiance& irradiance_of) {
  refuse_indirect_only(request);
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

ProbeSource make_environment_source() {
  ProbeSource source;
  source.name = "environment maps";
  source.matches = [](const std::string& path) { return file_kind(path) == FileKind::image; };
  source.probe = [](const ProbeRequest& request) {
    refuse_indirect_only(request);
    LoadedEnvironment loaded = load_environment_image(request.source);
    print_warnings(request.common, loaded.warnings);
    const EnvironmentImage& image = loaded.image;
    const IrradianceSums sums = sum_irradiance(image, request.table.n);
    ProbeEstimates out;
    for (const V3d& e : sums.e) out.e.emplace_back(e);
    out.standard_error.assign(out.e.size(), Rgb(0, 0, 0));
    out.warnings = std::move(loaded.warnings);
    out.facts = {{"source", std::string("environment")},
                 {"layout", std::string(name_of(image.layout))},
                 {"error_bound_lux", std::max({sums.error_bound.x, sums.error_bound.y, sums.error_bound.z})}};
    out.facts.merge(loaded.facts);
    return out;
  };
  return source;
}

}  // namespace ivory
