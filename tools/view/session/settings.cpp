#include "tools/view/session/settings.h"

#include <array>

namespace ivory {

namespace {

// As DebugView counts them.
constexpr std::array<std::string_view, 10> summaries{
    "light as it is",
    "E on the surface by each object's method, as a white surface would show it",
    "E on the surface from the nearest vertex of the grid alone",
    "how far the grid's six vectors leave E open: half the bracket's width over its middle",
    "share of the interpolation's weight that the grid's leak guard leaves",
    "E read without leak guard less E read with it, lux: what would leak",
    "picture less --reference, luminance",
    "the grid's vertices as spheres lit by what they store",
    "the grid's vertices by the share of their cell that they see; red: nothing stored",
    "six irradiance vectors a vertex: red along x, green y, blue z, pale for the negative side"};

}  // namespace

ViewMethod view_method_from_name(std::string_view text) {
  return text == "direct" ? ViewMethod::grid : from_name<ViewMethod>(text);
}

std::string_view summary(DebugView view) { return summaries[std::size_t(view)]; }

bool needs_grid(DebugView view) {
  return view != DebugView::none && view != DebugView::irradiance && view != DebugView::difference;
}

bool is_number(DebugView view) {
  return view == DebugView::bracket || view == DebugView::kept || view == DebugView::guard ||
         view == DebugView::difference;
}

bool is_signed(DebugView view) { return view == DebugView::guard || view == DebugView::difference; }

}  // namespace ivory
