#include "tracer/lights/choice/tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ivory {

namespace {

float angle_between(const V3f& a, const V3f& b) {
  // Exact for small angles, too, where acos is not.
  return 2 * std::atan2((a - b).length(), (a + b).length());
}

// The smallest cone around both, about; widened for rounding.
void merge_cones(const LightBounds& a, const LightBounds& b, LightBounds& out) {
  const LightBounds& wide = a.spread_rad >= b.spread_rad ? a : b;
  const LightBounds& narrow = a.spread_rad >= b.spread_rad ? b : a;
  const float between = angle_between(wide.axis, narrow.axis);
  out.axis = wide.axis;
  out.spread_rad = wide.spread_rad;
  if (between + narrow.spread_rad <= wide.spread_rad) return;
  const float spread = 0.5F * (wide.spread_rad + between + narrow.spread_rad) + 1e-5F;
  const V3f around = wide.axis.cross(narrow.axis);
  if (spread >= pi || !(around.length2() > 1e-12F)) {
    out.spread_rad = spread >= pi || between > 1 ? pi : spread + between;
    return;
  }
  const float turn = spread - wide.spread_rad;
  const V3f k = around.normalized();
  out.axis = (wide.axis * std::cos(turn) + k.cross(wide.axis) * std::sin(turn)).normalized();
  out.spread_rad = spread;
}

// Integral of the cosine over the directions that a cone of such normals shines in, sr (Conty Estevez & Kulla, eq. 1):
// whole up to the spread, falling beyond it.
float orientation_measure(const LightBounds& b) {
  const float outer = std::min(b.spread_rad + b.reach_rad, pi);
  const float c = std::cos(b.spread_rad);
  const float s = std::sin(b.spread_rad);
  const float measure =
      2 * pi * (1 - c) + pi / 2 * (2 * outer * s - std::cos(b.spread_rad - 2 * outer) - 2 * b.spread_rad * s + c);
  return b.two_sided ? 2 * measure : measure;
}

// By the diagonal's square instead of the surface, which is nothing for lamps in a row.
float split_cost(const LightBounds& b) {
  return b.intensity_cd > 0 ? b.intensity_cd * orientation_measure(b) * b.box.size().length2() : 0.0F;
}

}  // namespace

LightBounds merge(const LightBounds& a, const LightBounds& b) {
  if (!(a.intensity_cd > 0)) return b;
  if (!(b.intensity_cd > 0)) return a;
  LightBounds out;
  out.box = a.box;
  out.box.extendBy(b.box);
  merge_cones(a, b, out);
  out.reach_rad = std::max(a.reach_rad, b.reach_rad);
  out.two_sided = a.two_sided || b.two_sided;
  out.intensity_cd = a.intensity_cd + b.intensity_cd;
  return out;
}

// From the root down. What is split are groups until one is left, then the lights of that one.
struct LightTree::Builder {
  struct Item {
    LightBounds bounds;
    std::uint32_t index;
  };

  LightTree& tree;
  std::span<const LightBounds> lights;
  const std::vector<std::vector<std::uint32_t>>& groups;

  static LightBounds merged(std::span<const Item> items) {
    LightBounds out;
    for (const Item& item : items) out = merge(out, item.bounds);
    return out;
  }

  std::vector<Item> shining_lights(std::uint32_t group) const {
    std::vector<Item> items;
    for (const std::uint32_t light : groups[group]) {
      if (lights[light].intensity_cd > 0) items.push_back({lights[light], light});
    }
    return items;
  }

  // Moves the first part to the front; how many those are. The cheapest of a few planes across each axis, or the middle
  // where none separates.
  static std::size_t split(std::span<Item> items) {
    Box3f centers;
    for (const Item& item : items) centers.extendBy(item.bounds.box.center());
    constexpr int bins = 12;
    float best = std::numeric_limits<float>::infinity();
    int best_axis = -1;
    int best_plane = 0;
    const auto bin_of = [&](const Item& item, int axis) {
      const float at = (item.bounds.box.center()[axis] - centers.min[axis]) / centers.size()[axis];
      return std::min(int(at * bins), bins - 1);
    };
    for (int axis = 0; axis < 3; ++axis) {
      if (!(centers.size()[axis] > 0)) continue;
      std::array<LightBounds, bins> in_bin;
      for (const Item& item : items) {
        LightBounds& b = in_bin[std::size_t(bin_of(item, axis))];
        b = merge(b, item.bounds);
      }
      std::array<float, bins> below{};
      LightBounds sum;
      for (std::size_t i = 0; i + 1 < bins; ++i) {
        sum = merge(sum, in_bin[i]);
        below[i] = split_cost(sum);
      }
      sum = {};
      for (std::size_t i = bins - 1; i > 0; --i) {
        sum = merge(sum, in_bin[i]);
        // Long boxes are cut across.
        const float cost = (below[i - 1] + split_cost(sum)) / std::max(centers.size()[axis], 1e-30F);
        if (!(cost < best)) continue;
        best = cost;
        best_axis = axis;
        best_plane = int(i);
      }
    }
    if (best_axis < 0) return items.size() / 2;
    const auto second = std::partition(items.begin(), items.end(),
                                       [&](const Item& item) { return bin_of(item, best_axis) < best_plane; });
    const auto first_count = std::size_t(second - items.begin());
    return first_count == 0 || first_count == items.size() ? items.size() / 2 : first_count;
  }

  void build(std::uint32_t node, std::span<Item> items, bool are_groups) {
    if (items.size() == 1 && are_groups) {
      tree.group_nodes_[items[0].index] = node;
      std::vector<Item> inner = shining_lights(items[0].index);
      build(node, inner, false);
      return;
    }
    if (items.size() == 1) {
      tree.nodes_[node].is_leaf = true;
      tree.nodes_[node].child = items[0].index;
      tree.leaf_[items[0].index] = node;
      return;
    }
    const std::size_t first_count = split(items);
    const auto first = std::uint32_t(tree.nodes_.size());
    tree.nodes_[node].child = first;
    for (const std::span<Item> half : {items.first(first_count), items.subspan(first_count)}) {
      tree.nodes_.push_back(make_node(merged(half)));
      tree.nodes_.back().parent = node;
    }
    build(first, items.first(first_count), are_groups);
    build(first + 1, items.subspan(first_count), are_groups);
  }
};

LightTree::LightTree(std::span<const LightBounds> lights, const std::vector<std::vector<std::uint32_t>>& groups) {
  leaf_.assign(lights.size(), no_node);
  group_nodes_.assign(groups.size(), no_node);
  Builder builder{*this, lights, groups};
  std::vector<Builder::Item> items;
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    const std::vector<Builder::Item> inner = builder.shining_lights(g);
    if (!inner.empty()) items.push_back({Builder::merged(inner), g});
  }
  if (items.empty()) return;
  nodes_.push_back(make_node(Builder::merged(items)));
  builder.build(0, items, true);
  nodes_.shrink_to_fit();
}

LightTree::Node LightTree::make_node(const LightBounds& b) {
  Node node{};
  node.center = b.box.center();
  node.radius2 = 0.25F * b.box.size().length2();
  node.axis = b.axis;
  node.intensity_cd = b.intensity_cd;
  node.cos_spread = std::cos(b.spread_rad);
  node.sin_spread = std::sin(std::min(b.spread_rad, pi));
  node.cos_reach = std::cos(b.reach_rad);
  node.two_sided = b.two_sided;
  node.parent = no_node;
  return node;
}

namespace {

// Cosine of an angle less another, 1 where that is below 0.
float cos_difference(float cos_a, float sin_a, float cos_b, float sin_b) {
  return cos_a > cos_b ? 1.0F : cos_a * cos_b + sin_a * sin_b;
}
float sin_difference(float cos_a, float sin_a, float cos_b, float sin_b) {
  return cos_a > cos_b ? 0.0F : sin_a * cos_b - cos_a * sin_b;
}

float sine_of(float cosine) { return std::sqrt(std::max(0.0F, 1 - cosine * cosine)); }

}  // namespace

// Conty Estevez & Kulla, eq. 3: intensity over squared distance, times the cosine at the lights and that at the
// receiver, each at the most favourable angle that the sphere around the lights leaves open. Within that sphere the
// distance is its radius.
float LightTree::importance(const Node& node, const Receiver& receiver) {
  const V3f to = node.center - receiver.p;
  const float d2 = to.length2();
  const float near2 = std::max(d2, node.radius2);
  // A lamp at the receiver itself: as much as still can be added up.
  constexpr float most = 0x1p120F;
  if (!(node.intensity_cd > 0)) return 0;
  float value = node.intensity_cd < most * near2 ? node.intensity_cd / near2 : most;
  if (!(d2 > node.radius2)) return value;  // in their midst
  const V3f w = to / std::sqrt(d2);
  const float sin2_box = node.radius2 / d2;
  const float sin_box = std::sqrt(sin2_box);
  const float cos_box = std::sqrt(std::max(0.0F, 1 - sin2_box));

  float cos_out = -node.axis.dot(w);
  if (node.two_sided) cos_out = std::abs(cos_out);
  const float sin_out = sine_of(cos_out);
  const float cos_spread_less = cos_difference(cos_out, sin_out, node.cos_spread, node.sin_spread);
  const float sin_spread_less = sin_difference(cos_out, sin_out, node.cos_spread, node.sin_spread);
  const float cos_light = cos_difference(cos_spread_less, sin_spread_less, cos_box, sin_box);
  // What rounding leaves of nothing is nothing, but for the light's edge.
  constexpr float rounding = 1e-6F;
  if (cos_light < node.cos_reach - rounding) return 0;
  // A spot's edge may lie beyond 90 degrees off its nearest normal.
  value *= std::max(cos_light, 0.01F);
  if (receiver.n == V3f(0, 0, 0)) return value;
  const float cos_in = receiver.n.dot(w);
  const float cos_surface = cos_difference(cos_in, sine_of(cos_in), cos_box, sin_box);
  return cos_surface > -rounding ? value * std::max(cos_surface, rounding) : 0.0F;
}

float LightTree::importance(std::uint32_t node, const Receiver& receiver) const {
  return importance(nodes_[node], receiver);
}

// By what is known one step further down, where bounds are tighter: for twice the work a fifth of the variance. Lights
// that lie close together as seen from the receiver are told apart well enough without.
float LightTree::first_share(std::uint32_t first_child, const Receiver& receiver) const {
  const auto ahead = [&](const Node& node) {
    constexpr float narrow2 = 0.02F;  // squared sine of the angle that they appear under
    if (node.is_leaf || node.radius2 < narrow2 * (node.center - receiver.p).length2())
      return importance(node, receiver);
    return importance(nodes_[node.child], receiver) + importance(nodes_[node.child + 1], receiver);
  };
  const float first = ahead(nodes_[first_child]);
  const float second = ahead(nodes_[first_child + 1]);
  const float sum = first + second;
  return sum > 0 ? first / sum : -1.0F;
}

std::optional<LightTree::Pick> LightTree::pick(std::uint32_t node, const Receiver& receiver, double u) const {
  if (nodes_[node].is_leaf && !(importance(nodes_[node], receiver) > 0)) return std::nullopt;
  float probability = 1;
  while (!nodes_[node].is_leaf) {
    const std::uint32_t first = nodes_[node].child;
    const float share = first_share(first, receiver);
    if (share < 0) return std::nullopt;
    const auto s = double(share);
    if (u < s) {
      node = first;
      probability *= share;
      u /= s;
    } else {
      node = first + 1;
      probability *= 1 - share;
      u = (u - s) / (1 - s);
    }
    u = std::min(u, 1 - 0x1p-53);
  }
  return Pick{nodes_[node].child, probability, u};
}

float LightTree::probability(std::uint32_t above, std::uint32_t node, const Receiver& receiver) const {
  float probability = 1;
  while (node != above) {
    const std::uint32_t parent = nodes_[node].parent;
    const std::uint32_t first = nodes_[parent].child;
    const float share = first_share(first, receiver);
    if (share < 0) return 0;
    probability *= node == first ? share : 1 - share;
    node = parent;
  }
  return probability;
}

}  // namespace ivory
