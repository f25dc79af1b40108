#include "tools/bake/grid/contract.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "tools/cli/csv.h"
#include "tools/cli/numbers.h"
#include "tools/cli/target_error.h"
#include "tools/cli/usage_error.h"
#include "tools/input/points.h"

namespace ivory {

namespace {

using Json = nlohmann::ordered_json;

// The points of the domain: x,y,z,nx,ny,nz and, where there is such a column, their weight.
std::vector<DomainPoint> read_domain_points(const std::string& path, const V3d& anchor_m) {
  const PointsTable table = read_points_csv(path);
  const std::vector<V3f> places = local_points(table, anchor_m);
  const auto names = csv_cells(table.header);
  const auto column = std::size_t(std::find(names.begin(), names.end(), "weight") - names.begin());
  std::vector<DomainPoint> points;
  double sum = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    DomainPoint point{places[i], table.n[i], 1, true};
    if (column < names.size()) {
      const std::size_t line = i + 2;  // after the header, from 1
      const std::string remedy = "give weights of at least 0";
      point.weight = csv_number(path, {line, table.rows[i]}, csv_cells(table.rows[i])[column], "weight", remedy);
      if (point.weight < 0) throw Error(path, fmt::format("line {}: the weight is below 0", line), remedy);
    }
    sum += point.weight;
    points.push_back(point);
  }
  if (!(sum > 0)) throw Error(path, "all weights are 0", "give some point a weight above 0");
  if (points.size() < 2) throw Error(path, "holds one point alone", "give at least two: their spread is what tells");
  return points;
}

bool fixes_grid(const GridBakeParams& bake) {
  return bake.resolution || bake.voxel_size_m || bake.photons != 0 || bake.photon_range;
}

}  // namespace

void add_grid_contract_options(Command command, GridContractOptions& options) {
  const std::string group = "An error to be met";
  add_target_error_option(
      command, options.target,
      fmt::format("RMS error of E over the domain ÷ mean E there, as 2% or 0.02: spacing and photons are chosen by it\n"
                  "unless given, and the error is measured by path tracing [{}, where neither --voxel-size,\n"
                  "--resolution nor --photons is given, and at most the work of 32 vertices along the longest side\n"
                  "with 256 photons each]",
                  format_share(default_target_error)))
      .group(group);
  add_dry_run_option(command, options.dry_run).group(group);
  command
      .add_option(
          "--max-memory",
          [&options](const std::string& text) {
            options.most_memory_bytes = parse_count("--max-memory", text);
            if (options.most_memory_bytes == 0) throw UsageError("--max-memory must be at least 1 byte");
          },
          "Memory that the bake may take; k, m, g are allowed [three quarters of the machine's]")
      .type_name("BYTES")
      .group(group);
  command
      .add_option(
          "--max-time",
          [&options](const std::string& text) {
            const auto seconds = parse_number(text);
            if (!seconds || !(*seconds > 0)) throw UsageError("--max-time: '" + text + "' is not a number above 0");
            options.most_seconds = *seconds;
          },
          "Time that pilots, bake and certificate may take, about; the grid then depends on the machine's speed")
      .type_name("SECONDS")
      .group(group);
  command
      .add_choice("--error-domain", options.domain,
                  "Where the error counts: lit surfaces and the free space that light reaches (of --dynamic boxes,\n"
                  "where given), three to one, or one of the two")
      .group(group);
  command
      .add_option("--error-points", options.points,
                  "Where the error counts: columns x,y,z (metres), nx,ny,nz and, if you like, weight")
      .type_name("P.csv")
      .group(group);
  command
      .add_option("--report", options.report,
                  "A page of the measured error: what it is made of, pictures of where it is, the worst places")
      .type_name("OUT.html")
      .group(group);
}

bool has_contract(const GridContractOptions& options, const GridBakeParams& bake) {
  if (options.target && bake.photon_range)
    throw UsageError("--target-error chooses its photons as it goes: it does not go with --photon-range");
  const bool has = options.target || options.dry_run || !fixes_grid(bake);
  if (options.dry_run && bake.photon_range) throw UsageError("--dry-run does not go with --photon-range");
  if (has) return true;
  const auto refuse = [](const char* option) {
    throw UsageError(fmt::format("{} serves --target-error: give that too", option));
  };
  if (options.most_seconds) refuse("--max-time");
  if (options.domain != DomainKind::both) refuse("--error-domain");
  if (!options.points.empty()) refuse("--error-points");
  if (!options.report.empty()) refuse("--report");
  return false;
}

ContractParams contract_params(const GridContractOptions& options, const GridBakeParams& bake, const V3d& anchor_m,
                               const CommonOptions& common) {
  ContractParams params;
  params.bake = bake;
  params.target = options.target.value_or(default_target_error);
  params.domain = options.domain;
  if (!options.points.empty()) params.points = read_domain_points(options.points, anchor_m);
  params.lookup.guard = bake.guard == Guard::off ? Guard::off : Guard::rays;
  params.most_seconds = options.most_seconds;
  if (!options.target && !fixes_grid(bake)) params.most_work = 1;
  params.note = [&common](const std::string& line) { print_note(common, line); };
  return params;
}

Json plan_json(const GridPlan& plan, double target, const V3d& anchor_m) {
  const GridFrame& frame = plan.frame;
  Json json{{"target", target},
            {"resolution", {frame.size.x, frame.size.y, frame.size.z}},
            {"spacing_m", {shortest(frame.spacing_m.x), shortest(frame.spacing_m.y), shortest(frame.spacing_m.z)}},
            {"origin_m", shortest(frame.origin_m, anchor_m)},
            {"levels", plan.levels},
            {"vertices", plan.vertices},
            {"photons", plan.photons},
            {"error", prediction_json(plan.error)},
            {"bias", plan.bias},
            {"noise", plan.noise},
            {"direction", plan.direction}};
  if (plan.direction_sh9) json["direction_sh9"] = *plan.direction_sh9;
  json["seconds"] = prediction_json(plan.seconds);
  json["memory_bytes"] = prediction_json(plan.memory_bytes);
  json["file_bytes"] = prediction_json(plan.file_bytes);
  json["meets"] = plan.meets;
  if (!plan.meets) json["limited_by"] = plan.limited_by;
  json["pilots"] = Json::array();
  for (const PilotErrors& pilot : plan.pilots) {
    json["pilots"].push_back(
        {{"spacing_m", pilot.spacing_m}, {"photons", pilot.photons}, {"bias", pilot.bias}, {"noise", pilot.noise}});
  }
  return json;
}

std::string plan_text(const GridPlan& plan, double target) {
  const GridFrame& frame = plan.frame;
  const std::string count = plan.levels == 1
                                ? fmt::format("{}x{}x{} vertices", frame.size.x, frame.size.y, frame.size.z)
                                : fmt::format("{} vertices on {} levels, the finest", plan.vertices, plan.levels);
  std::string text = fmt::format("plan: {}, {:.4g} x {:.4g} x {:.4g} m apart, {} photons\n", count, frame.spacing_m.x,
                                 frame.spacing_m.y, frame.spacing_m.z, format_count(double(plan.photons)));
  if (plan.error.expected > 0) {
    text += fmt::format("error {}: bias {}, noise {}; asked for {}\n", share_text(plan.error), format_share(plan.bias),
                        format_share(plan.noise), format_share(target));
    text += fmt::format("time {}, memory {}, file {}\n", seconds_text(plan.seconds), bytes_text(plan.memory_bytes),
                        bytes_text(plan.file_bytes));
    if (plan.direction > 0.5 * plan.error.expected && plan.direction_sh9 &&
        *plan.direction_sh9 < 0.8 * plan.direction) {
      text += fmt::format("the basis alone is {} off; --basis sh9 would be {}\n", format_share(plan.direction),
                          format_share(*plan.direction_sh9));
    }
  }
  if (!plan.meets) text += "limited by " + plan.limited_by + "\n";
  return text;
}

void add_contract_result(const ContractResult& contract, const GridContractOptions& options, Json& result,
                         const CommonOptions& common) {
  std::vector<std::string> warnings;
  if (contract.certificate) {
    result["certificate"] = certificate_json(contract.certificate->summary);
    result["certificate"]["rounds"] = contract.rounds;
    Json worst = Json::array();
    for (const WorstPlace& place : contract.certificate->worst) {
      worst.push_back({{"position_m", {place.p_world.x, place.p_world.y, place.p_world.z}},
                       {"normal", {shortest(place.n.x), shortest(place.n.y), shortest(place.n.z)}},
                       {"on_surface", place.on_surface},
                       {"lux", place.e_lux},
                       {"lux_read", place.read_lux},
                       {"off", place.off},
                       {"cause", place.cause}});
    }
    result["certificate"]["worst"] = std::move(worst);
    if (const std::string missed = missed_text(contract.certificate->summary); !missed.empty()) {
      const std::string why = contract.plan.limited_by.empty() ? "" : "; limited by " + contract.plan.limited_by;
      warnings.push_back(result["file"].get<std::string>() + ": " + missed + why);
    }
  } else {
    warnings.push_back(result["file"].get<std::string>() + ": its error is not known: light reaches too few points");
  }
  if (options.most_seconds) warnings.push_back("--max-time had a say: another machine may choose another grid");
  for (const std::string& warning : warnings) result["warnings"].push_back(warning);
  print_warnings(common, warnings);
  // They stand in "certificate".
  Json parameters = Json::object();
  for (const auto& [key, value] : result["parameters"].items()) {
    if (!key.starts_with("certificate_")) parameters[key] = value;
  }
  result["parameters"] = std::move(parameters);
}

std::string contract_text(const ContractResult& contract) {
  if (!contract.certificate) return {};
  std::string text = certificate_text(contract.certificate->summary);
  constexpr std::size_t most = 3;
  for (std::size_t i = 0; i < std::min(most, contract.certificate->worst.size()); ++i)
    text += "worst at " + text_of(contract.certificate->worst[i]) + "\n";
  return text;
}

}  // namespace ivory
