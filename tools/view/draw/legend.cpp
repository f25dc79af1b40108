#include "tools/view/draw/legend.h"

#include <algorithm>
#include <cmath>

#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <imgui.h>

#include "grid/base/error.h"

namespace ivory {

void draw_legend(ImDrawList& list, const ColorRange& range, const std::string& title, int height) {
  constexpr float margin = 10;
  constexpr float width = 256;
  constexpr float bar = 12;
  const float top = float(height) - margin - bar - 2 * ImGui::GetFontSize() - 8;
  const ImU32 white = IM_COL32(255, 255, 255, 255);
  list.AddRectFilled({margin - 6, top - 4}, {margin + width + 6, float(height) - margin + 4}, IM_COL32(0, 0, 0, 160));
  list.AddText({margin, top}, white, title.c_str());
  const float bar_top = top + ImGui::GetFontSize() + 3;
  const ColorMap& map = range.is_signed ? signed_colors() : sequential_colors();
  constexpr int steps = 128;
  for (int i = 0; i < steps; ++i) {
    const V3f c = color_at(map, (float(i) + 0.5F) / float(steps));
    const auto byte = [](float x) { return int(std::lround(x * 255)); };
    list.AddRectFilled({margin + width * float(i) / float(steps), bar_top},
                       {margin + width * float(i + 1) / float(steps), bar_top + bar},
                       IM_COL32(byte(c.x), byte(c.y), byte(c.z), 255));
  }
  for (int i = 0; i <= 2; ++i) {
    const float share = float(i) / 2;
    const std::string number = fmt::format("{:.3g}", range.least + (range.greatest - range.least) * share);
    const float text_width = ImGui::GetFont()->CalcTextSizeA(ImGui::GetFontSize(), 1000, 0, number.c_str()).x;
    const float x = std::clamp(margin + width * share - 0.5F * text_width, margin, margin + width - text_width);
    list.AddText({x, bar_top + bar + 2}, white, number.c_str());
  }
}

LegendPainter::LegendPainter() {
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  if (!ImGui_ImplOpenGL3_Init("#version 330 core")) {
    ImGui::DestroyContext();
    throw Error("OpenGL", "Dear ImGui cannot draw in this context", "use another driver");
  }
}

LegendPainter::~LegendPainter() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext();
}

void LegendPainter::draw(const ColorRange& range, const std::string& title, int width, int height) {
  ImGui::GetIO().DisplaySize = {float(width), float(height)};
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  draw_legend(*ImGui::GetBackgroundDrawList(), range, title, height);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace ivory
