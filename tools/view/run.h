// What the two ways of running the viewer, with a window and without, have in common.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/cli/common.h"
#include "tools/view/draw/frame.h"
#include "tools/view/session/session.h"

namespace ivory {

struct ViewRun {
  SessionInput input;
  ViewSettings settings;
  std::string method;                   // of all objects; empty: by what was given
  std::vector<std::string> methods_of;  // OBJECT=METHOD
  std::string save_grid;                // where the grid goes that is baked without an asset; empty: nowhere
  std::string reference;
  std::vector<std::string> outputs;     // pictures; in a window the name of screenshots
  std::uint64_t frames = 0;             // 0: one, or in a window until it is closed
  double frames_per_second = 30;        // of time that passes between frames without a window
  int samples = 16;                     // points a pixel
  std::optional<float> exposure_stops;  // empty: found from the first frame
};

// Loads all and applies the choices. Needs a current context. Throws as open_session() does, and UsageError for choices
// that cannot be had.
ViewSession start_session(const ViewRun& run, const CommonOptions& common);

// Exposure in stops for the session's picture as it is: what ivory render would choose. Draws a point of each pixel.
float find_exposure(ViewFrame& frame, ViewSession& session, ViewTarget& target);

// Throws UsageError where the file would hold linear light and the session shows none: the difference to a picture of
// display values.
void require_linear_form(const std::string& path, const ViewSession& session);

// The picture in the target as a file: linear formats hold the mean itself (radiance in nits, or the debug view's
// numbers), the others what the display shows. Throws as require_linear_form() does.
void write_picture(const std::string& path, const ViewSession& session, const ViewTarget& target, bool force);

// What the false colours show: "guard, lux".
std::string legend_title(const ViewSession& session);

// "frame_%04d.png" with its number put in; `path` itself where it has none. has_number() tells which.
bool has_number(const std::string& path);
std::string numbered(const std::string& path, std::uint64_t number);

// The name of the next screenshot with that extension, by the names that -o gives or ivory_%04d: the first number that
// is free.
std::string screenshot_name(const std::vector<std::string>& outputs, const std::string& extension);

// Camera, objects and how each is lit.
nlohmann::ordered_json describe(const ViewSession& session);

}  // namespace ivory
