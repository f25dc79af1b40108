// A grid's vertices, drawn among the surfaces: as spheres that show what is stored there, or as its vectors.
#pragma once

#include "runtime/renderer/renderer.h"
#include "tools/view/session/assets.h"
#include "tools/view/session/settings.h"

namespace ivory {

// Every so many vertices per axis that at most some 20,000 show.
int automatic_vertex_step(const GridFrame& frame);

class OverlayPass {
 public:
  // Draws DebugView::vertices, validity or vectors into the bound framebuffer, against its depth, which stays as
  // the surfaces left it for what is hidden. Spheres are lit as white Lambert surfaces, in nits; colours that are not
  // light are made to look as they are named after `tone`'s exposure. Throws ParameterError for vectors of a basis that
  // stores none.
  void draw(const GridAsset& grid, const RuntimeCamera& camera, const ViewSettings& settings);

 private:
  gl::Program& program(const GridAsset& grid, DebugView view);

  std::map<std::string, gl::Program> programs_;
  gl::VertexArray no_vertices_;
};

}  // namespace ivory
