// ivory bench runtime: what a frame costs by each source of ambient light, and what loading costs.
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <time.h>
#include <unistd.h>

#include "grid/io/fiv.h"
#include "grid/io/vdb/vdb.h"
#include "runtime/assets/cubemap.h"
#include "runtime/assets/fiv.h"
#include "runtime/assets/irradiance_grid.h"
#include "runtime/assets/lobes.h"
#include "runtime/gl/check.h"
#include "runtime/gl/headless_context.h"
#include "runtime/renderer/renderer.h"
#include "tools/bench/median.h"
#include "tools/bench/runtime_assets.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/environment.h"
#include "tools/input/scene.h"
#include "tracer/bake/fiv/baker.h"

namespace ivory {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr int width = 640;
constexpr int height = 480;
constexpr float floor_half_m = 8;

double wall_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
// Of all threads, the software renderer's among them: other work on the machine does not count.
double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) * 1e3 + double(now.tv_nsec) * 1e-6;
}

struct Target {
  gl::Texture color = gl::make_texture_2d("colour", gl::Format::rgba16f, width, height, nullptr, gl::Filter::nearest);
  gl::Texture depth = gl::make_texture_2d("depth", gl::Format::depth24, width, height, nullptr, gl::Filter::nearest);
  gl::Framebuffer framebuffer = gl::make<gl::Kind::framebuffer>();
};

// A matt floor that fills the frame, seen from a man's height above the objects: the camera and what it sees are the
// same for all.
class Stage {
 public:
  Stage() {
    IVORY_GL(glBindFramebuffer, GL_FRAMEBUFFER, target_.framebuffer.id());
    IVORY_GL(glFramebufferTexture2D, GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target_.color.object.id(), 0);
    IVORY_GL(glFramebufferTexture2D, GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, target_.depth.object.id(), 0);
    IVORY_GL(glViewport, 0, 0, width, height);
    const Mesh floor = make_floor(8 * floor_half_m);
    MeshData data;
    data.positions = floor.positions;
    data.normals = floor.normals;
    data.triangles = floor.triangles;
    floor_ = upload(data, "floor");
    material_.dielectric_f0 = Rgb(0, 0, 0);
    material_.dielectric_f90 = 0;
    M44f camera;
    camera.setEulerAngles(V3f(-0.95F, 0, 0));
    M44f place;
    place.setTranslation(V3f(0, 11, 9));
    frame_.camera = make_perspective(camera * place, 0.8F, float(width) / height, 0.1F, 200);
    frame_.direct = false;
    item_.mesh = &floor_;
    item_.material = &material_;
    frame_.items = std::span(&item_, 1);
  }

  void draw(const AmbientSource& ambient) {
    item_.ambient = &ambient;
    renderer_.draw(frame_);
    glFinish();
  }

  // Of the last frame: alpha is 1 where anything was drawn.
  int pixels_shaded() const {
    std::vector<V4f> pixels(std::size_t(width) * height);
    IVORY_GL(glReadPixels, 0, 0, width, height, GL_RGBA, GL_FLOAT, pixels.data());
    return int(std::count_if(pixels.begin(), pixels.end(), [](const V4f& p) { return p.w > 0; }));
  }

 private:
  Target target_;
  GpuMesh floor_;
  SurfaceMaterial material_;
  DrawItem item_;
  FrameParams frame_;
  Renderer renderer_;
};

struct Method {
  std::string name;
  AmbientSource ambient;
  int occluders = 0;
  GpuFivTables* fiv = nullptr;
  std::span<const GpuFivOccluder> crowd = {};
  std::vector<double> wall = {};
  std::vector<double> cpu = {};
};

// All methods in turn, round after round.
void measure(Stage& stage, std::vector<Method>& methods, int rounds, Progress& progress) {
  for (int round = -1; round < rounds; ++round) {  // the first round compiles
    for (Method& m : methods) {
      if (m.fiv != nullptr) set_occluders(*m.fiv, m.crowd);
      const double wall = wall_ms();
      const double cpu = cpu_ms();
      stage.draw(m.ambient);
      if (round < 0) continue;
      m.wall.push_back(wall_ms() - wall);
      m.cpu.push_back(cpu_ms() - cpu);
    }
    progress.update(std::uint64_t(round + 1), std::uint64_t(rounds));
  }
}

Json report(const std::vector<Method>& methods, int pixels, std::string& text) {
  Json out = Json::array();
  const double wall_1 = median(methods.front().wall);
  const double cpu_1 = median(methods.front().cpu);
  for (const Method& m : methods) {
    const double wall = median(m.wall);
    const double cpu = median(m.cpu);
    Json one{{"method", m.name},
             {"frame_ms", wall},
             {"over_constant", wall / wall_1},
             {"cpu_ms", cpu},
             {"cpu_over_constant", cpu / cpu_1}};
    text += fmt::format("  {:<34} {:>9.2f} ms {:>7.1f}x   CPU {:>9.2f} ms {:>7.1f}x", m.name, wall, wall / wall_1, cpu,
                        cpu / cpu_1);
    if (m.occluders > 0) {
      const double ns = (cpu - cpu_1) * 1e6 / pixels / m.occluders;
      one["cpu_ns_a_receiver_and_occluder"] = ns;
      text += fmt::format("   {:.0f} ns a receiver and occluder", ns);
    }
    text += "\n";
    out.push_back(std::move(one));
  }
  return out;
}

std::vector<GpuFivOccluder> crowd_of(const FivOccluder& object, int count) {
  std::vector<GpuFivOccluder> out;
  const Box3f box = bounds(object.scene);  // in bounding radii about the sphere's centre
  const float radius = object.radius_m;
  for (const V3f& foot : strewn_on_floor(count, floor_half_m - 1))
    out.push_back({0, foot + V3f(0, -box.min.y * radius, 0), radius});
  return out;
}

template <typename Load>
Json load_time(const std::string& path, const char* what, const Load& load, std::string& text) {
  std::vector<double> wall;
  std::vector<double> cpu;
  std::size_t bytes = 0;
  for (int i = 0; i < 3; ++i) {
    const double wall_begin = wall_ms();
    const double cpu_begin = cpu_ms();
    const auto asset = load(path);
    glFinish();
    wall.push_back(wall_ms() - wall_begin);
    cpu.push_back(cpu_ms() - cpu_begin);
    bytes = asset.bytes();
  }
  text += fmt::format("  {:<34} {:>9.0f} ms   CPU {:>9.0f} ms   file {}, on the GPU {}\n", what, median(wall),
                      median(cpu), format_bytes(fs::file_size(path)), format_bytes(bytes));
  return {{"asset", what},
          {"load_ms", median(wall)},
          {"cpu_ms", median(cpu)},
          {"file_bytes", fs::file_size(path)},
          {"gpu_bytes", bytes}};
}

// A folder of its own below the temporary one, gone afterwards.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / fmt::format("ivory_bench_runtime_{}", getpid())) {
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string operator/(const char* name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

Json load_times(const RuntimeBenchAssets& assets, std::string& text) {
  const Folder folder;
  write_vdb(folder / "grid.vdb", assets.grid, false);
  const FivTable six = resampled(assets.table, {256, 129, 30});
  write_fiv(folder / "six.exr", six, ExrPrecision::float32, false);
  const FivTable one = first_hemisphere(six);
  write_fiv(folder / "one.exr", one, ExrPrecision::float32, false);
  const auto tables = [](const std::string& path) { return load_fiv_tables(std::array{path}); };
  const V3i& size = assets.grid.frame.size;
  Json out = Json::array();
  out.push_back(load_time(
      folder / "grid.vdb", fmt::format("grid {}x{}x{}", size.x, size.y, size.z).c_str(),
      [](const std::string& path) { return load_grid(path); }, text));
  out.push_back(load_time(folder / "one.exr", "FIV 256x129x30", tables, text));
  out.push_back(load_time(folder / "six.exr", "FIV 256x129x30, six hemispheres", tables, text));
  return out;
}

struct BenchRuntimeOptions {
  std::string mesh;
  SceneOptions load;
  EnvironmentChoice environment;
  int rounds = 7;
  int grid_side = 64;
};

void run(const BenchRuntimeOptions& options, const CommonOptions& common) {
  const Scene object = load_scene(options.mesh, options.load.load).scene;
  EnvironmentInput input = load_environment_input(options.environment);
  print_warnings(common, input.warnings);
  const EnvironmentMap environment = to_latlong(std::move(input.image));
  const HeadlessContext context;
  Progress progress(common, "measuring", "rounds");
  progress.note("baking what to draw with");
  const RuntimeBenchAssets assets = make_runtime_bench_assets(object, environment, options.grid_side);

  Stage stage;
  const GpuSh9 sh9 = upload(assets.sh9);
  const GpuDifMap difmap = upload(assets.difmap);
  const GpuGrid grid = upload(assets.grid);
  const GpuGrid levels = upload(assets.levels);
  const GpuLocalizedCube cube = upload(assets.cube);
  GpuLobes lobes = upload(assets.lobes);
  place(lobes, std::vector<RuntimeSphereLight>{{{V3f(3, 5, 2), 0.5F}, Rgb(20, 20, 20)}}, assets.spheres.spheres);
  const auto grid_read = [&](Interpolation interpolation, Guard guard) {
    return ambient(grid, LookupParams{.guard = guard, .interpolation = interpolation});
  };
  const auto levels_read = [&](Interpolation interpolation) {
    return ambient(levels, LookupParams{.guard = Guard::planes, .interpolation = interpolation});
  };
  GpuFivTables fiv = upload(std::span(&assets.table, 1));
  const std::vector<GpuFivOccluder> crowd = crowd_of(assets.occluder, 60);
  std::vector<Method> methods;
  methods.push_back({"constant", constant_ambient(Rgb(1, 1, 1))});
  methods.push_back({"SH9", ambient(sh9)});
  methods.push_back({"DifMap", ambient(difmap)});
  methods.push_back({"grid, trilinear", grid_read(Interpolation::trilinear, Guard::off)});
  methods.push_back({"grid, trilinear, guard planes", grid_read(Interpolation::trilinear, Guard::planes)});
  methods.push_back({"grid, tricubic", grid_read(Interpolation::tricubic, Guard::off)});
  methods.push_back({"grid, tricubic, guard planes", grid_read(Interpolation::tricubic, Guard::planes)});
  methods.push_back({"three levels, trilinear, planes", levels_read(Interpolation::trilinear)});
  methods.push_back({"three levels, tricubic, planes", levels_read(Interpolation::tricubic)});
  methods.push_back({"cube map, M = 4", ambient(cube)});
  methods.push_back({fmt::format("lobes, depth 4, {} spheres", assets.spheres.spheres.size()), ambient(lobes, false)});
  for (const int count : {1, 10, 20, 40, 60}) {
    methods.push_back({fmt::format("FIV, {} occluder{}", count, count == 1 ? "" : "s"), ambient(fiv, difmap), count,
                       &fiv, std::span(crowd).first(std::size_t(count))});
  }
  measure(stage, methods, options.rounds, progress);
  const int pixels = stage.pixels_shaded();

  std::string text = fmt::format("{}\n{} x {}, {} pixels shaded\n", gl_description(), width, height, pixels);
  Json result{{"opengl", gl_description()}, {"width", width}, {"height", height}, {"pixels", pixels}};
  result["methods"] = report(methods, pixels, text);

  // The same forty occluders from tables of other sizes, and of the object in sixteen times as many triangles.
  constexpr int forty = 40;
  std::vector<GpuFivTables> others;
  std::vector<std::string> names;
  const auto add = [&](const std::string& name, const FivTable& table, bool half_floats) {
    others.push_back(upload(std::span(&table, 1), {half_floats}));
    names.push_back(name);
  };
  for (const V3i& size : {V3i(32, 17, 15), V3i(128, 65, 30), V3i(256, 129, 30)})
    add(fmt::format("table of {}x{}x{}", size.x, size.y, size.z), resampled(assets.table, size), false);
  add("table of 64x33x30 in halves", assets.table, true);
  const Scene fine = subdivided(object, 2);
  FivParams params;
  params.samples = assets.table.size;
  params.hemispheres = 6;
  add(fmt::format("mesh of {} triangles", format_count(double(assets.triangles))), assets.table, false);
  add(fmt::format("mesh of {} triangles", format_count(double(triangle_count(fine)))),
      bake_fiv(make_fiv_occluder(fine), assets.environment, params), false);
  std::vector<Method> sizes;
  sizes.push_back({"constant", constant_ambient(Rgb(1, 1, 1))});
  for (std::size_t i = 0; i < others.size(); ++i)
    sizes.push_back({names[i], ambient(others[i], difmap), forty, &others[i], std::span(crowd).first(forty)});
  measure(stage, sizes, options.rounds, progress);
  text += "forty occluders by\n";
  result["sizes"] = report(sizes, pixels, text);
  text += "loading\n";
  result["loading"] = load_times(assets, text);
  print_result(common, result, text);
}

}  // namespace

void add_bench_runtime_command(Command bench, CommonOptions& common) {
  Command command = bench.add_subcommand(
      "runtime",
      "Frame times of the OpenGL runtime without a window, 640 x 480, a floor that fills the frame: each source of\n"
      "ambient light beside constant light, in turn; FIV tables by number of occluders, table and mesh; loading.");
  auto options = std::make_shared<BenchRuntimeOptions>();
  command.add_option("MESH", options->mesh, "glTF file of the object that the assets are baked of").required();
  add_environment_options(command, options->environment);
  add_scene_options(command, options->load);
  command.get_option("--env").required();
  command.add_option("--rounds", options->rounds, "Frames of each; medians are reported").within(1, 1000);
  command.add_option("--grid", options->grid_side, "Vertices of the grid along each axis").within(2, 128);
  command.footer("Example:\n  ivory bench runtime scenes/knot.glb --env scenes/sky.hdr");
  set_action(command, common, Output::none, [options, &common] { run(*options, common); });
}

}  // namespace ivory
