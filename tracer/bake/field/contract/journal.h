// What a bake to an error has measured so far, kept in its checkpoints: gone on from, it decides as it did, without the
// bakes and the measurements that led there. Pilots are baked again.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tracer/bake/field/contract/contract.h"
#include "tracer/bake/field/contract/planning_points.h"

namespace ivory {

class Journal {
 public:
  // Reads what the checkpoint of params.bake has, where there is one; throws Error where it is of another bake or
  // damaged, unless it may be replaced.
  Journal(const LitScene& lit, const ContractParams& params);

  // Is the next measurement known from a run before? Then the bake before it is not needed.
  bool is_known() const { return next_ < reached_.size(); }
  // What was measured then, or what `measure` measures now.
  ReachedError reached(const std::function<ReachedError()>& measure);
  // For the next bake, whose checkpoints keep what was measured by now; nothing where none are kept.
  std::optional<CheckpointPolicy> policy() const;

 private:
  std::optional<CheckpointPolicy> policy_;
  std::vector<ReachedError> reached_;
  std::size_t next_ = 0;
};

}  // namespace ivory
