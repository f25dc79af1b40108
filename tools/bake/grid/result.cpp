#include "tools/bake/grid/result.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/field/evidence.h"
#include "grid/io/json.h"
#include "grid/io/vdb/vdb.h"
#include "tools/bake/facts.h"

namespace ivory {

namespace {

std::uint64_t whole_photons(const GridAccumulator& accumulator) {
  return std::uint64_t(find_int(accumulator.metadata, "photons").value_or(0));
}

// Fractions of the power emitted; nothing where no ledger was kept.
Json ledger_json(const GridAccumulator& accumulator) {
  const auto counter = [&](const char* counter_name) {
    const auto found = accumulator.counters.find(counter_name);
    return found == accumulator.counters.end() ? 0.0 : static_cast<double>(found->second);
  };
  const double emitted = counter("ledger_emitted");
  if (!(emitted > 0)) return nullptr;
  return {{"absorbed", counter("ledger_absorbed") / emitted},
          {"escaped", counter("ledger_escaped") / emitted},
          {"terminated", counter("ledger_terminated") / emitted}};
}

// Bytes a stored vertex of what look-ups read: moments, visible fraction, compact guard.
std::int64_t bytes_read(const GridAccumulator& accumulator) {
  return std::int64_t(function_count(accumulator.basis)) * 3 * std::int64_t(sizeof(float)) +
         std::int64_t(sizeof(float)) + (accumulator.guard.empty() ? 0 : std::int64_t(sizeof(GuardRecord)));
}

// Of all that was added to the coarsest level's vertices, each group's part, whatever the direction.
Json groups_json(const GridAccumulator& accumulator) {
  const SumLayout layout = sum_layout(accumulator.basis, accumulator.estimator);
  // The moments of octants are of |w|, and the first of spherical harmonics is constant: neither is negative.
  const int counted = layout.slots == 1 ? 1 : layout.functions;
  const auto total = [&](const std::vector<std::int64_t>& sums) {
    double sum = 0;
    for (std::size_t slot = 0; slot < accumulator.vertex_count_of(0) * std::size_t(layout.slots); ++slot) {
      for (int i = 0; i < 3 * counted; ++i)
        sum += std::abs(double(sums[slot * std::size_t(layout.lanes()) + std::size_t(i)]));
    }
    return sum;
  };
  Json groups = Json::array();
  if (accumulator.groups.empty()) return groups;
  const double all = total(accumulator.sums);
  for (const SumGroup& group : accumulator.groups)
    groups.push_back({{"name", group.name}, {"share", all > 0 ? total(group.sums) / all : 0.0}});
  return groups;
}

double share(std::size_t part, std::size_t whole) { return whole == 0 ? 0 : double(part) / double(whole); }

}  // namespace

bool is_whole(const GridAccumulator& accumulator) {
  return accumulator.photon_begin == 0 && accumulator.photon_end == whole_photons(accumulator);
}

Json write_result(const std::string& path, GridAccumulator accumulator, bool finished, const CommonOptions& common) {
  const Evidence found = evidence(accumulator);
  const std::string doubt = few_photons_text(found);
  const Json groups = groups_json(accumulator);
  if (finished) {
    const IrradianceGrid grid = finish_grid(accumulator, doubt);
    write_vdb(path, grid, common.force);
  } else {
    write_vdb(path, accumulator, common.force);
  }
  const GridFrame& frame = accumulator.finest_frame();
  const auto stored = std::count_if(accumulator.visible_fraction.begin(), accumulator.visible_fraction.end(),
                                    [](float f) { return f > 0; });
  Json result{{"file", path},
              {"kind", finished ? "grid" : "sums"},
              {"bytes", std::filesystem::file_size(path)},
              {"resolution", {frame.size.x, frame.size.y, frame.size.z}},
              {"spacing_m", {shortest(frame.spacing_m.x), shortest(frame.spacing_m.y), shortest(frame.spacing_m.z)}},
              {"origin_m", shortest(frame.origin_m, accumulator.anchor_m)},
              {"vertices", accumulator.vertex_count()},
              {"vertices_stored", stored},
              {"memory_bytes", stored * bytes_read(accumulator)},
              {"photons", whole_photons(accumulator)},
              {"photon_range", {accumulator.photon_begin, accumulator.photon_end}},
              {"energy", ledger_json(accumulator)}};
  if (!groups.empty()) result["groups"] = groups;
  if (accumulator.levels() > 1) {
    result["levels"] = Json::array();  // the coarsest first
    for (int level = 0; level < accumulator.levels(); ++level) {
      const auto first = accumulator.visible_fraction.begin() + std::ptrdiff_t(accumulator.first_vertex_of(level));
      const auto count = std::ptrdiff_t(accumulator.vertex_count_of(level));
      const V3f& h = accumulator.frame_of(level).spacing_m;
      result["levels"].push_back(
          {{"spacing_m", {shortest(h.x), shortest(h.y), shortest(h.z)}},
           {"vertices", count},
           {"vertices_stored", std::count_if(first, first + count, [](float f) { return f > 0; })}});
    }
  }
  Metadata parameters = accumulator.metadata;
  parameters["light"] = std::string(name_of(accumulator.light));
  result["parameters"] = to_json(parameters);
  result["photons_a_vertex"] = {{"median", found.median},
                                {"few_share", share(found.few, found.vertices)},
                                {"none_share", share(found.unmet, found.vertices)}};
  result["warnings"] = Json::array();
  if (!doubt.empty()) {
    const char* remedy =
        found.unmet == found.vertices
            ? "look where --bounds and the lights lie, whether anything reflects, and give more --photons"
            : "give more --photons, or larger voxels";
    result["warnings"].push_back(fmt::format("{}: {} ({})", path, doubt, remedy));
    print_note(common, "warning: " + result["warnings"].back().get<std::string>());
  }
  return result;
}

std::string result_text(const Json& result) {
  const auto& size = result["resolution"];
  const auto& spacing = result["spacing_m"];
  const auto& range = result["photon_range"];
  const auto& parameters = result["parameters"];
  const auto parameter = [&](const char* key) { return parameters.value(key, std::string("unknown")); };
  std::string vertices = fmt::format("{}x{}x{}", size[0].get<int>(), size[1].get<int>(), size[2].get<int>());
  std::string where;
  if (result.contains("levels")) {
    vertices = std::to_string(result["vertices"].get<std::int64_t>());
    where = fmt::format(" on the finest of {} levels", result["levels"].size());
  }
  std::string text =
      fmt::format("{}: {} of {} vertices ({} stored), {:.4g} x {:.4g} x {:.4g} m apart{}, {}\n",
                  result["file"].get<std::string>(), result["kind"] == "grid" ? "grid" : "photon sums", vertices,
                  result["vertices_stored"].get<std::int64_t>(), spacing[0].get<float>(), spacing[1].get<float>(),
                  spacing[2].get<float>(), where, format_bytes(result["bytes"].get<std::uint64_t>()));
  text += fmt::format("{} light, basis {}, estimator {}, guard {}\n", parameter("light"), parameter("basis"),
                      parameter("estimator"), parameter("guard"));
  text += fmt::format("photons {}:{} of {}", range[0].get<std::uint64_t>(), range[1].get<std::uint64_t>(),
                      result["photons"].get<std::uint64_t>());
  if (const auto& energy = result["energy"]; !energy.is_null()) {
    text += fmt::format("; of their power {:.2f} % absorbed, {:.2f} % escaped, {:.2g} % cut off by --bounces",
                        100 * energy["absorbed"].get<double>(), 100 * energy["escaped"].get<double>(),
                        100 * energy["terminated"].get<double>());
  }
  if (result.contains("groups")) {
    text += "\ngroups:";
    for (const auto& group : result["groups"])
      text += fmt::format(" {} {:.3g} %", group["name"].get<std::string>(), 100 * group["share"].get<double>());
    text += " of the light";
  }
  if (const auto& met = result["photons_a_vertex"]; met["none_share"].get<double>() < 1) {
    text += fmt::format("\nabout {:.3g} photons came to a vertex (median)", met["median"].get<double>());
    if (const auto none = met["none_share"].get<double>(); none > 0)
      text += fmt::format(", none to {:.2g} % of them", 100 * none);
  }
  return text + "\n";
}

}  // namespace ivory
