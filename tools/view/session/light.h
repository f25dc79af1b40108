// Which asset lights an object by which method, and what of it moves.
#pragma once

#include <string>
#include <string_view>

#include "runtime/assets/ambient.h"
#include "tools/view/session/session.h"

namespace ivory {

// Lights an object by a method alone, from the first asset that it can read. Throws ParameterError where there is none.
void choose_method(ViewSession& session, std::size_t object, ViewMethod method);
// The same for one of the sources that add up; the second of one method reads the second asset of its kind.
void choose_method(ViewSession& session, std::size_t object, std::size_t part, ViewMethod method);
// By "METHOD[*WEIGHT][+METHOD[*WEIGHT]...]": "grid+fiv*0.5". Throws ParameterError as choose_method() does and for
// texts that say nothing.
void choose_lights(ViewSession& session, std::size_t object, std::string_view text);
// Such a text of what lights the object.
std::string lights_text(const ViewObject& object);

// The direct light that an object's sources hold, and that is not to be drawn once more.
struct HeldLight {
  bool punctual = false;
  bool surfaces = false;  // that emit, but for spherical lights
  bool spheres = false;   // spherical lights
  bool environment = false;
  bool holds(ExtendedKind kind) const {
    return kind == ExtendedKind::surfaces ? surfaces : kind == ExtendedKind::spheres ? spheres : environment;
  }
};
HeldLight held_light(const ViewSession& session, const ViewObject& object);

// What the method, or the debug view, lacks, for the user; empty for nothing.
std::string lacks(const ViewSession& session, ViewMethod method);
std::string lacks(const ViewSession& session, DebugView view);

// Brings to the GPU where spherical lights and occluders are now. To be called before a frame; needs a current context.
void place_lights_and_occluders(ViewSession& session);

// Throws ParameterError ("method") where an object that is lit by FIV has an occluder that is turned as its tables
// cannot be; after place_lights_and_occluders().
void require_turns(const ViewSession& session);

// A grid as the settings read it.
AmbientSource grid_source(const ViewAsset& asset, const ViewSettings& settings);
// The source that lights the object now.
AmbientSource ambient_source(const ViewSession& session, std::size_t object);

}  // namespace ivory
