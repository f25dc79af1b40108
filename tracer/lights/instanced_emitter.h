// An emissive mesh that is placed many times: which of its triangles shines is chosen by their power in the mesh's own
// space, so that one table serves all instances. Where an instance is stretched, photons of triangles that grew carry
// more than the others.
#pragma once

#include <vector>

#include "tracer/core/alias_table.h"
#include "tracer/lights/triangle.h"

namespace ivory {

struct InstancedEmitter {
  const MeshEmission* emission = nullptr;
  std::vector<int> triangles;      // of the mesh, those with area that shine
  AliasTable table;                // over them
  std::vector<float> probability;  // with which the table picks each
  std::vector<int> entry;          // [triangle of the mesh]: where it is among them, else no_index
  // Light by direction, for the power of stretched instances: unit normals and their sum of radiance times area.
  struct Facing {
    V3d normal;
    V3d nits_m2;
  };
  std::vector<Facing> facings;
  V3d nits_m2{0, 0, 0};  // of all
};

// `emission` must outlive it.
InstancedEmitter make_instanced_emitter(const Scene& scene, const MeshEmission& emission);

// Of one of its instances, lumen per channel: exact, whatever the instance's transform does to areas.
Rgb power_lm(const Scene& scene, const InstancedEmitter& emitter, int instance);

// One of its triangles, placed, and the probability of picking it.
struct PickedTriangle {
  TriangleLight light;
  float probability;
};
PickedTriangle pick(const Scene& scene, const InstancedEmitter& emitter, int instance, RandomStream& random);

}  // namespace ivory
