// Which of a scene's lights are sampled for a surface, by what they may give there.
#pragma once

#include "tracer/lights/choice/tree.h"

namespace ivory {

// How many lights are sampled for a receiver.
enum class LightPick {
  one,   // one of all
  each,  // each light where those are four at most; or each sun, the sky and one of the lamps, where those are four at
         // most; else one of all
};

// A light that comes from afar, and so is the same everywhere but for the surface's normal.
struct LightFromAfar {
  std::uint32_t light = 0;  // its number among all
  V3f w{0, 0, 0};           // unit, towards it; zero: from all sides
  float lux = 0;            // strongest channel, on a surface that faces it
};

class LightChoice {
 public:
  LightChoice() = default;
  // `bounds` of each light, of those from afar with no intensity. groups[g]: lights that are one lamp.
  LightChoice(std::vector<LightFromAfar> from_afar, std::span<const LightBounds> bounds,
              const std::vector<std::vector<std::uint32_t>>& groups);

  // How many lights are sampled.
  int samples(LightPick pick) const { return pick == LightPick::each ? each_count_ : 1; }

  struct Chosen {
    std::uint32_t light;
    float probability;
    double u;  // uniform in [0, 1) again
  };
  // The light of sample i, by u uniform in [0, 1); nothing where none that it could be reaches the receiver.
  std::optional<Chosen> choose(const Receiver& receiver, LightPick pick, int i, double u) const;
  // The probability with which one of the samples is that light.
  float probability(const Receiver& receiver, std::uint32_t light, LightPick pick) const;

 private:
  struct Shares {
    float total = 0;  // of importance
    float even = 0;   // what each light that reaches the receiver gets besides
  };
  float importance(std::size_t from_afar, const Receiver& receiver) const;
  Shares shares(const Receiver& receiver) const;
  std::optional<Chosen> choose_local(const Receiver& receiver, double u) const;
  float local_probability(const Receiver& receiver, std::uint32_t light) const;
  std::optional<Chosen> choose_in_group(std::uint32_t group, const Receiver& receiver, double u) const;

  static constexpr std::uint32_t local = 0xffffffffU;
  std::vector<LightFromAfar> from_afar_;
  std::vector<std::uint32_t> afar_of_;  // [light] its place among those, or `local`
  LightTree tree_;
  std::vector<std::uint32_t> groups_;    // nodes of those that shine
  std::vector<std::uint32_t> group_of_;  // [light] its group's node
  bool each_group_ = false;              // LightPick::each means every group, not one of all
  bool only_one_ = false;                // it means one of all
  int each_count_ = 1;
};

}  // namespace ivory
