#include "tools/view/session/settings.h"

#include <string>

#include "grid/base/error.h"

namespace ivory {

namespace {

constexpr std::array<std::string_view, 8> method_names{"none", "constant", "sh9",     "difmap",
                                                       "grid", "fiv",      "cubemap", "lobes"};

struct DebugText {
  std::string_view name;
  std::string_view summary;
};
constexpr std::array<DebugText, 10> debug_texts{
    {{"none", "light as it is"},
     {"irradiance", "E on the surface by each object's method, as a white surface would show it"},
     {"stored", "E on the surface from the nearest vertex of the grid alone"},
     {"bracket", "how far the grid's six vectors leave E open: half the bracket's width over its middle"},
     {"kept", "share of the interpolation's weight that the grid's leak guard leaves"},
     {"guard", "E read without leak guard less E read with it, lux: what would leak"},
     {"difference", "picture less --reference, luminance"},
     {"vertices", "the grid's vertices as spheres lit by what they store"},
     {"validity", "the grid's vertices by the share of their cell that they see; red: nothing stored"},
     {"vectors", "six irradiance vectors a vertex: red along x, green y, blue z, pale for the negative side"}}};

}  // namespace

std::string_view name(ViewMethod method) { return method_names[std::size_t(method)]; }

ViewMethod view_method_from_name(std::string_view text) {
  if (text == "direct") return ViewMethod::grid;
  for (const ViewMethod method : all_view_methods) {
    if (name(method) == text) return method;
  }
  throw UsageError("unknown method '" + std::string(text) +
                   "'; one of none, constant, sh9, difmap, grid, fiv, cubemap, lobes");
}

std::string_view name(DebugView view) { return debug_texts[std::size_t(view)].name; }
std::string_view summary(DebugView view) { return debug_texts[std::size_t(view)].summary; }

DebugView debug_view_from_name(std::string_view text) {
  for (const DebugView view : all_debug_views) {
    if (name(view) == text) return view;
  }
  throw UsageError("unknown debug view '" + std::string(text) + "'; --help lists them");
}

bool needs_grid(DebugView view) {
  return view != DebugView::none && view != DebugView::irradiance && view != DebugView::difference;
}

bool is_number(DebugView view) {
  return view == DebugView::bracket || view == DebugView::kept || view == DebugView::guard ||
         view == DebugView::difference;
}

bool is_signed(DebugView view) { return view == DebugView::guard || view == DebugView::difference; }

}  // namespace ivory
