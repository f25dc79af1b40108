// Which asset lights an object by which method, and what of it moves.
#pragma once

#include <string>

#include "runtime/assets/ambient.h"
#include "tools/view/session/session.h"

namespace ivory {

// Lights an object by a method, from the first asset that it can read. Throws ParameterError where there is none.
void choose_method(ViewSession& session, std::size_t object, ViewMethod method);

// What the method, or the debug view, lacks, for the user; empty for nothing.
std::string lacks(const ViewSession& session, ViewMethod method);
std::string lacks(const ViewSession& session, DebugView view);

// Brings to the GPU where spherical lights and occluders are now. To be called before a frame; needs a current context.
void place_lights_and_occluders(ViewSession& session);

// A grid as the settings read it.
AmbientSource grid_source(const ViewAsset& asset, const ViewSettings& settings);
// The source that lights the object now.
AmbientSource ambient_source(const ViewSession& session, std::size_t object);

}  // namespace ivory
