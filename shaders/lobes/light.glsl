// Light of spherical lights that a surface made of cosine lobes reflects, with soft shadows from sphere sets. Twin of
// grid/lobes/light.cpp, where the formulas are derived.
//
// Define before it, else the defaults hold:
//   IVORY_MAX_LOBES   lobes that a reflectance may have, the diffuse one included (2; up to 8 for Lafortune's)
//   IVORY_MAX_SPLIT   a light wider than a highlight is taken as up to 4^n leaves (3; at most IVORY_LEAF_DEPTH)
//   IVORY_MASK_DEPTH  of the mask's quad-tree (lobes/visibility.glsl)
// A compiler lays out IVORY_MAX_LOBES copies of the product: no more than you need.
//
// Inputs: IvoryLobeLights and the samplers, all from ivory::bind(GpuLobes). `scene` (RGBA32F) holds
//   [0, 2 lights)      a light's centre and radius, m; its radiance, nits
//   [.., + groups)     spheres around eight neighbours each
//   [.., + spheres)    the occluders, group by group; lights among them
#include "base/pi.glsl"
#include "lobes/table.glsl"
#ifndef IVORY_MAX_LOBES
#define IVORY_MAX_LOBES 2
#endif
#ifndef IVORY_MAX_SPLIT
#define IVORY_MAX_SPLIT 3
#endif
#if !defined(IVORY_LEAF_DEPTH) && defined(IVORY_MASK_DEPTH)
#if IVORY_MASK_DEPTH < IVORY_MAX_SPLIT
#define IVORY_LEAF_DEPTH IVORY_MAX_SPLIT
#else
#define IVORY_LEAF_DEPTH IVORY_MASK_DEPTH
#endif
#endif
#include "lobes/visibility.glsl"

struct IvoryLobeLights {
  IvoryLobeTable table;
  int lights;
  int groups;
  int spheres;
  float threshold;  // products below this fraction of the lobe's unshadowed light are dropped; 0 keeps all
  float grow;       // of ivory_splat_sphere()
};

// The reflectance towards one direction times max(ns.wi, 0): colours times lobes of scale 1 at most. The first is the
// Lambertian one, of exponent 1; black where there is none.
struct IvoryReflectanceLobes {
  int count;
  IvoryLobe lobe[IVORY_MAX_LOBES];
  vec3 color[IVORY_MAX_LOBES];
};

// Does a Lambertian surface see of a patch its vector moment alone? Well above the horizon it does.
bool ivory_patch_is_above(float cosine, float spread) {
  return cosine > 0.0 && cosine * cosine >= 4.5 * spread * (2.0 - 2.0 * spread);
}
float ivory_lambert_product(IvoryLobe f, float cosine, float height, float spread) {
  return f.scale * cosine * 2.0 * ivory_pi * height * (1.0 - spread);
}

// f with the lobe of a patch: its solid angle over 2 pi and 1 - mean cosine.
float ivory_product_with_patch(IvoryLobeTable table, sampler3D integrals, IvoryLobe f, vec3 axis, float height,
                               float spread) {
  float cosine = dot(f.axis, axis);
  if (f.exponent == 1.0 && ivory_patch_is_above(cosine, spread))
    return ivory_lambert_product(f, cosine, height, spread);
  return ivory_lobe_product_integral(table, integrals, f, ivory_spread_lobe(axis, height, spread));
}

// The product of f with a leaf of that height is below `least` where the angle's cosine is below the returned value.
float ivory_cosine_of_product(IvoryLobe f, float height, float least) {
  float e = min(2.0 / height - 2.0, 100000.0);
  float peak = f.scale * 2.0 * ivory_pi * (2.0 - height) / (f.exponent + e + 1.0);
  float ratio = least / peak;
  if (!(ratio < 1.0)) return 2.0;  // even the peak is
  float harmonic = f.exponent * e / max(f.exponent + e, 1e-6);
  return harmonic > 1e-3 ? pow(ratio, 1.0 / harmonic) : -1.0;
}

// The level at which the light's leaves are a quarter as wide as f, or as wide as they may be.
int ivory_split_level(IvoryLobe f, IvoryLightCap cap) {
  float e = 2.0 / cap.height - 2.0;
  int level = 0;
  for (int i = 0; i < IVORY_MAX_SPLIT; ++i) {
    level += e < 16.0 * f.exponent ? 1 : 0;
    e *= 4.0;
  }
  return level;
}

// Marks what the spheres hide of the light. `wanted` false leaves all lit.
void ivory_make_shadow_mask(inout uint rows[IVORY_MASK_SIZE], IvoryLobeLights lobes, samplerBuffer scene, vec4 light,
                            IvoryLightCap cap, vec3 p, bool wanted) {
  float light_power = ivory_power(light, p);
  float cosine = 1.0 - cap.height;
  float sine = sqrt(cap.height * (2.0 - cap.height));
  int first_group = 2 * lobes.lights;
  int first_sphere = first_group + lobes.groups;
  // Two loops, the inner one looking for the next sphere to splat: lanes that run side by side wait for the longest
  // list of spheres found, not of spheres asked. (Not as do-while loops: nested ones go wrong in Mesa 22.3.)
  int i = wanted ? 0 : lobes.spheres;
  bool open = false;  // within a group that may hide something
  while (i < lobes.spheres) {
    bool found = false;
    vec4 sphere = vec4(0.0);
    while (!found && i < lobes.spheres) {
      sphere = texelFetch(scene, open ? first_sphere + i : first_group + (i >> 3));
      bool may = ivory_may_hide(sphere, p, cap.z, cosine, sine);
      found = open && may;
      int next = open ? i + 1 : (may ? i : i + 8);
      open = open ? (next & 7) != 0 : may;
      i = next;
    }
    ivory_splat_sphere(rows, sphere, found, cap, p, light_power, lobes.grow);
  }
}

// Radiance in nits that a surface at world p with shading normal ns sends on. A light that holds p gives nothing,
// spheres that hold p cast no shadow there.
vec3 ivory_lobe_light(IvoryLobeLights lobes, samplerBuffer scene, samplerBuffer blocks, sampler3D integrals, vec3 p,
                      vec3 ns, IvoryReflectanceLobes r) {
  vec3 radiance = vec3(0.0);
  for (int light_index = 0; light_index < lobes.lights; ++light_index) {
    vec4 light = texelFetch(scene, 2 * light_index);
    bool lights = ivory_power(light, p) > 0.0 && dot(light.xyz - p, ns) > -light.w;
    // A light far away stands in where none shines, so that numbers stay numbers.
    IvoryLightCap cap = ivory_make_light_cap(lights ? light : vec4(p + ns, 0.5), p);
    uint rows[IVORY_MASK_SIZE];
    for (int j = 0; j < IVORY_MASK_SIZE; ++j) rows[j] = 0u;
    ivory_make_shadow_mask(rows, lobes, scene, light, cap, p, lights);

    float whole[IVORY_MAX_LOBES];
    float lit[IVORY_MAX_LOBES];
    float dark[IVORY_MAX_LOBES];
    int split[IVORY_MAX_LOBES];
    float least_cosine[IVORY_MAX_LOBES * (IVORY_LEAF_DEPTH + 1)];
    int level = 0;
    for (int k = 0; k < IVORY_MAX_LOBES; ++k) {
      lit[k] = 0.0;
      dark[k] = 0.0;
      split[k] = k < r.count ? ivory_split_level(r.lobe[k], cap) : 0;
      level = max(level, split[k]);
      whole[k] = ivory_product_with_patch(lobes.table, integrals, r.lobe[k], cap.z, cap.height, 0.5 * cap.height);
      for (int l = 0; l <= IVORY_LEAF_DEPTH; ++l) {
        float height = min(cap.height * (4.0 / ivory_pi) / float(1 << (2 * l)), cap.height);
        float least = ivory_cosine_of_product(r.lobe[k], height, lobes.threshold * whole[k]);
        least_cosine[k * (IVORY_LEAF_DEPTH + 1) + l] = lobes.threshold > 0.0 ? least : -2.0;
      }
    }

    IvoryMaskLeaves leaves = ivory_mask_leaves(rows, level);
    IvoryLeafWalk walk = ivory_begin_leaves(leaves);
    float lit_height = 0.0;
    bool at_horizon = false;  // is any leaf? Then the Lambertian lobe needs its table, and a second walk.
    do {
      IvoryMaskLeaf leaf = ivory_next_leaf(walk, leaves, blocks, cap);
      lit_height += leaf.lit ? leaf.height : 0.0;
      float cosine = dot(r.lobe[0].axis, leaf.axis);
      at_horizon = at_horizon || !ivory_patch_is_above(cosine, leaf.spread);
      float diffuse = cosine >= least_cosine[leaf.level]
                          ? ivory_lambert_product(r.lobe[0], cosine, leaf.height, leaf.spread)
                          : 0.0;
      lit[0] += leaf.lit ? diffuse : 0.0;
      dark[0] += leaf.lit ? 0.0 : diffuse;
      for (int k = 1; k < IVORY_MAX_LOBES; ++k) {
        if (dot(r.lobe[k].axis, leaf.axis) >= least_cosine[k * (IVORY_LEAF_DEPTH + 1) + leaf.level]) {
          float product =
              ivory_product_with_patch(lobes.table, integrals, r.lobe[k], leaf.axis, leaf.height, leaf.spread);
          lit[k] += leaf.lit ? product : 0.0;
          dark[k] += leaf.lit ? 0.0 : product;
        }
      }
    } while (ivory_more_leaves(walk));

    float lit_again = 0.0;
    float dark_again = 0.0;
    walk = ivory_begin_leaves(leaves);
    while (at_horizon && ivory_more_leaves(walk)) {
      IvoryMaskLeaf leaf = ivory_next_leaf(walk, leaves, blocks, cap);
      float product = ivory_product_with_patch(lobes.table, integrals, r.lobe[0], leaf.axis, leaf.height, leaf.spread);
      if (dot(r.lobe[0].axis, leaf.axis) < least_cosine[leaf.level]) product = 0.0;
      lit_again += leaf.lit ? product : 0.0;
      dark_again += leaf.lit ? 0.0 : product;
    }
    if (at_horizon) {
      lit[0] = lit_again;
      dark[0] = dark_again;
    }

    vec3 reflected = vec3(0.0);
    for (int k = 0; k < IVORY_MAX_LOBES; ++k) {
      float all = lit[k] + dark[k];
      // A threshold so high that nothing is left: by solid angle.
      float part = all > 0.0 ? (split[k] > 0 ? lit[k] : whole[k] * (lit[k] / all))
                             : whole[k] * (lit_height / cap.height);
      if (k < r.count && whole[k] > 0.0) reflected += r.color[k] * part;
    }
    if (lights) radiance += texelFetch(scene, 2 * light_index + 1).rgb * reflected;
  }
  return radiance;
}

// The lobes of a Lambertian surface: E = pi L for f = 1/pi, so that a colour of 1 gives E.
IvoryReflectanceLobes ivory_lambert_lobes(vec3 ns, vec3 color) {
  IvoryReflectanceLobes r;
  r.count = 1;
  for (int k = 0; k < IVORY_MAX_LOBES; ++k) {
    r.lobe[k] = IvoryLobe(ns, 1.0, 1.0);
    r.color[k] = color;
  }
  return r;
}

#if IVORY_MAX_LOBES > 1
// Adds f = color max(axis.wi, 0)^exponent, 1/sr, above the horizon of ns.
void ivory_add_glossy_lobe(inout IvoryReflectanceLobes r, IvoryLobeTable table, sampler3D products, vec3 ns, vec3 axis,
                           float exponent, vec3 color) {
  IvoryLobe product = ivory_lobe_product(table, products, IvoryLobe(ns, 1.0, 1.0), IvoryLobe(axis, exponent, 1.0));
  for (int k = 0; k < IVORY_MAX_LOBES; ++k) {
    if (k == r.count) {
      r.lobe[k] = product;
      r.color[k] = color;
    }
  }
  ++r.count;
}

// Exponent of the Phong lobe as wide as a GGX lobe of roughness alpha.
float ivory_phong_exponent(float roughness_alpha) {
  float alpha2 = max(roughness_alpha * roughness_alpha, 1e-12);
  return clamp(0.5 * (1.0 - alpha2) / alpha2, 0.0, 100000.0);
}

// Modified Phong: f = kd/pi + ks (e + 2)/(2 pi) max(r.wi, 0)^e, kd the diffuse albedo times what ks, the specular
// reflectance at normal incidence, leaves over.
IvoryReflectanceLobes ivory_phong_lobes(IvoryLobeTable table, sampler3D products, vec3 ns, vec3 wo, vec3 diffuse_albedo,
                                        vec3 ks, float roughness_alpha) {
  float largest = max(ks.x, max(ks.y, ks.z));
  IvoryReflectanceLobes r = ivory_lambert_lobes(ns, diffuse_albedo * (max(0.0, 1.0 - largest) / ivory_pi));
  float exponent = ivory_phong_exponent(roughness_alpha);
  vec3 mirror = normalize(ns * (2.0 * dot(ns, wo)) - wo);
  ivory_add_glossy_lobe(r, table, products, ns, mirror, exponent, ks * ((exponent + 2.0) / (2.0 * ivory_pi)));
  return r;
}
#endif
