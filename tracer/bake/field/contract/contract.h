// A grid of irradiance vectors to an error that is asked for: pilots, a plan, the bake, and its certificate.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "grid/base/prediction.h"
#include "tracer/bake/field/baker.h"
#include "tracer/bake/field/contract/certificate.h"
#include "tracer/bake/field/contract/plan.h"

namespace ivory {

struct ContractParams {
  // Voxel size, resolution or photons that it sets are kept; no photon range.
  GridBakeParams bake;
  double target = 0.05;
  DomainKind domain = DomainKind::both;
  std::vector<DomainPoint> points;            // the domain, unless empty
  LookupParams lookup{.guard = Guard::rays};  // how the grid will be read
  // Bounds. Without most_seconds the same scene and parameters give the same grid on any machine; a clock has a say
  // only with it.
  std::optional<double> most_seconds = std::nullopt;
  // How much more work than a bake by resolution alone may cost (32 vertices along the longest side, 256 photons each):
  // for targets that nobody asked for.
  std::optional<double> most_work = std::nullopt;
  std::function<void(const std::string&)> note;  // lines for people: what is done, what was found
};

// What is going to be baked, with the range that each prediction is good for.
struct GridPlan {
  GridFrame frame;  // of the finest level
  int levels = 1;
  std::size_t vertices = 0;
  std::uint64_t photons = 0;
  Prediction error;  // share of mean E
  double bias = 0;   // of it, shares likewise
  double noise = 0;
  double direction = 0;                 // part of the bias
  std::optional<double> direction_sh9;  // what that would be with basis sh9
  Prediction seconds;                   // of bake and certificate, by the pilots' clock
  Prediction memory_bytes;              // of the bake
  Prediction file_bytes;
  bool meets = false;      // does it promise the target?
  std::string limited_by;  // where not: by what
  std::vector<PilotErrors> pilots;
};

struct ContractResult {
  GridPlan plan;  // the first
  GridAccumulator sums;
  std::optional<FieldCertificate> certificate;  // nothing where no light could be measured
  int rounds = 1;                               // bakes, the pilots' not counted
  bool by_clock = false;                        // did time decide anything?
};

// The plan alone; bakes pilots.
GridPlan plan_grid(const LitScene& lit, const ContractParams& params);

// All of it. Throws as bake_grid_sums() does. A target that bounds keep it from is missed, not an error.
ContractResult bake_to_error(const LitScene& lit, const ContractParams& params);

}  // namespace ivory
