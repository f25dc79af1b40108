// ivory view: the window on the runtime, and the same pictures without a window.
#include <memory>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/cli/commands.h"
#include "tools/input/grid.h"
#include "tools/input/group_factors.h"
#include "tools/input/objects.h"
#include "tools/input/scene.h"
#include "tools/view/headless.h"
#include "tools/view/window/viewer.h"
#include "tracer/image/file.h"

namespace ivory {

namespace {

struct ViewCommand {
  ViewRun run;
  bool headless = false;
  Imath::V2i size{0, 0};
  std::uint64_t samples = 0;
  std::string constant;
  std::vector<std::string> named;  // assets given by --grid and the like
  bool indirect_only = false;
};

void check_outputs(const ViewCommand& command, const CommonOptions& common) {
  if (!command.run.save_grid.empty()) check_output(command.run.save_grid, ".vdb", common);
  for (const std::string& output : command.run.outputs) {
    check_image_name(output);
    if (command.headless && !has_number(output)) check_output(output, common);
    for (std::uint64_t i = 0;
         command.headless && has_number(output) && i < std::max<std::uint64_t>(command.run.frames, 1); ++i)
      check_output(numbered(output, i), common);
  }
}

ViewRun finished(const ViewCommand& command) {
  ViewRun run = command.run;
  run.input.assets.insert(run.input.assets.end(), command.named.begin(), command.named.end());
  if (run.settings.lookup.guard == Guard::rays)
    throw UsageError("--guard rays: shaders trace no rays; planes is what the grid stores of what they would find");
  if (run.settings.lookup.interpolation == Interpolation::fitted)
    throw UsageError("--interpolation fitted: shaders read trilinear and tricubic; render and probe read fitted");
  run.settings.direct = !command.indirect_only;
  run.settings.constant_e_lux = Rgb(0, 0, 0);
  if (!command.constant.empty()) {
    const V3f e(parse_vector3("--constant", command.constant));
    if (!(e.x >= 0 && e.y >= 0 && e.z >= 0)) throw UsageError("--constant: irradiance is not negative");
    run.settings.constant_e_lux = e;
  }
  run.input.may_play = !command.headless;
  if (run.input.plays && !run.input.load.load.time_s) run.input.load.load.time_s = 0;
  run.input.size = command.size.x > 0 ? command.size : command.headless ? Imath::V2i(640, 480) : Imath::V2i(1280, 800);
  if (command.samples > 4096) throw UsageError("--samples: at most 4096 points a pixel");
  run.samples = command.samples > 0 ? int(command.samples) : 16;
  if (run.frames > 1'000'000) throw UsageError("--frames: at most 1000000");
  return run;
}

void run_view(const ViewCommand& command, const CommonOptions& common) {
  const ViewRun run = finished(command);
  if (command.headless && run.outputs.empty()) throw UsageError("--headless needs -o IMAGE");
  check_outputs(command, common);
  if (command.headless) {
    run_headless(run, common);
  } else {
    run_window(run, common);
  }
}

void add_content_options(Command app, ViewCommand& command) {
  app.add_option("scene", command.run.input.scene, "Scene: .gltf or .glb, metres, +Y up").required().type_name("SCENE");
  app.add_option("files", command.run.input.assets,
                 "What lights it, and more: grids (.vdb), SH9 (.json), DifMaps, FIV tables, localized cube maps and\n"
                 "lobe tables (.exr), sphere sets (.json), models (.glb) as objects, lat-long images as environment.\n"
                 "The same files may be dropped onto the window")
      .type_name("FILE");
  app.add_option("--camera", command.run.input.camera,
                 "The scene's camera, by name or index [the first; a framing view where it has none]")
      .type_name("NAME|INDEX");
  add_environment_options(app, command.run.input.environment);
  add_scene_options(app, command.run.input.load);
  app.add_option("--object", command.run.input.objects,
                 "An object that moves: a model placed in the scene, or a node of the scene; may be repeated")
      .repeated()
      .type_name("FILE.glb[@PLACE]|NODE");
  add_place_option(app, command.run.input.places);
  app.add_option(
         "--path", command.run.input.paths,
         "How the object of the same number moves: circle:RADIUS[,SECONDS] on the ground, line:X,Y,Z[,SECONDS]\n"
         "there and back, turn:SECONDS on the spot, or keys:FILE.csv with lines t,x,y,z[,rx,ry,rz[,scale]] (seconds,\n"
         "metres from its place, degrees as in --place, a factor)")
      .repeated()
      .type_name("PATH");
}

void add_light_options(Command app, ViewCommand& command) {
  const std::string group = "Light";
  app.add_option("--method", command.run.method,
                 "Where ambient light comes from: none, constant, sh9, difmap, grid (or direct, as ivory render calls\n"
                 "it), fiv, cubemap, lobes; or several that add up, each with a weight: grid+fiv*0.5, and grid+grid\n"
                 "for two files [the best of what is given; without any asset a grid that is baked at the start]")
      .type_name("NAME[*W][+NAME..]")
      .group(group);
  app.add_option("--method-of", command.run.methods_of,
                 "The same for one object, by its name (file or node; 'scene' for the scene); may be repeated")
      .repeated()
      .type_name("OBJECT=NAME[*W][+NAME..]")
      .group(group);
  app.add_option("--save-grid", command.run.save_grid,
                 "Keeps the grid that is baked where no asset and no method is given [nowhere]: the scene's indirect\n"
                 "light at up to 32 vertices a side, by 128 photons a vertex, some seconds' work; its error is not\n"
                 "measured (ivory bake grid does)")
      .type_name("GRID.vdb")
      .group(group);
  // What ivory render calls the same files, for scripts that draw by both.
  for (const auto& [option, type] : {std::pair{"--grid", "GRID.vdb"},
                                     {"--ambient", "DIFMAP.exr|SH9.json"},
                                     {"--cubemap", "MAP.exr"},
                                     {"--lobes", "LOBES.exr"}}) {
    app.add_option(
           option, [&command](const std::string& path) { command.named.push_back(path); }, "The same as FILE")
        .repeated()
        .type_name(type)
        .group(group);
  }
  app.add_option("--occluder", command.run.input.occluders,
                 "FIV table of a node, which becomes an object; tables given as FILE find their objects by themselves")
      .repeated()
      .type_name("NODE=TABLE.exr")
      .group(group);
  app.add_option(
         "--sphere-light",
         [&command](const std::string& text) {
           command.run.input.sphere_lights.push_back(parse_sphere_light("--sphere-light", text));
         },
         "Adds a spherical light for method lobes: centre and radius in metres, radiance in nits; may be repeated")
      .repeated()
      .type_name("X,Y,Z,RADIUS,R,G,B")
      .group(group);
  app.add_option(
         "--spheres", command.run.input.spheres,
         "Sphere set that casts shadows by method lobes, moved by X,Y,Z, or with the object that it was fitted to")
      .repeated()
      .type_name("SET.json[@X,Y,Z]")
      .group(group);
  app.add_option("--constant", command.constant, "Irradiance of method constant in lux [as bright as the grid]")
      .type_name("R,G,B")
      .group(group);
  add_lookup_options(app, command.run.settings.lookup, "Leak guard of grid look-ups", group);
  app.add_choice("--lookup", command.run.settings.cube_method, "How localized cube maps are read").group(group);
  app.add_choice("--overlap", command.run.settings.fiv.overlap,
                 "How light that several FIV occluders hide is counted once")
      .group(group);
  app.add_choice("--straddling", command.run.settings.fiv.straddling,
                 "FIV occluders that reach below a receiver's plane")
      .group(group);
  app.add_option("--mask-depth", command.run.settings.lobes.mask_depth, "Depth of the quad-tree of lobes' shadows")
      .within(0, max_mask_depth)
      .group(group);
  app.add_choice("--mask", command.run.settings.lobes.mask_rule, "What of a mask's cell must lie behind a sphere")
      .group(group);
  app.add_option("--threshold", command.run.settings.lobes.threshold,
                 "Lobe products under this fraction of the unshadowed light are dropped")
      .within(0.0, 1.0)
      .group(group);
  app.add_option("--split", command.run.settings.lobes.max_split_level,
                 "A light wider than a highlight is taken as up to 4^SPLIT lobes")
      .within(0, max_mask_depth)
      .group(group);
  app.add_option("--lamp", command.run.input.lamps,
                 "A punctual light by its node's name: factor on its brightness, then its colour, then metres that it\n"
                 "is moved by; may be repeated. What grids hold of it stays as it was baked")
      .repeated()
      .type_name("NAME=SCALE[,R,G,B[,X,Y,Z]]")
      .group(group);
  add_group_factor_options(app, command.run.input.factors, {"--group-scale", "--group-tint", group});
  app.add_flag("--indirect-only", command.indirect_only, "Leave out direct light and emission").group(group);
  app.add_option("--shadow-size", command.run.settings.shadow_size, "Texels a side of shadow maps")
      .within(16, 8192)
      .group(group);
}

void add_picture_options(Command app, ViewCommand& command) {
  const std::string group = "Picture";
  app.add_image_size("--size", command.size, "Size of the picture in pixels [640x480; window 1280x800]").group(group);
  app.add_count("--samples", command.samples, "Points a pixel [16; in a window once nothing moves]").group(group);
  app.add_option("--exposure", command.run.exposure_stops,
                 "Stops for tone-mapped pictures [as ivory render chooses, from the first frame]")
      .within(-100.0, 100.0)
      .type_name("STOPS")
      .group(group);
  app.add_choice("--tone", command.run.settings.tone.curve,
                 "Curve from light to display: neutral is that of ivory render")
      .group(group);
  std::string debug = "What is shown instead of light, or on top of it:";
  for (const DebugView view : all_debug_views) debug += fmt::format("\n  {:<11} {}", name_of(view), summary(view));
  app.add_choice("--debug,--view-mode", command.run.settings.debug, debug).type_name("NAME").group(group);
  app.add_flag("--false-color", command.run.settings.false_color, "Debug views irradiance and stored in false colours")
      .group(group);
  app.add_option("--range", command.run.settings.range, "Largest value of false colours [from the picture]")
      .positive()
      .type_name("VALUE")
      .group(group);
  app.add_option("--glyph-scale", command.run.settings.glyph_scale, "Size of spheres and vectors")
      .within(0.01, 100.0)
      .group(group);
  app.add_option("--vertex-step", command.run.settings.vertex_step,
                 "Show each so many of the grid's vertices [so that at most 20000 show]")
      .within(1, 65536)
      .type_name("N")
      .group(group);
  app.add_option("--reference", command.run.reference,
                 "Picture of the same size to compare with: .exr in nits; .png as displayed")
      .type_name("IMAGE")
      .group(group);
}

}  // namespace

void add_view_command(Command app, CommonOptions& common) {
  Command command = app.add_subcommand("view", "Look at a scene lit by baked assets, in a window or without");
  auto options = std::make_shared<ViewCommand>();
  add_content_options(command, *options);
  command.add_flag("--headless", options->headless, "No window: draw --frames and write -o. Needs no display");
  command.add_count("--frames", options->run.frames, "Frames to draw [1; in a window: until it is closed]");
  command.add_flag(
      "--play", options->run.input.plays,
      "Plays the scene's animation from --time on [0]: without a window frame I is what ivory render\n"
      "--time shows at I / --fps later (a scene without a camera stays framed as in the first); in a window it\n"
      "starts over at its end");
  command.add_option("--fps", options->run.frames_per_second, "Frames a second of the paths' time without a window")
      .within(1e-3, 1e6);
  command
      .add_option(
          "-o,--output", options->run.outputs,
          "Picture to write, may be repeated: .exr, .hdr, .tif keep linear nits, or the numbers of a debug view;\n"
          ".png, .jpg what the display shows. The last frame; each one where the name has a number: f_%04d.png.\n"
          "In a window: the name of screenshots [ivory_%04d.png]")
      .repeated()
      .type_name("IMAGE");
  add_light_options(command, *options);
  add_picture_options(command, *options);
  command.footer(
      "In the window: left mouse drags an object over the ground (Shift: in the picture's plane; Ctrl: turns "
      "it)\n"
      "and orbits elsewhere; , and . turn the object clicked last, - and = scale it;\n"
      "right looks around, middle moves, the wheel comes closer; W A S D Q E fly; F all in view, Home the first view;\n"
      "P screenshot, Shift+P as linear EXR, Ctrl+P with the panel; V next debug view, G guard, C tricubic, X "
      "exposure,\n"
      "Space halts paths and animations, Delete removes an object, H hides the panel, Esc quits (--json then prints "
      "where all "
      "is).\n"
      "\nDirect light: point, spot and directional lights by shadow maps; emissive surfaces, spherical lights and the\n"
      "environment by a few dozen points of theirs with shadow maps, others for each of --samples; each but what an\n"
      "object's own light holds (a grid of --direct, a cube map, lobes, an environment's irradiance).\n"
      "\nExamples:\n"
      "  ivory view room.glb\n"
      "  ivory view room.glb room.vdb\n"
      "  ivory view room.glb room.vdb --object knot.glb@0,0,1 --path circle:1,4\n"
      "  ivory view room.glb room.vdb --headless -o room.exr --indirect-only && ivory compare room.exr truth.exr\n"
      "  ivory view room.glb room.vdb --headless --debug vectors -o vectors.png\n"
      "  ivory view room.glb room.vdb --headless --object knot.glb --path circle:1,4 --frames 120 -o f_%04d.png");
  set_action(command, common, Output::file, [options, &common] { run_view(*options, common); });
}

}  // namespace ivory
