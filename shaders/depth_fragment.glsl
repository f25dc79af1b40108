// What ivory::Renderer lays down before it shades: the depth of what is there altogether.
#include "surface.glsl"

void main() {
  if (ivory_coverage(ivory_base().a) <= 0.0) discard;
}
