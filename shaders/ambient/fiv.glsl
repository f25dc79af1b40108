// Ambient light of an environment (SH9 or DifMap) shadowed by occluders with FIV tables. Twin: fiv_irradiance() of
// grid/fiv/light.h. Set by bind(const GpuFivTables&, ...) of runtime/assets/fiv.h.
//
// IVORY_FIV_OVERLAP, before it: 0 none, 1 discs, 2 covers (as without), 3 product. IVORY_FIV_SELF: for objects that are
// occluders themselves, as `ivory_fiv_self` says. IVORY_FIV_TURNS: where a mesh has tables of several turns.
#include "env/sh9.glsl"
#include "env/difmap.glsl"
#include "fiv/light.glsl"

uniform IvorySh9 ivory_sh9;
uniform samplerCube ivory_difmap_e;
uniform float ivory_difmap_scale;  // lux
uniform mat3 ivory_difmap_from_world;  // as in ambient/difmap.glsl
uniform int ivory_fiv_use_difmap;  // 0: unshadowed light from SH9, 1: from the DifMap
uniform sampler3D ivory_fiv_atlas;
uniform sampler2D ivory_fiv_spheres;
uniform int ivory_fiv_straddling;  // 0 bound, 1 scale
uniform int ivory_fiv_self;        // index of the occluder that the object is, or -1: has no default, set it
uniform mat3 ivory_fiv_from_world;  // to where the environment stands as it was baked: has no default, set it

layout(std140) uniform IvoryFivTables { IvoryFivTable ivory_fiv_tables[64]; };

layout(std140) uniform IvoryFivOccluders {
  ivec4 ivory_fiv_occluders;      // x: how many
  vec4 ivory_fiv_place[256];      // centre of the bounding sphere and its radius in metres, in the environment's frame
  ivec4 ivory_fiv_table_of[256];  // index of its table, and of the next turn's; the bits of that one's share
};

// What occluder i hides from q, its own place in bounding radii.
IvoryFivMoments ivory_fiv_hidden_by(int i, vec3 q, bool split) {
  ivec4 which = ivory_fiv_table_of[i];
  IvoryFivMoments moments = ivory_lookup(ivory_fiv_atlas, ivory_fiv_spheres, ivory_fiv_tables[which.x], q, split);
#ifdef IVORY_FIV_TURNS
  float share = intBitsToFloat(which.z);
  if (share > 0.0) {
    IvoryFivMoments next = ivory_lookup(ivory_fiv_atlas, ivory_fiv_spheres, ivory_fiv_tables[which.y], q, split);
    for (int s = 0; s < 9; ++s) moments.slab[s] = mix(moments.slab[s], next.slab[s], share);
  }
#endif
  return moments;
}

// E in lux at world p for the unit normal n.
vec3 ivory_ambient(vec3 p, vec3 ng, vec3 n) {
  vec3 unshadowed = ivory_fiv_use_difmap == 1
                        ? ivory_irradiance(ivory_difmap_e, ivory_difmap_scale, ivory_difmap_from_world * n)
                        : ivory_irradiance(ivory_sh9, n);
  p = ivory_fiv_from_world * p;
  n = ivory_fiv_from_world * n;
  float allowance = ivory_fiv_negligible * ivory_luminance(unshadowed);
  float neglected = 0.0;
  IvoryFivShadows shadows = ivory_fiv_no_shadows();
  int count = ivory_fiv_occluders.x;
  int i = 0;
  do {
    // On to the next occluder that counts, each receiver by itself: what lies below its plane or is negligible costs no
    // look-up, on hardware that runs through masked code too.
    bool found = false;
    vec3 q = vec3(0.0, 1.0, 0.0);
    float height = 0.0;
    int which = 0;
    int at = 0;
    while (i < count && !found) {
      vec4 place = ivory_fiv_place[i];
      q = (p - place.xyz) / place.w;
      height = -dot(q, n);
      which = ivory_fiv_table_of[i].x;
      float at_most = ivory_fiv_tables[which].scale.y * ivory_fiv_falloff(length(q));
      bool above = height > -1.0 && i != ivory_fiv_self;
      found = above && neglected + at_most > allowance;
      at = i;
      neglected += above && !found ? at_most : 0.0;
      ++i;
    }
    // Wholly above the plane n.F says all.
    IvoryFivMoments moments = ivory_fiv_hidden_by(at, q, height < 1.0 && ivory_fiv_straddling == 0);
    IvoryFivShadow shadow =
        ivory_fiv_shadow_by(moments, ivory_fiv_tables[which], q, height, n, ivory_fiv_straddling, unshadowed);
    shadow.hidden = found ? shadow.hidden : vec3(0.0);
    shadow.luminance = found ? shadow.luminance : 0.0;
    ivory_fiv_add(shadows, shadow, unshadowed);
  } while (i < count);
  vec3 open = unshadowed;
#ifdef IVORY_FIV_SELF
  vec4 place = ivory_fiv_place[ivory_fiv_self];
  IvoryFivTable table = ivory_fiv_tables[ivory_fiv_table_of[ivory_fiv_self].x];
  IvoryFivMoments moments = ivory_fiv_hidden_by(ivory_fiv_self, (p - place.xyz) / place.w, true);
  open = ivory_self_shadowed_irradiance(table, moments, n);
#endif
  return ivory_fiv_leave(open, unshadowed, ivory_fiv_hidden(shadows, unshadowed));
}
