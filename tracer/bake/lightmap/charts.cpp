#include "tracer/bake/lightmap/charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "tracer/core/surface.h"

namespace ivory {

namespace {

using Imath::V2d;

constexpr const char* remedy = "unwrap it anew, each surface apart (in Blender: UV > Lightmap Pack)";
constexpr int largest_size = 16384;

using UvTriangle = std::array<V2d, 3>;  // in texels

double cross(const V2d& a, const V2d& b) { return a.x * b.y - a.y * b.x; }
double twice_area(const UvTriangle& t) { return cross(t[1] - t[0], t[2] - t[0]); }

// Weights of the 2nd and 3rd corner.
V2d barycentric(const UvTriangle& t, const V2d& p) {
  const double area = twice_area(t);
  return {cross(p - t[0], t[2] - t[0]) / area, cross(t[1] - t[0], p - t[0]) / area};
}
double least_weight_of(const V2d& b) { return std::min({b.x, b.y, 1 - b.x - b.y}); }

// The triangle's point nearest to p.
V2d nearest_point(const UvTriangle& t, const V2d& p) {
  if (least_weight_of(barycentric(t, p)) >= 0) return p;
  V2d best = t[0];
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const V2d& a = t[i];
    const V2d edge = t[(i + 1) % 3] - a;
    const double length2 = edge.dot(edge);
    const double s = length2 > 0 ? std::clamp((p - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
    const V2d q = a + edge * s;
    const double distance2 = (q - p).dot(q - p);
    if (distance2 < least) {
      least = distance2;
      best = q;
    }
  }
  return best;
}

// The same, but not on its edge: where two walls meet, what starts in both may see past either.
V2d nearest_inside(const UvTriangle& t, const V2d& p) {
  constexpr double inset = 0.05;  // texels
  const V2d q = nearest_point(t, p);
  if (q == p) return q;
  const V2d inwards = (t[0] + t[1] + t[2]) / 3.0 - q;
  const double length = inwards.length();
  return length > inset ? q + inwards * (inset / length) : q + inwards;
}

const Mesh& mesh_of(const Scene& scene, int instance) {
  return scene.meshes[std::size_t(scene.instances[std::size_t(instance)].mesh)];
}

UvTriangle uv_triangle(const Mesh& mesh, int triangle, int uv_set, int width, int height) {
  UvTriangle t;
  const std::vector<V2f>& uvs = mesh.uvs[std::size_t(uv_set)];
  for (unsigned i = 0; i < 3; ++i) {
    const V2f& uv = uvs[mesh.triangles[std::size_t(triangle)][i]];
    t[i] = V2d(double(uv.x) * width, double(uv.y) * height);
  }
  return t;
}

std::string quoted_list(const std::set<std::string>& names) {
  std::string text;
  std::size_t count = 0;
  for (const std::string& name : names) {
    if (count == 3) return text + fmt::format(" and {} more", names.size() - count);
    text += (count++ == 0 ? "'" : ", '") + name + "'";
  }
  return text;
}

std::string name_of_instance(const Scene& scene, int instance) {
  const int node = scene.instances[std::size_t(instance)].node;
  const std::string& own = node == no_index ? std::string() : scene.nodes[std::size_t(node)].name;
  return own.empty() ? mesh_of(scene, instance).name : own;
}

// Meshes whose charts are no charts.
void check_coordinates(const Scene& scene, const std::vector<int>& instances, int uv_set) {
  std::set<std::string> missing;
  std::set<std::string> flat;
  std::set<std::string> outside;
  for (const int instance : instances) {
    const Mesh& mesh = mesh_of(scene, instance);
    if (mesh.uvs.size() <= std::size_t(uv_set) || mesh.uvs[std::size_t(uv_set)].empty()) {
      missing.insert(mesh.name);
      continue;
    }
    constexpr float rounding = 1e-4F;
    double area = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      area += std::abs(twice_area(uv_triangle(mesh, int(t), uv_set, 1, 1)));
    if (!(area > 0)) flat.insert(mesh.name);
    for (const V2f& uv : mesh.uvs[std::size_t(uv_set)]) {
      if (!(std::min(uv.x, uv.y) >= -rounding && std::max(uv.x, uv.y) <= 1 + rounding)) outside.insert(mesh.name);
    }
  }
  const auto fail = [&](const std::set<std::string>& names, const char* cause) {
    if (!names.empty())
      throw Error(scene.name, fmt::format("{} {} TEXCOORD_{}", quoted_list(names), cause, uv_set), remedy);
  };
  fail(missing, "lacks");
  fail(flat, "has no area in");
  fail(outside, "lies beyond 0 to 1 in");
}

// Puts triangles into texels, and counts the places that two of them have.
class Rasteriser {
 public:
  Rasteriser(const Scene& scene, Charts& charts)
      : scene_(scene), charts_(charts), distance_(charts.texels.size(), infinity), inside_(charts.texels.size(), 0) {}

  void add(int instance, int triangle) {
    const UvTriangle t =
        uv_triangle(mesh_of(scene_, instance), triangle, charts_.uv_set, charts_.width, charts_.height);
    if (!(std::abs(twice_area(t)) > 0)) return;
    const auto [x0, x1] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [y0, y1] = std::minmax({t[0].y, t[1].y, t[2].y});
    const auto first = [](double a) { return std::max(int(std::floor(a - 0.5)), 0); };
    const int last_x = std::min(int(std::ceil(x1 + 0.5)), charts_.width - 1);
    const int last_y = std::min(int(std::ceil(y1 + 0.5)), charts_.height - 1);
    for (int y = first(y0); y <= last_y; ++y)
      for (int x = first(x0); x <= last_x; ++x) add_texel(t, instance, triangle, x, y);
  }

  void check() const {
    if (overlaps_ == 0) return;
    const std::string a = name_of_instance(scene_, first_[0]);
    const std::string b = name_of_instance(scene_, first_[1]);
    const bool twice = first_[0] != first_[1] &&
                       scene_.instances[std::size_t(first_[0])].mesh == scene_.instances[std::size_t(first_[1])].mesh;
    const std::string who = first_[0] == first_[1] ? fmt::format("'{}' overlap each other", a)
                            : twice ? fmt::format("'{}' and '{}' are the same, as they place one mesh", a, b)
                                    : fmt::format("'{}' and '{}' overlap", a, b);
    throw Error(scene_.name,
                fmt::format("the charts of {} in TEXCOORD_{} ({} texels, the first at {:.4g}, {:.4g})", who,
                            charts_.uv_set, overlaps_, first_uv_.x, first_uv_.y),
                remedy);
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  void add_texel(const UvTriangle& t, int instance, int triangle, int x, int y) {
    const V2d center(x + 0.5, y + 0.5);
    const std::size_t index = std::size_t(y) * std::size_t(charts_.width) + std::size_t(x);
    ChartTexel& texel = charts_.texels[index];
    const V2d q = nearest_point(t, center);
    const V2d away = q - center;
    if (std::max(std::abs(away.x), std::abs(away.y)) >= 0.5) return;
    // Shared edges run through centres: only what is inside of both is there twice.
    constexpr double edge = 1e-3;  // of the triangle
    const bool inside = away == V2d(0, 0) && least_weight_of(barycentric(t, center)) > edge;
    if (inside && inside_[index] != 0) {
      if (overlaps_++ == 0) {
        first_ = {texel.instance, instance};
        first_uv_ = V2d(center.x / charts_.width, center.y / charts_.height);
      }
      return;
    }
    const double distance = away.length();
    if (!inside && (inside_[index] != 0 || distance >= distance_[index])) return;
    distance_[index] = distance;
    inside_[index] = inside ? 1 : 0;
    texel = {instance, triangle, V2f(barycentric(t, nearest_inside(t, center)))};
  }

  const Scene& scene_;
  Charts& charts_;
  std::vector<double> distance_;
  std::vector<char> inside_;
  std::size_t overlaps_ = 0;
  std::array<int, 2> first_{no_index, no_index};
  V2d first_uv_{0, 0};
};

}  // namespace

Charts make_charts(const Scene& scene, int uv_set, int width, int height) {
  if (std::min(width, height) < 1 || std::max(width, height) > largest_size)
    throw ParameterError("size", fmt::format("takes 1 to {} texels along a side", largest_size));
  std::vector<int> instances;
  for (int i = 0; i < int(scene.instances.size()); ++i) {
    const bool is_sphere =
        std::ranges::any_of(scene.sphere_lights, [&](const SphereLight& light) { return light.instance == i; });
    if (!is_sphere) instances.push_back(i);
  }
  if (instances.empty()) throw Error(scene.name, "has no surface to light", "export it with its meshes");
  check_coordinates(scene, instances, uv_set);
  const std::size_t count = std::size_t(width) * std::size_t(height);
  check_memory(fmt::format("lightmap of {}x{}", width, height), double(count) * 64, "choose a smaller size");
  Charts charts{width, height, uv_set, std::vector<ChartTexel>(count)};
  Rasteriser rasteriser(scene, charts);
  for (const int instance : instances) {
    const Mesh& mesh = mesh_of(scene, instance);
    for (int triangle = 0; triangle < int(mesh.triangles.size()); ++triangle) rasteriser.add(instance, triangle);
  }
  rasteriser.check();
  return charts;
}

ChartPoint chart_point(const Scene& scene, const Charts& charts, std::size_t index, const V2f& offset) {
  const ChartTexel& texel = charts.texels[index];
  const Instance& instance = scene.instances[std::size_t(texel.instance)];
  const Mesh& mesh = scene.meshes[std::size_t(instance.mesh)];
  const auto& corners = mesh.triangles[std::size_t(texel.triangle)];
  V2f b = texel.barycentric;
  if (offset != V2f(0, 0)) {
    const UvTriangle t = uv_triangle(mesh, texel.triangle, charts.uv_set, charts.width, charts.height);
    const V2d at = t[0] + (t[1] - t[0]) * double(b.x) + (t[2] - t[0]) * double(b.y) + V2d(offset);
    b = V2f(barycentric(t, nearest_inside(t, at)));
  }
  const float a = 1 - b.x - b.y;
  std::array<V3f, 3> p;
  for (unsigned i = 0; i < 3; ++i) instance.to_world.multVecMatrix(mesh.positions[corners[i]], p[i]);
  ChartPoint point;
  point.p = p[0] * a + p[1] * b.x + p[2] * b.y;
  const float mirror = instance.to_world.determinant() < 0 ? -1.0F : 1.0F;
  point.ng = (p[1] - p[0]).cross(p[2] - p[0]).normalized() * mirror;
  point.ns = point.ng;
  if (!mesh.normals.empty()) {
    const V3f n = mesh.normals[corners.x] * a + mesh.normals[corners.y] * b.x + mesh.normals[corners.z] * b.y;
    // Normals go with the inverse transpose.
    V3f world;
    instance.to_world.inverse().transposed().multDirMatrix(n, world);
    world.normalize();
    if (world.dot(point.ng) > 0) point.ns = world;
  }
  point.reach_m = triangle_reach_m(scene, texel.instance, texel.triangle);
  point.both = scene.materials[std::size_t(mesh.material)].double_sided;
  return point;
}

}  // namespace ivory
