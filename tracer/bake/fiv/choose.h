// The smallest FIV table that meets an error.
#pragma once

#include <span>

#include "tracer/bake/fiv/baker.h"
#include "tracer/bake/fiv/truth.h"

namespace ivory {

// Samples that tables to an error have at most, unless a user says otherwise.
inline const V3i most_fiv_samples(192, 97, 68);

struct FivChoice {
  FivTable table;
  MeasuredError predicted;  // by `pilot`
  bool met = false;         // with the whole of its interval
};

// Tables of growing size are baked, several at a time, up to params.samples, for each of `hemispheres` (1, 6 or both),
// and judged at the receivers of `pilot`: the first in a fixed order, roughly that of memory, that meets `target`,
// or where none does the one whose interval ends lowest; it ends early where more samples no longer help. Choices
// depend on `target` by comparison alone, so that a tighter one never gives a coarser table. Throws as bake_fiv() does.
FivChoice choose_fiv(const FivOccluder& occluder, const CubeMap& environment, const FivParams& params,
                     const FivTruth& pilot, double target, std::span<const int> hemispheres);

}  // namespace ivory
