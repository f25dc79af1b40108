// Which of many local lights to sample for a point: a binary tree over them whose nodes bound where their lights are,
// where these shine, and how strongly (Conty Estevez & Kulla, "Importance Sampling of Many Lights with Adaptive Tree
// Splitting", 2018). Own code: no library of Debian's has it apart from a renderer.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "grid/base/types.h"

namespace ivory {

// Where light is asked for. n: unit normal, light from behind it does not count; zero: light from all sides does.
struct Receiver {
  V3f p{0, 0, 0};
  V3f n{0, 0, 0};
};

// What is known of lights as a whole. They shine with at most intensity_cd, each around a normal that lies within
// spread_rad of the axis: falling with the cosine of the angle off that normal, and nothing beyond reach_rad.
struct LightBounds {
  Box3f box;
  V3f axis{0, 0, 1};  // unit
  float spread_rad = 0;
  float reach_rad = 0;
  bool two_sided = false;  // and the same around -axis
  float intensity_cd = 0;  // strongest channel, of all together
};

// Of both together. Lights of no intensity count for nothing.
LightBounds merge(const LightBounds& a, const LightBounds& b);

class LightTree {
 public:
  // `lights` bounds each light; groups[g] holds lights (each in one group) that stay together below one node. Lights of
  // no intensity are never picked.
  LightTree() = default;
  LightTree(std::span<const LightBounds> lights, const std::vector<std::vector<std::uint32_t>>& groups);

  static constexpr std::uint32_t no_node = 0xffffffffU;

  bool empty() const { return nodes_.empty(); }
  std::uint32_t root() const { return nodes_.empty() ? no_node : 0; }
  // The node above all lights of a group, and that of a light; no_node where it does not shine.
  std::uint32_t group_node(std::size_t group) const { return group_nodes_[group]; }
  std::uint32_t light_node(std::size_t light) const { return leaf_[light]; }

  // About the irradiance in lux that the lights below a node give the receiver unshadowed, from above where they lie
  // close together; 0 only where none of them reaches it.
  float importance(std::uint32_t node, const Receiver& receiver) const;

  struct Pick {
    std::uint32_t light;
    float probability;  // of picking it, given the node
    double u;           // uniform in [0, 1) again
  };
  // A light below the node by importance, by u uniform in [0, 1); nothing where none reaches the receiver.
  std::optional<Pick> pick(std::uint32_t node, const Receiver& receiver, double u) const;
  // With which pick(), asked at the node `above`, comes by `node`, which is below it or the same.
  float probability(std::uint32_t above, std::uint32_t node, const Receiver& receiver) const;

  // Bytes that a tree over so many lights takes.
  static double bytes(double lights) { return lights * (2 * sizeof(Node) + 8); }

 private:
  // Cosines and sines of the bounds' angles instead of the angles.
  struct Node {
    V3f center;
    float radius2;  // of the sphere around the box
    V3f axis;
    float intensity_cd;
    float cos_spread;
    float sin_spread;
    float cos_reach;
    bool two_sided;
    bool is_leaf;
    std::uint32_t child;   // the first of two side by side; of a leaf, the light
    std::uint32_t parent;  // no_node at the root
  };
  static Node make_node(const LightBounds& bounds);
  static float importance(const Node& node, const Receiver& receiver);
  // Of the first of two children; less than 0 where neither reaches the receiver.
  float first_share(std::uint32_t first_child, const Receiver& receiver) const;

  struct Builder;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> leaf_;         // [light] its node, no_node for dark ones
  std::vector<std::uint32_t> group_nodes_;  // [group]
};

}  // namespace ivory
