// All lights of a scene as maps from unit cubes to photons: what a guide goes by.
#pragma once

#include <map>
#include <vector>

#include "tracer/lights/environment.h"
#include "tracer/lights/guide.h"

namespace ivory {

// A piece of the emission: a sun or the sky through one of the discs that they enter by, or lamps that stand together.
struct StratumSource {
  enum class Kind { sun, sky, lamps, emitters } kind = Kind::lamps;
  std::size_t light = 0;  // sun: among the punctual lights
  std::size_t disc = 0;   // sun, sky
  // Lamps, emitters: members[first] to members[last - 1].
  std::size_t first = 0;
  std::size_t last = 0;
};

struct Strata {
  std::vector<StratumSource> sources;
  std::vector<GuideStratum> shapes;  // of each source
  std::vector<std::size_t> members;  // lights by their number in the table, neighbours together
  std::vector<double> before;        // [member] of the probabilities that they are picked with; one more at the end
  std::map<const void*, std::vector<double>> instanced;  // the same for the triangles of an InstancedEmitter
  SkyTable sky;
};

}  // namespace ivory
