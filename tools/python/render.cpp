// Scene.render, ivory.Camera, and pictures to files and back.
#include <array>
#include <cmath>
#include <cstring>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "grid/base/anchor.h"
#include "tools/input/grid.h"
#include "tools/python/arrays.h"
#include "tools/python/assets.h"
#include "tools/python/work.h"
#include "tracer/core/camera.h"
#include "tracer/image/file.h"
#include "tracer/render/final_gather.h"
#include "tracer/render/path_tracer.h"

namespace ivory::python {

namespace py = pybind11;

namespace {

using Point = std::array<double, 3>;
constexpr int largest_side = 65536;

V3d to_v3d(const Point& p) { return {p[0], p[1], p[2]}; }

CameraAsset make_camera(const Point& position, const Point& target, double fov, const Point& up) {
  const CameraAsset camera{to_v3d(position), to_v3d(target), to_v3d(up), fov};
  require(fov > 0 && fov < 180, "fov", "it must be between 0 and 180 degrees");
  const V3d across = (camera.target - camera.position).cross(camera.up);
  require(across.length() > 0 && std::isfinite(across.length()), "target",
          "it must not lie at the position, nor straight along up from it");
  return camera;
}

Camera camera_in(const CameraAsset& asset, const Scene& scene) {
  const V3d back = (asset.position - asset.target).normalized();
  const V3d right = asset.up.cross(back).normalized();
  const V3d up = back.cross(right);
  const V3f at = to_local(asset.position, scene.anchor_m);
  Camera camera;
  camera.name = "ivory.Camera";
  const auto row = [&](int i, const V3f& v) {
    for (int j = 0; j < 3; ++j) camera.to_world[i][j] = v[j];
  };
  row(0, V3f(right));
  row(1, V3f(up));
  row(2, V3f(back));
  row(3, at);
  camera.yfov_rad = float(asset.fov_deg * double(pi) / 180);
  return camera;
}

// None: the scene's first, or one that sees all of it; a name or an index; an ivory.Camera.
Camera choose_camera(const py::object& given, const LitScene& lit, int width, int height) {
  const Scene& scene = *lit.scene;
  if (py::isinstance<CameraAsset>(given)) return camera_in(given.cast<const CameraAsset&>(), scene);
  if (!given.is_none()) return find_camera(scene, py::str(given).cast<std::string>());
  if (!scene.cameras.empty()) return scene.cameras.front();
  return framing_camera(lit.intersector.center(), lit.intersector.radius_m(), float(width) / float(height));
}

py::array_t<float> to_array(const std::vector<Rgb>& pixels, int width, int height) {
  py::array_t<float> array(std::vector<py::ssize_t>{height, width, 3});
  std::memcpy(array.mutable_data(), pixels.data(), pixels.size() * sizeof(Rgb));
  return array;
}

Film to_film(const py::array_t<float, py::array::c_style | py::array::forcecast>& pixels) {
  require(pixels.ndim() == 3 && pixels.shape(2) == 3 && pixels.size() > 0 && pixels.shape(0) <= largest_side &&
              pixels.shape(1) <= largest_side,
          "pixels", "it must have the shape (height, width, 3)");
  Film film;
  film.width = int(pixels.shape(1));
  film.height = int(pixels.shape(0));
  film.pixels.resize(std::size_t(pixels.size()) / 3);
  std::memcpy(static_cast<void*>(film.pixels.data()), pixels.data(), film.pixels.size() * sizeof(Rgb));
  for (const Rgb& pixel : film.pixels)
    require(std::isfinite(pixel.x + pixel.y + pixel.z), "pixels", "some values are not finite");
  return film;
}

py::array_t<float> render(const SceneAsset& scene, const std::string& method, int width, int height, int samples,
                          std::uint64_t seed, const py::object& camera, const GridAsset* grid, int gather,
                          const std::optional<std::string>& guard, const std::string& interpolation,
                          const std::string& reconstruction, int bounces, bool indirect_only, int threads,
                          const py::object& progress) {
  require(width >= 1 && width <= largest_side, "width", "it must be from 1 to 65536");
  require(height >= 1 && height <= largest_side, "height", "it must be from 1 to 65536");
  require(samples >= 1, "samples", "it must be at least 1");
  require(gather >= 1, "gather", "it must be at least 1");
  require(bounces >= 0, "bounces", "it must be at least 0");
  const bool path = method == "path";
  require(path || method == "direct" || method == "gather", "method", "it is path, direct or gather");
  require(path == (grid == nullptr), "grid", "method path reads none; direct and gather need one");
  const LitScene& lit = scene.input.lit;
  const View view = make_view(scene.path, choose_camera(camera, lit, width, height), width, height);
  LookupParams lookup;
  std::vector<std::string> warnings;
  std::optional<IrradianceGrid> moved;
  const IrradianceGrid* read = nullptr;
  if (!path) {
    lookup = lookup_params(*grid, true, {guard, interpolation, reconstruction});
    warnings = check_grid_of(*grid, scene);
    read = &grid_in_scene(*grid, scene, moved);
  }
  LookupTally tally;
  const Film film = run(progress, threads, [&](Job& job) {
    RenderParams params;
    params.samples = samples;
    params.seed = seed;
    params.threads = threads;
    params.progress = job.fractions("rendering");
    if (path) return render_path(lit, view, params, {.max_bounces = bounces, .indirect_only = indirect_only});
    return render_gather(lit, indirect_light(lit, {read, lookup, &tally}), view, params,
                         {.gather_rays = method == "gather" ? gather : 0, .indirect_only = indirect_only});
  });
  if (const auto doubt = doubt_about(lit.intersector, view, "the picture's")) warnings.push_back(*doubt);
  if (grid != nullptr) {
    const std::vector<std::string> doubts = doubts_about(tally, {.grid = grid->name, .lookup = lookup});
    warnings.insert(warnings.end(), doubts.begin(), doubts.end());
  }
  warn(warnings);
  return to_array(film.pixels, film.width, film.height);
}

void write_picture(const std::filesystem::path& path,
                   const py::array_t<float, py::array::c_style | py::array::forcecast>& pixels,
                   std::optional<float> exposure, bool force) {
  const Film film = to_film(pixels);
  const std::string name = path.string();
  require(!exposure || !is_linear_image(name), "exposure", "it serves tone-mapped pictures (.png, .jpg)");
  const py::gil_scoped_release free;
  const float stops = is_linear_image(name) ? 0 : exposure.value_or(auto_exposure(film));
  write_image(name, film, stops, {{"units", std::string("nits")}}, force);
}

py::array_t<float> read_picture(const std::filesystem::path& path) {
  const ImageFile file = [&] {
    const py::gil_scoped_release free;
    return read_image_file(path.string());
  }();
  warn(file.warnings);
  return to_array(file.film.pixels, file.film.width, file.film.height);
}

py::array_t<float> display(const py::array_t<float, py::array::c_style | py::array::forcecast>& pixels,
                           std::optional<float> exposure) {
  const Film film = to_film(pixels);
  const std::vector<float> values = display_values(film, exposure.value_or(auto_exposure(film)));
  py::array_t<float> array(std::vector<py::ssize_t>{film.height, film.width, 3});
  std::memcpy(array.mutable_data(), values.data(), values.size() * sizeof(float));
  return array;
}

}  // namespace

void bind_render(Classes& classes, py::module_& m) {
  classes.camera.doc() = "Where a picture is taken from: places in metres, the vertical field of view in degrees.";
  classes.camera.def(py::init(&make_camera), py::arg("position"), py::arg("target"), py::arg("fov") = 45.0,
                     py::arg("up") = Point{0, 1, 0});
  const PathParams path;
  classes.scene.def(
      "render", &render, py::arg("method") = "path", py::kw_only(), py::arg("width") = 640, py::arg("height") = 480,
      py::arg("samples") = 64, py::arg("seed") = 1, py::arg("camera") = py::none(), py::arg("grid") = py::none(),
      py::arg("gather") = 16, py::arg("guard") = py::none(), py::arg("interpolation") = "trilinear",
      py::arg("reconstruction") = "optimal", py::arg("bounces") = path.max_bounces, py::arg("indirect_only") = false,
      py::arg("threads") = 0, py::arg("progress") = py::none(),
      "A picture of radiance in nits, (height, width, 3): path traced (path), with indirect light read from a grid "
      "(direct), or gathered one bounce before it is read (gather).");
  m.def("write_image", &write_picture, py::arg("path"), py::arg("pixels"), py::kw_only(),
        py::arg("exposure") = py::none(), py::arg("force") = false,
        "Writes (height, width, 3): .exr, .hdr and .tif keep linear values, .png and .jpg are tone-mapped after "
        "2**exposure.");
  m.def("read_image", &read_picture, py::arg("path"), "A picture as (height, width, 3), as the file holds it.");
  m.def("display", &display, py::arg("pixels"), py::kw_only(), py::arg("exposure") = py::none(),
        "What write_image puts into .png files, 0 to 1: for matplotlib.");
}

}  // namespace ivory::python
