// What an asset takes, before it is made: enough to start the longest first, and to run side by side what fits.
#pragma once

#include "tools/batch/job/job.h"
#include "tools/batch/state/record.h"

namespace ivory {

struct AssetCost {
  double seconds = 0;       // as long as last time; else a guess by its kind, good for an order
  bool measured = false;    // are the seconds last time's?
  double memory_bytes = 0;  // beside the scenes and environments, which assets share
};

// `limit_bytes`: what all may take. A grid to an error that tells no --max-memory counts as half of it, unless its last
// bake has planned less.
AssetCost cost_of(const JobAsset& asset, const AssetRecord* record, int threads, double limit_bytes);

}  // namespace ivory
