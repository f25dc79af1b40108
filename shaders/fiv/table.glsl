// FIV occluder tables: the light that an occluder hides, by the receiver's place around it. Twin: grid/fiv/table.h.
//
// `atlas`: all tables in one 3D texture with linear filtering. A table is a box of it, a slab for each four of its
// numbers, three slabs side by side: azimuth (the first column once more behind the last) to x, polar angle to y,
// spheres to z. A texel holds moments over fiv_falloff() of its sphere and over the table's scale. Slabs 0 to 2 hold
// the vectors F_x, F_y, F_z (rgb) and, of six hemispheres, D_xx.rgb in their alphas; slabs 3 to 8 the other D in order,
// D_xy.r to D_zz.b: number 4 s + c is channel c of slab s.
// `spheres`: a row a table, a texel for each of its bins of even width in log2 of the distance. There at most one
// sphere lies within a bin: (log2 of its radius, its index, spheres an octave before it, and behind it).
#include "base/fast_angle.glsl"
#include "base/pi.glsl"

struct IvoryFivTable {
  vec4 origin;    // xyz: the first texel of slab 0; w: slabs, 3 or 9
  vec4 samples;   // azimuths, polar angles, spheres; w: coverage, the share of the bounding disc that is filled
  vec4 bins;      // log2 of the first and the last radius, bins an octave, bins
  vec4 scale;     // x: of the moments, lux; y: most_hidden() in lux; z: row in `spheres`
  vec4 total[9];  // moments of the whole environment in the order of the slabs, lux
};

// Moments in the order of the slabs.
struct IvoryFivMoments {
  vec4 slab[9];
};

// Over bounding radii.
float ivory_fiv_falloff(float r) { return r > 1.0 ? 1.0 / (r * r) : 1.0; }

// Index of the sphere at distance r, fractional between two: even in log r.
float ivory_fiv_sphere(sampler2D spheres, IvoryFivTable table, float r) {
  float x = clamp(log2(max(r, 1e-30)), table.bins.x, table.bins.y);
  float bin = min(floor((x - table.bins.x) * table.bins.z), table.bins.w - 1.0);
  vec4 knot = texelFetch(spheres, ivec2(int(bin), int(table.scale.z)), 0);
  float sphere = knot.y + (x - knot.x) * (x < knot.x ? knot.z : knot.w);
  return clamp(sphere, 0.0, table.samples.z - 1.0);
}

// lookup() of the twin. q: the receiver's position relative to the occluder's centre in bounding radii. Three fetches,
// nine where `split` asks for the D of six hemispheres too; otherwise they are 0.
IvoryFivMoments ivory_lookup(sampler3D atlas, sampler2D spheres, IvoryFivTable table, vec3 q, bool split) {
  float r = length(q);
  float azimuth = 0.5 + ivory_fast_angle(-q.x, q.z) / (2.0 * ivory_pi);
  float polar = ivory_fast_angle(length(q.xz), q.y) / ivory_pi;
  vec3 texel = vec3(0.5) + table.origin.xyz +
               vec3(clamp(azimuth, 0.0, 1.0) * table.samples.x, clamp(polar, 0.0, 1.0) * (table.samples.y - 1.0),
                    ivory_fiv_sphere(spheres, table, r));
  vec3 per_texel = 1.0 / vec3(textureSize(atlas, 0));
  vec3 at = texel * per_texel;
  vec3 right = vec3((table.samples.x + 1.0) * per_texel.x, 0.0, 0.0);
  vec3 down = vec3(0.0, table.samples.y * per_texel.y, 0.0);
  float scale = table.scale.x * ivory_fiv_falloff(r);
  IvoryFivMoments m;
  m.slab[0] = textureLod(atlas, at, 0.0) * scale;
  m.slab[1] = textureLod(atlas, at + right, 0.0) * scale;
  m.slab[2] = textureLod(atlas, at + 2.0 * right, 0.0) * scale;
  if (split && table.origin.w > 3.0) {
    m.slab[3] = textureLod(atlas, at + down, 0.0) * scale;
    m.slab[4] = textureLod(atlas, at + down + right, 0.0) * scale;
    m.slab[5] = textureLod(atlas, at + down + 2.0 * right, 0.0) * scale;
    m.slab[6] = textureLod(atlas, at + 2.0 * down, 0.0) * scale;
    m.slab[7] = textureLod(atlas, at + 2.0 * down + right, 0.0) * scale;
    m.slab[8] = textureLod(atlas, at + 2.0 * down + 2.0 * right, 0.0) * scale;
  } else {
    for (int s = 3; s < 9; ++s) m.slab[s] = vec4(0.0);
  }
  return m;
}

// n.F, and n.D_x, n.D_y, n.D_z.
vec3 ivory_fiv_dot_f(IvoryFivMoments m, vec3 n) {
  return m.slab[0].rgb * n.x + m.slab[1].rgb * n.y + m.slab[2].rgb * n.z;
}
vec3 ivory_fiv_dot_dx(IvoryFivMoments m, vec3 n) {
  return vec3(m.slab[0].a, m.slab[1].a, m.slab[2].a) * n.x + m.slab[3].rgb * n.y +
         vec3(m.slab[3].a, m.slab[4].rg) * n.z;
}
vec3 ivory_fiv_dot_dy(IvoryFivMoments m, vec3 n) {
  return vec3(m.slab[4].ba, m.slab[5].r) * n.x + m.slab[5].gba * n.y + m.slab[6].rgb * n.z;
}
vec3 ivory_fiv_dot_dz(IvoryFivMoments m, vec3 n) {
  return vec3(m.slab[6].a, m.slab[7].rg) * n.x + vec3(m.slab[7].ba, m.slab[8].r) * n.y + m.slab[8].gba * n.z;
}

// irradiance_bracket().lower of grid/field/basis.h. For an axis i, with a = n.F and b = n.D_i, it is
// max(0, (a + b) / 2) + max(0, (a - b) / 2) = max(0, a, (a + |b|) / 2).
vec3 ivory_fiv_lower_bound(IvoryFivMoments m, vec3 n) {
  vec3 a = ivory_fiv_dot_f(m, n);
  vec3 b = max(abs(ivory_fiv_dot_dx(m, n)), max(abs(ivory_fiv_dot_dy(m, n)), abs(ivory_fiv_dot_dz(m, n))));
  return max(max(a, 0.5 * (a + b)), 0.0);
}

// Irradiance in lux that the occluder takes from a receiver of unit normal n over whose plane its centre stands d
// bounding radii high. `straddling`: 0 bound, 1 scale.
vec3 ivory_hidden_irradiance(IvoryFivTable table, IvoryFivMoments hidden, vec3 n, float d, int straddling) {
  if (d <= -1.0) return vec3(0.0);
  vec3 whole = max(ivory_fiv_dot_f(hidden, n), 0.0);
  if (d >= 1.0) return whole;
  if (straddling == 1) return whole * ((d + 1.0) * 0.5);
  return table.origin.w > 3.0 ? ivory_fiv_lower_bound(hidden, n) : whole;
}

// Irradiance in lux that the occluder leaves to a point of its own surface.
vec3 ivory_self_shadowed_irradiance(IvoryFivTable table, IvoryFivMoments hidden, vec3 n) {
  IvoryFivMoments visible;
  for (int s = 0; s < 9; ++s) visible.slab[s] = table.total[s] - hidden.slab[s];
  return table.origin.w > 3.0 ? ivory_fiv_lower_bound(visible, n) : max(ivory_fiv_dot_f(visible, n), 0.0);
}
