// Depth alone, of ivory::Renderer before it shades and of shadow maps: of what covers at least half.
#include "renderer/surface.glsl"

void main() {
  if (ivory_coverage(ivory_base().a) < 0.5) discard;
}
