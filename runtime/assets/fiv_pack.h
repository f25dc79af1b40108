// FIV tables as the shaders read them (shaders/fiv/table.glsl): boxes of one 3D texture, and a block each of numbers.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "grid/fiv/table.h"

namespace ivory {

// IvoryFivTable of the shaders, in layout std140.
struct FivTableBlock {
  V4f origin;
  V4f samples;
  V4f bins;
  V4f scale;
  std::array<V4f, 9> total;
};
// Bins of log2 r so narrow that none holds more than one sphere: one fetch finds where r lies.
struct FivSphereBins {
  float first = 0;  // log2 of the radii
  float last = 0;
  float per_octave = 0;  // bins
  std::vector<V4f> knots;
};

// Throws Error naming `name` for spheres that are too close.
FivSphereBins make_fiv_bins(const std::string& name, const std::vector<float>& radii);

// Texels that the table takes.
V3i fiv_box_of(const FivTable& table);

// Moments over the falloff at their sphere, times `factor`, into the table's box.
void fill_fiv_box(const FivTable& table, const V3i& corner, const V3i& atlas_size, float factor,
                  std::vector<V4f>& atlas);

// The largest of what fill_fiv_box() writes, for a factor of 1.
float largest_fiv_level(const FivTable& table);

FivTableBlock describe_fiv(const FivTable& table, const V3i& corner, const FivSphereBins& bins, float scale, int row);

}  // namespace ivory
