// Scene.bake_cubemap and ivory.CubeMap.
#include "grid/io/cubemap.h"

#include <array>
#include <cmath>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "grid/base/anchor.h"
#include "grid/io/file.h"
#include "tools/cli/numbers.h"
#include "tools/input/assumptions.h"
#include "tools/input/grid.h"
#include "tools/python/arrays.h"
#include "tools/python/assets.h"
#include "tools/python/work.h"
#include "tracer/bake/cubemap/capture.h"

namespace ivory::python {

namespace py = pybind11;

namespace {

CubeMapAsset bake_cubemap(const SceneAsset& scene, const std::array<double, 3>& at, int size, int capture, int samples,
                          std::uint64_t seed, const GridAsset* grid, const std::optional<std::string>& guard,
                          const std::string& interpolation, const std::string& reconstruction, const std::string& shell,
                          int threads, const py::object& progress) {
  const LitScene& lit = scene.input.lit;
  const V3d place(at[0], at[1], at[2]);
  require(std::isfinite(place.length2()), "at", "it is not finite");
  require(size >= 1 && size <= largest_localized_size, "size", "it must be from 1 to 64");
  require(capture >= 1 && capture <= 4096, "capture", "it must be from 1 to 4096");
  require(capture % size == 0, "size", "it must divide capture");
  require(samples >= 1 && samples <= 1'000'000, "samples", "it must be from 1 to 1000000");
  require(grid != nullptr || !guard, "guard", "it serves a grid");
  const ShellFit fit = choice<ShellFit>("shell", shell);
  if (lit.lights.empty())
    throw Error(scene.path, "nothing emits light", "add a light or an emissive material, or give an environment");
  GridInputOptions read;
  std::optional<IrradianceGrid> moved;
  LookupTally tally;
  GridLight light;
  std::vector<std::string> said;
  if (grid != nullptr) {
    read = {grid->name, lookup_params(*grid, true, {guard, interpolation, reconstruction})};
    said = check_grid_of(*grid, scene);
    light = {&grid_in_scene(*grid, scene, moved), read.lookup, &tally};
  }
  CubeMapAsset asset = run(progress, threads, [&](Job& job) {
    CaptureParams params;
    params.size = capture;
    params.samples = samples;
    params.seed = seed;
    params.threads = threads;
    params.progress = job.fractions("capturing");
    if (grid != nullptr) params.grid = &light;
    const Capture captured = capture_cube(lit, to_local(place, lit.scene->anchor_m), params);
    std::vector<std::string> warnings = judge_capture(scene.path, place, captured, *lit.scene);
    const std::vector<std::string> doubts = doubts_about(tally, read);
    warnings.insert(warnings.end(), doubts.begin(), doubts.end());
    CubeMapAsset made{"cube map of " + scene.path, localize(captured.cube, size, fit), warnings};
    made.data.metadata = cubemap_facts(scene.input.origin, params, fit, warnings);
    if (grid != nullptr) {
      describe(read, made.data.metadata);
      describe(tally, made.data.metadata);
    }
    return made;
  });
  said.insert(said.end(), asset.warnings.begin(), asset.warnings.end());
  warn(said);
  return asset;
}

}  // namespace

void bind_cubemap(Classes& classes) {
  const CaptureParams params;
  classes.scene.def("bake_cubemap", &bake_cubemap, py::arg("at"), py::kw_only(), py::arg("size") = 4,
                    py::arg("capture") = params.size, py::arg("samples") = params.samples, py::arg("seed") = 1,
                    py::arg("grid") = py::none(), py::arg("guard") = py::none(), py::arg("interpolation") = "trilinear",
                    py::arg("reconstruction") = "optimal", py::arg("shell") = "fitted", py::arg("threads") = 0,
                    py::arg("progress") = py::none(), "What arrives at a point, as 'ivory bake cubemap' captures it.");
  classes.cubemap.doc() = "A localized cube map: what arrives at a point, and from how far.";
  classes.cubemap
      .def_static(
          "read",
          [](const std::filesystem::path& path) {
            return CubeMapAsset{path.string(), read_localized_cube(path.string())};
          },
          py::arg("path"))
      .def(
          "write",
          [](const CubeMapAsset& c, const std::filesystem::path& path, bool force) {
            require(lower_extension(path.string()) == ".exr", "path", "it must end in .exr");
            write_localized_cube(path.string(), c.data, force);
          },
          py::arg("path"), py::kw_only(), py::arg("force") = false)
      .def(
          "irradiance",
          [](const CubeMapAsset& c, const py::object& p, const py::object& n, const std::string& method) {
            const CubeReader reader = make_cube_reader(c.data, choice<CubeMethod>("method", method));
            return map_points(Vectors(p, "p"), Vectors(n, "n"), c.data.anchor_m,
                              [&](const V3f& at, const V3f& normal) { return ivory::irradiance(reader, at, normal); });
          },
          py::arg("p"), py::arg("n"), py::kw_only(), py::arg("method") = "polygon",
          "E in lux at points p (..., 3) near the reference point, with unit normals n.")
      .def_readonly("name", &CubeMapAsset::name)
      .def_readonly("warnings", &CubeMapAsset::warnings)
      .def_property_readonly("metadata", [](const CubeMapAsset& c) { return to_dict(c.data.metadata); })
      .def_property_readonly("size", [](const CubeMapAsset& c) { return c.data.radiance.size; })
      .def_property_readonly(
          "position",
          [](const CubeMapAsset& c) { return py::tuple(py::cast(shortest(c.data.origin_m, c.data.anchor_m))); })
      .def_property_readonly(
          "radiance",
          [](const py::object& self) {
            const CubeMap& map = self.cast<const CubeMapAsset&>().data.radiance;
            return view(reinterpret_cast<const float*>(map.texels.data()), {cube_faces, map.size, map.size, 3}, self);
          })
      .def("__repr__", [](const CubeMapAsset& c) { return "<ivory.CubeMap '" + c.name + "'>"; });
}

}  // namespace ivory::python
