// A scene's meshes, textures and materials as the runtime draws them.
#pragma once

#include <string>
#include <vector>

#include "runtime/renderer/material.h"
#include "runtime/renderer/mesh.h"
#include "runtime/renderer/punctual_light.h"
#include "tracer/core/scene.h"

namespace ivory {

struct ModelPart {
  std::size_t mesh = 0;
  std::size_t material = 0;
  M44f to_world;
};

// Materials point to textures: the model moves, its textures stay where they are.
struct GpuModel {
  std::vector<GpuMesh> meshes;
  std::vector<gl::Texture> textures;
  std::vector<SurfaceMaterial> materials;
  std::vector<ModelPart> parts;
  std::vector<std::string> left_out;  // one line each: what the picture lacks

  std::size_t bytes() const;
};

// Only what the instances show. Throws Error where OpenGL has no room for it.
GpuModel upload(const Scene& scene);

// From one pose of a scene to another: transforms and vertices alone where both have the same meshes in the same
// places, else all anew. Throws as upload() does.
void update(GpuModel& model, const Scene& before, const Scene& scene);

// The scene's point, spot and directional lights; its other lights give none of them.
std::vector<RuntimeLight> runtime_lights(const Scene& scene);

// The `count` of them that light a scene of that sphere most, in the order that they came in.
std::vector<RuntimeLight> strongest(const std::vector<RuntimeLight>& lights, std::size_t count, const V3f& center_m,
                                    float radius_m);

}  // namespace ivory
