// The light of a grid that keeps groups of lights apart, each by its own strength and colour.
#pragma once

#include <map>
#include <string>

#include "grid/field/irradiance_grid.h"

namespace ivory {

// What the light of a group is multiplied by, a factor a channel; groups that are not named stay as they are.
using GroupFactors = std::map<std::string, Rgb>;

// A grid without groups, of their light times the factors. Light adds up, so it is what a bake of lamps dimmed and
// coloured so would give, with the noise of its photons. With factors of 1 alone it is the grid's own sum of all, to
// the bit; with others it loses the certificate, which was measured of that sum. Throws ParameterError ("groups") where
// the grid keeps none or not the one named, and for factors that are negative or not finite.
IrradianceGrid mix_groups(const IrradianceGrid& grid, const GroupFactors& factors);

}  // namespace ivory
