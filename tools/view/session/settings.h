// What the viewer's user chooses.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "grid/cubemap/localized.h"
#include "grid/field/irradiance_grid.h"
#include "grid/fiv/light.h"
#include "grid/lobes/light.h"
#include "tools/view/draw/display.h"

namespace ivory {

// Where an object's ambient light comes from.
enum class ViewMethod { none, constant, sh9, difmap, grid, fiv, cubemap, lobes };
inline constexpr std::array<ViewMethod, 8> all_view_methods{ViewMethod::none,    ViewMethod::constant, ViewMethod::sh9,
                                                            ViewMethod::difmap,  ViewMethod::grid,     ViewMethod::fiv,
                                                            ViewMethod::cubemap, ViewMethod::lobes};
std::string_view name(ViewMethod method);
// "direct", what ivory render calls it, is grid. Throws UsageError for an unknown one.
ViewMethod view_method_from_name(std::string_view name);

// What is shown instead of light, or on top of it.
enum class DebugView {
  none,
  irradiance,  // E by the object's method, on the surface
  stored,      // E from what the nearest vertex of the grid stores
  bracket,     // half the width of the bracket around E that the six vectors leave, over its middle
  kept,        // share of the interpolation's weight that trust and guard leave
  guard,       // E read without guard less E read with it: what leaks otherwise
  difference,  // picture less reference
  vertices,    // the grid's vertices as spheres, lit by what they store
  validity,    // the same, by the share of its cell that a vertex sees
  vectors,     // the six irradiance vectors of each vertex
};
inline constexpr std::array<DebugView, 10> all_debug_views{
    DebugView::none,  DebugView::irradiance, DebugView::stored,   DebugView::bracket,  DebugView::kept,
    DebugView::guard, DebugView::difference, DebugView::vertices, DebugView::validity, DebugView::vectors};
std::string_view name(DebugView view);
DebugView debug_view_from_name(std::string_view name);  // throws UsageError
std::string_view summary(DebugView view);               // for help and tooltips

bool needs_grid(DebugView view);
// Shown in false colour whatever the user chooses?
bool is_number(DebugView view);
bool is_signed(DebugView view);

struct ViewSettings {
  bool direct = true;  // and what shines by itself, and the environment behind
  int shadow_size = 1024;
  Rgb constant_e_lux{1, 1, 1};
  LookupParams lookup;
  Guard guard = Guard::planes;
  CubeMethod cube_method = CubeMethod::polygon;
  FivLightParams fiv;
  LobeLightParams lobes;
  ToneParams tone;
  DebugView debug = DebugView::none;
  bool false_color = false;    // of views that are light
  std::optional<float> range;  // largest value of the false colours; empty: from the picture
  float glyph_scale = 1;       // of vectors and spheres
  int vertex_step = 0;         // every so many of the grid's vertices; 0: so that not too many show
};

}  // namespace ivory
