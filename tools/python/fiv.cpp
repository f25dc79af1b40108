// Mesh.bake_fiv and ivory.FivTable.
#include "grid/io/fiv.h"

#include <array>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "grid/base/memory.h"
#include "grid/io/file.h"
#include "tools/python/arrays.h"
#include "tools/python/assets.h"
#include "tools/python/work.h"
#include "tracer/bake/fiv/baker.h"

namespace ivory::python {

namespace py = pybind11;

namespace {

FivAsset bake_table(const MeshInput& mesh, const EnvironmentAsset& environment, const std::array<int, 3>& samples,
                    int hemispheres, int env_size, int parts, float farthest, int silhouette, int threads,
                    const py::object& progress) {
  FivParams params;
  params.samples = {samples[0], samples[1], samples[2]};
  params.hemispheres = hemispheres;
  params.environment_size = env_size;
  params.parts = parts;
  params.farthest = farthest;
  params.silhouette_pixels = silhouette;
  params.intersector = mesh.options.intersector;
  const auto within = [](int value, int low, int high) { return value >= low && value <= high; };
  require(within(samples[0], 3, 65536) && within(samples[1], 2, 65536) && within(samples[2], 2, 65536), "samples",
          "at least 3 azimuths, 2 polar angles and 2 distances are needed, and at most 65536");
  require(hemispheres == 1 || hemispheres == 6, "hemispheres", "it is 1 or 6");
  require(within(env_size, 1, 512), "env_size", "it must be from 1 to 512");
  require(within(parts, 1, 1'000'000), "parts", "it must be from 1 to 1000000");
  require(farthest >= 1.5F && farthest <= 1000, "farthest", "it must be from 1.5 to 1000");
  require(within(silhouette, 8, 1024), "silhouette", "it must be from 8 to 1024");
  check_memory(mesh.path, fiv_bake_bytes(params), "ask for fewer samples");
  return run(progress, threads, [&](Job& job) {
    params.progress = [report = job.counts("baking")](std::size_t done, std::size_t total) { report(done, total); };
    const FivOccluder occluder = make_fiv_occluder(mesh.loaded.scene);
    const CubeMap cube = fine_cube(to_latlong(environment.input.image), env_size);
    FivAsset asset{"FIV table of " + mesh.path, bake_fiv(occluder, cube, params)};
    asset.data.metadata = fiv_facts(mesh, occluder, params, environment.input.origin);
    return asset;
  });
}

}  // namespace

void bind_fiv(Classes& classes) {
  const FivParams params;
  classes.mesh.def("bake_fiv", &bake_table, py::arg("environment"), py::kw_only(),
                   py::arg("samples") = std::array<int, 3>{params.samples.x, params.samples.y, params.samples.z},
                   py::arg("hemispheres") = params.hemispheres, py::arg("env_size") = params.environment_size,
                   py::arg("parts") = params.parts, py::arg("farthest") = params.farthest,
                   py::arg("silhouette") = params.silhouette_pixels, py::arg("threads") = 0,
                   py::arg("progress") = py::none(),
                   "What the moving mesh hides of an environment's light, as 'ivory bake fiv' tabulates it.");
  classes.fiv.doc() = "An occluder table: the light of an environment that a moving mesh hides.";
  classes.fiv
      .def_static(
          "read",
          [](const std::filesystem::path& path) {
            return FivAsset{path.string(), read_fiv(path.string())};
          },
          py::arg("path"))
      .def(
          "write",
          [](const FivAsset& f, const std::filesystem::path& path, const std::string& precision, bool force) {
            require(lower_extension(path.string()) == ".exr", "path", "it must end in .exr");
            const auto kept = choice<ExrPrecision>("precision", precision);
            const py::gil_scoped_release free;
            write_fiv(path.string(), f.data, kept, force);
          },
          py::arg("path"), py::kw_only(), py::arg("precision") = std::string(name_of(ExrPrecision::float32)),
          py::arg("force") = false)
      .def(
          "hidden_irradiance",
          [](const FivAsset& f, const py::object& p, const py::object& n, const std::string& straddling) {
            const auto how = choice<Straddling>("straddling", straddling);
            const FivTable& table = f.data;
            return map_points(Vectors(p, "p"), Vectors(n, "n"), V3d(0, 0, 0), [&](const V3f& at, const V3f& normal) {
              const V3f q = at / table.radius_m;
              return ivory::hidden_irradiance(table, lookup(table, q), normal, -q.dot(normal), how);
            });
          },
          py::arg("p"), py::arg("n"), py::kw_only(), py::arg("straddling") = "bound",
          "E in lux that the occluder hides from points p (..., 3), metres from its bounding sphere's centre, with "
          "unit normals n.")
      .def_readonly("name", &FivAsset::name)
      .def_property_readonly("metadata", [](const FivAsset& f) { return to_dict(f.data.metadata); })
      .def_property_readonly("hemispheres", [](const FivAsset& f) { return f.data.hemispheres; })
      .def_property_readonly("radius", [](const FivAsset& f) { return f.data.radius_m; })
      .def_property_readonly("center", [](const FivAsset& f) { return to_tuple(V3d(f.data.center_m)); })
      .def_property_readonly("radii", [](const FivAsset& f) { return f.data.radii; })
      .def_property_readonly(
          "values",
          [](const py::object& self) {
            const FivTable& t = self.cast<const FivAsset&>().data;
            return view(t.values.data(), {t.size.z, t.size.y, t.size.x, fiv_function_count(t.hemispheres), 3}, self);
          })
      .def("__repr__", [](const FivAsset& f) { return "<ivory.FivTable '" + f.name + "'>"; });
}

}  // namespace ivory::python
