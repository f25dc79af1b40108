#include "tools/bake/grid/report_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <tbb/parallel_for.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/io/image_codec.h"
#include "tools/view/draw/colormap.h"
#include "tracer/core/surface.h"
#include "tracer/image/file.h"

namespace ivory {

namespace {

constexpr int long_side = 420;  // pixels
const V3f background(0.93F, 0.93F, 0.93F);
const V3f outside_color(0.8F, 0.8F, 0.8F);
const V3f unseen_color(1, 0, 1);

// What a pixel shows.
struct Seen {
  DomainPoint at;
  bool in_grid = false;
  Reading reading;
  double off = 0;  // estimated from the measured points
};

struct NamedView {
  std::string title;
  View view;
  bool cut = false;  // orthographic, cut open at view.near_m
};

// A box along the grid's axes, looked at along one of them from outside and cut open.
NamedView cut_view(const GridFrame& frame, const std::string& title, const V3f& right, const V3f& up, float cut) {
  const V3f extent = V3f(frame.size) * frame.spacing_m;
  const auto along = [&](const V3f& axis) { return std::abs(axis.dot(extent)); };
  const V3f forward = up.cross(right);
  const V3f middle = frame.to_world((V3f(frame.size) - V3f(1, 1, 1)) * 0.5F);
  NamedView out;
  out.title = title;
  out.cut = true;
  View& view = out.view;
  view.perspective = false;
  constexpr float margin = 1.02F;
  const float w = along(right) * margin;
  const float h = along(up) * margin;
  view.width = std::max(8, int(long_side * std::min(1.0F, w / h)));
  view.height = std::max(8, int(long_side * std::min(1.0F, h / w)));
  view.forward = frame.direction_to_world(forward);
  view.right = frame.direction_to_world(right) * (w / 2);
  view.up = frame.direction_to_world(up) * (h / 2);
  const float depth = along(forward);
  view.origin = middle - view.forward * depth;
  view.near_m = depth * (0.5F + cut);
  return out;
}

std::vector<NamedView> choose_views(const Scene& scene, const GridFrame& frame) {
  const V3f x(1, 0, 0);
  const V3f y(0, 1, 0);
  const V3f z(0, 0, 1);
  std::vector<NamedView> views;
  views.push_back(cut_view(frame, "from above, cut open at three quarters of the height", x, -z, 0.25F));
  views.push_back(cut_view(frame, "from the front, cut open in the middle", x, y, 0.5F));
  views.push_back(cut_view(frame, "from the right, cut open in the middle", -z, y, 0.5F));
  if (!scene.cameras.empty()) {
    constexpr int width = long_side;
    constexpr int height = long_side * 3 / 4;
    views.push_back({"through the scene's first camera", make_view(scene.name, scene.cameras[0], width, height)});
  }
  return views;
}

bool is_inside(const GridFrame& frame, const V3f& p) {
  const V3f index = frame.to_index(p);
  for (unsigned axis = 0; axis < 3; ++axis) {
    if (!(index[axis] >= -0.6F && index[axis] <= float(frame.size[axis]) - 0.4F)) return false;
  }
  return true;
}

// Of the nearest points that face about the same way, by the inverse square of their distance: several, as each has its
// truth's noise.
double off_at(const std::vector<MeasuredPoint>& points, const DomainPoint& at, double mean_e_lux, float voxel_m) {
  constexpr std::size_t most = 10;
  const double near_m2 = 0.25 * double(voxel_m) * double(voxel_m);
  std::array<std::pair<float, std::size_t>, most> nearest;
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const DomainPoint& p = points[i].point.at;
    if (!p.on_surface || p.n.dot(at.n) < 0.7F) continue;
    const float d2 = (p.p - at.p).length2();
    if (count == most && d2 >= nearest[most - 1].first) continue;
    if (count < most) ++count;
    std::size_t k = count - 1;
    for (; k > 0 && nearest[k - 1].first > d2; --k) nearest[k] = nearest[k - 1];
    nearest[k] = {d2, i};
  }
  double sum = 0;
  double weights = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const MeasuredPoint& m = points[nearest[k].second];
    const double weight = 1 / (double(nearest[k].first) + near_m2);
    sum += weight * mean_of(m.reading.e - m.point.truth.e) / mean_e_lux;
    weights += weight;
  }
  return weights > 0 ? sum / weights : 0;
}

std::optional<Seen> look(const LitScene& lit, const IrradianceGrid& grid, const FieldCertificate& certificate,
                         const LookupParams& lookup, const View& view, const V2f& pixel) {
  Ray ray = make_ray(view, pixel);
  ray.blocking_coverage = half_coverage;
  const auto hit = lit.intersector.closest(ray);
  if (!hit) return std::nullopt;
  const Surface surface = make_surface(*lit.scene, ray, *hit);
  Seen seen;
  seen.at = {surface.p, surface.ng, 1, true};
  seen.in_grid = is_inside(grid.frame, surface.p);
  if (!seen.in_grid) return seen;
  seen.reading = read_grid(grid, lit.intersector, seen.at, lookup);
  const V3f& h = grid.finest_frame().spacing_m;
  seen.off = off_at(certificate.points, seen.at, certificate.mean_e_lux, std::max({h.x, h.y, h.z}));
  return seen;
}

std::vector<std::uint8_t> png_of(int width, int height, const std::vector<V3f>& display) {
  std::string cause;
  const ImageToWrite image{width, height, PixelType::float32, &display.front().x, false, {}};
  std::vector<std::uint8_t> bytes = image_codec().encode("report.png", image, cause);
  if (bytes.empty()) throw Error("report", "a picture of it cannot be written (" + cause + ")", "leave --report out");
  return bytes;
}

using Pixels = std::vector<std::optional<Seen>>;

template <typename Color>
ReportPicture picture(const char* title, const View& view, const Pixels& pixels, const Color& color) {
  std::vector<V3f> display;
  display.reserve(pixels.size());
  for (const auto& seen : pixels) display.push_back(!seen ? background : !seen->in_grid ? outside_color : color(*seen));
  return {title, png_of(view.width, view.height, display)};
}

ReportPicture light_picture(const View& view, const Pixels& pixels) {
  Film film;
  film.width = view.width;
  film.height = view.height;
  for (const auto& seen : pixels) film.pixels.push_back(seen && seen->in_grid ? Rgb(seen->reading.e) : Rgb(0, 0, 0));
  const std::vector<float> values = display_values(film, auto_exposure(film));
  std::vector<V3f> display(pixels.size(), background);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels[i]) display[i] = V3f(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
  }
  return {"light read", png_of(view.width, view.height, display)};
}

// Pixel coordinates of a point, and how far along the view it lies.
std::optional<V3f> project(const View& view, const V3f& p) {
  const V3f d = p - view.origin;
  const float depth = d.dot(view.forward);
  if (view.perspective && depth <= 0) return std::nullopt;
  const float scale = view.perspective ? depth : 1;
  const float x = d.dot(view.right) / view.right.length2() / scale;
  const float y = d.dot(view.up) / view.up.length2() / scale;
  return V3f((x + 1) / 2 * float(view.width), (1 - y) / 2 * float(view.height), depth);
}

// The layer of each level's vertices that the cut passes first: dark where no light came, coloured by level where it
// did.
ReportPicture vertex_picture(const View& view, const Pixels& pixels, const IrradianceGrid& grid) {
  std::vector<V3f> display(pixels.size(), background);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (pixels[i]) display[i] = V3f(1, 1, 1) * (0.6F + 0.25F * std::abs(pixels[i]->at.n.dot(view.forward)));
  }
  for (std::uint32_t v = 0; v < grid.visible_fraction.size(); ++v) {
    if (grid.visible_fraction[v] <= 0) continue;
    const int level = grid.level_of(v);
    const V3f& h = grid.frame_of(level).spacing_m;
    const auto at = project(view, grid.position_of(v));
    // Vertices may lie in the very plane of the cut.
    const float layer_m = std::max({h.x, h.y, h.z});
    if (!at || at->z < view.near_m - 0.25F * layer_m || at->z >= view.near_m + 0.75F * layer_m) continue;
    const bool lit = !is_black(grid.variance[v]);
    const float share = grid.levels() == 1 ? 0.5F : float(level) / float(grid.levels() - 1);
    const V3f color = lit ? color_at(signed_colors(), 0.08F + 0.84F * share) : V3f(0.25F, 0.25F, 0.25F);
    for (int dy = -1; dy < 2; ++dy) {
      for (int dx = -1; dx < 2; ++dx) {
        const int px = int(at->x) + dx;
        const int py = int(at->y) + dy;
        if (px >= 0 && px < view.width && py >= 0 && py < view.height) {
          display[std::size_t(py) * std::size_t(view.width) + std::size_t(px)] =
              grid.levels() == 1 && lit ? V3f(0.1F, 0.35F, 0.8F) : color;
        }
      }
    }
  }
  return {"vertices", png_of(view.width, view.height, display)};
}

std::vector<ReportMark> marks_in(const View& view, const Pixels& pixels, const FieldCertificate& certificate,
                                 const V3d& anchor_m) {
  std::vector<ReportMark> marks;
  for (std::size_t i = 0; i < certificate.worst.size(); ++i) {
    const V3f p = to_local(certificate.worst[i].p_world, anchor_m);
    const auto at = project(view, p);
    if (!at || at->z < view.near_m || at->x < 0 || at->y < 0 || at->x >= float(view.width) ||
        at->y >= float(view.height))
      continue;
    // Not behind what is seen there.
    const auto& seen = pixels[std::size_t(at->y) * std::size_t(view.width) + std::size_t(at->x)];
    if (seen && (seen->at.p - view.origin).dot(view.forward) < at->z * 0.99F - 1e-3F) continue;
    marks.push_back({i, at->x, at->y});
  }
  return marks;
}

}  // namespace

ReportScales report_scales(const FieldCertificate& certificate) {
  const double error = std::max(certificate.interval.error, certificate.summary.target);
  const auto noise = certificate.summary.parts.find("noise");
  return {3 * error, noise == certificate.summary.parts.end() ? error : std::max(2 * noise->second, 1e-6)};
}

std::vector<ReportView> report_views(const LitScene& lit, const IrradianceGrid& grid,
                                     const FieldCertificate& certificate, const LookupParams& lookup) {
  const ReportScales scales = report_scales(certificate);
  const double mean_e = certificate.mean_e_lux;
  std::vector<ReportView> out;
  for (const NamedView& named : choose_views(*lit.scene, grid.frame)) {
    const View& view = named.view;
    Pixels pixels(std::size_t(view.width) * std::size_t(view.height));
    tbb::parallel_for(std::size_t(0), pixels.size(), [&](std::size_t i) {
      const auto width = std::size_t(view.width);
      const std::size_t row = i / width;
      pixels[i] = look(lit, grid, certificate, lookup, view, V2f(float(i % width) + 0.5F, float(row) + 0.5F));
    });
    ReportView shown{named.title, view.width, view.height, {}, {}};
    shown.pictures.push_back(light_picture(view, pixels));
    shown.pictures.push_back(picture("error", view, pixels, [&](const Seen& seen) {
      return color_at(signed_colors(), float(0.5 + 0.5 * seen.off / scales.off));
    }));
    shown.pictures.push_back(picture("noise", view, pixels, [&](const Seen& seen) {
      return color_at(sequential_colors(), float(std::sqrt(mean_of(seen.reading.noise)) / mean_e / scales.noise));
    }));
    shown.pictures.push_back(picture("leaks", view, pixels, [&](const Seen& seen) {
      if (seen.reading.unseen) return unseen_color;
      const double off = mean_of(seen.reading.e_by_planes - seen.reading.e) / mean_e;
      return color_at(signed_colors(), float(0.5 + 0.5 * off / scales.off));
    }));
    if (named.cut) shown.pictures.push_back(vertex_picture(view, pixels, grid));
    shown.marks = marks_in(view, pixels, certificate, lit.scene->anchor_m);
    out.push_back(std::move(shown));
  }
  return out;
}

}  // namespace ivory
