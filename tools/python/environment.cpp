// ivory.Environment, ivory.Sh9 and ivory.DifMap: distant light.
#include <cstring>
#include <variant>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "grid/env/irradiance.h"
#include "grid/env/irradiance/sum.h"
#include "grid/io/difmap.h"
#include "grid/io/export/sh9_dialect.h"
#include "grid/io/file.h"
#include "tools/python/arrays.h"
#include "tools/python/assets.h"
#include "tools/python/work.h"

namespace ivory::python {

namespace py = pybind11;

Sh9 make_sh9(std::string name, ivory::Sh9Asset asset) {
  const Sh9MatricesF matrices = to_float(sh9_matrices(asset.sh));
  return {std::move(name), {std::move(asset), matrices}};
}

EnvironmentAsset load_environment_asset(const std::string& path, const std::string& layout) {
  EnvironmentChoice given{path, layout};
  EnvironmentInput input = load_environment_input(given);
  IrradianceTree tree = make_irradiance_tree(input.image);
  return {std::move(given), std::move(input), std::move(tree)};
}

namespace {

using Order = std::variant<std::string, int>;
using Window = std::variant<std::string, double>;

Sh9 bake_sh9(const EnvironmentAsset& environment, const Order& order, double max_error, const Window& window,
             int threads, const py::object& progress) {
  Sh9Choices choices;
  if (const int* fixed = std::get_if<int>(&order)) {
    require(*fixed >= 0 && *fixed <= 2, "order", "it is auto, 0, 1 or 2");
    choices.order = *fixed;
  } else {
    require(std::get<std::string>(order) == "auto", "order", "it is auto, 0, 1 or 2");
  }
  require(max_error >= 0 && max_error <= 1, "max_error", "it must be from 0 to 1");
  choices.max_error = max_error;
  const double* width = std::get_if<double>(&window);
  require(width == nullptr || (*width >= 2 && *width <= 1e6), "window", "a width must be from 2 to 1000000");
  choices.window = width != nullptr ? std::to_string(*width) : std::get<std::string>(window);
  chosen_window(choices.window, {});
  return run(progress, threads, [&](Job&) {
    const RadianceMoments moments = radiance_moments(environment.input.image);
    const IrradianceMap truth = bake_irradiance(environment.tree, sh9_truth_size);
    return make_sh9("SH9 of " + environment.choice.path, make_sh9_asset(sh9_from_moments(moments), choices, truth.e,
                                                                        moments.total, environment.input.origin));
  });
}

DifMapAsset bake_difmap(const EnvironmentAsset& environment, int size, int threads, const py::object& progress) {
  require(size >= 1 && size <= 1024, "size", "it must be from 1 to 1024");
  return run(progress, threads, [&](Job&) {
    IrradianceMap baked = bake_irradiance(environment.tree, size);
    const V3d total = environment.tree.total();
    const Sh9Error error = sh9_error(sh9_from_moments(radiance_moments(environment.input.image)), baked.e, total);
    return DifMapAsset{"DifMap of " + environment.choice.path,
                       make_difmap(std::move(baked), total, error, environment.input.origin)};
  });
}

py::array_t<float> irradiance_of(const EnvironmentAsset& environment, const py::object& n, bool exact) {
  const Vectors normals(n, "n");
  const auto to_rgb = [](const V3d& e) { return Rgb(float(e.x), float(e.y), float(e.z)); };
  if (!exact) return map_normals(normals, [&](const V3f& v) { return to_rgb(environment.tree.irradiance(V3d(v)).e); });
  py::array_t<float> out = map_normals(normals, [](const V3f&) { return Rgb(0, 0, 0); });  // judges them
  Rgb* const values = reinterpret_cast<Rgb*>(out.mutable_data());
  const py::gil_scoped_release free;
  std::vector<V3f> all(normals.count());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = normals.local(i, V3d(0, 0, 0));
  const IrradianceSums sums = sum_irradiance(environment.input.image, all);
  for (std::size_t i = 0; i < all.size(); ++i) values[i] = to_rgb(sums.e[i]);
  return out;
}

void bind_sh9(py::class_<Sh9>& sh9) {
  sh9.doc() = "Nine spherical-harmonic coefficients of distant light.";
  sh9.def_static(
         "read", [](const std::filesystem::path& path) { return make_sh9(path.string(), read_sh9(path.string())); },
         py::arg("path"))
      .def(
          "write",
          [](const Sh9& s, const std::filesystem::path& path, const std::string& dialect, bool force) {
            require(lower_extension(path.string()) == ".json", "path", "it must end in .json");
            write_sh9_dialect(path.string(), s.data.asset, choice<Sh9Dialect>("dialect", dialect), force);
          },
          py::arg("path"), py::kw_only(), py::arg("dialect") = "ivory", py::arg("force") = false,
          "For ivory, or for another reader: three.js, filament, EXT_lights_image_based, babylon.js, playcanvas, "
          "unity.")
      .def(
          "irradiance",
          [](const Sh9& s, const py::object& n) {
            return map_normals(Vectors(n, "n"), [&](const V3f& v) { return ivory::irradiance(s.data.matrices, v); });
          },
          py::arg("n"), "E in lux for unit normals n (..., 3), unshadowed.")
      .def_readonly("name", &Sh9::name)
      .def_property_readonly("metadata", [](const Sh9& s) { return to_dict(s.data.asset.metadata); })
      .def_property_readonly("order", [](const Sh9& s) { return s.data.asset.order; })
      .def_property_readonly("average_error", [](const Sh9& s) { return s.data.asset.error.average; })
      .def_property_readonly("maximum_error", [](const Sh9& s) { return s.data.asset.error.maximum; })
      .def_property_readonly("coefficients",
                             [](const Sh9& s) {
                               py::array_t<double> out(std::vector<py::ssize_t>{9, 3});
                               std::memcpy(out.mutable_data(), s.data.asset.sh.coefficients.data(),
                                           27 * sizeof(double));
                               return out;
                             })
      .def("__repr__", [](const Sh9& s) { return "<ivory.Sh9 '" + s.name + "'>"; });
}

void bind_difmap(py::class_<DifMapAsset>& difmap) {
  difmap.doc() = "The irradiance of distant light for every normal, a cube map.";
  difmap
      .def_static(
          "read",
          [](const std::filesystem::path& path) {
            return DifMapAsset{path.string(), read_difmap(path.string())};
          },
          py::arg("path"))
      .def(
          "write",
          [](const DifMapAsset& d, const std::filesystem::path& path, bool force) {
            require(lower_extension(path.string()) == ".exr", "path", "it must end in .exr");
            write_difmap(path.string(), d.data, force);
          },
          py::arg("path"), py::kw_only(), py::arg("force") = false)
      .def(
          "irradiance",
          [](const DifMapAsset& d, const py::object& n) {
            return map_normals(Vectors(n, "n"), [&](const V3f& v) { return ivory::irradiance(d.data, v); });
          },
          py::arg("n"), "E in lux for unit normals n (..., 3), unshadowed.")
      .def_readonly("name", &DifMapAsset::name)
      .def_property_readonly("metadata", [](const DifMapAsset& d) { return to_dict(d.data.metadata); })
      .def_property_readonly("size", [](const DifMapAsset& d) { return d.data.e.size; })
      .def_property_readonly(
          "texels",
          [](const py::object& self) {
            const CubeMap& e = self.cast<const DifMapAsset&>().data.e;
            return view(reinterpret_cast<const float*>(e.texels.data()), {cube_faces, e.size, e.size, 3}, self);
          })
      .def("__repr__", [](const DifMapAsset& d) { return "<ivory.DifMap '" + d.name + "'>"; });
}

}  // namespace

void bind_environment(Classes& classes) {
  classes.environment.doc() = "An environment map: radiance in nits from all directions.";
  classes.environment
      .def(py::init([](const std::filesystem::path& path, const std::string& layout) {
             EnvironmentAsset environment = [&] {
               const py::gil_scoped_release free;
               return load_environment_asset(path.string(), layout);
             }();
             warn(environment.input.warnings);
             return environment;
           }),
           py::arg("path"), py::kw_only(), py::arg("layout") = "")
      .def_property_readonly("path", [](const EnvironmentAsset& e) { return e.choice.path; })
      .def_property_readonly("layout",
                             [](const EnvironmentAsset& e) { return std::string(name_of(e.input.image.layout)); })
      .def_property_readonly("warnings", [](const EnvironmentAsset& e) { return e.input.warnings; })
      .def_property_readonly("total_radiance", [](const EnvironmentAsset& e) { return to_tuple(e.tree.total()); })
      .def(
          "irradiance", &irradiance_of, py::arg("n"), py::kw_only(), py::arg("exact") = false,
          "E in lux for unit normals n (..., 3), unshadowed: by a tree over the map's texels, a few ten-thousandths of "
          "the mean E off at most for maps of 64 rows and less for finer ones, or by a sum over all texels (exact).")
      .def("bake_sh9", &bake_sh9, py::kw_only(), py::arg("order") = "auto", py::arg("max_error") = 0.01,
           py::arg("window") = "none", py::arg("threads") = 0, py::arg("progress") = py::none(),
           "Nine coefficients, as 'ivory bake sh9' makes them.")
      .def("bake_difmap", &bake_difmap, py::kw_only(), py::arg("size") = 64, py::arg("threads") = 0,
           py::arg("progress") = py::none(), "The irradiance map, as 'ivory bake difmap' makes it.")
      .def("__repr__", [](const EnvironmentAsset& e) { return "<ivory.Environment '" + e.choice.path + "'>"; });
  bind_sh9(classes.sh9);
  bind_difmap(classes.difmap);
}

}  // namespace ivory::python
