// Groups of lights that the viewer's grids keep apart: dimmed and coloured as one looks.
#pragma once

#include <string>
#include <vector>

#include "tools/view/session/session.h"

namespace ivory {

// Of all grids, each once, in the order of the files.
std::vector<std::string> group_names(const ViewSession& session);

// Mixes all grids by session.factors, and dims the punctual lights with them. Needs a current context. Throws
// ParameterError ("groups") for a factor whose group no grid has, and as mix_groups() does. Emissive surfaces and the
// environment shine as they are.
void mix_groups(ViewSession& session);

}  // namespace ivory
