#include "tracer/bake/fiv/directions.h"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace ivory {

namespace {

struct Light {
  V3f w;
  Rgb power;
};

int octant_of(const V3f& w) { return (w.x < 0 ? 1 : 0) | (w.y < 0 ? 2 : 0) | (w.z < 0 ? 4 : 0); }

FivDirections sorted_by_octant(std::vector<Light> lights) {
  std::stable_sort(lights.begin(), lights.end(), [](const Light& a, const Light& b) {
    const int octant_a = octant_of(a.w);
    const int octant_b = octant_of(b.w);
    return octant_a != octant_b ? octant_a < octant_b : max_component(a.power) > max_component(b.power);
  });
  FivDirections out;
  for (const Light& light : lights) {
    out.w.push_back(light.w);
    out.power.push_back(light.power);
    ++out.octant_begin[std::size_t(octant_of(light.w)) + 1];
  }
  std::partial_sum(out.octant_begin.begin(), out.octant_begin.end(), out.octant_begin.begin());
  return out;
}

std::vector<Rgb> powers(const CubeMap& map) {
  std::vector<Rgb> out;
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < map.size; ++row) {
      for (int column = 0; column < map.size; ++column) {
        out.push_back(map.texels[cube_index(map.size, face, row, column)] *
                      float(cube_texel_solid_angle(map.size, row, column)));
      }
    }
  }
  return out;
}

// Of the strongest channel, so that light of any colour counts.
double total_of(const std::vector<Rgb>& power) {
  double total = 0;
  for (const Rgb& p : power) total += double(max_component(p));
  return total;
}

// A square of texels of one face.
struct Block {
  int row;
  int column;
  int size;
};

// Sums over blocks of a face in constant time, from running sums along both axes in double.
class FaceSums {
 public:
  FaceSums(const std::vector<Rgb>& texel_power, int size, int face) : size_(size), face_(face) {
    sums_.resize(std::size_t(size + 1) * std::size_t(size + 1), V3d(0, 0, 0));
    for (int row = 0; row < size; ++row) {
      V3d along(0, 0, 0);
      for (int column = 0; column < size; ++column) {
        const Rgb& p = texel_power[cube_index(size, face, row, column)];
        along += V3d(p.x, p.y, p.z);
        at(row + 1, column + 1) = at(row, column + 1) + along;
      }
    }
  }

  Light light(const Block& block) const {
    const int bottom = block.row + block.size;
    const int right = block.column + block.size;
    const V3d sum = at(bottom, right) - at(block.row, right) - at(bottom, block.column) + at(block.row, block.column);
    const double middle_s = double(2 * block.column + block.size) / size_ - 1;
    const double middle_t = double(2 * block.row + block.size) / size_ - 1;
    return {V3f(cube_point(face_, middle_s, middle_t).normalized()),
            Rgb(std::max(0.0F, float(sum.x)), std::max(0.0F, float(sum.y)), std::max(0.0F, float(sum.z)))};
  }

 private:
  V3d& at(int row, int column) { return sums_[std::size_t(row) * std::size_t(size_ + 1) + std::size_t(column)]; }
  const V3d& at(int row, int column) const {
    return sums_[std::size_t(row) * std::size_t(size_ + 1) + std::size_t(column)];
  }

  int size_;
  int face_;
  std::vector<V3d> sums_;
};

void divide(const FaceSums& sums, const Block& block, double share, std::vector<Light>& out) {
  const Light light = sums.light(block);
  if (block.size % 2 != 0 || double(max_component(light.power)) <= share) {
    out.push_back(light);
    return;
  }
  const int half = block.size / 2;
  for (const int down : {0, half}) {
    for (const int right : {0, half}) divide(sums, {block.row + down, block.column + right, half}, share, out);
  }
}

// Mean radiance of each texel of a cube of `size` texels, fewer than `fine` has: texels count by the area that they
// share on the face.
CubeMap shrink(const CubeMap& fine, int size) {
  // Texel i of the fine row and texel k of the coarse one overlap by this many fine texels.
  const auto overlap = [&](int i, int k) {
    const double low = double(k) * fine.size / size;
    const double high = double(k + 1) * fine.size / size;
    return std::max(0.0, std::min(double(i + 1), high) - std::max(double(i), low));
  };
  CubeMap out{size, std::vector<Rgb>(std::size_t(cube_faces) * std::size_t(size) * std::size_t(size), Rgb(0, 0, 0))};
  const double area = double(fine.size) * fine.size / (double(size) * size);
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < fine.size; ++row) {
      for (int column = 0; column < fine.size; ++column) {
        const Rgb& radiance = fine.texels[cube_index(fine.size, face, row, column)];
        // Two coarse texels at most, as they are the larger.
        for (int r = row * size / fine.size; r < size && r * fine.size < (row + 1) * size; ++r) {
          for (int c = column * size / fine.size; c < size && c * fine.size < (column + 1) * size; ++c)
            out.texels[cube_index(size, face, r, c)] += radiance * float(overlap(row, r) * overlap(column, c) / area);
        }
      }
    }
  }
  return out;
}

}  // namespace

FivDirections make_fiv_directions(const CubeMap& environment) {
  return make_fiv_directions(environment, environment.size, 1);
}

FivDirections make_fiv_directions(const CubeMap& fine, int size, int parts) {
  assert(size >= 1 && fine.size % size == 0);
  const std::vector<Rgb> texel_power = powers(fine);
  const double share = total_of(texel_power) / parts;
  std::vector<Light> lights;
  for (int face = 0; face < cube_faces; ++face) {
    const FaceSums sums(texel_power, fine.size, face);
    const int block = fine.size / size;
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) divide(sums, {row * block, column * block, block}, share, lights);
    }
  }
  return sorted_by_octant(lights);
}

FivDirections make_fiv_pilot_directions(const CubeMap& environment, int size) {
  if (environment.size <= size) return make_fiv_directions(environment);
  if (environment.size % size == 0) return make_fiv_directions(environment, size, 1);
  return make_fiv_directions(shrink(environment, size));
}

SplitDirections split_bright(const FivDirections& directions, int parts) {
  const double share = total_of(directions.power) / parts;
  std::vector<Light> bright;
  std::vector<Light> rest;
  for (std::size_t k = 0; k < directions.w.size(); ++k) {
    (double(max_component(directions.power[k])) > share ? bright : rest)
        .push_back({directions.w[k], directions.power[k]});
  }
  return {sorted_by_octant(bright), sorted_by_octant(rest)};
}

FivMoments fold_octants(const std::array<float, 72>& octants, int hemispheres) {
  FivMoments moments{};
  for (std::size_t octant = 0; octant < 8; ++octant) {
    for (std::size_t i = 0; i < 9; ++i) {
      const float value = octants[9 * octant + i];
      moments[i] += value;
      if (hemispheres == 1) continue;
      for (std::size_t axis = 0; axis < 3; ++axis)
        moments[9 * (axis + 1) + i] += (octant >> axis & 1U) != 0 ? -value : value;
    }
  }
  return moments;
}

FivMoments total_moments(const FivDirections& directions) {
  std::array<double, 72> sums{};
  for (std::size_t octant = 0; octant < 8; ++octant) {
    for (std::size_t k = directions.octant_begin[octant]; k < directions.octant_begin[octant + 1]; ++k) {
      for (std::size_t i = 0; i < 9; ++i)
        sums[9 * octant + i] += double(directions.w[k][unsigned(i / 3)]) * double(directions.power[k][unsigned(i % 3)]);
    }
  }
  std::array<float, 72> rounded{};
  std::copy(sums.begin(), sums.end(), rounded.begin());
  return fold_octants(rounded, 6);
}

}  // namespace ivory
