// The light of a scene that comes without any: a grid that is baked before the first picture.
#pragma once

#include <string>

#include "tools/view/session/session.h"

namespace ivory {

// Was any asset given that lights?
bool is_lit_by_assets(const ViewSession& session);

// Bakes the scene's indirect light, with the session's environment and without objects, into a grid that joins the
// assets; keeps it as `save_grid` unless that is empty. Always the same for the same scene. Says what it is; does
// nothing but say so where nothing shines. Needs a current context. Throws Error as the bake and the writer do.
void bake_default_grid(ViewSession& session, const std::string& save_grid, const CommonOptions& common);

}  // namespace ivory
