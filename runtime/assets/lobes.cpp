#include "runtime/assets/lobes.h"

#include <cmath>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/io/lobes.h"

namespace ivory {

GpuLobes upload(const LobeTable& table, const std::string& what) {
  gl::require_context();
  const int n = table.exponent_nodes;
  const std::size_t nodes = std::size_t(n) * std::size_t(n) * std::size_t(table.angle_nodes);
  if (n < 2 || table.angle_nodes < 2 || table.values.size() != nodes * LobeTable::channels)
    throw Error(what, "is no lobe table: its size is wrong", "make it with ivory bake lobes");
  std::vector<float> integrals(nodes);
  for (std::size_t i = 0; i < nodes; ++i) integrals[i] = table.values[i * LobeTable::channels];
  std::vector<V4f> blocks;
  for (const MaskBlock& block : mask_blocks()) {
    blocks.emplace_back(block.x, block.y, block.area, block.variance);
    blocks.emplace_back(block.a, block.b, 0.0F, 0.0F);
  }
  GpuLobes lobes;
  const V3i size(table.angle_nodes, n, n);
  lobes.integrals = gl::make_texture_3d(what, gl::Format::r32f, size, integrals.data(), gl::Filter::linear);
  lobes.products = gl::make_texture_3d(what, gl::Format::rgb32f, size, table.values.data(), gl::Filter::linear);
  lobes.blocks = gl::make_texel_buffer(what, blocks);
  lobes.scene = gl::make_texel_buffer(what, std::vector<V4f>(1), /*changes=*/true);
  lobes.exponent_nodes = n;
  lobes.angle_nodes = table.angle_nodes;
  return lobes;
}

GpuLobes load_lobes(const std::string& path) { return upload(read_lobes(path).table, path); }

void place(GpuLobes& lobes, std::span<const RuntimeSphereLight> lights, std::span<const Sphere> occluders) {
  std::vector<Sphere> spheres(occluders.begin(), occluders.end());
  for (const RuntimeSphereLight& light : lights) spheres.push_back(light.sphere);
  const SphereGroups groups = make_sphere_groups(std::move(spheres));
  std::vector<V4f> texels;
  texels.reserve(1 + 2 * lights.size() + groups.groups.size() + groups.spheres.size());
  const auto add = [&texels](const Sphere& sphere) {
    texels.emplace_back(sphere.center.x, sphere.center.y, sphere.center.z, sphere.radius_m);
  };
  for (const RuntimeSphereLight& light : lights) {
    add(light.sphere);
    texels.emplace_back(light.radiance_nits.x, light.radiance_nits.y, light.radiance_nits.z, 0.0F);
  }
  for (const SphereGroups::Group& group : groups.groups) add(group.bounds);
  for (const Sphere& sphere : groups.spheres) add(sphere);
  if (texels.empty()) texels.emplace_back(0.0F, 0.0F, 0.0F, 0.0F);
  gl::write(lobes.scene, "spheres that cast shadows", texels);
  lobes.lights = int(lights.size());
  lobes.groups = int(groups.groups.size());
  lobes.spheres = int(groups.spheres.size());
}

int bind(const GpuLobes& lobes, gl::Program& program, int first_unit, const LobeLightParams& params) {
  const float grow = std::sqrt(2.0F) / float(1 << params.mask_depth);
  program.set("ivory_lobes.table.exponent_nodes", lobes.exponent_nodes);
  program.set("ivory_lobes.table.angle_nodes", lobes.angle_nodes);
  program.set("ivory_lobes.lights", lobes.lights);
  program.set("ivory_lobes.groups", lobes.groups);
  program.set("ivory_lobes.spheres", lobes.spheres);
  program.set("ivory_lobes.threshold", params.threshold);
  program.set("ivory_lobes.grow", params.mask_rule == MaskRule::center   ? 0.0F
                                  : params.mask_rule == MaskRule::inside ? -grow
                                                                         : grow);
  program.set("ivory_lobe_scene", first_unit);
  gl::bind(lobes.scene.texture, first_unit);
  program.set("ivory_lobe_blocks", first_unit + 1);
  gl::bind(lobes.blocks.texture, first_unit + 1);
  program.set("ivory_lobe_integrals", first_unit + 2);
  gl::bind(lobes.integrals, first_unit + 2);
  program.set("ivory_lobe_products", first_unit + 3);
  gl::bind(lobes.products, first_unit + 3);
  return first_unit + 4;
}

std::string lobe_defines(const LobeLightParams& params) {
  if (params.mask_depth < 0 || params.mask_depth > max_mask_depth || params.max_split_level < 0 ||
      params.max_split_level > max_mask_depth)
    throw ParameterError("mask_depth", "masks and split lights have depths from 0 to 5");
  return fmt::format("#define IVORY_MASK_DEPTH {}\n#define IVORY_MAX_SPLIT {}\n", params.mask_depth,
                     params.max_split_level);
}

AmbientSource ambient(const GpuLobes& lobes, bool glossy, const LobeLightParams& params) {
  return {lobe_defines(params) + (glossy ? "#define IVORY_LOBES_GLOSSY\n" : "") + "#include \"ambient/lobes.glsl\"\n",
          [&lobes, params](gl::Program& program, int first_unit) { return bind(lobes, program, first_unit, params); }};
}

}  // namespace ivory
