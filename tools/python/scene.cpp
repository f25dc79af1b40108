// ivory.Scene and ivory.Mesh: glTF files, and the light in them path-traced.
#include <cmath>
#include <limits>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "grid/base/anchor.h"
#include "tools/cli/numbers.h"
#include "tools/python/arrays.h"
#include "tools/python/assets.h"
#include "tools/python/work.h"
#include "tracer/render/probe.h"

namespace ivory::python {

namespace py = pybind11;

namespace {

using Path = std::filesystem::path;

SceneOptions scene_options(double scale, std::optional<double> time, const std::string& animation,
                           const std::vector<std::string>& without, bool portable) {
  require(scale >= 1e-6 && scale <= 1e6, "scale", "it must be from 1e-6 to 1e6");
  require(animation.empty() || time, "animation", "it goes with time");
  SceneOptions options;
  options.load.scale = scale;
  options.load.time_s = time;
  options.load.animation = animation;
  options.load.without = without;
  options.intersector.portable = portable;
  return options;
}

SceneAsset load_scene_asset(const Path& path, const std::optional<Path>& environment, const std::string& layout,
                            double scale, std::optional<double> time, const std::string& animation,
                            const std::vector<std::string>& without, bool portable) {
  require(environment || layout.empty(), "layout", "it goes with environment");
  const SceneOptions options = scene_options(scale, time, animation, without, portable);
  EnvironmentChoice choice;
  if (environment) choice = {environment->string(), layout};
  CommonOptions quiet;
  quiet.quiet = true;
  SceneAsset scene = [&] {
    const py::gil_scoped_release free;
    return SceneAsset{path.string(), load_scene_input(path.string(), options, choice, quiet)};
  }();
  warn(scene.input.warnings);
  return scene;
}

MeshInput load_mesh_asset(const Path& path, double scale, std::optional<double> time, const std::string& animation,
                          const std::vector<std::string>& without, bool portable) {
  MeshInput mesh = [&] {
    const SceneOptions options = scene_options(scale, time, animation, without, portable);
    const py::gil_scoped_release free;
    return load_mesh_input(path.string(), options, CommonOptions());
  }();
  warn(mesh.loaded.warnings);
  return mesh;
}

py::object bounds_of(const Scene& scene) {
  const Box3f box = bounds(scene);
  if (box.isEmpty()) return py::none();
  return py::make_tuple(py::tuple(py::cast(shortest(box.min, scene.anchor_m))),
                        py::tuple(py::cast(shortest(box.max, scene.anchor_m))));
}

std::size_t triangles_of(const Scene& scene) {
  std::size_t count = 0;
  for (const Instance& instance : scene.instances) count += scene.meshes[std::size_t(instance.mesh)].triangles.size();
  return count;
}

std::vector<std::string> cameras_of(const Scene& scene) {
  std::vector<std::string> names;
  for (const Camera& camera : scene.cameras) names.push_back(camera.name);
  return names;
}

py::tuple traced_irradiance(const SceneAsset& scene, const py::object& p, const py::object& n, int samples,
                            std::uint64_t seed, bool indirect_only, int bounces, int threads,
                            const py::object& progress) {
  require(samples >= 2, "samples", "it must be at least 2");
  require(bounces >= 1, "bounces", "it must be at least 1");
  const Vectors points(p, "p");
  const Vectors normals(n, "n");
  const Scene& own = *scene.input.lit.scene;
  const std::vector<py::ssize_t> shape = common_shape(points, normals);
  py::array_t<float> e(shape);
  py::array_t<float> error(shape);
  std::vector<ProbePoint> probes(std::size_t(e.size()) / 3);
  for (std::size_t i = 0; i < probes.size(); ++i) {
    probes[i] = {points.local(points.is_one() ? 0 : i, own.anchor_m),
                 normals.local(normals.is_one() ? 0 : i, V3d(0, 0, 0))};
    require(std::isfinite(probes[i].p.x + probes[i].p.y + probes[i].p.z), "p", "some positions are not finite");
    require(std::abs(probes[i].n.length2() - 1) < 2e-3F, "n", "normals must be unit vectors");
  }
  const std::vector<ProbeResult> results = run(progress, threads, [&](Job& job) {
    ProbeParams params;
    params.samples = samples;
    params.max_bounces = bounces;
    params.seed = seed;
    params.threads = threads;
    params.indirect_only = indirect_only;
    params.progress = job.fractions("tracing");
    return probe_scene(scene.input.lit, probes, params);
  });
  Rgb* const values = reinterpret_cast<Rgb*>(e.mutable_data());
  Rgb* const errors = reinterpret_cast<Rgb*>(error.mutable_data());
  constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < results.size(); ++i) {
    values[i] = results[i].e;
    // All samples black: as many as there are say nothing of what the next one may bring.
    errors[i] = is_black(results[i].e) ? Rgb(unknown, unknown, unknown) : results[i].standard_error;
  }
  return py::make_tuple(e, error);
}

}  // namespace

void bind_scene(Classes& classes) {
  classes.scene.doc() = "A glTF scene, ready to be traced: +Y up, metres; light in candela, lux and nits.";
  classes.scene
      .def(py::init(&load_scene_asset), py::arg("path"), py::arg("environment") = py::none(), py::kw_only(),
           py::arg("layout") = "", py::arg("scale") = 1.0, py::arg("time") = py::none(), py::arg("animation") = "",
           py::arg("without") = std::vector<std::string>{}, py::arg("portable") = false)
      .def_readonly("path", &SceneAsset::path)
      .def_property_readonly("warnings", [](const SceneAsset& s) { return s.input.warnings; })
      .def_property_readonly("origin", [](const SceneAsset& s) { return to_dict(s.input.origin); })
      .def_property_readonly("bounds", [](const SceneAsset& s) { return bounds_of(*s.input.lit.scene); })
      .def_property_readonly("triangles", [](const SceneAsset& s) { return triangles_of(*s.input.lit.scene); })
      .def_property_readonly("cameras", [](const SceneAsset& s) { return cameras_of(*s.input.lit.scene); })
      .def("irradiance", &traced_irradiance, py::arg("p"), py::arg("n"), py::kw_only(), py::arg("samples") = 1024,
           py::arg("seed") = 1, py::arg("indirect_only") = false, py::arg("bounces") = ProbeParams{}.max_bounces,
           py::arg("threads") = 0, py::arg("progress") = py::none(),
           "E in lux at points p (..., 3) with unit normals n, path-traced, and its standard error (nan where no "
           "path met light).")
      .def("__repr__", [](const SceneAsset& s) { return "<ivory.Scene '" + s.path + "'>"; });

  classes.mesh.doc() = "A glTF file taken as one object: an occluder, without lights.";
  classes.mesh
      .def(py::init(&load_mesh_asset), py::arg("path"), py::kw_only(), py::arg("scale") = 1.0,
           py::arg("time") = py::none(), py::arg("animation") = "", py::arg("without") = std::vector<std::string>{},
           py::arg("portable") = false)
      .def_readonly("path", &MeshInput::path)
      .def_property_readonly("warnings", [](const MeshInput& m) { return m.loaded.warnings; })
      .def_property_readonly("bounds", [](const MeshInput& m) { return bounds_of(m.loaded.scene); })
      .def_property_readonly("triangles", [](const MeshInput& m) { return triangles_of(m.loaded.scene); })
      .def("__repr__", [](const MeshInput& m) { return "<ivory.Mesh '" + m.path + "'>"; });
}

}  // namespace ivory::python
