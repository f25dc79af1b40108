// ivory view --headless.
#pragma once

#include "tools/view/run.h"

namespace ivory {

// Draws the frames in an OpenGL context of its own, without a window or a display, writes the pictures and prints the
// result. Throws UsageError and Error as the parts do.
void run_headless(const ViewRun& run, const CommonOptions& common);

}  // namespace ivory
