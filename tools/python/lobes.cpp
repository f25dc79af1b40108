// ivory.bake_lobes, ivory.LobeTable, Mesh.bake_spheres and ivory.SphereSet.
#include <cmath>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "grid/base/anchor.h"
#include "grid/io/file.h"
#include "grid/io/sphere_set.h"
#include "tools/python/arrays.h"
#include "tools/python/assets.h"
#include "tools/python/work.h"
#include "tracer/bake/spheres/fit.h"

namespace ivory::python {

namespace py = pybind11;

namespace {

LobesAsset bake_lobes(int exponent_nodes, int angle_nodes, std::uint64_t error_samples, std::uint64_t seed, int threads,
                      const py::object& progress) {
  require(error_samples >= 1 && error_samples <= 100'000'000, "error_samples", "it must be from 1 to 100000000");
  return run(progress, threads, [&](Job&) {
    LobesAsset asset{"lobe table", {make_lobe_table({exponent_nodes, angle_nodes}), {}}};
    asset.data.metadata = lobe_facts(lobe_table_errors(asset.data.table, error_samples, seed), seed);
    return asset;
  });
}

SpheresAsset bake_spheres(const MeshInput& mesh, int count, int resolution, int threads, const py::object& progress) {
  require(count >= 1 && count <= 4096, "count", "it must be from 1 to 4096");
  require(resolution == 0 || (resolution >= 16 && resolution <= 192), "resolution",
          "it must be from 16 to 192, or 0 to go by the count");
  return run(progress, threads, [&](Job& job) {
    SphereFitParams params;
    params.count = count;
    params.resolution = resolution;
    params.progress = job.fractions("fitting");
    SphereFit fit = fit_spheres(mesh.loaded.scene, params);
    fit.set.metadata = sphere_facts(mesh, fit, count);
    return SpheresAsset{"spheres of " + mesh.path, std::move(fit.set)};
  });
}

py::array_t<double> spheres_of(const SpheresAsset& asset) {
  const SphereSet& set = asset.data;
  py::array_t<double> out(std::vector<py::ssize_t>{py::ssize_t(set.spheres.size()), 4});
  double* values = out.mutable_data();
  for (const Sphere& sphere : set.spheres) {
    const V3d center = to_world(sphere.center, set.anchor_m);
    for (const double value : {center.x, center.y, center.z, double(sphere.radius_m)}) *values++ = value;
  }
  return out;
}

double product_integral(const LobesAsset& lobes, float e1, float e2, float angle_rad) {
  require(e1 >= 0 && e2 >= 0, "exponent", "it must be 0 or more");
  const Lobe a{V3f(0, 0, 1), e1, 1};
  const Lobe b{V3f(std::sin(angle_rad), 0, std::cos(angle_rad)), e2, 1};
  return double(lobe_product_integral(lobes.data.table, a, b));
}

}  // namespace

void bind_lobes(Classes& classes, py::module_& m) {
  const LobeTableParams params;
  m.def("bake_lobes", &bake_lobes, py::kw_only(), py::arg("exponent_nodes") = params.exponent_nodes,
        py::arg("angle_nodes") = params.angle_nodes, py::arg("error_samples") = 100'000, py::arg("seed") = 1,
        py::arg("threads") = 0, py::arg("progress") = py::none(),
        "The table of products of cosine lobes, as 'ivory bake lobes' makes it.");
  classes.mesh.def("bake_spheres", &bake_spheres, py::kw_only(), py::arg("count") = 64, py::arg("resolution") = 0,
                   py::arg("threads") = 0, py::arg("progress") = py::none(),
                   "The mesh as spheres that cast its shadows, as 'ivory bake spheres' fits them.");

  classes.lobes.doc() = "Products of two cosine lobes as one lobe.";
  classes.lobes
      .def_static(
          "read",
          [](const std::filesystem::path& path) {
            return LobesAsset{path.string(), read_lobes(path.string())};
          },
          py::arg("path"))
      .def(
          "write",
          [](const LobesAsset& l, const std::filesystem::path& path, bool force) {
            require(lower_extension(path.string()) == ".exr", "path", "it must end in .exr");
            write_lobes(path.string(), l.data.table, l.data.metadata, force);
          },
          py::arg("path"), py::kw_only(), py::arg("force") = false)
      .def("product_integral", &product_integral, py::arg("exponent1"), py::arg("exponent2"), py::arg("angle"),
           "The integral over the sphere of the product of two lobes of unit scale, their axes so many radians apart.")
      .def_readonly("name", &LobesAsset::name)
      .def_property_readonly("metadata", [](const LobesAsset& l) { return to_dict(l.data.metadata); })
      .def_property_readonly("values",
                             [](const py::object& self) {
                               const LobeTable& t = self.cast<const LobesAsset&>().data.table;
                               return view(t.values.data(),
                                           {t.exponent_nodes, t.exponent_nodes, t.angle_nodes, LobeTable::channels},
                                           self);
                             })
      .def("__repr__", [](const LobesAsset& l) { return "<ivory.LobeTable '" + l.name + "'>"; });

  classes.spheres.doc() = "A mesh as a set of spheres.";
  classes.spheres
      .def_static(
          "read",
          [](const std::filesystem::path& path) {
            return SpheresAsset{path.string(), read_spheres(path.string())};
          },
          py::arg("path"))
      .def(
          "write",
          [](const SpheresAsset& s, const std::filesystem::path& path, bool force) {
            require(lower_extension(path.string()) == ".json", "path", "it must end in .json");
            write_spheres(path.string(), s.data, force);
          },
          py::arg("path"), py::kw_only(), py::arg("force") = false)
      .def_readonly("name", &SpheresAsset::name)
      .def_property_readonly("metadata", [](const SpheresAsset& s) { return to_dict(s.data.metadata); })
      .def_property_readonly("spheres", &spheres_of, "x, y, z and radius of each, metres.")
      .def("__len__", [](const SpheresAsset& s) { return s.data.spheres.size(); })
      .def("__repr__", [](const SpheresAsset& s) { return "<ivory.SphereSet '" + s.name + "'>"; });
}

}  // namespace ivory::python
