#include "tracer/bake/field/contract/domain.h"

#include <algorithm>
#include <cmath>

#include "grid/base/error.h"
#include "tracer/core/sampler.h"
#include "tracer/core/sampling.h"
#include "tracer/core/surface.h"

namespace ivory {
namespace {

struct Corner {
  V3f index;  // index coordinates of the frame
  V2f barycentric;
};

// Sutherland and Hodgman: the polygon's part on the near side of index[axis] = at.
std::vector<Corner> clip(const std::vector<Corner>& polygon, unsigned axis, float at, float side) {
  std::vector<Corner> out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner& a = polygon[i];
    const Corner& b = polygon[(i + 1) % polygon.size()];
    const float da = (at - a.index[axis]) * side;
    const float db = (at - b.index[axis]) * side;
    if (da >= 0) out.push_back(a);
    if ((da >= 0) != (db >= 0)) {
      const float t = da / (da - db);
      out.push_back({a.index + (b.index - a.index) * t, a.barycentric + (b.barycentric - a.barycentric) * t});
    }
  }
  return out;
}

std::vector<Corner> clip_to_cells(std::vector<Corner> polygon, const V3i& size) {
  // Surfaces in the box's own faces are the rule, not the exception: rounding must not lose them.
  constexpr float margin = 0.01F;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const float low = -0.5F - margin;
    const float high = float(size[axis]) - 0.5F + margin;
    const auto [least, most] =
        std::minmax_element(polygon.begin(), polygon.end(),
                            [&](const Corner& a, const Corner& b) { return a.index[axis] < b.index[axis]; });
    if (polygon.empty() || least->index[axis] > high || most->index[axis] < low) return {};
    const bool below = least->index[axis] < low;
    const bool above = most->index[axis] > high;
    if (above) polygon = clip(polygon, axis, high, 1);
    if (below) polygon = clip(polygon, axis, low, -1);
  }
  return polygon;
}

struct Corners {
  std::array<V3f, 3> p;
};

Corners corners_of(const Scene& scene, int instance, int triangle) {
  const Instance& placed = scene.instances[std::size_t(instance)];
  const Mesh& mesh = scene.meshes[std::size_t(placed.mesh)];
  const auto& t = mesh.triangles[std::size_t(triangle)];
  return {{mesh.positions[t.x] * placed.to_world, mesh.positions[t.y] * placed.to_world,
           mesh.positions[t.z] * placed.to_world}};
}

V3f at_barycentric(const Corners& c, const V2f& b) {
  return c.p[0] + (c.p[1] - c.p[0]) * b.x + (c.p[2] - c.p[0]) * b.y;
}

// The entry of a running sum that u (0 to 1) of its total falls into.
std::size_t pick(const std::vector<double>& until, double u) {
  const auto found = std::upper_bound(until.begin(), until.end(), u * until.back());
  return std::min(std::size_t(found - until.begin()), until.size() - 1);
}

}  // namespace

Domain::Domain(const Scene& scene, DomainParams params) : scene_(scene), params_(std::move(params)) {
  if (!params_.given.empty()) return;
  const GridFrame& frame = params_.frame;
  if (params_.kind != DomainKind::space) {
    double area = 0;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      const Mesh& mesh = scene.meshes[std::size_t(scene.instances[i].mesh)];
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Corners c = corners_of(scene, int(i), int(t));
        const std::vector<Corner> polygon = clip_to_cells(
            {{frame.to_index(c.p[0]), {0, 0}}, {frame.to_index(c.p[1]), {1, 0}}, {frame.to_index(c.p[2]), {0, 1}}},
            frame.size);
        const double whole = 0.5 * V3d(c.p[1] - c.p[0]).cross(V3d(c.p[2] - c.p[0])).length();
        for (std::size_t k = 2; k < polygon.size(); ++k) {
          const Piece piece{polygon[0].barycentric, polygon[k - 1].barycentric, polygon[k].barycentric, int(i), int(t)};
          const V2f e1 = piece.b - piece.a;
          const V2f e2 = piece.c - piece.a;
          const double own = whole * std::abs(double(e1.x) * e2.y - double(e1.y) * e2.x);
          if (!(own > 0)) continue;
          area += own;
          pieces_.push_back(piece);
          area_until_.push_back(area);
        }
      }
    }
  }
  if (params_.kind != DomainKind::surfaces) {
    double volume = 0;
    const auto add = [&](const Box3f& box) {
      const V3f size = box.size();
      volume += double(size.x) * size.y * size.z;
      boxes_.push_back(box);
      volume_until_.push_back(volume);
    };
    if (params_.dynamic_regions) {
      for (const Box3f& region : *params_.dynamic_regions) add(region);
    } else {
      add({V3f(-0.5F, -0.5F, -0.5F), V3f(frame.size) - V3f(0.5F, 0.5F, 0.5F)});
    }
    if (!(volume > 0)) {
      boxes_.clear();
      volume_until_.clear();
    }
  }
  if (pieces_.empty() && boxes_.empty()) {
    throw ParameterError("error_domain",
                         params_.kind == DomainKind::space
                             ? "there is no free space to measure the error in: name --dynamic boxes, or none at all"
                             : "no surface lies within the grid");
  }
}

std::uint64_t Domain::size() const {
  return params_.given.empty() ? std::numeric_limits<std::uint64_t>::max() : params_.given.size();
}

// Alpha-masked surfaces are there where they cover: a point in one of their holes is none.
std::optional<DomainPoint> Domain::surface_point(RandomStream& random) const {
  const double coarse = random.next();
  const Piece& piece = pieces_[pick(area_until_, coarse + double(random.next()) * 0x1p-24)];
  const V2f in_piece = sample_triangle(random.next2());
  const bool behind = random.next() < 0.5F;
  const V2f barycentric = piece.a + (piece.b - piece.a) * in_piece.x + (piece.c - piece.a) * in_piece.y;
  const Corners c = corners_of(scene_, piece.instance, piece.triangle);
  const int mesh = scene_.instances[std::size_t(piece.instance)].mesh;
  const V3f cross = (c.p[1] - c.p[0]).cross(c.p[2] - c.p[0]);
  if (!(cross.length() > 0)) return std::nullopt;
  const Material& material = scene_.materials[std::size_t(scene_.meshes[std::size_t(mesh)].material)];
  if (has_coverage(material) && coverage_at(scene_, mesh, piece.triangle, barycentric) < half_coverage)
    return std::nullopt;
  const V3f n = cross.normalized();
  return DomainPoint{at_barycentric(c, barycentric), behind ? -n : n, 1, true};
}

DomainPoint Domain::space_point(RandomStream& random) const {
  const Box3f& box = boxes_[pick(volume_until_, random.next())];
  V3f at;
  for (unsigned axis = 0; axis < 3; ++axis) at[axis] = box.min[axis] + box.size()[axis] * random.next();
  const V3f n = params_.frame.direction_to_world(sample_sphere(random.next2()));
  const V3f p = params_.dynamic_regions ? at : params_.frame.to_world(at);
  return {p, n, 1, false};
}

DomainPoint Domain::point(std::uint64_t index) const {
  if (!params_.given.empty()) return params_.given[index];
  RandomStream random(params_.seed, StreamPurpose::domain, index);
  const double share = boxes_.empty() ? 1 : pieces_.empty() ? 0 : surface_share;
  if (random.next() < share) {
    constexpr int attempts = 64;  // a surface all holes is none
    for (int i = 0; i < attempts; ++i) {
      if (const auto found = surface_point(random)) return *found;
    }
  }
  return boxes_.empty() ? DomainPoint{{0, 0, 0}, {0, 1, 0}, 0, true} : space_point(random);
}

void balance_weights(const std::vector<DomainPoint*>& points) {
  constexpr double enough = 16;
  double on_surface = 0;
  for (const DomainPoint* p : points) on_surface += p->on_surface ? 1 : 0;
  const double all = double(points.size());
  if (on_surface < enough || all - on_surface < enough) return;
  for (DomainPoint* p : points)
    p->weight = p->on_surface ? surface_share * all / on_surface : (1 - surface_share) * all / (all - on_surface);
}

}  // namespace ivory
