#include "tools/bake/grid_result.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/field/resolve.h"
#include "grid/io/json.h"
#include "grid/io/vdb/vdb.h"

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

}  // namespace

bool is_whole(const GridAccumulator& accumulator) {
  return accumulator.photon_begin == 0 && accumulator.photon_end == whole_photons(accumulator);
}

Json write_result(const std::string& path, const GridAccumulator& accumulator, bool finished,
                  const CommonOptions& common) {
  if (finished) {
    IrradianceGrid grid = resolve(accumulator);
    grid.metadata["photon_begin"] = std::int64_t(accumulator.photon_begin);
    grid.metadata["photon_end"] = std::int64_t(accumulator.photon_end);
    for (const auto& [key, value] : accumulator.counters) grid.metadata[key] = value;
    write_vdb(path, grid, common.force);
  } else {
    write_vdb(path, accumulator, common.force);
  }
  const GridFrame& frame = accumulator.frame;
  const auto stored = std::count_if(accumulator.visible_fraction.begin(), accumulator.visible_fraction.end(),
                                    [](float f) { return f > 0; });
  Json result{{"file", path},
              {"kind", finished ? "grid" : "sums"},
              {"bytes", std::filesystem::file_size(path)},
              {"resolution", {frame.size.x, frame.size.y, frame.size.z}},
              {"spacing_m", {shortest(frame.spacing_m.x), shortest(frame.spacing_m.y), shortest(frame.spacing_m.z)}},
              {"origin_m", shortest(frame.origin_m, accumulator.anchor_m)},
              {"vertices", frame.vertex_count()},
              {"vertices_stored", stored},
              {"memory_bytes", stored * bytes_read(accumulator)},
              {"photons", whole_photons(accumulator)},
              {"photon_range", {accumulator.photon_begin, accumulator.photon_end}},
              {"energy", ledger_json(accumulator)}};
  Metadata parameters = accumulator.metadata;
  parameters["light"] = std::string(name_of(accumulator.light));
  result["parameters"] = to_json(parameters);
  return result;
}

std::string result_text(const Json& result) {
  const auto& size = result["resolution"];
  const auto& spacing = result["spacing_m"];
  const auto& range = result["photon_range"];
  const auto& parameters = result["parameters"];
  const auto parameter = [&](const char* key) { return parameters.value(key, std::string("unknown")); };
  std::string text = fmt::format(
      "{}: {} of {}x{}x{} vertices ({} stored), {:.4g} x {:.4g} x {:.4g} m apart, {}\n",
      result["file"].get<std::string>(), result["kind"] == "grid" ? "grid" : "photon sums", size[0].get<int>(),
      size[1].get<int>(), size[2].get<int>(), result["vertices_stored"].get<std::int64_t>(), spacing[0].get<float>(),
      spacing[1].get<float>(), spacing[2].get<float>(), format_bytes(result["bytes"].get<std::uint64_t>()));
  text += fmt::format("{} light, basis {}, estimator {}, guard {}\n", parameter("light"), parameter("basis"),
                      parameter("estimator"), parameter("guard"));
  text += fmt::format("photons {}:{} of {}", range[0].get<std::uint64_t>(), range[1].get<std::uint64_t>(),
                      result["photons"].get<std::uint64_t>());
  if (const auto& energy = result["energy"]; !energy.is_null()) {
    text += fmt::format("; of their power {:.2f} % absorbed, {:.2f} % escaped, {:.2g} % cut off by --bounces",
                        100 * energy["absorbed"].get<double>(), 100 * energy["escaped"].get<double>(),
                        100 * energy["terminated"].get<double>());
  }
  return text + "\n";
}

}  // namespace ivory
