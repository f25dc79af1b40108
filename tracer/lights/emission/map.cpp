#include "tracer/lights/emission/map.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "tracer/core/texture.h"
#include "tracer/lights/emission/covered_cell.h"

namespace ivory {

namespace {

constexpr int cells_a_sum = 16;

int sums_a_row(const CellAxis& axis) { return axis.count / cells_a_sum + 1; }

const Material& material_of(const EmissionMap& map) { return map.scene->materials[std::size_t(map.material)]; }

// Texels per axis of a cell's corners: left and right, the same for nearest texels.
struct Corners {
  int x0, x1, y0, y1;
};

Corners corners_of(const EmissionMap& map, int i, int j) {
  const bool nearest = map.scene->textures[std::size_t(map.use.texture)].nearest;
  const int x = i + map.x.first_texel;
  const int y = j + map.y.first_texel;
  return {x, nearest ? x : x + 1, y, nearest ? y : y + 1};
}

V3d emitted(const EmissionMap& map, int x, int y) {
  const V4f t = texel(*map.scene, map.use, x, y, true);
  const Rgb& factor = material_of(map).emission;
  return {double(t.x) * double(factor.x), double(t.y) * double(factor.y), double(t.z) * double(factor.z)};
}

// Of an opaque material's texels: the mean of bilinear weights over a cell is that of its corners.
V3d mean_of_texels(const EmissionMap& map, int i, int j) {
  const Corners c = corners_of(map, i, j);
  if (c.x0 == c.x1) return emitted(map, c.x0, c.y0);
  return (emitted(map, c.x0, c.y0) + emitted(map, c.x1, c.y0) + emitted(map, c.x0, c.y1) + emitted(map, c.x1, c.y1)) *
         0.25;
}

double sum(const V3d& v) { return v.x + v.y + v.z; }

struct CellValue {
  double weight;
  V3d radiance;
};

// Of stored cell (i, j) of a map in texels.
CellValue make_cell(const EmissionMap& map, int i, int j) {
  if (material_of(map).alpha_mode == AlphaMode::opaque) {
    const V3d mean = mean_of_texels(map, i, j);
    return {sum(mean), mean};
  }
  const CoveredLight covered = covered_light(map, i, j);
  return {std::max(sum(covered.mean), covered.most / 16), covered.mean};
}

// Rounded to 0 a cell would never be chosen.
float stored(double weight) { return std::max(float(weight), weight > 0 ? 1e-37F : 0.0F); }

void store_cells(EmissionMap& map) {
  const auto width = std::size_t(map.x.count);
  map.weights.resize(width * std::size_t(map.y.count));
  map.radiances.resize(map.weights.size());
  tbb::parallel_for(tbb::blocked_range<int>(0, map.y.count), [&](const tbb::blocked_range<int>& rows) {
    for (int j = rows.begin(); j < rows.end(); ++j) {
      for (int i = 0; i < map.x.count; ++i) {
        const CellValue value = make_cell(map, i, j);
        const std::size_t at = std::size_t(j) * width + std::size_t(i);
        map.weights[at] = stored(value.weight);
        map.radiances[at] = Rgb(float(value.radiance.x), float(value.radiance.y), float(value.radiance.z));
      }
    }
  });
}

// Means over blocks, each cell by its share.
void store_blocks(const EmissionMap& fine, EmissionMap& map) {
  const auto width = std::size_t(map.x.count);
  map.weights.resize(width * std::size_t(map.y.count));
  map.radiances.resize(map.weights.size());
  const auto share = [](const CellAxis& axis, int block, int cell) {
    const double begin = std::max(double(cell), block / axis.cells_a_texel);
    const double end = std::min(double(cell) + 1, (block + 1) / axis.cells_a_texel);
    return std::max(0.0, end - begin) * axis.cells_a_texel;
  };
  tbb::parallel_for(tbb::blocked_range<int>(0, map.y.count), [&](const tbb::blocked_range<int>& rows) {
    for (int block_j = rows.begin(); block_j < rows.end(); ++block_j) {
      std::vector<double> weights(width, 0);
      std::vector<V3d> radiances(width, V3d(0, 0, 0));
      for (int j = int(block_j / map.y.cells_a_texel); j < fine.y.period(); ++j) {
        const double share_j = share(map.y, block_j, j);
        if (share_j == 0 && j > block_j / map.y.cells_a_texel) break;
        for (int i = 0; i < fine.x.period(); ++i) {
          const CellValue value = make_cell(fine, fine.x.stored(i), fine.y.stored(j));
          if (value.weight == 0) continue;
          const int block = std::min(int(i * map.x.cells_a_texel), map.x.count - 1);
          for (int block_i = block; block_i <= std::min(block + 1, map.x.count - 1); ++block_i) {
            const double part = share_j * share(map.x, block_i, i);
            weights[std::size_t(block_i)] += part * value.weight;
            radiances[std::size_t(block_i)] += value.radiance * part;
          }
        }
      }
      for (std::size_t i = 0; i < width; ++i) {
        const std::size_t at = std::size_t(block_j) * width + i;
        map.weights[at] = stored(weights[i]);
        map.radiances[at] = Rgb(float(radiances[i].x), float(radiances[i].y), float(radiances[i].z));
      }
    }
  });
}

V3d stored_radiance(const EmissionMap& map, int i, int j) {
  if (map.radiances.empty()) return mean_of_texels(map, i, j);
  const Rgb& value = map.radiances[std::size_t(j) * std::size_t(map.x.count) + std::size_t(i)];
  return {double(value.x), double(value.y), double(value.z)};
}

double stored_weight(const EmissionMap& map, int i, int j) {
  return double(map.weights[std::size_t(j) * std::size_t(map.x.count) + std::size_t(i)]);
}

// One row of cells of an opaque material's texels, as mean_of_texels() gives them, each column of texels once.
std::vector<V3d> row_of_texels(const EmissionMap& map, int j) {
  const bool nearest = map.scene->textures[std::size_t(map.use.texture)].nearest;
  const auto column = [&](int i) {
    const Corners c = corners_of(map, i, j);
    return nearest ? emitted(map, c.x0, c.y0) : emitted(map, c.x0, c.y0) + emitted(map, c.x0, c.y1);
  };
  std::vector<V3d> row(std::size_t(map.x.count));
  V3d left = column(0);
  for (int i = 0; i < map.x.count; ++i) {
    const V3d right = nearest && i + 1 == map.x.count ? left : column(i + 1);
    row[std::size_t(i)] = nearest ? left : (left + right) * 0.25;
    left = right;
  }
  return row;
}

void make_sums(EmissionMap& map) {
  const auto sums = std::size_t(sums_a_row(map.x));
  const bool of_texels = map.radiances.empty();
  map.weights.resize(std::size_t(map.x.count) * std::size_t(map.y.count));
  map.weight_sums.resize(sums * std::size_t(map.y.count));
  map.radiance_sums.resize(map.weight_sums.size());
  tbb::parallel_for(tbb::blocked_range<int>(0, map.y.count), [&](const tbb::blocked_range<int>& rows) {
    for (int j = rows.begin(); j < rows.end(); ++j) {
      const std::vector<V3d> row = of_texels ? row_of_texels(map, j) : std::vector<V3d>();
      double weights = 0;
      V3d radiances(0, 0, 0);
      for (int i = 0; i <= map.x.count; ++i) {
        if (i % cells_a_sum == 0) {
          const std::size_t at = std::size_t(j) * sums + std::size_t(i / cells_a_sum);
          map.weight_sums[at] = weights;
          map.radiance_sums[at] = radiances;
        }
        if (i == map.x.count) break;
        float& weight = map.weights[std::size_t(j) * std::size_t(map.x.count) + std::size_t(i)];
        if (of_texels) weight = stored(sum(row[std::size_t(i)]));
        weights += double(weight);
        radiances += of_texels ? row[std::size_t(i)] : stored_radiance(map, i, j);
      }
    }
  });
}

// Sum over the first k stored cells of stored row j; a block of zeros is not looked into.
template <typename Value, typename Cell>
Value prefix(const EmissionMap& map, const std::vector<Value>& sums, int k, int j, const Cell& cell) {
  const std::size_t at = std::size_t(j) * std::size_t(sums_a_row(map.x)) + std::size_t(k / cells_a_sum);
  Value total = sums[at];
  const int from = k / cells_a_sum * cells_a_sum;
  if (from + cells_a_sum <= map.x.count && sums[at + 1] == total) return total;
  for (int i = from; i < k; ++i) total += cell(i);
  return total;
}

double weight_before(const EmissionMap& map, int i, int j) {
  const auto cell = [&](int k) { return stored_weight(map, k, j); };
  return sum_before<double>(
      map.x, i, [&](int k) { return prefix(map, map.weight_sums, k, j, cell); }, cell);
}

}  // namespace

std::optional<EmissionMap> make_emission_axes(const Scene& scene, int material) {
  const Material& m = scene.materials[std::size_t(material)];
  if (is_black(m.emission)) return std::nullopt;
  const bool emits = is_textured(scene, m.emission_texture);
  const bool covers = m.alpha_mode != AlphaMode::opaque && is_textured(scene, m.base_color_texture);
  if (!emits && !covers) return std::nullopt;
  EmissionMap map;
  map.scene = &scene;
  map.material = material;
  map.use = emits ? m.emission_texture : m.base_color_texture;
  if (emits && covers) {
    map.whole = same_coordinates(scene, m.emission_texture, m.base_color_texture);
    const auto texels = [&](const TextureUse& use) {
      const Imath::V2i size = texture_size(scene, use);
      return double(size.x) * double(size.y);
    };
    if (map.whole && texels(m.base_color_texture) > texels(m.emission_texture)) map.use = m.base_color_texture;
  }
  const Texture& texture = scene.textures[std::size_t(map.use.texture)];
  map.texels = texture_size(scene, map.use);
  map.x = make_cell_axis(map.texels.x, texture.wrap_s, texture.nearest);
  map.y = make_cell_axis(map.texels.y, texture.wrap_t, texture.nearest);
  return map;
}

std::optional<EmissionMap> make_emission_map(const Scene& scene, int material, int join) {
  std::optional<EmissionMap> map = make_emission_axes(scene, material);
  if (!map) return map;
  if (join > 1) {
    const EmissionMap fine = *map;
    map->x = joined(fine.x, join);
    map->y = joined(fine.y, join);
    store_blocks(fine, *map);
  } else if (scene.materials[std::size_t(material)].alpha_mode != AlphaMode::opaque) {
    store_cells(*map);
  }
  make_sums(*map);
  return map;
}

double cell_weight(const EmissionMap& map, int i, int j) {
  return stored_weight(map, map.x.stored(i), map.y.stored(j));
}

double run_weight(const EmissionMap& map, int begin, int end, int j) {
  const int row = map.y.stored(j);
  return weight_before(map, end, row) - weight_before(map, begin, row);
}

int find_in_run(const EmissionMap& map, int begin, int end, int j, double target) {
  const int row = map.y.stored(j);
  const double exceeded = weight_before(map, begin, row) + target;
  int low = begin;  // the sum before `low` does not exceed it
  int high = end;
  while (high - low > 1) {
    const int middle = low + (high - low) / 2;
    (weight_before(map, middle, row) > exceeded ? high : low) = middle;
  }
  return low;
}

V3d cell_radiance(const EmissionMap& map, int i, int j) {
  return stored_radiance(map, map.x.stored(i), map.y.stored(j));
}

V3d run_radiance(const EmissionMap& map, int begin, int end, int j) {
  const int row = map.y.stored(j);
  const auto cell = [&](int k) { return stored_radiance(map, k, row); };
  const auto before = [&](int i) {
    return sum_before<V3d>(
        map.x, i, [&](int k) { return prefix(map, map.radiance_sums, k, row, cell); }, cell);
  };
  return before(end) - before(begin);
}

V3d bilinear_radiance(const EmissionMap& map, int i, int j, double x, double y) {
  const Corners c = corners_of(map, map.x.stored(i), map.y.stored(j));
  if (c.x0 == c.x1) return emitted(map, c.x0, c.y0);
  // Mirrored cells are stored once, so the texels are asked for where the cell lies.
  const int left = i + map.x.first_texel;
  const int top = j + map.y.first_texel;
  const double fx = std::clamp(x - i, 0.0, 1.0);
  const double fy = std::clamp(y - j, 0.0, 1.0);
  return (emitted(map, left, top) * (1 - fx) + emitted(map, left + 1, top) * fx) * (1 - fy) +
         (emitted(map, left, top + 1) * (1 - fx) + emitted(map, left + 1, top + 1) * fx) * fy;
}

void forget_radiance(EmissionMap& map) {
  map.radiances = {};
  map.radiance_sums = {};
}

Imath::V2i cell_at(const EmissionMap& map, const Mesh& mesh, int triangle, const V2f& barycentric) {
  const V2f at = uv_texels(map.texels, uv_at(mesh, triangle, barycentric, map.use));
  // Rounded as sample() does it.
  if (map.x.cells_a_texel == 1 && map.y.cells_a_texel == 1)
    return {map.x.cell(double(at.x + float(map.x.shift))), map.y.cell(double(at.y + float(map.y.shift)))};
  return {map.x.cell(map.x.at(double(at.x))), map.y.cell(map.y.at(double(at.y)))};
}

}  // namespace ivory
