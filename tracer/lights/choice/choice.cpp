#include "tracer/lights/choice/choice.h"

#include <algorithm>

// What a light gives unshadowed says little where walls stand between: a sun outside gives a million times what a lamp
// indoors does, and nothing of it comes in. So half of the picks go evenly over what reaches the receiver unshadowed:
// each sun, the sky, and the lamps as one. With I the importance of one of n of those,
//
//   q = I / (2 sum I) + 1 / (2 n),
//
// no estimate has more than twice the variance of picking by importance alone, and none is starved. Among the lamps
// the tree chooses, and an eighth of the picks goes evenly over all of them: next to the tree's that costs a seventh
// more variance at most, and a lamp behind a wall nearby does not starve those in the room.

namespace ivory {

namespace {

constexpr std::size_t most_each = 4;
constexpr float even_share_afar = 0.5F;
constexpr float even_share_lamps = 0.125F;

double below_one(double u) { return std::min(u, 1 - 0x1p-53); }

}  // namespace

LightChoice::LightChoice(std::vector<LightFromAfar> from_afar, std::span<const LightBounds> bounds,
                         const std::vector<std::vector<std::uint32_t>>& groups)
    : from_afar_(std::move(from_afar)), tree_(bounds, groups) {
  std::erase_if(from_afar_, [](const LightFromAfar& light) { return !(light.lux > 0); });
  afar_of_.assign(bounds.size(), local);
  for (std::uint32_t i = 0; i < from_afar_.size(); ++i) afar_of_[from_afar_[i].light] = i;
  group_of_.assign(bounds.size(), LightTree::no_node);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::uint32_t node = tree_.group_node(g);
    if (node == LightTree::no_node) continue;
    groups_.push_back(node);
    for (const std::uint32_t light : groups[g]) group_of_[light] = node;
  }
  each_group_ = from_afar_.size() + groups_.size() <= most_each;
  const std::size_t count = from_afar_.size() + (each_group_ ? groups_.size() : 1);
  only_one_ = count > most_each;
  each_count_ = only_one_ ? 1 : int(std::max<std::size_t>(1, count));
}

float LightChoice::importance(std::size_t index, const Receiver& receiver) const {
  const LightFromAfar& light = from_afar_[index];
  const bool facing = light.w == V3f(0, 0, 0) || receiver.n == V3f(0, 0, 0);
  return facing ? light.lux : light.lux * std::max(0.0F, receiver.n.dot(light.w));
}

LightChoice::Shares LightChoice::shares(const Receiver& receiver) const {
  Shares shares;
  float count = 0;
  const auto add = [&](float value) {
    shares.total += value;
    if (value > 0) count += 1;
  };
  for (std::size_t i = 0; i < from_afar_.size(); ++i) add(importance(i, receiver));
  if (!tree_.empty()) add(tree_.importance(tree_.root(), receiver));
  if (count > 0) shares.even = even_share_afar / count;
  return shares;
}

std::optional<LightChoice::Chosen> LightChoice::choose_in_group(std::uint32_t group, const Receiver& receiver,
                                                                double u) const {
  const std::optional<LightTree::Pick> picked = tree_.pick(group, receiver, u);
  if (!picked) return std::nullopt;
  return Chosen{picked->light, picked->probability, picked->u};
}

std::optional<LightChoice::Chosen> LightChoice::choose_local(const Receiver& receiver, double u) const {
  if (groups_.size() == 1) return choose_in_group(groups_[0], receiver, u);
  std::optional<Chosen> chosen;
  if (u < double(even_share_lamps)) {
    const double at = below_one(u / double(even_share_lamps)) * double(groups_.size());
    const auto g = std::size_t(at);
    chosen = choose_in_group(groups_[g], receiver, at - double(g));
  } else {
    chosen = choose_in_group(tree_.root(), receiver,
                             below_one((u - double(even_share_lamps)) / double(1 - even_share_lamps)));
  }
  if (chosen) chosen->probability = local_probability(receiver, chosen->light);
  return chosen;
}

float LightChoice::local_probability(const Receiver& receiver, std::uint32_t light) const {
  const std::uint32_t group = group_of_[light];
  const float within = tree_.probability(group, tree_.light_node(light), receiver);
  if (groups_.size() == 1) return within;
  return within * (even_share_lamps / float(groups_.size()) +
                   (1 - even_share_lamps) * tree_.probability(tree_.root(), group, receiver));
}

std::optional<LightChoice::Chosen> LightChoice::choose(const Receiver& receiver, LightPick pick, int i,
                                                       double u) const {
  const std::size_t afar = from_afar_.size();
  if (pick == LightPick::each && !only_one_) {
    const auto index = std::size_t(i);
    if (index < afar) {
      if (!(importance(index, receiver) > 0)) return std::nullopt;
      return Chosen{from_afar_[index].light, 1, u};
    }
    if (tree_.empty()) return std::nullopt;
    return each_group_ ? choose_in_group(groups_[index - afar], receiver, u) : choose_local(receiver, u);
  }
  if (afar == 0) return tree_.empty() ? std::nullopt : choose_local(receiver, u);
  const Shares all = shares(receiver);
  if (!(all.total > 0)) return std::nullopt;
  const auto share_of = [&](float value) {
    return value > 0 ? (1 - even_share_afar) * value / all.total + all.even : 0.0F;
  };
  double before = 0;
  for (std::size_t k = 0; k < afar; ++k) {
    const float share = share_of(importance(k, receiver));
    if (u < before + double(share)) return Chosen{from_afar_[k].light, share, below_one((u - before) / double(share))};
    before += double(share);
  }
  const float share = tree_.empty() ? 0.0F : share_of(tree_.importance(tree_.root(), receiver));
  if (!(share > 0)) return std::nullopt;
  std::optional<Chosen> chosen = choose_local(receiver, std::clamp((u - before) / double(share), 0.0, 1 - 0x1p-53));
  if (chosen) chosen->probability *= share;
  return chosen;
}

float LightChoice::probability(const Receiver& receiver, std::uint32_t light, LightPick pick) const {
  const std::uint32_t index = afar_of_[light];
  if (index == local && group_of_[light] == LightTree::no_node) return 0;
  if (pick == LightPick::each && !only_one_) {
    if (index != local) return importance(index, receiver) > 0 ? 1.0F : 0.0F;
    return each_group_ ? tree_.probability(group_of_[light], tree_.light_node(light), receiver)
                       : local_probability(receiver, light);
  }
  if (from_afar_.empty()) return local_probability(receiver, light);
  const Shares all = shares(receiver);
  const float value = index != local ? importance(index, receiver) : tree_.importance(tree_.root(), receiver);
  if (!(value > 0)) return 0;
  const float share = (1 - even_share_afar) * value / all.total + all.even;
  return index != local ? share : share * local_probability(receiver, light);
}

}  // namespace ivory
