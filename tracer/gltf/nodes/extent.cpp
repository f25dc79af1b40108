#include "tracer/gltf/nodes/extent.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "grid/base/anchor.h"
#include "tracer/gltf/nodes/tree.h"

namespace ivory::gltf {
namespace {

using Imath::M44d;

constexpr double max_coordinate_m = 1e9;

double largest(const V3d& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }
double half_side(const Imath::Box3d& box) { return largest(box.size()) / 2; }

// Half of the triangles have a longer side that is longer than this.
double median_edge(const Mesh& mesh) {
  std::vector<float> edges;
  edges.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const V3f &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    edges.push_back(std::max({(b - a).length(), (c - b).length(), (a - c).length()}));
  }
  const auto half = edges.begin() + std::ptrdiff_t(edges.size() / 2);
  std::nth_element(edges.begin(), half, edges.end());
  return double(*half);
}

}  // namespace

// Positions of a mesh are moved to its own middle where they are over a hundred times its size away from their origin:
// its transform then has to take that distance off again, and does it in floats. Exact, for the middle is a float too
// and all positions lie within a small part of it.
const Extent::MeshBox& Extent::box_of(std::size_t node, int mesh_index) {
  constexpr double farthest_of_half = 128;
  if (boxes_.size() < scene_.meshes.size()) boxes_.resize(scene_.meshes.size());
  MeshBox& known = boxes_[std::size_t(mesh_index)];
  if (!known.box.isEmpty()) return known;
  Mesh& mesh = scene_.meshes[std::size_t(mesh_index)];
  for (const V3f& p : mesh.positions) known.box.extendBy(V3d(p));
  const V3d middle(V3f(known.box.center()));
  if (largest(middle) <= farthest_of_half * half_side(known.box)) return known;
  check_vertices(node, mesh, float(largest(middle)));
  known.offset = middle;
  for (V3f& p : mesh.positions) p = V3f(V3d(p) - middle);
  known.box = {known.box.min - middle, known.box.max - middle};
  return known;
}

void Extent::check_vertices(std::size_t node, const Mesh& mesh, float farthest) {
  constexpr double lost = 0.25;
  constexpr double coarse = 1.0 / 256;
  const double step = double(float_step(farthest));
  const double edge = median_edge(mesh);
  if (step < coarse * edge) return;
  const std::string cause = fmt::format(
      "{} has a mesh '{}' with vertices at {:.7g} of its file's units, where floats are {:.2g} apart and half "
      "of its triangles shorter than {:.2g}",
      node_label(document_, node), mesh.name, farthest, step, edge);
  if (step >= lost * edge) {
    document_.fail(cause + ": its shape is lost",
                   "export it near its origin, with the distance in its node's translation");
  }
  document_.warn(cause +
                 ": vertices far out are rough; export the mesh near its origin, with the distance in its node's "
                 "translation");
}

void Extent::add_mesh(std::size_t node, int mesh, const M44d& world) {
  const MeshBox& local = box_of(node, mesh);
  M44d from_mesh;
  from_mesh.setTranslation(local.offset);
  from_mesh = from_mesh * world;
  Imath::Box3d box;
  for (int corner = 0; corner < 8; ++corner) {
    const V3d p((corner & 1) != 0 ? local.box.max.x : local.box.min.x,
                (corner & 2) != 0 ? local.box.max.y : local.box.min.y,
                (corner & 4) != 0 ? local.box.max.z : local.box.min.z);
    box.extendBy(p * from_mesh);
  }
  if (!(largest(box.min) <= max_coordinate_m && largest(box.max) <= max_coordinate_m)) {
    document_.fail(
        fmt::format("{} places its mesh farther out than {:g} m", node_label(document_, node), max_coordinate_m),
        "scale the model down");
  }
  pieces_.push_back({box.center(), half_side(box), double(scene_.meshes[std::size_t(mesh)].triangles.size()), node});
}

void Extent::add_ball(std::size_t node, const V3d& center_m, double radius_m) {
  pieces_.push_back({center_m, radius_m, 1, node});
}

V3d Extent::mesh_offset(int mesh) const {
  return std::size_t(mesh) < boxes_.size() ? boxes_[std::size_t(mesh)].offset : V3d(0, 0, 0);
}

void Extent::check_steps(std::size_t node, int mesh, const std::vector<M44d>& instances) {
  constexpr double coarse = 1.0 / 16;
  const double half = half_side(box_of(node, mesh).box);
  for (const M44d& m : instances) {
    const V3d place(m[3][0], m[3][1], m[3][2]);
    const double scale =
        std::sqrt(std::max({V3d(m[0][0], m[0][1], m[0][2]).length2(), V3d(m[1][0], m[1][1], m[1][2]).length2(),
                            V3d(m[2][0], m[2][1], m[2][2]).length2()}));
    const double step = double(float_step(float(largest(place))));
    if (step <= coarse * half * scale) continue;
    document_.warn(
        fmt::format("{} places instances at {:.7g} of its units, where floats are {:.2g} apart, and they are {:.2g} "
                    "wide: they stand "
                    "roughly; put the distance into the node's translation",
                    node_label(document_, node), largest(place), step, 2 * half * scale));
    return;
  }
}

// The median of `values` by the pieces' triangles.
double Extent::middle(std::vector<std::size_t>& order, const std::vector<double>& values) const {
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  double all = 0;
  for (const Piece& piece : pieces_) all += piece.triangles;
  double sum = 0;
  for (const std::size_t i : order) {
    sum += pieces_[i].triangles;
    if (2 * sum >= all) return values[i];
  }
  return 0;
}

V3d Extent::choose_anchor() {
  if (pieces_.empty()) return V3d(0, 0, 0);
  std::vector<std::size_t> order(pieces_.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::vector<double> values(pieces_.size());
  V3d center;
  for (unsigned axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = pieces_[i].center_m[axis];
    center[axis] = middle(order, values);
  }
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = largest(pieces_[i].center_m - center) + pieces_[i].half_m;
  const V3d anchor = ivory::choose_anchor(center, middle(order, values));

  constexpr double longest_offset_of_half = 0.25;
  std::size_t rough = 0;
  const Piece* worst = nullptr;
  for (const Piece& piece : pieces_) {
    const double far_m = largest(piece.center_m - anchor);
    if (!(piece.half_m > 0) || far_m * 0x1p-17 <= longest_offset_of_half * piece.half_m) continue;
    ++rough;
    if (worst == nullptr || far_m > largest(worst->center_m - anchor)) worst = &piece;
  }
  if (worst != nullptr) {
    const double far_m = largest(worst->center_m - anchor);
    document_.warn(
        fmt::format("{}{} small for the distance from most of the scene, {:.3g} m: light there is wrong, for "
                    "rays start {:.2g} m off; give what stands far away a file of its own",
                    node_label(document_, worst->node),
                    rough == 1 ? " is" : fmt::format(" and {} other meshes are", rough - 1), far_m, far_m * 0x1p-17));
  }
  return anchor;
}

}  // namespace ivory::gltf
