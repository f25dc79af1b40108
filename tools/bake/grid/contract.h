// ivory bake grid --target-error: the options, the plan that is said before the bake, and what is said of it after.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/cli/common.h"
#include "tracer/bake/field/contract/contract.h"

namespace ivory {

// Of a bake that names neither an error nor spacing or photons.
inline constexpr double default_target_error = 0.05;

struct GridContractOptions {
  std::optional<double> target;
  std::optional<double> most_seconds;
  std::uint64_t most_memory_bytes = 0;
  bool dry_run = false;
  DomainKind domain = DomainKind::both;
  std::string points;
  std::string report;
};

void add_grid_contract_options(Command command, GridContractOptions& options);

// Does the bake go by an error? Asked for, or because nothing else says how fine it is to be. Throws UsageError for
// options that do not go together.
bool has_contract(const GridContractOptions& options, const GridBakeParams& bake);

// `bake` is all but voxel size, resolution and photons, unless they are given.
ContractParams contract_params(const GridContractOptions& options, const GridBakeParams& bake, const V3d& anchor_m,
                               const CommonOptions& common);

nlohmann::ordered_json plan_json(const GridPlan& plan, double target, const V3d& anchor_m);
std::string plan_text(const GridPlan& plan, double target);

// "certificate" of the bake's result, with warnings added to its own and printed.
void add_contract_result(const ContractResult& contract, const GridContractOptions& options,
                         nlohmann::ordered_json& result, const CommonOptions& common);
std::string contract_text(const ContractResult& contract);

}  // namespace ivory
