#include "tools/export/report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/anchor.h"

namespace ivory {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_walls = 8;
constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};

Json world(const V3f& p, const V3d& anchor_m) {
  const V3d at = to_world(p, anchor_m);
  return {at.x, at.y, at.z};
}

double share(double lux, const ReaderReport& report) {
  return report.survey.mean_lux > 0 ? lux / report.survey.mean_lux : 0;
}

std::string place_text(const V3f& p, const V3d& anchor_m) {
  const V3d at = to_world(p, anchor_m);
  return fmt::format("{:.2f} {:.2f} {:.2f}", at.x, at.y, at.z);
}

std::string measured_text(const ReaderReport& report) {
  return fmt::format("{} points on {}, against the grid's look-up guarded by {}", report.survey.points.size(),
                     report.by_rays ? "the scene's surfaces" : "surfaces that the grid's planes know",
                     report.by_rays ? "rays" : "planes");
}

// Seen along one axis of the world: the points, coloured by how far off they are.
std::string plan_svg(const ReaderReport& report, unsigned across, unsigned down, bool flip) {
  constexpr double width = 420;
  constexpr double most_off = 0.5;
  constexpr std::size_t most_points = 3000;
  Box3f box;
  for (const SurveyPoint& point : report.survey.points) box.extendBy(point.at.p);
  const V3f size = box.max - box.min;
  const double scale = (width - 20) / std::max({double(size[across]), double(size[down]), 1e-6});
  std::string svg =
      fmt::format("<svg width={:.0f} height={:.0f}>\n", 20 + scale * size[across], 20 + scale * size[down]);
  const std::size_t every = std::max<std::size_t>(1, report.survey.points.size() / most_points);
  std::vector<std::pair<double, std::string>> dots;
  for (std::size_t i = 0; i < report.survey.points.size(); i += every) {
    const SurveyPoint& point = report.survey.points[i];
    const double off = off_by(point, report.survey.mean_lux);
    const double t = std::min(std::abs(off) / most_off, 1.0);
    const V3d end = off > 0 ? V3d(178, 24, 43) : V3d(33, 102, 172);
    const V3d colour = V3d(225, 225, 225) * (1 - t) + end * t;
    const double y = double(point.at.p[down] - box.min[down]);
    dots.emplace_back(
        std::abs(off),
        fmt::format("<circle cx={:.1f} cy={:.1f} r={:.1f} fill=\"rgb({:.0f},{:.0f},{:.0f})\"/>\n",
                    10 + scale * double(point.at.p[across] - box.min[across]),
                    10 + scale * (flip ? double(size[down]) - y : y), 1.5 + 2 * t, colour.x, colour.y, colour.z));
  }
  // The worst lie on top.
  std::stable_sort(dots.begin(), dots.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& dot : dots) svg += dot.second;
  return svg + "</svg>";
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '&') {
      out += "&amp;";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace

Json to_json(const ReaderReport& report) {
  const ReaderSurvey& survey = report.survey;
  Json worst = Json::array();
  for (const SurveyPlace& place : survey.worst) {
    worst.push_back({{"p_m", world(place.at.p, report.anchor_m)},
                     {"n", {place.at.n.x, place.at.n.y, place.at.n.z}},
                     {"shown_lux", place.shown_lux},
                     {"known_lux", place.known_lux},
                     {"off", place.off}});
  }
  Json walls = Json::array();
  for (const ThinWall& wall : report.walls) {
    walls.push_back({{"center_m", world(wall.center, report.anchor_m)},
                     {"across", axis_names[std::size_t(wall.axis)]},
                     {"pairs", wall.pairs},
                     {"area_m2", wall.area_m2},
                     {"rms", share(wall.rms_lux, report)},
                     {"brightest", share(wall.brightest_lux, report)},
                     {"darkest", share(wall.darkest_lux, report)}});
  }
  return {{"measure", measured_text(report) + "; shares of mean E there"},
          {"points", survey.points.size()},
          {"mean_lux", survey.mean_lux},
          {"rms", survey.rms},
          {"tolerance", survey_tolerance},
          {"too_bright", survey.too_bright},
          {"too_dark", survey.too_dark},
          {"worst", worst},
          {"thin_walls", walls}};
}

std::string report_text(const ReaderReport& report) {
  const ReaderSurvey& survey = report.survey;
  if (survey.points.empty()) return "report: no surface in the grid is known to have light\n";
  std::string text = fmt::format(
      "what {} will show, at {}: {:.2f} % off (RMS of mean E, {:.3g} lux); {:.2f} % of the points more than {:g} % too "
      "bright, {:.2f} % too dark\n",
      report.target, measured_text(report), 100 * survey.rms, survey.mean_lux, 100 * survey.too_bright,
      100 * survey_tolerance, 100 * survey.too_dark);
  for (const SurveyPlace& place : survey.worst) {
    if (std::abs(place.off) <= survey_tolerance) break;
    text += fmt::format("  at {}, normal {:.2f} {:.2f} {:.2f}: {:+.0f} % ({:.3g} lux shown, {:.3g} known)\n",
                        place_text(place.at.p, report.anchor_m), place.at.n.x, place.at.n.y, place.at.n.z,
                        100 * place.off, place.shown_lux, place.known_lux);
  }
  std::size_t count = 0;
  for (const ThinWall& wall : report.walls) {
    if (++count > most_walls) {
      text += fmt::format("  and {} walls more\n", report.walls.size() - most_walls);
      break;
    }
    text += fmt::format(
        "  wall thinner than a cell at {}, across {}, about {:.2g} m2: its faces are up to {:.0f} % too bright, {:.0f} "
        "% "
        "too dark\n",
        place_text(wall.center, report.anchor_m), axis_names[std::size_t(wall.axis)], wall.area_m2,
        100 * share(wall.brightest_lux, report), -100 * share(wall.darkest_lux, report));
  }
  return text;
}

std::string report_html(const ReaderReport& report) {
  const ReaderSurvey& survey = report.survey;
  const std::string title = fmt::format("{} in {}", report.grid, report.target);
  std::string html = "<!doctype html><html lang=en><meta charset=utf-8><title>" + escaped(title) + R"(</title>
<style>
body{font:15px/1.45 sans-serif;margin:2em auto;max-width:1300px;padding:0 1em;color:#222}
h1{font-size:24px}h2{font-size:18px}
table{border-collapse:collapse}td,th{padding:3px 10px;border-bottom:1px solid #ddd;text-align:right}
figure{display:inline-block;margin:0 12px 0 0;vertical-align:top}
.scale{display:inline-block;width:200px;height:12px;background:linear-gradient(to right,#2166ac,#e1e1e1,#b2182b)}
</style>
)";
  html += "<h1>" + escaped(title) + ": what it will show</h1>\n";
  html += fmt::format(
      "<p>{:.2f} % off (RMS of mean E, {:.3g} lux); {:.2f} % of the points more than {:g} % too bright, {:.2f} % too "
      "dark. Measured at {}.</p>\n",
      100 * survey.rms, survey.mean_lux, 100 * survey.too_bright, 100 * survey_tolerance, 100 * survey.too_dark,
      measured_text(report));
  if (survey.points.empty()) return html + "<p>No surface in the grid is known to have light.</p></html>\n";
  html += "<h2>Where</h2><p><span class=scale></span> from 50 % of mean E too dark to 50 % too bright</p>\n";
  html += "<figure>" + plan_svg(report, 0, 2, false) + "<figcaption>from above</figcaption></figure>\n";
  html += "<figure>" + plan_svg(report, 0, 1, true) + "<figcaption>from the front</figcaption></figure>\n";
  html += "<figure>" + plan_svg(report, 2, 1, true) + "<figcaption>from the left</figcaption></figure>\n";
  html += "<h2>Worst places</h2><table><tr><th>place, m<th>normal<th>off, of mean E<th>lux shown<th>lux known</tr>\n";
  for (const SurveyPlace& place : survey.worst) {
    html += fmt::format("<tr><td>{}<td>{:.2f} {:.2f} {:.2f}<td>{:+.1f} %<td>{:.3g}<td>{:.3g}</tr>\n",
                        place_text(place.at.p, report.anchor_m), place.at.n.x, place.at.n.y, place.at.n.z,
                        100 * place.off, place.shown_lux, place.known_lux);
  }
  html += "</table>\n<h2>Walls thinner than a cell</h2>\n";
  if (report.walls.empty()) return html + "<p>None that the grid's planes know.</p></html>\n";
  html += "<table><tr><th>centre, m<th>across<th>m²<th>RMS, of mean E<th>too bright<th>too dark</tr>\n";
  for (const ThinWall& wall : report.walls) {
    html += fmt::format("<tr><td>{}<td>{}<td>{:.2g}<td>{:.1f} %<td>{:.1f} %<td>{:.1f} %</tr>\n",
                        place_text(wall.center, report.anchor_m), axis_names[std::size_t(wall.axis)], wall.area_m2,
                        100 * share(wall.rms_lux, report), 100 * share(wall.brightest_lux, report),
                        -100 * share(wall.darkest_lux, report));
  }
  return html + "</table></html>\n";
}

}  // namespace ivory
