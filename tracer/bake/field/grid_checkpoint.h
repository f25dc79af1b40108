// Checkpoints of grids: photon sums as `merge` reads them, of a bake's first photons, which say what bake they are of.
#pragma once

#include <functional>
#include <string>

#include "grid/field/accumulator.h"
#include "tracer/bake/checkpoint.h"
#include "tracer/bake/field/grid_params.h"

namespace ivory {

// Facts of a checkpoint's metadata begin with this: parts of a bake and finished grids have none of them.
inline const std::string checkpoint_prefix = "checkpoint_";
// Key in CheckpointPolicy::origin of bakes that follow on one another by the same path: the checkpoint of one before,
// or after, is of no use and in nobody's way.
inline const std::string checkpoint_series = checkpoint_prefix + "series";

// The kind of CPU, as far as hits of rays and with them a bake's bytes differ by it: not where they are `portable`.
std::string checkpoint_cpu(bool portable);

// Why the file at policy.path is not gone on from: damage, or what `fault` says of its facts, which are empty where it
// is no checkpoint. Empty where it is. Throws Error with that unless policy.replace; then an event says it.
std::string checkpoint_fault(const CheckpointPolicy& policy,
                             const std::function<std::string(const Metadata& found)>& fault);

class GridCheckpoint {
 public:
  // Of the bake that `described`, `lattice` and params say: whose photons go from `begin`, those that a caller had at
  // hand included, to `end`. Looks whether there is a file to go on from: throws Error where it is of another bake or
  // damaged, unless policy.replace. `cpu` is checkpoint_cpu(). `params` must outlive this object.
  GridCheckpoint(const GridBakeParams& params, const Lattice& lattice, const Metadata& described,
                 const std::string& cpu, std::uint64_t begin, std::uint64_t end);

  // Is there a file to go on from?
  bool is_there() const { return is_there_; }
  // What it holds. `bake` is all but sums and photons, and comes back as it was; throws Error where what it says is not
  // what the file says, as after a bake on another kind of CPU.
  GridAccumulator read(GridAccumulator& bake) const;

  // Is it time for one, or to stop? From any thread, one at a time.
  bool is_wanted();
  bool is_to_stop();
  // Writes it, unless it cannot: that is an event while the bake goes on, and an Error where it is to stop. `sums`
  // comes back as it was.
  void write(GridAccumulator& sums);
  [[noreturn]] void stop(std::uint64_t done) const;

 private:
  void report(CheckpointEvent::Kind kind, std::string line, std::uint64_t done, double seconds = 0) const;
  // Why a file with those facts is not this bake's; empty where it is.
  std::string fault(const Metadata& found) const;
  // What the file says of that bake.
  Metadata stored(Metadata of_bake) const;

  const CheckpointPolicy& policy_;
  Metadata described_;  // what is known before photons fly, with policy.origin
  std::string key_;
  std::uint64_t begin_;
  std::uint64_t end_;
  CheckpointClock clock_;
  bool is_there_ = false;
  bool is_to_stop_ = false;
};

}  // namespace ivory
