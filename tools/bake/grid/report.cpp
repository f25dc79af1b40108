#include "tools/bake/grid/report.h"

#include <algorithm>

#include <fmt/format.h>

#include "tools/bake/grid/report_pictures.h"
#include "tools/cli/numbers.h"
#include "tools/cli/target_error.h"
#include "tools/view/draw/colormap.h"

namespace ivory {

namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '&') {
      out += "&amp;";
    } else if (c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve(bytes.size() * 4 / 3 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t block = std::uint32_t(bytes[i]) << 16U;
    if (i + 1 < bytes.size()) block |= std::uint32_t(bytes[i + 1]) << 8U;
    if (i + 2 < bytes.size()) block |= bytes[i + 2];
    for (unsigned k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : digits[block >> (18U - 6U * k) & 63U];
  }
  return out;
}

constexpr const char* style = R"(<style>
body{font:15px/1.45 sans-serif;margin:2em auto;max-width:1400px;padding:0 1em;color:#222}
h1{font-size:24px}h2{font-size:18px;margin-top:1.6em}
table{border-collapse:collapse}td,th{padding:3px 10px;border-bottom:1px solid #ddd;text-align:right}
td.text,th.text{text-align:left}
.verdict{font-size:20px;padding:.5em .8em;border-radius:6px;display:inline-block}
.met{background:#e2f3e2}.missed{background:#fbe3dd}
.view{display:flex;flex-wrap:wrap;gap:12px}
figure{margin:0}figcaption{font-size:13px;color:#555}
.bar{background:#4878a8;height:12px;display:inline-block}
.scale{height:12px;width:220px;display:inline-block;vertical-align:middle}
</style>
)";

std::string gradient(const ColorMap& map) {
  std::string stops;
  for (const V3f& c : map) stops += fmt::format(",rgb({:.0f},{:.0f},{:.0f})", 255 * c.x, 255 * c.y, 255 * c.z);
  return fmt::format("<span class=scale style=\"background:linear-gradient(to right{})\"></span>", stops);
}

// The measured error on a line, its interval and the target.
std::string interval_svg(const Certificate& c) {
  const double end = 1.25 * std::max({c.high, c.target, 1e-6});
  constexpr double width = 560;
  const auto x = [&](double share) { return 10 + width * share / end; };
  std::string svg = fmt::format("<svg width={:.0f} height=56 font-size=12 font-family=sans-serif>", width + 60);
  svg += fmt::format("<line x1=10 y1=28 x2={:.1f} y2=28 stroke=\"#999\"/>", x(end));
  svg += fmt::format("<rect x={:.1f} y=20 width={:.1f} height=16 fill=\"#4878a8\" opacity=.35 />", x(c.low),
                     std::max(1.0, x(c.high) - x(c.low)));
  svg += fmt::format("<line x1={0:.1f} y1=14 x2={0:.1f} y2=42 stroke=\"#23507c\" stroke-width=3 />", x(c.error));
  svg += fmt::format("<text x={:.1f} y=54 text-anchor=middle>{}</text>", x(c.error), format_share(c.error));
  if (c.target > 0) {
    svg += fmt::format("<line x1={0:.1f} y1=14 x2={0:.1f} y2=42 stroke=\"#b03a2e\" stroke-dasharray=\"4 3\" />",
                       x(c.target));
    svg += fmt::format("<text x={:.1f} y=11 text-anchor=middle fill=\"#b03a2e\">asked for {}</text>", x(c.target),
                       format_share(c.target));
  }
  return svg + "</svg>";
}

const std::map<std::string, const char*>& explanations() {
  static const std::map<std::string, const char*> texts{
      {"noise", "photons, by chance"},
      {"resolution", "light that varies between vertices: contacts, inner edges"},
      {"direction", "what the basis makes of light from all directions"},
      {"unseen", "points that no vertex sees, which read 0"},
      {"leaks", "light read where none arrives (beside the error)"},
      {"planes", "what readers by the stored planes see besides, engines and the viewer (beside the error)"}};
  return texts;
}

std::string parts_table(const Certificate& c) {
  double most = 1e-9;
  for (const auto& [name, part] : c.parts) most = std::max(most, part);
  std::string html = "<table><tr><th class=text>part<th>share of mean E<th class=text><th class=text></tr>\n";
  for (const auto& [name, part] : c.parts) {
    const auto found = explanations().find(name);
    html += fmt::format(
        "<tr><td class=text>{}<td>{}<td class=text><span class=bar style=\"width:{:.0f}px\"></span><td class=text>{}\n",
        escaped(name), format_share(part), 220 * part / most, found == explanations().end() ? "" : found->second);
  }
  return html + "</table>\n";
}

std::string facts_table(const IrradianceGrid& grid, const ContractResult& contract) {
  std::string html = "<table>\n";
  const auto row = [&](const std::string& name, const std::string& value) {
    html += fmt::format("<tr><td class=text>{}<td class=text>{}</tr>\n", escaped(name), escaped(value));
  };
  const GridFrame& frame = grid.finest_frame();
  const auto stored =
      std::count_if(grid.visible_fraction.begin(), grid.visible_fraction.end(), [](float f) { return f > 0; });
  row("vertices", fmt::format("{} stored, of {} in {}", stored, grid.visible_fraction.size(),
                              grid.levels() == 1 ? fmt::format("{}x{}x{}", frame.size.x, frame.size.y, frame.size.z)
                                                 : fmt::format("{} levels", grid.levels())));
  row("finest spacing",
      fmt::format("{:.4g} x {:.4g} x {:.4g} m", frame.spacing_m.x, frame.spacing_m.y, frame.spacing_m.z));
  row("photons", format_count(double(contract.sums.photon_end)));
  row("basis", std::string(name_of(grid.basis)));
  row("bakes", fmt::format("{}, and {} pilots", contract.rounds, contract.plan.pilots.size()));
  row("predicted", fmt::format("{} ({} to {})", format_share(contract.plan.error.expected),
                               format_share(contract.plan.error.low), format_share(contract.plan.error.high)));
  const auto counter = [&](const char* name) {
    const auto found = contract.sums.counters.find(name);
    return found == contract.sums.counters.end() ? 0.0 : double(found->second);
  };
  if (const double emitted = counter("ledger_emitted"); emitted > 0) {
    row("energy", fmt::format("{:.2f} % absorbed, {:.2f} % escaped, {:.2g} % cut off by --bounces",
                              100 * counter("ledger_absorbed") / emitted, 100 * counter("ledger_escaped") / emitted,
                              100 * counter("ledger_terminated") / emitted));
  }
  for (const PilotErrors& pilot : contract.plan.pilots) {
    row("pilot", fmt::format("{:.4g} m, {} photons: bias {}, noise {}", pilot.spacing_m, format_count(pilot.photons),
                             format_share(pilot.bias), format_share(pilot.noise)));
  }
  return html + "</table>\n";
}

std::string worst_table(const FieldCertificate& certificate) {
  std::string html =
      "<table><tr><th><th class=text>place, metres<th>off, of mean E<th>lux read<th>lux<th class=text>likely "
      "cause</tr>\n";
  for (std::size_t i = 0; i < certificate.worst.size(); ++i) {
    const WorstPlace& place = certificate.worst[i];
    html += fmt::format(
        "<tr><td>{}<td class=text>{:.5g} {:.5g} {:.5g}{}<td>{:+.2g} %<td>{:.3g}<td>{:.3g}<td class=text>{}\n", i + 1,
        place.p_world.x, place.p_world.y, place.p_world.z, place.on_surface ? "" : " in free space", 100 * place.off,
        place.read_lux, place.e_lux, escaped(place.cause));
  }
  return html + "</table>\n";
}

std::string view_html(const ReportView& view) {
  std::string html = fmt::format("<h3>{}</h3><div class=view>\n", escaped(view.title));
  for (const ReportPicture& picture : view.pictures) {
    html += fmt::format(
        "<figure><svg width={0} height={1}><image width={0} height={1} href=\"data:image/png;base64,{2}\"/>",
        view.width, view.height, base64(picture.png));
    if (picture.title == "error") {
      for (const ReportMark& mark : view.marks) {
        html += fmt::format(
            "<circle cx={0:.1f} cy={1:.1f} r=8 fill=\"#fffc\" stroke=\"#222\" /><text x={0:.1f} y={2:.1f} font-size=11 "
            "text-anchor=middle font-family=sans-serif>{3}</text>",
            mark.x, mark.y, mark.y + 4, mark.place + 1);
      }
    }
    html += fmt::format("</svg><figcaption>{}</figcaption></figure>\n", escaped(picture.title));
  }
  return html + "</div>\n";
}

}  // namespace

std::string grid_report(const std::string& grid_path, const LitScene& lit, const IrradianceGrid& grid,
                        const ContractResult& contract, const LookupParams& lookup) {
  const FieldCertificate& certificate = *contract.certificate;
  const Certificate& c = certificate.summary;
  const ReportScales scales = report_scales(certificate);
  std::string html = "<!doctype html><html lang=en><meta charset=utf-8><title>" + escaped(grid_path) +
                     ": certificate</title>\n" + style;
  html += fmt::format("<h1>{}: its error, measured</h1>\n", escaped(grid_path));
  const bool met = c.target == 0 || c.error <= c.target;
  html += fmt::format(
      "<p class=\"verdict {}\">Error {} (95 %: {} to {}){}</p>\n", met ? "met" : "missed", format_share(c.error),
      format_share(c.low), format_share(c.high),
      c.target == 0 ? "" : std::string(met ? ", within" : ", above") + " the " + format_share(c.target) + " asked for");
  if (!met && !contract.plan.limited_by.empty())
    html += "<p>Limited by " + escaped(contract.plan.limited_by) + ".</p>\n";
  html += "<p>" + interval_svg(c) + "</p><p>" + escaped(c.measure) + ".</p>\n";
  html += "<h2>What it is made of</h2>\n" + parts_table(c);
  html += "<h2>What was baked</h2>\n" + facts_table(grid, contract);
  html += "<h2>Where</h2>\n";
  html += fmt::format(
      "<p>Error and leaks: {} from {} darker to {} brighter, of mean E. Noise: {} from 0 to {}. Magenta: "
      "no vertex sees it. Grey: outside the grid.{}</p>\n",
      gradient(signed_colors()), format_share(scales.off), format_share(scales.off), gradient(sequential_colors()),
      format_share(scales.noise),
      grid.levels() == 1 ? " Vertices: blue where light came, dark where none did."
                         : " Vertices: blue to red from coarse to fine, dark where no light came.");
  for (const ReportView& view : report_views(lit, grid, certificate, lookup)) html += view_html(view);
  html += "<h2>Worst places</h2>\n" + worst_table(certificate) + "</html>\n";
  return html;
}

}  // namespace ivory
