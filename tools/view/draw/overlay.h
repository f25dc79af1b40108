// A grid's vertices, drawn among the surfaces: as spheres that show what is stored there, or as its vectors.
#pragma once

#include "runtime/renderer/renderer.h"
#include "tools/view/session/assets.h"
#include "tools/view/session/settings.h"

namespace ivory {

// The smallest step of which every step-th vertex along each axis of so many makes at most 20,000.
int automatic_vertex_step(const V3i& size);

class OverlayPass {
 public:
  // Draws settings.debug, one of DebugView::vertices, validity and vectors, into the bound framebuffer and its depth:
  // surfaces hide what lies behind them. Spheres that show light are white Lambert surfaces, in nits. Other colours are
  // as bright as looks right after the exposure of settings.tone. Throws ParameterError for vectors of a basis that
  // stores none.
  void draw(const GridAsset& grid, const RuntimeCamera& camera, const ViewSettings& settings);

 private:
  gl::Program& program(const GridAsset& grid, DebugView view);

  std::map<std::string, gl::Program> programs_;
  gl::VertexArray no_vertices_;
};

}  // namespace ivory
