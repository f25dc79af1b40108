// ivory.Grid: a baked irradiance-vector grid, its numbers and its look-ups.
#include <algorithm>
#include <limits>
#include <map>
#include <span>
#include <variant>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "grid/base/anchor.h"
#include "grid/base/certificate.h"
#include "grid/field/evidence.h"
#include "grid/field/mix.h"
#include "grid/io/file.h"
#include "grid/io/vdb/vdb.h"
#include "tools/cli/numbers.h"
#include "tools/input/group_factors.h"
#include "tools/input/vdb/load.h"
#include "tools/python/arrays.h"
#include "tools/python/assets.h"
#include "tools/python/work.h"
#include "tracer/render/guard_rays_batch.h"

namespace ivory::python {

namespace py = pybind11;

LookupParams lookup_params(const GridAsset& grid, bool has_scene, const LookupNames& names) {
  const bool has_planes = !grid.data.guard.empty();
  LookupParams params;
  params.guard = names.guard  ? choice<Guard>("guard", *names.guard)
                 : has_scene  ? Guard::rays
                 : has_planes ? Guard::planes
                              : Guard::off;
  params.interpolation = choice<Interpolation>("interpolation", names.interpolation);
  params.reconstruction = choice<Reconstruction>("reconstruction", names.reconstruction);
  params.nudge_voxels = names.nudge_voxels;
  require(params.nudge_voxels >= 0 && params.nudge_voxels <= 2, "nudge", "it must be from 0 to 2 voxels");
  require(params.guard != Guard::rays || has_scene, "guard", "rays need the scene");
  require(params.guard != Guard::planes || has_planes, "guard", "the grid stores no planes; read it by rays or off");
  require(reads(params.reconstruction, grid.data.basis), "reconstruction", "it reads grids of basis vectors only");
  return params;
}

std::vector<std::string> check_grid_of(const GridAsset& grid, const SceneAsset& scene) {
  const Metadata& baked = grid.data.metadata;
  if (grid.data.light != StoredLight::indirect)
    throw Error(grid.name, "holds direct light, which rendering would count twice", "bake it without direct");
  if (find_text(baked, "environment_hash") != find_text(scene.input.origin, "environment_hash"))
    throw Error(grid.name, "was baked under another environment than the scene has", "load the scene with the same");
  check_scale(grid.name, baked, scene.input.origin);
  const auto hash = find_text(baked, "scene_hash");
  if (!hash || *hash == scene.input.lit.scene->content_hash) return {};
  return {grid.name + " was baked from another scene (" + find_text(baked, "scene").value_or("") + ")"};
}

const IrradianceGrid& grid_in_scene(const GridAsset& grid, const SceneAsset& scene,
                                    std::optional<IrradianceGrid>& moved) {
  const V3d& anchor_m = scene.input.lit.scene->anchor_m;
  if (grid.data.anchor_m == anchor_m) return grid.data;
  moved = grid.data;
  set_anchor(*moved, anchor_m);
  return *moved;
}

namespace {

// As many as lie close together, and yet every thread has some.
constexpr std::size_t points_a_task = 4096;

// What a look-up reads from, and how.
struct Reader {
  const IrradianceGrid* grid = nullptr;
  const Intersector* intersector = nullptr;
  LookupParams params;
  std::optional<IrradianceGrid> moved;
};

void prepare(Reader& reader, const GridAsset& grid, const SceneAsset* scene, const LookupNames& names) {
  reader.params = lookup_params(grid, scene != nullptr, names);
  reader.grid = &grid.data;
  if (scene == nullptr) return;
  require(reader.params.guard == Guard::rays, "scene", "it serves guard rays only");
  check_scale(grid.name, grid.data.metadata, scene->input.origin);
  const auto baked = find_text(grid.data.metadata, "scene_hash");
  if (baked && *baked != scene->input.lit.scene->content_hash)
    warn({scene->path + " is not what " + grid.name + " was baked from"});
  reader.intersector = &scene->input.lit.intersector;
  reader.grid = &grid_in_scene(grid, *scene, reader.moved);
}

py::array_t<float> read_irradiance(const GridAsset& grid, const py::object& p, const py::object& n,
                                   const SceneAsset* scene, const std::optional<std::string>& guard,
                                   const std::string& interpolation, const std::string& reconstruction, float nudge) {
  Reader reader;
  prepare(reader, grid, scene, {guard, interpolation, reconstruction, nudge});
  const IrradianceGrid& data = *reader.grid;
  return map_blocks(Vectors(p, "p"), Vectors(n, "n"), data.anchor_m, points_a_task,
                    [&](std::span<const V3f> points, std::span<const V3f> normals, Rgb* values) {
                      const std::vector<Rgb> e =
                          lookup_irradiance(data, reader.intersector, {points, normals}, normals, reader.params);
                      std::copy(e.begin(), e.end(), values);
                    });
}

py::array_t<float> read_error(const GridAsset& grid, const py::object& p, const py::object& n, const SceneAsset* scene,
                              const std::optional<std::string>& guard, const std::string& interpolation, float nudge) {
  Reader reader;
  prepare(reader, grid, scene, {guard, interpolation, "optimal", nudge});
  const IrradianceGrid& data = *reader.grid;
  const float unmet_lux = unmet_bound_lux(data).value_or(0);
  constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  return map_blocks(Vectors(p, "p"), Vectors(n, "n"), data.anchor_m, points_a_task,
                    [&](std::span<const V3f> points, std::span<const V3f> normals, Rgb* values) {
                      for (const GridReading& reading : lookup_readings(data, reader.intersector, {points, normals},
                                                                        normals, reader.params, unmet_lux)) {
                        const Rgb& error = reading.standard_error;
                        *values++ = is_black(error) ? Rgb(unknown, unknown, unknown) : error;
                      }
                    });
}

py::array_t<double> vertex_positions(const GridAsset& grid) {
  const IrradianceGrid& data = grid.data;
  const std::size_t count = data.vertex_count();
  py::array_t<double> out(std::vector<py::ssize_t>{py::ssize_t(count), 3});
  double* const values = out.mutable_data();
  const py::gil_scoped_release free;
  for (std::size_t v = 0; v < count; ++v) {
    const VertexPlace place = data.place_of(std::uint32_t(v));
    const V3d p = to_world(data.frame_of(place.level).to_world(V3f(place.at)), data.anchor_m);
    for (int axis = 0; axis < 3; ++axis) values[3 * v + std::size_t(axis)] = p[axis];
  }
  return out;
}

py::object certificate(const GridAsset& grid) {
  const auto found = find_certificate(grid.data.metadata);
  if (!found) return py::none();
  py::dict dict;
  dict["target"] = found->target > 0 ? py::object(py::float_(found->target)) : py::none();
  dict["error"] = found->error;
  dict["low"] = found->low;
  dict["high"] = found->high;
  dict["measure"] = found->measure;
  dict["parts"] = found->parts;
  return dict;
}

using Factor = std::variant<float, std::array<float, 3>>;

GridAsset mix(const GridAsset& grid, const std::map<std::string, Factor>& factors) {
  GroupFactors by_group;
  std::string changes;
  for (const auto& [group, factor] : factors) {
    const auto* scale = std::get_if<float>(&factor);
    const Rgb rgb = scale != nullptr ? Rgb(*scale, *scale, *scale)
                                     : Rgb(std::get<1>(factor)[0], std::get<1>(factor)[1], std::get<1>(factor)[2]);
    by_group[group] = rgb;
  }
  const py::gil_scoped_release free;
  GridAsset mixed{"mix of " + grid.name, mix_groups(grid.data, by_group)};
  for (const GridGroup& group : grid.data.groups) {
    const auto found = by_group.find(group.name);
    if (found == by_group.end() || found->second == Rgb(1, 1, 1)) continue;
    changes += (changes.empty() ? "" : " ") + text_of(group.name, found->second);
  }
  if (!changes.empty()) mixed.data.metadata["mix"] = changes;
  return mixed;
}

py::tuple size_of(const GridFrame& frame) { return py::make_tuple(frame.size.x, frame.size.y, frame.size.z); }

}  // namespace

void bind_grid(Classes& classes) {
  using Size = py::ssize_t;
  classes.grid.doc() = "A baked grid of irradiance: E at any point and normal.";
  classes.grid
      .def_static(
          "read",
          [](const std::filesystem::path& path) {
            const py::gil_scoped_release free;
            return GridAsset{path.string(), load_grid_vdb(path.string(), /*with_groups=*/true)};
          },
          py::arg("path"), "A finished grid (.vdb).")
      .def(
          "write",
          [](const GridAsset& g, const std::filesystem::path& path, bool force) {
            require(lower_extension(path.string()) == ".vdb", "path", "it must end in .vdb");
            const py::gil_scoped_release free;
            write_vdb(path.string(), g.data, force);
          },
          py::arg("path"), py::kw_only(), py::arg("force") = false)
      .def("irradiance", &read_irradiance, py::arg("p"), py::arg("n"), py::kw_only(), py::arg("scene") = py::none(),
           py::arg("guard") = py::none(), py::arg("interpolation") = "trilinear", py::arg("reconstruction") = "optimal",
           py::arg("nudge") = LookupParams{}.nudge_voxels,
           "E in lux at points p (..., 3) in metres with unit normals n. The leak guard is rays where the scene is "
           "given, else the stored planes where there are any.")
      .def("standard_error", &read_error, py::arg("p"), py::arg("n"), py::kw_only(), py::arg("scene") = py::none(),
           py::arg("guard") = py::none(), py::arg("interpolation") = "trilinear",
           py::arg("nudge") = LookupParams{}.nudge_voxels,
           "Standard error of that E from photon noise alone, lux: a bound where no photon came, nan where no vertex "
           "sees the point.")
      .def("mix", &mix, py::arg("factors"),
           "A grid of its groups' light times the factors: {'hall': 0.3, 'sky': (1, 0.9, 0.8)}.")
      .def("vertex_positions", &vertex_positions, "Where the vertices stand, (vertices, 3), metres.")
      .def_readonly("name", &GridAsset::name)
      .def_readonly("warnings", &GridAsset::warnings)
      .def_property_readonly("metadata", [](const GridAsset& g) { return to_dict(g.data.metadata); })
      .def_property_readonly("certificate", &certificate)
      .def_property_readonly("basis", [](const GridAsset& g) { return std::string(name_of(g.data.basis)); })
      .def_property_readonly("light", [](const GridAsset& g) { return std::string(name_of(g.data.light)); })
      .def_property_readonly("has_planes", [](const GridAsset& g) { return !g.data.guard.empty(); })
      .def_property_readonly("levels", [](const GridAsset& g) { return g.data.levels(); })
      .def_property_readonly("vertices", [](const GridAsset& g) { return g.data.vertex_count(); })
      .def_property_readonly("resolution", [](const GridAsset& g) { return size_of(g.data.finest_frame()); })
      .def_property_readonly("spacing",
                             [](const GridAsset& g) {
                               return py::tuple(py::cast(shortest(g.data.finest_frame().spacing_m, V3d(0, 0, 0))));
                             })
      .def_property_readonly("groups",
                             [](const GridAsset& g) {
                               std::vector<std::string> names;
                               for (const GridGroup& group : g.data.groups) names.push_back(group.name);
                               return names;
                             })
      .def_property_readonly(
          "moments",
          [](const py::object& self) {
            const IrradianceGrid& g = self.cast<const GridAsset&>().data;
            return view(g.moments.data(), {Size(g.vertex_count()), Size(function_count(g.basis)), 3}, self);
          })
      .def_property_readonly(
          "variance",
          [](const py::object& self) {
            const IrradianceGrid& g = self.cast<const GridAsset&>().data;
            return view(reinterpret_cast<const float*>(g.variance.data()), {Size(g.variance.size()), 3}, self);
          })
      .def_property_readonly("visible_fraction",
                             [](const py::object& self) {
                               const IrradianceGrid& g = self.cast<const GridAsset&>().data;
                               return view(g.visible_fraction.data(), {Size(g.visible_fraction.size())}, self);
                             })
      .def("__repr__", [](const GridAsset& g) {
        return "<ivory.Grid '" + g.name + "', " + std::to_string(g.data.vertex_count()) + " vertices>";
      });
}

}  // namespace ivory::python
