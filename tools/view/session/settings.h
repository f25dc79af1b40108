// What the viewer's user chooses.
#pragma once

#include <optional>
#include <string_view>

#include "grid/base/names.h"
#include "grid/cubemap/localized.h"
#include "grid/field/irradiance_grid.h"
#include "grid/fiv/light.h"
#include "grid/lobes/light.h"
#include "tools/view/draw/display.h"

namespace ivory {

// Where an object's ambient light comes from.
enum class ViewMethod { none, constant, sh9, difmap, grid, fiv, cubemap, lobes };
template <>
inline constexpr auto name_table<ViewMethod> = make_name_table<ViewMethod>("method",
                                                                           {{ViewMethod::none, "none"},
                                                                            {ViewMethod::constant, "constant"},
                                                                            {ViewMethod::sh9, "sh9"},
                                                                            {ViewMethod::difmap, "difmap"},
                                                                            {ViewMethod::grid, "grid"},
                                                                            {ViewMethod::fiv, "fiv"},
                                                                            {ViewMethod::cubemap, "cubemap"},
                                                                            {ViewMethod::lobes, "lobes"}});
inline constexpr auto all_view_methods = values_of<ViewMethod>();
// "direct", what ivory render calls it, is grid. Throws ParameterError for an unknown one.
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
template <>
inline constexpr auto name_table<DebugView> = make_name_table<DebugView>("debug view",
                                                                         {{DebugView::none, "none"},
                                                                          {DebugView::irradiance, "irradiance"},
                                                                          {DebugView::stored, "stored"},
                                                                          {DebugView::bracket, "bracket"},
                                                                          {DebugView::kept, "kept"},
                                                                          {DebugView::guard, "guard"},
                                                                          {DebugView::difference, "difference"},
                                                                          {DebugView::vertices, "vertices"},
                                                                          {DebugView::validity, "validity"},
                                                                          {DebugView::vectors, "vectors"}});
inline constexpr auto all_debug_views = values_of<DebugView>();
std::string_view summary(DebugView view);  // for help and tooltips

bool needs_grid(DebugView view);
// Shown in false colour whatever the user chooses?
bool is_number(DebugView view);
bool is_signed(DebugView view);

struct ViewSettings {
  bool direct = true;  // and emission, and the environment behind
  int shadow_size = 1024;
  Rgb constant_e_lux{1, 1, 1};
  LookupParams lookup;
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
