// The photons of a bake into its integer sums, on all threads, with pauses: at each the sums are exactly those of the
// photons before it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "grid/field/accumulator.h"
#include "tracer/bake/field/deposit/photon_deposit.h"
#include "tracer/bake/field/deposit/target.h"
#include "tracer/lights/groups.h"
#include "tracer/render/photons/tracer.h"

namespace ivory {

class PhotonSums {
 public:
  // `target` without sums yet; `groups`, where not null, keeps the light of each apart. `tracer` and `groups` must
  // outlive this object.
  PhotonSums(const PhotonTracer& tracer, DepositTarget target, const LightGroups* groups, int threads);

  // Traces photons from `begin` up to `end`, and calls batch_done(photons traced so far) after each batch of them, from
  // any thread, one at a time: when it returns true, the batches that are under way are the last. Returns the first
  // photon that was not traced; all before it are in the sums, whichever thread had them.
  using BatchDone = std::function<bool(std::uint64_t done)>;
  std::uint64_t trace(std::uint64_t begin, std::uint64_t end, const BatchDone& batch_done);

  // Moves the sums, by vertex, into `out`, with its lattice, basis, estimator, quanta, groups and counters; all else in
  // it stays.
  void take(GridAccumulator& out);
  // And back, from where they were taken or from a file that holds those of the same bake; `out` keeps the rest.
  void put(GridAccumulator& out);

 private:
  struct Worker;

  void deposit(Worker& worker) const;

  const PhotonTracer& tracer_;
  const LightGroups* groups_;
  int threads_;
  std::vector<DepositTarget> targets_;  // one for each group of lights, or one: what they add up to is what one has
  PhotonLedger ledger_;
};

}  // namespace ivory
