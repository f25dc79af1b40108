// FIV tables against brute force on a plane, and what baking and reading them costs.
#pragma once

#include <vector>

#include "grid/fiv/light.h"
#include "tracer/bake/fiv/baker.h"

namespace ivory {

// A square of receivers, in bounding radii of the occluder, its centre being the origin.
struct FivPlane {
  V3f point{0, -1, 0};  // the middle of the square
  V3f n{0, 1, 0};       // unit
  float half_side = 3;
  int resolution = 64;  // receivers along a side
};

std::vector<V3f> plane_receivers(const FivPlane& plane);

// The receivers' irradiance under `environment`, every texel as one light, among copies of the occluder moved by
// `copies` (bounding radii): with all light, and what the occluders leave of it by one ray to each light, copy and
// receiver. What tables would say if they were exact.
struct FivReference {
  std::vector<Rgb> e;      // lux
  Rgb unshadowed;          // the same for all: they face one way
  std::vector<bool> open;  // not inside any copy
};
FivReference reference_by_rays(const FivOccluder& occluder, const CubeMap& environment, const FivPlane& plane,
                               const std::vector<V3f>& copies);

// The same from the occluder's table.
std::vector<Rgb> irradiance_by_table(const FivTable& table, const FivPlane& plane, const std::vector<V3f>& copies,
                                     const Rgb& unshadowed, const FivLightParams& params);

// Root of the mean squared difference over the range of the reference, all channels of the open receivers.
double shadow_nrmse(const std::vector<Rgb>& e, const FivReference& reference);

// Environments of 6 x size x size texels: one light of one texel from above and aside, or two coloured discs of
// half-angle 0.28.
CubeMap one_light(int size);
CubeMap two_area_lights(int size);

struct FivBakeTime {
  double table_s = 0;
  double rays_s = 0;          // of the same samples and directions by one ray each, extrapolated from every `stride`th
  double rms_difference = 0;  // between the two, over the largest value
};
// No values are fitted or filled in, which rays know nothing of.
FivBakeTime compare_with_rays(const FivOccluder& occluder, const CubeMap& environment, FivParams params,
                              std::size_t stride);

struct FivReadTime {
  double table_ns = 0;  // one receiver and occluder, one thread
  double ray_ns = 0;    // one occlusion ray towards the environment from the same receivers, one thread
};
FivReadTime time_reading(const FivOccluder& occluder, const FivTable& table, const FivPlane& plane);

}  // namespace ivory
