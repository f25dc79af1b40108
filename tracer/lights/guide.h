// Where lights' photons are sent, learnt from what earlier ones did: a density over the random numbers that photons are
// made of.
//
// Every light is cut into strata, and every stratum is a map from the unit cube to photons (tracer/lights/strata.h):
// neighbours in the cube are photons that start and fly alike. A guide cuts the cubes into cells and gives each a
// probability. Guiding random numbers and not rays (Guo et al., "Primary Sample Space Path Guiding", EGSR 2018) keeps
// it the same for all lights and the powers of photons exact: one whose map gives it the power P carries P / density.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tracer/core/alias_table.h"

namespace ivory {

// Of the cube: which light or triangle; the place on it or on the disc that light enters through; the direction.
inline constexpr std::size_t guide_axes = 5;
inline constexpr unsigned axis_which = 0;
inline constexpr unsigned axis_place = 1;      // and 2
inline constexpr unsigned axis_direction = 3;  // and 4
using GuideAxes = std::array<double, guide_axes>;

struct GuideStratum {
  double share = 0;   // of all photons where nothing is guided
  unsigned axes = 0;  // bit i: axis i matters
  double weakest_lm =
      0;  // strongest channel of its photons where nothing is guided; a textured emitter's vary around it
  double heaviest_lm = 0;
};

struct GuidePoint {
  std::uint32_t stratum = 0;
  GuideAxes u{};       // [0, 1); 0 along axes that do not matter
  double density = 1;  // of photons there, over that without guiding
};

// A photon that was sent out by some guide, and what it brought.
struct GuideSample {
  GuidePoint point;
  // Square of what it would have brought where nothing is guided: what the variance of the sought mean adds up.
  double square = 0;
};

class EmissionGuide {
 public:
  EmissionGuide() = default;
  // Nothing is guided: density 1.
  explicit EmissionGuide(std::span<const GuideStratum> strata);

  GuidePoint sample(RandomStream& random) const;
  std::size_t cells() const { return cells_.size(); }
  // Over each stratum's cells.
  double least_density(std::uint32_t stratum) const { return least_[stratum]; }
  double largest_density(std::uint32_t stratum) const { return largest_[stratum]; }

 private:
  friend EmissionGuide make_guide(std::span<const GuideStratum>, std::span<const GuideSample>, double);
  struct Cell {
    std::uint32_t stratum = 0;
    std::array<float, guide_axes> low{};
    std::array<float, guide_axes> size{};  // powers of two; 0 along axes that do not matter
  };
  void finish(std::span<const GuideStratum> strata, const std::vector<double>& weights);

  std::vector<Cell> cells_;
  std::vector<double> density_;  // [cell]
  AliasTable table_;             // over cells
  std::vector<unsigned> axes_;   // [stratum]
  std::vector<double> least_;    // [stratum]
  std::vector<double> largest_;
};

// The guide of least variance that the samples vouch for; the share `defensive` of its photons goes as without a guide,
// so that no photon carries more than 1 / defensive times what it would have then. Depends on the order of the samples
// in nothing but rounding.
EmissionGuide make_guide(std::span<const GuideStratum> strata, std::span<const GuideSample> samples, double defensive);

}  // namespace ivory
