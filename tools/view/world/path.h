// Where a moving object is at a time.
#pragma once

#include <string>
#include <vector>

#include "grid/base/types.h"

namespace ivory {

struct Keyframe {
  double time_s = 0;
  V3f offset_m{0, 0, 0};
};

// Nothing moves without a kind.
struct ObjectPath {
  enum class Kind { none, circle, line, keys };
  Kind kind = Kind::none;
  float radius_m = 1;          // circle around +Y that starts at the object's own place, its centre to -X of it
  V3f there_m{0, 0, 0};        // line: from the object's own place by this much, and back
  double period_s = 4;         // circle: one turn; line: there and back
  std::vector<Keyframe> keys;  // in the order of time; the last one's time is the period
};

// "circle:RADIUS[,SECONDS]", "line:X,Y,Z[,SECONDS]" or "keys:FILE.csv". The file has a line t,x,y,z (seconds from 0,
// metres from the object's own place) a keyframe, '#' and the header t,x,y,z are skipped. Throws UsageError for other
// texts, Error for files that are missing, malformed, unordered or longer than 100,000 keyframes.
ObjectPath parse_path(const std::string& text);

// Offset from the object's own place, over and over: zero at time 0 but for keyframes that start elsewhere. A line is
// slow at both ends (a cosine); between keyframes it is straight and even.
V3f offset_at(const ObjectPath& path, double time_s);

}  // namespace ivory
