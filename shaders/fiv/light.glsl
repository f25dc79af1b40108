// The light of an environment at a receiver among moving occluders. Twin: grid/fiv/light.h.
//
// Go through the occluders, ivory_fiv_add() each one's shadow to IvoryFivShadows, then ask for ivory_fiv_leave():
// shaders/ambient/fiv.glsl does. IVORY_FIV_OVERLAP: 0 none, 1 discs, 2 covers, 3 product.
#ifndef IVORY_FIV_OVERLAP
#define IVORY_FIV_OVERLAP 2
#endif
#include "base/pi.glsl"
#include "fiv/table.glsl"

// Shadows that are compared pair by pair; the macros below spell them out, as arrays indexed by variables would leave
// the registers.
#define IVORY_FIV_STRONGEST 8
#define IVORY_FIV_FOR_STRONGEST(DO) DO(0) DO(1) DO(2) DO(3) DO(4) DO(5) DO(6) DO(7)

// The share of the unshadowed light that occluders left out may hide, all together.
const float ivory_fiv_negligible = 1e-3;

// What one occluder does to a receiver; of no account where nothing is hidden.
struct IvoryFivShadow {
  vec3 hidden;        // lux
  float luminance;    // of hidden
  vec3 light;         // unit, mean direction of what is hidden, weighted by radiance
  float disc_radius;  // of its bounding sphere on the unit sphere about the receiver
  vec3 towards;       // unit, to the occluder's centre
  vec3 coverage;      // share of the light of its disc that it hides: covered_share() of the twin
  float gathered;     // share of what it hides that comes from light gathered in a few places
};

struct IvoryFivShadows {
  IvoryFivShadow strongest[IVORY_FIV_STRONGEST];  // in descending order of luminance
  vec3 sum;    // of all, lux
  vec3 share;  // of the unshadowed light that is visible if shadows multiply: all of them, or, for overlap 2, all but
               // the strongest, after what those hide already
};

float ivory_luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

#define IVORY_FIV_EMPTY(i) shadows.strongest[i] = none;
IvoryFivShadows ivory_fiv_no_shadows() {
  IvoryFivShadow none = IvoryFivShadow(vec3(0.0), 0.0, vec3(0.0), 1.0, vec3(0.0), vec3(0.0), 0.0);
  IvoryFivShadows shadows;
  IVORY_FIV_FOR_STRONGEST(IVORY_FIV_EMPTY)
  shadows.sum = vec3(0.0);
  shadows.share = vec3(1.0);
  return shadows;
}

// For a receiver at q (in bounding radii) over whose plane the centre stands `height` high, above -1, of what the
// occluder hides there.
IvoryFivShadow ivory_fiv_shadow_by(IvoryFivMoments moments, IvoryFivTable table, vec3 q, float height, vec3 n,
                                   int straddling, vec3 unshadowed) {
  float r = length(q);
  IvoryFivShadow shadow;
  shadow.towards = r > 0.0 ? q / -r : n;
  shadow.disc_radius = r > 1.0 ? 1.0 / r : 1.0;
  shadow.hidden = ivory_hidden_irradiance(table, moments, n, height, straddling);
  shadow.luminance = ivory_luminance(shadow.hidden);
  vec3 light = vec3(ivory_luminance(moments.slab[0].rgb), ivory_luminance(moments.slab[1].rgb),
                    ivory_luminance(moments.slab[2].rgb));
  float size = length(light);
  shadow.light = size > 0.0 ? light / size : vec3(0.0);
  float filled = table.samples.w;
  float area = shadow.disc_radius * shadow.disc_radius;
  float cosine = max(0.0, dot(shadow.towards, n));
  float even = ivory_luminance(unshadowed) * cosine * filled * area;
  shadow.gathered = shadow.luminance > 0.0 ? clamp(1.0 - even / shadow.luminance, 0.0, 1.0) : 0.0;
  // A disc on the horizon with nothing behind it is filled as ever.
  vec3 through = unshadowed * (area * (cosine + 0.5 * shadow.disc_radius * (1.0 - cosine)));
  vec3 share = max(vec3(filled), min(shadow.hidden / max(through, 1e-37), 1.0));
  shadow.coverage = mix(vec3(filled), share, greaterThan(through, vec3(0.0)));
  return shadow;
}

// The same of what its table says.
IvoryFivShadow ivory_fiv_shadow_of(sampler3D atlas, sampler2D spheres, IvoryFivTable table, vec3 q, float height,
                                   vec3 n, int straddling, vec3 unshadowed) {
  // Wholly above the plane n.F says all.
  IvoryFivMoments moments = ivory_lookup(atlas, spheres, table, q, height < 1.0 && straddling == 0);
  return ivory_fiv_shadow_by(moments, table, q, height, n, straddling, unshadowed);
}

// Area that two discs share in a plane, their centres `apart`.
float ivory_lens_area(float r1, float r2, float apart) {
  if (apart >= r1 + r2) return 0.0;
  float smaller = min(r1, r2);
  if (apart <= abs(r1 - r2)) return ivory_pi * smaller * smaller;
  // The angle whose cosine is c1 by both legs of its triangle: digits stay where it is small.
  float c1 = apart * apart + r1 * r1 - r2 * r2;
  float c2 = apart * apart + r2 * r2 - r1 * r1;
  float height =
      sqrt(max((-apart + r1 + r2) * (apart + r1 - r2) * (apart - r1 + r2) * (apart + r1 + r2), 0.0));
  return r1 * r1 * ivory_fast_angle(height, c1) + r2 * r2 * ivory_fast_angle(height, c2) - 0.5 * height;
}

float ivory_fiv_common_area(IvoryFivShadow a, IvoryFivShadow b) {
  return ivory_lens_area(a.disc_radius, b.disc_radius, distance(a.towards, b.towards));
}

float ivory_fiv_disc_area(IvoryFivShadow a) { return ivory_pi * a.disc_radius * a.disc_radius; }

// How much of what `weak` hides `strong` has left open.
vec3 ivory_fiv_left_open(IvoryFivShadow strong, IvoryFivShadow weak) {
  float gathered = weak.gathered * strong.gathered;
  vec3 spread = strong.coverage * (ivory_fiv_common_area(strong, weak) / ivory_fiv_disc_area(weak));
  float apart = distance(strong.light, weak.light);
  float same = max(0.0, 1.0 - apart / min(strong.disc_radius, weak.disc_radius));
  return 1.0 - min((1.0 - gathered) * spread + gathered * same, 1.0);
}

// 1 - hidden / unshadowed per channel, 1 where there is no light.
vec3 ivory_fiv_visible(vec3 hidden, vec3 unshadowed) {
  vec3 share = max(1.0 - hidden / max(unshadowed, 1e-37), 0.0);
  return mix(vec3(1.0), share, greaterThan(unshadowed, vec3(0.0)));
}

IvoryFivShadow ivory_fiv_select(IvoryFivShadow a, IvoryFivShadow b, bool second) {
  return IvoryFivShadow(second ? b.hidden : a.hidden, second ? b.luminance : a.luminance, second ? b.light : a.light,
                        second ? b.disc_radius : a.disc_radius, second ? b.towards : a.towards,
                        second ? b.coverage : a.coverage, second ? b.gathered : a.gathered);
}

// Keeps the stronger and goes on with the other.
void ivory_fiv_exchange(inout IvoryFivShadow kept, inout IvoryFivShadow shadow) {
  IvoryFivShadow before = kept;
  bool stronger = shadow.luminance > before.luminance;
  kept = ivory_fiv_select(before, shadow, stronger);
  shadow = ivory_fiv_select(shadow, before, stronger);
}

#define IVORY_FIV_EXCHANGE(i) ivory_fiv_exchange(shadows.strongest[i], shadow);
#define IVORY_FIV_OPEN(i) open *= ivory_fiv_left_open(shadows.strongest[i], shadow);

// Shadows that hide nothing change nothing.
void ivory_fiv_add(inout IvoryFivShadows shadows, IvoryFivShadow shadow, vec3 unshadowed) {
#if IVORY_FIV_OVERLAP == 3
  shadows.share *= ivory_fiv_visible(shadow.hidden, unshadowed);
#else
  shadows.sum += shadow.hidden;
#endif
#if IVORY_FIV_OVERLAP == 1 || IVORY_FIV_OVERLAP == 2
  IVORY_FIV_FOR_STRONGEST(IVORY_FIV_EXCHANGE)
#endif
#if IVORY_FIV_OVERLAP == 2
  vec3 open = vec3(1.0);
  IVORY_FIV_FOR_STRONGEST(IVORY_FIV_OPEN)
  shadows.share *= ivory_fiv_visible(shadow.hidden * open, unshadowed);
#endif
}

#define IVORY_FIV_PAIR(j, k) ivory_fiv_pair(shadows.strongest[j], shadows.strongest[k], hidden, open);
#if IVORY_FIV_OVERLAP == 1
#define IVORY_FIV_FIRST
#define IVORY_FIV_NEXT(k)
#else
#define IVORY_FIV_FIRST hidden = min(shadows.strongest[0].hidden, unshadowed);
#define IVORY_FIV_NEXT(k) ivory_fiv_next(shadows.strongest[k].hidden, unshadowed, hidden, open);
#endif

// Eq. 13 and 14: of what a pair hides, the share of its discs that they have in common was counted twice. Or what
// the stronger one leaves open to the other.
void ivory_fiv_pair(IvoryFivShadow strong, IvoryFivShadow weak, inout vec3 hidden, inout vec3 open) {
#if IVORY_FIV_OVERLAP == 1
  float share = ivory_fiv_common_area(strong, weak) / (ivory_fiv_disc_area(strong) + ivory_fiv_disc_area(weak));
  if (weak.luminance > 0.0) hidden -= (strong.hidden + weak.hidden) * share;
#else
  open *= ivory_fiv_left_open(strong, weak);
#endif
}

// Adds what the next shadow hides of its light, at most half way from its share of all light to everything of the rest.
void ivory_fiv_next(vec3 own, vec3 unshadowed, inout vec3 hidden, inout vec3 open) {
  vec3 rest = max(unshadowed - hidden, 0.0);
  vec3 share = mix(vec3(0.0), min(own / max(unshadowed, 1e-37), 1.0), greaterThan(unshadowed, vec3(0.0)));
  hidden += min(own * open, rest * (share + 0.5 * (1.0 - share)));
  open = vec3(1.0);
}

// Irradiance in lux that all shadows take together.
vec3 ivory_fiv_hidden(IvoryFivShadows shadows, vec3 unshadowed) {
#if IVORY_FIV_OVERLAP == 0
  return shadows.sum;
#elif IVORY_FIV_OVERLAP == 3
  return unshadowed * (1.0 - shadows.share);
#else
  vec3 hidden = vec3(0.0);
  vec3 open = vec3(1.0);
  IVORY_FIV_FIRST
  IVORY_FIV_PAIR(0, 1) IVORY_FIV_NEXT(1)
  IVORY_FIV_PAIR(0, 2) IVORY_FIV_PAIR(1, 2) IVORY_FIV_NEXT(2)
  IVORY_FIV_PAIR(0, 3) IVORY_FIV_PAIR(1, 3) IVORY_FIV_PAIR(2, 3) IVORY_FIV_NEXT(3)
  IVORY_FIV_PAIR(0, 4) IVORY_FIV_PAIR(1, 4) IVORY_FIV_PAIR(2, 4) IVORY_FIV_PAIR(3, 4) IVORY_FIV_NEXT(4)
  IVORY_FIV_PAIR(0, 5) IVORY_FIV_PAIR(1, 5) IVORY_FIV_PAIR(2, 5) IVORY_FIV_PAIR(3, 5) IVORY_FIV_PAIR(4, 5)
  IVORY_FIV_NEXT(5)
  IVORY_FIV_PAIR(0, 6) IVORY_FIV_PAIR(1, 6) IVORY_FIV_PAIR(2, 6) IVORY_FIV_PAIR(3, 6) IVORY_FIV_PAIR(4, 6)
  IVORY_FIV_PAIR(5, 6) IVORY_FIV_NEXT(6)
  IVORY_FIV_PAIR(0, 7) IVORY_FIV_PAIR(1, 7) IVORY_FIV_PAIR(2, 7) IVORY_FIV_PAIR(3, 7) IVORY_FIV_PAIR(4, 7)
  IVORY_FIV_PAIR(5, 7) IVORY_FIV_PAIR(6, 7) IVORY_FIV_NEXT(7)
#if IVORY_FIV_OVERLAP == 1
  return shadows.sum + hidden;
#else
  return hidden + max(unshadowed - hidden, 0.0) * (1.0 - shadows.share);
#endif
#endif
}

// Of the unshadowed light, or of `open`, what the receiver's own object leaves of it: what remains, in lux.
vec3 ivory_fiv_leave(vec3 open, vec3 unshadowed, vec3 hidden) {
  vec3 share = mix(vec3(0.0), clamp(hidden / max(unshadowed, 1e-37), 0.0, 1.0), greaterThan(unshadowed, vec3(0.0)));
  return min(open, unshadowed) * (1.0 - share);
}
