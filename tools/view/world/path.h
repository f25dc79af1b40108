// Where a moving object is at a time.
#pragma once

#include <string>
#include <vector>

#include "grid/base/types.h"

namespace ivory {

// What a path adds to an object's own place, turn and size.
struct PathPoint {
  V3f offset_m{0, 0, 0};
  V3f turn_deg{0, 0, 0};
  float scale = 1;  // a factor
};

struct Keyframe {
  double time_s = 0;
  PathPoint at;
};

// Nothing moves without a kind.
struct ObjectPath {
  enum class Kind { none, circle, line, turn, keys };
  Kind kind = Kind::none;
  float radius_m = 1;          // circle around +Y that starts at the object's own place, its centre to -X of it
  V3f there_m{0, 0, 0};        // line: from the object's own place by this much, and back
  double period_s = 4;         // circle, turn: one turn; line: there and back
  std::vector<Keyframe> keys;  // in the order of time; the last one's time is the period
};

// "circle:RADIUS[,SECONDS]", "line:X,Y,Z[,SECONDS]", "turn:SECONDS" (on the spot, about +Y) or "keys:FILE.csv". The
// file has a keyframe a line: t,x,y,z (seconds from 0, metres from the object's own place), then, where it turns,
// rx,ry,rz (degrees, as Placement has them), then, where it grows, a scale; '#' and a header that begins with t,x,y,z
// are skipped. Throws UsageError for other texts, Error for files that are missing, malformed, unordered or longer than
// 100,000 keyframes.
ObjectPath parse_path(const std::string& text);

// Over and over; nothing at time 0 but for keyframes that start elsewhere. A line is slow at both ends (a cosine);
// between keyframes all is even.
PathPoint at(const ObjectPath& path, double time_s);

}  // namespace ivory
