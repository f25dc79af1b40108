// What is known in the course of a bake to an error: from the points that it is planned by to the sums at hand.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tracer/bake/field/contract/candidates.h"
#include "tracer/bake/field/contract/contract.h"
#include "tracer/bake/field/contract/planning_points.h"

namespace ivory {

// Predictions are off by a tenth as a rule, and so is the measurement of what was reached.
inline constexpr double aim_of_target = 0.88;

struct Stopwatch {
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();

  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); }
};

// What bakes took, by the clock and by the cost model; the pilots' too.
struct BakeTimes {
  double measured = 0;  // seconds
  double modelled = 0;

  // Seconds of this machine for one of the cost model's.
  double scale() const { return modelled > 0 ? measured / modelled : 1; }
};

// Sums of the last pilot, then of the bake, which may go on from them.
struct SumsAtHand {
  std::optional<GridAccumulator> sums;
  std::uint64_t photons = 0;        // in them: the first so many
  std::uint64_t guide_photons = 0;  // that their emission was guided for
  double stored_share = 1;          // of a pilot's vertices, those that see something

  bool stand_on(const Lattice& lattice) const { return sums && static_cast<const Lattice&>(*sums) == lattice; }
  // Takes in photons that follow those at hand.
  void add(GridAccumulator more);
};

struct ContractState {
  ContractState(const LitScene& lit, const ContractParams& params);  // both must outlive it
  void note(const std::string& line) const {
    if (params.note) params.note(line);
  }

  // Fixed before the first bake.
  const LitScene& lit;
  const ContractParams& params;
  GridFrame cover;  // the box that is asked for
  Domain domain;
  TruthParams truth;
  CostModel costs;
  Stopwatch since_start;
  PlanningPoints points;
  GridCandidates candidates;  // but that some are dropped where finer ones turn out to be worth nothing
  double direction = 0;       // error of the basis that is asked for, a share of mean E
  std::optional<double> direction_sh9;

  // What bakes showed so far.
  std::vector<PilotErrors> pilots;  // the coarsest first
  BakeTimes times;
  SumsAtHand at_hand;

  // What follows from it.
  ErrorModel model;
  Plan chosen;
  // How many times as much work as was done, or is planned, the target would take, where that is too much.
  std::optional<double> too_dear;
  double most_work = 0;  // that all bakes together may take, on the cost model's machine: of the first plan

  const GridCandidate& chosen_candidate() const { return candidates.list[chosen.spacing]; }
};

}  // namespace ivory
