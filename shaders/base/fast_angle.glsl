// The angle of a vector in the plane. Twin: grid/base/fast_angle.h, which says how the polynomial came about.
#include "base/pi.glsl"

// atan2(y, x) to 6e-7 rad. (0, 0) gives 0.
float ivory_fast_angle(float y, float x) {
  float ay = abs(y);
  float ax = abs(x);
  float longer = max(ay, ax);
  float t = longer > 0.0 ? min(ay, ax) / longer : 0.0;
  float t2 = t * t;
  float angle = -0.00455979211;
  angle = angle * t2 + 0.0237805191;
  angle = angle * t2 - 0.0588297546;
  angle = angle * t2 + 0.0986886546;
  angle = angle * t2 - 0.140032902;
  angle = angle * t2 + 0.199669614;
  angle = angle * t2 - 0.333318114;
  angle = (angle * t2 + 0.999999881) * t;
  angle = ay > ax ? 0.5 * ivory_pi - angle : angle;
  angle = x < 0.0 ? ivory_pi - angle : angle;
  return y < 0.0 ? -angle : angle;
}
