#include "tracer/bake/spheres/winding_number.h"

#include <algorithm>
#include <cmath>

// Own code: libigl, whose headers have one, is no package of Debian 12.

namespace ivory {

namespace {

// A group is a dipole from this many of its radii on: errors of up to 0.02, with 1/2 to be told from 0 and 1.
constexpr double far_radii = 2.5;
constexpr std::uint32_t leaf_size = 8;

// Solid angle (Van Oosterom & Strackee 1983) over 4 pi.
double solid_angle_fraction(const Triangle3d& t, const V3d& p) {
  const V3d a = t[0] - p;
  const V3d b = t[1] - p;
  const V3d c = t[2] - p;
  const double la = a.length();
  const double lb = b.length();
  const double lc = c.length();
  const double y = a.dot(b.cross(c));
  const double x = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return std::atan2(y, x) / (2 * double(pi));
}

V3d centroid(const Triangle3d& t) { return (t[0] + t[1] + t[2]) / 3.0; }

}  // namespace

WindingNumber::WindingNumber(std::vector<Triangle3d> triangles) : triangles_(std::move(triangles)) {
  if (triangles_.empty()) return;
  nodes_.reserve(triangles_.size());
  Node root;
  root.count = std::uint32_t(triangles_.size());
  nodes_.push_back(root);
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) build(i);
}

void WindingNumber::build(std::uint32_t index) {
  Node node = nodes_[index];
  const auto begin = triangles_.begin() + node.first;
  const auto end = begin + node.count;
  double area = 0;
  V3d weighted(0, 0, 0);
  V3d low = centroid(*begin);
  V3d high = low;
  for (auto t = begin; t != end; ++t) {
    const V3d normal = ((*t)[1] - (*t)[0]).cross((*t)[2] - (*t)[0]) * 0.5;
    const V3d c = centroid(*t);
    node.dipole += normal;
    weighted += c * normal.length();
    area += normal.length();
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], c[k]);
      high[k] = std::max(high[k], c[k]);
    }
  }
  node.center = area > 0 ? weighted / area : (low + high) * 0.5;
  for (auto t = begin; t != end; ++t) {
    for (const V3d& v : *t) node.radius = std::max(node.radius, (v - node.center).length());
  }
  if (node.count > leaf_size) {
    const V3d size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const auto middle = begin + node.count / 2;
    std::nth_element(begin, middle, end, [axis](const Triangle3d& a, const Triangle3d& b) {
      return centroid(a)[axis] < centroid(b)[axis];
    });
    node.child = std::uint32_t(nodes_.size());
    Node left;
    left.first = node.first;
    left.count = node.count / 2;
    Node right;
    right.first = node.first + left.count;
    right.count = node.count - left.count;
    nodes_.push_back(left);
    nodes_.push_back(right);
  }
  nodes_[index] = node;
}

double WindingNumber::at(const V3d& p) const {
  double sum = 0;
  if (nodes_.empty()) return sum;
  std::array<std::uint32_t, 64> stack;  // halving: depth 32 at most
  int top = 0;
  stack[0] = 0;
  while (top >= 0) {
    const Node& node = nodes_[stack[std::size_t(top--)]];
    const V3d d = node.center - p;
    const double distance2 = d.length2();
    if (distance2 > far_radii * far_radii * node.radius * node.radius) {
      sum += node.dipole.dot(d) / (distance2 * std::sqrt(distance2) * 4 * double(pi));
    } else if (node.child == 0) {
      for (std::uint32_t i = 0; i < node.count; ++i) sum += solid_angle_fraction(triangles_[node.first + i], p);
    } else {
      stack[std::size_t(++top)] = node.child;
      stack[std::size_t(++top)] = node.child + 1;
    }
  }
  return sum;
}

}  // namespace ivory
