// One entry of an irradiance cache: what arrives at a place of a surface, how that changes around it, and how far it
// can be trusted.
#pragma once

#include "tracer/core/surface.h"
#include "tracer/render/gather/hemisphere.h"

namespace ivory {

struct IrradianceRecord {
  V3f p;
  V3f n;           // unit geometric normal
  V3f tangent[2];  // with n the frame of its sectors
  float radius_m = 0;
  Rgb e{0, 0, 0};  // lux
  V3f vector[3];   // as HemisphereIrradiance
  V3f gradient[3];
  float reach_inverse_m[coarse_sectors];  // 1 / how far it can be used along the surface, by sector
};

// What an error of E counts beside, and within what distances records are to be used.
struct RecordLimits {
  float error = 0.1F;        // share of E that leaving out its second derivatives may make at the record's radius
  float floor_lux = 0;       // added to E's luminance for that: errors of dark places are seen beside lit ones
  float least_radius_m = 0;  // records of a smaller radius are given this one
  float most_radius_m = 0;
};
IrradianceRecord make_record(const V3f& p, const V3f& n, const Hemisphere& hemisphere, const RecordLimits& limits);

// How much the record says about a place of unit normal n, 0 to 1. It falls to nothing at its radius, at what stands
// on the surface between them, and at normals 25 degrees away.
float weight(const IrradianceRecord& record, const V3f& p, const V3f& n);

// E in lux at a place around it, for the unit shading normal ns.
Rgb irradiance(const IrradianceRecord& record, const V3f& p, const V3f& ns);

}  // namespace ivory
