#include "runtime/c/ivory.h"

#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "grid/base/error.h"
#include "runtime/assets/ambient.h"
#include "runtime/assets/cubemap.h"
#include "runtime/assets/difmap.h"
#include "runtime/assets/fiv.h"
#include "runtime/assets/irradiance_grid.h"
#include "runtime/assets/lobes.h"
#include "runtime/assets/sh9.h"
#include "runtime/gl/gl.h"
#include "runtime/gl/shader_source.h"

namespace {

using namespace ivory;

// What sums share with the light that it was loaded as.
using Asset = std::variant<std::shared_ptr<GpuGrid>, std::shared_ptr<GpuSh9>, std::shared_ptr<GpuDifMap>,
                           std::shared_ptr<GpuLocalizedCube>, std::shared_ptr<GpuFivTables>, std::shared_ptr<GpuLobes>>;

std::string& last_error() {
  thread_local std::string text;
  return text;
}

Rgb rgb_of(const float (&c)[3]) { return {c[0], c[1], c[2]}; }
Sphere sphere_of(const ivory_sphere& s) { return {V3f(s.center_m[0], s.center_m[1], s.center_m[2]), s.radius_m}; }

float radians(float degrees) { return degrees * (pi / 180); }

void require(bool good, const char* what, const char* cause) {
  if (!good) throw Error(what, cause, "see runtime/c/ivory.h");
}

// What `action` returns; `failed`, with the error kept, where it throws.
template <typename Result, typename Action>
Result caught(Result failed, const Action& action) {
  try {
    return action();
  } catch (const std::exception& error) {
    last_error() = error.what();
  } catch (...) {
    last_error() = "an unknown error";
  }
  return failed;
}

}  // namespace

struct ivory_light {
  std::vector<Asset> assets;  // one; of a sum all that it is made of, and of occluders the environment too
  ivory::AmbientSource source;
  std::string shader;
  std::optional<ivory::V3d> anchor_m;  // none where it has several
  bool is_sum = false;
  std::vector<ivory::GpuFivOccluder> occluders;  // of FIV tables, as they were set last
};

namespace {

ivory_light* make_light(std::vector<Asset> assets, AmbientSource source, const std::optional<V3d>& anchor_m) {
  auto light = std::make_unique<ivory_light>();
  light->assets = std::move(assets);
  light->source = std::move(source);
  light->shader = with_includes(light->source.shader);
  light->anchor_m = anchor_m;
  return light.release();
}

// Of an asset that ambient(asset) makes light of.
template <typename Gpu>
ivory_light* load(const char* path, Gpu (*read)(const std::string&), V3d (*anchor_m)(const Gpu&)) {
  return caught<ivory_light*>(nullptr, [&] {
    require(path != nullptr, "path", "is NULL");
    const auto gpu = std::make_shared<Gpu>(read(path));
    return make_light({gpu}, ambient(*gpu), anchor_m(*gpu));
  });
}

template <typename Gpu>
V3d no_anchor(const Gpu&) {
  return {0, 0, 0};
}
template <typename Gpu>
V3d own_anchor(const Gpu& gpu) {
  return gpu.anchor_m;
}

template <typename Gpu>
Gpu& own_asset(const ivory_light* light, const char* what) {
  require(light != nullptr, what, "is NULL");
  const auto* asset = light->is_sum ? nullptr : std::get_if<std::shared_ptr<Gpu>>(&light->assets.front());
  require(asset != nullptr, what, "is a light of another kind");
  return **asset;
}

}  // namespace

extern "C" {

const char* ivory_error(void) { return last_error().c_str(); }

ivory_light* ivory_load_grid(const char* path) {
  return load<GpuGrid>(
      path, [](const std::string& name) { return load_grid(name); }, own_anchor<GpuGrid>);
}

ivory_light* ivory_load_sh9(const char* path) { return load<GpuSh9>(path, load_sh9, no_anchor<GpuSh9>); }

ivory_light* ivory_load_difmap(const char* path) {
  return load<GpuDifMap>(
      path, [](const std::string& name) { return load_difmap(name); }, no_anchor<GpuDifMap>);
}

ivory_light* ivory_load_cubemap(const char* path) {
  return load<GpuLocalizedCube>(path, load_localized_cube, own_anchor<GpuLocalizedCube>);
}

ivory_light* ivory_load_fiv(const char* const* paths, int count, const ivory_light* environment) {
  return caught<ivory_light*>(nullptr, [&] {
    require(paths != nullptr && count > 0, "paths", "are none");
    require(environment != nullptr && !environment->is_sum, "environment", "is neither an SH9 nor a DifMap");
    std::vector<std::string> names;
    for (int i = 0; i < count; ++i) {
      require(paths[i] != nullptr, "paths", "one is NULL");
      names.emplace_back(paths[i]);
    }
    const Asset& unshadowed = environment->assets.front();
    const auto fiv = std::make_shared<GpuFivTables>(load_fiv_tables(names));
    AmbientSource source;
    if (const auto* sh9 = std::get_if<std::shared_ptr<GpuSh9>>(&unshadowed)) {
      source = ambient(*fiv, **sh9);
    } else {
      source = ambient(*fiv, own_asset<GpuDifMap>(environment, "environment"));
    }
    return make_light({fiv, unshadowed}, std::move(source), V3d(0, 0, 0));
  });
}

ivory_light* ivory_load_lobes(const char* path) {
  return caught<ivory_light*>(nullptr, [&] {
    require(path != nullptr, "path", "is NULL");
    const auto lobes = std::make_shared<GpuLobes>(load_lobes(path));
    return make_light({lobes}, ambient(*lobes, /*glossy=*/false), V3d(0, 0, 0));
  });
}

ivory_light* ivory_sum(const ivory_light* const* lights, const float (*weights)[3], int count) {
  return caught<ivory_light*>(nullptr, [&] {
    require(count >= 0 && (lights != nullptr || count == 0), "lights", "are NULL");
    std::vector<WeightedSource> sources;
    std::vector<Asset> assets;
    std::optional<V3d> anchor_m = V3d(0, 0, 0);
    for (int i = 0; i < count; ++i) {
      require(lights[i] != nullptr, "lights", "one is NULL");
      sources.push_back({lights[i]->source, weights != nullptr ? rgb_of(weights[i]) : Rgb(1, 1, 1)});
      assets.insert(assets.end(), lights[i]->assets.begin(), lights[i]->assets.end());
      if (i == 0) anchor_m = lights[i]->anchor_m;
      if (anchor_m != lights[i]->anchor_m) anchor_m.reset();
    }
    ivory_light* sum = make_light(std::move(assets), sum_of(sources), anchor_m);
    sum->is_sum = true;
    return sum;
  });
}

void ivory_free(ivory_light* light) { delete light; }

const char* ivory_shader(const ivory_light* light) { return light != nullptr ? light->shader.c_str() : ""; }

int ivory_bind(const ivory_light* light, unsigned program, int first_unit) {
  return caught(-1, [&] {
    require(light != nullptr, "light", "is NULL");
    gl::require_context();
    gl::BorrowedProgram borrowed(program);
    return light->source.bind(borrowed.program(), first_unit);
  });
}

int ivory_bounds(const ivory_light* light, float least_m[3], float greatest_m[3]) {
  return caught(-1, [&] {
    const GridFrame& frame = own_asset<GpuGrid>(light, "light").frame;
    Imath::Box3f box;
    for (int corner = 0; corner < 8; ++corner) {
      const V3i at((corner & 1) != 0 ? frame.size.x - 1 : 0, (corner & 2) != 0 ? frame.size.y - 1 : 0,
                   (corner & 4) != 0 ? frame.size.z - 1 : 0);
      box.extendBy(frame.to_world(V3f(at)));
    }
    for (unsigned axis = 0; axis < 3; ++axis) {
      least_m[axis] = box.min[axis];
      greatest_m[axis] = box.max[axis];
    }
    return 0;
  });
}

int ivory_anchor(const ivory_light* light, double anchor_m[3]) {
  return caught(-1, [&] {
    require(light != nullptr, "light", "is NULL");
    require(light->anchor_m.has_value(), "light", "is a sum of lights with several anchors");
    for (unsigned axis = 0; axis < 3; ++axis) anchor_m[axis] = (*light->anchor_m)[axis];
    return 0;
  });
}

int ivory_set_occluders(ivory_light* fiv, const ivory_occluder* occluders, int count) {
  return caught(-1, [&] {
    GpuFivTables& tables = own_asset<GpuFivTables>(fiv, "fiv");
    require(count >= 0 && (occluders != nullptr || count == 0), "occluders", "are NULL");
    std::vector<GpuFivOccluder> placed;
    for (const ivory_occluder& occluder : std::span(occluders, std::size_t(count))) {
      require(occluder.table >= 0 && occluder.table < int(tables.sets.size()), "occluders",
              "one has a table that is not there");
      require(occluder.radius_m > 0, "occluders", "one has no extent");
      const float(&c)[3] = occluder.center_m;
      placed.push_back({occluder.table, V3f(c[0], c[1], c[2]), occluder.radius_m, radians(occluder.turn_deg)});
    }
    set_occluders(tables, placed, tables.environment_turn_rad);
    fiv->occluders = std::move(placed);
    return 0;
  });
}

int ivory_turn_environment(ivory_light* light, float turn_deg) {
  return caught(-1, [&] {
    require(light != nullptr && !light->is_sum, "light", "is no environment");
    if (std::holds_alternative<std::shared_ptr<GpuFivTables>>(light->assets.front()))
      set_occluders(own_asset<GpuFivTables>(light, "light"), light->occluders, radians(turn_deg));
    Asset& asset = light->assets.back();
    if (const auto* sh9 = std::get_if<std::shared_ptr<GpuSh9>>(&asset)) {
      (*sh9)->turn_rad = radians(turn_deg);
    } else if (const auto* difmap = std::get_if<std::shared_ptr<GpuDifMap>>(&asset)) {
      (*difmap)->turn_rad = radians(turn_deg);
    } else {
      require(false, "light", "is no environment");
    }
    return 0;
  });
}

int ivory_set_spheres(ivory_light* lobes, const ivory_sphere_light* lights, int light_count,
                      const ivory_sphere* occluders, int occluder_count) {
  return caught(-1, [&] {
    GpuLobes& asset = own_asset<GpuLobes>(lobes, "lobes");
    require(light_count >= 0 && (lights != nullptr || light_count == 0), "lights", "are NULL");
    require(occluder_count >= 0 && (occluders != nullptr || occluder_count == 0), "occluders", "are NULL");
    std::vector<RuntimeSphereLight> shining;
    for (const ivory_sphere_light& light : std::span(lights, std::size_t(light_count)))
      shining.push_back({sphere_of(light.sphere), rgb_of(light.radiance_nits)});
    std::vector<Sphere> hiding;
    for (const ivory_sphere& sphere : std::span(occluders, std::size_t(occluder_count)))
      hiding.push_back(sphere_of(sphere));
    place(asset, shining, hiding);
    return 0;
  });
}

}  // extern "C"
