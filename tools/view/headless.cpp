#include "tools/view/headless.h"

#include <chrono>
#include <cstdlib>
#include <optional>

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/gl/headless_context.h"
#include "tools/view/draw/legend.h"
#include "tools/view/session/light.h"
#include "tracer/image/compare.h"
#include "tracer/image/file.h"

namespace ivory {

namespace {

using Clock = std::chrono::steady_clock;

void draw_frame(ViewFrame& frame, ViewSession& session, ViewTarget& target, int samples) {
  target.reset();
  place_lights_and_occluders(session);
  require_turns(session);
  for (int i = 0; i < samples; ++i) frame.draw_point(session, target, i);
}

}  // namespace

void run_headless(const ViewRun& run, const CommonOptions& common) {
  // Mesa's software renderer brings threads of its own.
  if (common.threads > 0) setenv("LP_NUM_THREADS", std::to_string(common.threads).c_str(), 0);
  const HeadlessContext context;
  ViewSession session = start_session(run, common);
  ViewTarget target(run.input.size.x, run.input.size.y);
  ViewFrame frame;
  for (const std::string& output : run.outputs) require_linear_form(output, session);
  const std::uint64_t frames = run.frames == 0 ? 1 : run.frames;
  pose_scene(session);  // as the first frame has it
  session.settings.tone.exposure_stops =
      run.exposure_stops ? *run.exposure_stops : find_exposure(frame, session, target);

  std::optional<LegendPainter> legend;
  if (ViewFrame::is_false_color(session.settings)) legend.emplace();

  Progress progress(common, "drawing", "frames");
  std::vector<std::string> written;
  double seconds = 0;
  for (std::uint64_t i = 0; i < frames; ++i) {
    session.world.time_s = double(i) / run.frames_per_second;
    if (session.animation) {
      session.animation->time_s = run.input.load.load.time_s.value_or(0) + session.world.time_s;
      pose_scene(session);
      if (!session.world.scene().cameras.empty()) look_as_at_first(session, run.input);
    }
    const auto start = Clock::now();
    draw_frame(frame, session, target, run.samples);
    frame.draw_display(session, target);
    if (legend) {
      const ColorRange range = frame.color_range(session, target);
      target.begin_display();
      legend->draw(range, legend_title(session), target.width(), target.height());
    }
    glFinish();
    seconds += std::chrono::duration<double>(Clock::now() - start).count();
    for (const std::string& output : run.outputs) {
      if (!has_number(output) && i + 1 < frames) continue;
      write_picture(numbered(output, i), session, target, common.force);
      written.push_back(numbered(output, i));
    }
    for (const std::string& note : session.notes) print_note(common, note);
    session.notes.clear();
    progress.update(i + 1, frames);
  }

  nlohmann::ordered_json result{{"outputs", written},
                                {"width", target.width()},
                                {"height", target.height()},
                                {"frames", frames},
                                {"samples", run.samples},
                                {"renderer", gl_description()},
                                {"gpu_bytes", session.bytes() + target.bytes() + frame.bytes()},
                                {"seconds_per_frame", seconds / double(frames)}};
  result.update(describe(session));
  std::string difference;
  if (session.reference && !session.reference->is_display) {
    const ImageDifference d = compare_images(target.read_mean(), session.reference->film);
    result["nrmse"] = d.nrmse;
    result["bias"] = d.bias;
    difference = fmt::format("nrmse {:.4g} and bias {:.4g} against {}\n", d.nrmse, d.bias, session.reference->path);
  }
  print_result(
      common, result,
      fmt::format("{}: {} x {}, {} {}, {:.1f} ms a frame, {} on the GPU ({})\n{}", fmt::join(written, ", "),
                  target.width(), target.height(), frames, frames == 1 ? "frame" : "frames",
                  1000 * seconds / double(frames), format_bytes(session.bytes() + target.bytes() + frame.bytes()),
                  gl_description(), difference));
}

}  // namespace ivory
