// Lights with extent as many small ones, each with a shadow map: what the viewer draws emissive surfaces, spherical
// lights and the environment by. From one point of a pixel to the next others are taken, so that the mean over the
// points has soft shadows.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "grid/base/placement.h"
#include "runtime/renderer/punctual_light.h"
#include "tracer/core/scene.h"
#include "tracer/lights/lights.h"

namespace ivory {

enum class ExtendedKind { surfaces, spheres, environment };

// A piece of such lights: a point of a surface, or a direction of the environment.
struct ExtendedPoint {
  V3f at{0, 0, 0};     // m, where the object has it; environment: unit, towards the light
  V3f n{0, 0, 0};      // unit normal; environment: zero
  Rgb light{0, 0, 0};  // cd along n; environment: lux on a surface that faces it
  float extent = 0;    // m2 that it stands for; environment: sr
  std::size_t object = 0;
};

// Points in groups of neighbours.
struct ExtendedLights {
  ExtendedKind kind = ExtendedKind::surfaces;
  std::vector<ExtendedPoint> points;
  std::vector<std::size_t> ends;  // [group] one past its last point
};

// How many groups there are: so many small lights are drawn at once.
int group_count(ExtendedKind kind);

// Of an object's surfaces that emit: spherical lights, or all others. Positions are the object's own; nothing where
// none emits.
std::vector<ExtendedPoint> surface_points(const Scene& scene, const Lights& lights, ExtendedKind kind,
                                          std::size_t object);
// Of an environment; nothing for a black one. `map` need not outlive them.
std::vector<ExtendedPoint> environment_points(const EnvironmentMap& map);

// Halves the group whose light times reach is greatest, along where it reaches farthest, until there are group_count()
// groups. Lengths count by `radius_m`, of the scene.
ExtendedLights make_extended_lights(ExtendedKind kind, std::vector<ExtendedPoint> points, float radius_m);

// One point of each group, with all of the group's light: another one for each number `sample`, in the middle of the
// group for 0. `places`: where each object stands; `sky`: the turn of the environment, of row vectors. The mean over
// many samples is the light of all.
std::vector<RuntimeLight> small_lights(const ExtendedLights& lights, int sample, std::span<const Placement> places,
                                       const M33f& sky = {});

}  // namespace ivory
