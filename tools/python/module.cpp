// The Python module ivory._ivory: classes, exceptions, and reading of any file. tools/python/ivory/__init__.py is what
// users import.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "grid/base/error.h"
#include "grid/io/cubemap.h"
#include "grid/io/difmap.h"
#include "grid/io/fiv.h"
#include "grid/io/sphere_set.h"
#include "tools/cli/usage_error.h"
#include "tools/input/file_kind.h"
#include "tools/input/vdb/load.h"
#include "tools/python/assets.h"
#include "tools/python/work.h"

namespace ivory::python {

namespace py = pybind11;

Classes::Classes(py::module_& m)
    : scene(m, "Scene"),
      mesh(m, "Mesh"),
      camera(m, "Camera"),
      environment(m, "Environment"),
      grid(m, "Grid"),
      sh9(m, "Sh9"),
      difmap(m, "DifMap"),
      fiv(m, "FivTable"),
      cubemap(m, "CubeMap"),
      lobes(m, "LobeTable"),
      spheres(m, "SphereSet") {}

namespace {

// An exception class of the module, which lives as long as the interpreter.
PyObject* add_class(py::module_& m, const char* name, const char* text, const py::object& bases) {
  PyObject* const type = PyErr_NewExceptionWithDoc((std::string("ivory.") + name).c_str(), text, bases.ptr(), nullptr);
  if (type == nullptr) throw py::error_already_set();
  m.attr(name) = py::handle(type);
  return type;
}

PyObject* error_class = nullptr;
PyObject* parameter_error_class = nullptr;

void add_exceptions(py::module_& m) {
  error_class = add_class(m, "Error", "What ivory cannot do: file, cause and remedy, in one line.",
                          py::reinterpret_borrow<py::object>(PyExc_RuntimeError));
  parameter_error_class =
      add_class(m, "ParameterError", "A parameter that is out of range, or does not go with the others.",
                py::make_tuple(py::handle(error_class), py::handle(PyExc_ValueError)));
  set_warning_class(add_class(m, "Warning", "What was ignored, clamped or assumed.",
                              py::reinterpret_borrow<py::object>(PyExc_UserWarning)));
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const ParameterError& error) {
      PyErr_SetString(parameter_error_class, error.what());
    } catch (const UsageError& error) {
      PyErr_SetString(parameter_error_class, error.what());
    } catch (const Error& error) {
      PyErr_SetString(error_class, error.what());
    }
  });
}

py::object read(const std::filesystem::path& file) {
  const std::string path = file.string();
  const auto without_gil = [](const auto& load) {
    const py::gil_scoped_release free;
    return load();
  };
  switch (without_gil([&] { return file_kind(path); })) {
    case FileKind::scene:
      throw Error(path, "is a scene, not an asset", "use ivory.Scene or ivory.Mesh");
    case FileKind::image:
      throw Error(path, "is an image, not an asset", "use ivory.Environment for environment maps");
    case FileKind::grid:
      return py::cast(GridAsset{path, without_gil([&] { return load_grid_vdb(path, true); })});
    case FileKind::sh9:
      return py::cast(make_sh9(path, read_sh9(path)));
    case FileKind::difmap:
      return py::cast(DifMapAsset{path, without_gil([&] { return read_difmap(path); })});
    case FileKind::fiv:
      return py::cast(FivAsset{path, without_gil([&] { return read_fiv(path); })});
    case FileKind::cubemap:
      return py::cast(CubeMapAsset{path, without_gil([&] { return read_localized_cube(path); })});
    case FileKind::lobes:
      return py::cast(LobesAsset{path, without_gil([&] { return read_lobes(path); })});
    case FileKind::spheres:
      return py::cast(SpheresAsset{path, without_gil([&] { return read_spheres(path); })});
  }
  return py::none();
}

}  // namespace

PYBIND11_MODULE(_ivory, m) {
  m.doc() = "ivory bakes light: assets, bakers, look-ups and renderers.";
  m.attr("__version__") = IVORY_VERSION;
  add_exceptions(m);
  Classes classes(m);
  bind_scene(classes);
  bind_render(classes, m);
  bind_grid(classes);
  bind_grid_bake(classes);
  bind_environment(classes);
  bind_cubemap(classes);
  bind_fiv(classes);
  bind_lobes(classes, m);
  m.def("read", &read, py::arg("path"), "The asset of any kind that a file holds.");
}

}  // namespace ivory::python
