#include "runtime/assets/fiv.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/base/half.h"
#include "grid/base/memory.h"
#include "grid/io/fiv.h"
#include "runtime/gl/boxes.h"
#include "runtime/gl/check.h"

namespace ivory {

namespace {

constexpr int most_bins = 1024;  // OpenGL 3.3 takes textures at least so wide

// IvoryFivTable and IvoryFivOccluders of the shaders, in layout std140.
struct TableBlock {
  V4f origin;
  V4f samples;
  V4f bins;
  V4f scale;
  std::array<V4f, 9> total;
};
struct OccluderBlock {
  std::array<std::int32_t, 4> count{};
  std::array<V4f, std::size_t(fiv_max_occluders)> place;
  std::array<std::array<std::int32_t, 4>, std::size_t(fiv_max_occluders)> table_of{};
};

int slab_count(const FivTable& table) { return table.hemispheres == 1 ? 3 : 9; }

// Which of a sample's numbers is channel c of slab s, or -1: see shaders/fiv/table.glsl.
int number_at(const FivTable& table, int s, int c) {
  if (s < 3 && c < 3) return 3 * s + c;
  if (table.hemispheres == 1) return -1;
  return s < 3 ? 9 + s : 4 * s + c;
}

V3i box_of(const FivTable& table) {
  return {3 * (table.size.x + 1), slab_count(table) / 3 * table.size.y, table.size.z};
}

// Bins of log2 r so narrow that none holds more than one sphere: one fetch finds where r lies.
struct SphereBins {
  float first = 0;  // log2 of the radii
  float last = 0;
  float per_octave = 0;  // bins
  std::vector<V4f> knots;
};

SphereBins make_bins(const std::string& name, const std::vector<float>& radii) {
  std::vector<double> x;
  x.reserve(radii.size());
  for (const float r : radii) x.push_back(std::log2(double(r)));
  const double range = x.back() - x.front();
  double narrowest = range;
  for (std::size_t k = 1; k < x.size(); ++k) narrowest = std::min(narrowest, x[k] - x[k - 1]);
  // A little narrower than the narrowest interval, against rounding.
  const double count = std::ceil(1.02 * range / narrowest);
  if (!(count <= most_bins)) {
    throw Error(name, fmt::format("has spheres closer to one another than a {}th of their range", most_bins),
                "bake it with fewer spheres");
  }
  SphereBins out;
  out.first = float(x.front());
  out.last = float(x.back());
  out.per_octave = float(count / range);
  std::size_t k = 0;  // the interval that the bin begins in
  for (int bin = 0; bin < int(count); ++bin) {
    const double begin = x.front() + range * bin / count;
    const double end = x.front() + range * (bin + 1) / count;
    while (k + 2 < x.size() && x[k + 1] <= begin) ++k;
    const double before = 1 / (x[k + 1] - x[k]);
    if (k + 2 < x.size() && x[k + 1] < end) {
      out.knots.emplace_back(float(x[k + 1]), float(k + 1), float(before), float(1 / (x[k + 2] - x[k + 1])));
    } else {
      out.knots.emplace_back(float(x[k]), float(k), float(before), float(before));
    }
  }
  return out;
}

// Moments over the falloff at their sphere, times `factor`, into the table's box.
void fill(const FivTable& table, const V3i& corner, const V3i& atlas_size, float factor, std::vector<V4f>& atlas) {
  const auto numbers = 3 * std::size_t(fiv_function_count(table.hemispheres));
  for (int s = 0; s < slab_count(table); ++s) {
    for (int k = 0; k < table.size.z; ++k) {
      const float level = factor / fiv_falloff(table.radii[std::size_t(k)]);
      for (int p = 0; p < table.size.y; ++p) {
        for (int a = 0; a <= table.size.x; ++a) {
          const std::size_t sample =
              (std::size_t(k) * std::size_t(table.size.y) + std::size_t(p)) * std::size_t(table.size.x) +
              std::size_t(a % table.size.x);
          const V3i at = corner + V3i(s % 3 * (table.size.x + 1) + a, s / 3 * table.size.y + p, k);
          V4f& texel =
              atlas[(std::size_t(at.z) * std::size_t(atlas_size.y) + std::size_t(at.y)) * std::size_t(atlas_size.x) +
                    std::size_t(at.x)];
          for (int c = 0; c < 4; ++c) {
            const int number = number_at(table, s, c);
            texel[unsigned(c)] = number < 0 ? 0 : table.values[sample * numbers + std::size_t(number)] * level;
          }
        }
      }
    }
  }
}

float largest_level(const FivTable& table) {
  const std::size_t sphere = table.values.size() / std::size_t(table.size.z);
  float largest = 0;
  for (std::size_t i = 0; i < table.values.size(); ++i)
    largest = std::max(largest, std::abs(table.values[i]) / fiv_falloff(table.radii[i / sphere]));
  return largest;
}

TableBlock describe(const FivTable& table, const V3i& corner, const SphereBins& bins, float scale, int row) {
  TableBlock block;
  block.origin = {float(corner.x), float(corner.y), float(corner.z), float(slab_count(table))};
  block.samples = {float(table.size.x), float(table.size.y), float(table.size.z), table.coverage};
  block.bins = {bins.first, bins.last, bins.per_octave, float(bins.knots.size())};
  block.scale = {scale, most_hidden(table), float(row), 0};
  for (int s = 0; s < 9; ++s) {
    for (int c = 0; c < 4; ++c) {
      const int number = s < slab_count(table) ? number_at(table, s, c) : -1;
      block.total[std::size_t(s)][unsigned(c)] = number < 0 ? 0 : table.total[std::size_t(number)];
    }
  }
  return block;
}

gl::Buffer uniform_buffer(const void* data, std::size_t bytes, GLenum usage) {
  auto buffer = gl::make<gl::Kind::buffer>();
  IVORY_GL(glBindBuffer, GL_UNIFORM_BUFFER, buffer.id());
  IVORY_GL(glBufferData, GL_UNIFORM_BUFFER, GLsizeiptr(bytes), data, usage);
  return buffer;
}

int bind_tables(const GpuFivTables& fiv, gl::Program& program, int unit, Straddling straddling, int self) {
  gl::bind(fiv.atlas, unit);
  program.set("ivory_fiv_atlas", unit++);
  gl::bind(fiv.spheres, unit);
  program.set("ivory_fiv_spheres", unit++);
  program.bind_block("IvoryFivTables", fiv.tables, fiv_tables_binding);
  program.bind_block("IvoryFivOccluders", fiv.occluders, fiv_occluders_binding);
  program.set("ivory_fiv_straddling", straddling == Straddling::scale ? 1 : 0);
  program.set("ivory_fiv_self", self);
  return unit;
}

template <typename Environment>
AmbientSource make_source(const GpuFivTables& fiv, const Environment& unshadowed, const FivLightParams& params,
                          int self) {
  return {fiv_defines(params.overlap, self >= 0) + "#include \"ambient/fiv.glsl\"\n",
          [&fiv, &unshadowed, straddling = params.straddling, self](gl::Program& program, int first_unit) {
            return bind(fiv, unshadowed, program, first_unit, straddling, self);
          }};
}

static_assert(int(FivOverlap::none) == 0 && int(FivOverlap::discs) == 1 && int(FivOverlap::covers) == 2 &&
              int(FivOverlap::product) == 3);

}  // namespace

std::size_t GpuFivTables::bytes() const {
  return atlas.bytes() + spheres.bytes() + std::size_t(fiv_max_tables) * sizeof(TableBlock) + sizeof(OccluderBlock);
}

GpuFivTables upload(std::span<const FivTable> tables, const FivUploadParams& params,
                    std::span<const std::string> names) {
  gl::require_context();
  assert(names.empty() || names.size() == tables.size());
  const auto name_of = [&](std::size_t i) { return names.empty() ? fmt::format("FIV table {}", i) : names[i]; };
  if (tables.empty() || tables.size() > std::size_t(fiv_max_tables)) {
    throw Error("FIV tables", fmt::format("there are {}, and a set takes 1 to {}", tables.size(), fiv_max_tables),
                "upload them as several sets");
  }
  GLint limit = 0;
  IVORY_GL(glGetIntegerv, GL_MAX_3D_TEXTURE_SIZE, &limit);
  std::vector<V3i> boxes;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const V3i& size = tables[i].size;
    const V3i box = box_of(tables[i]);
    if (std::max({box.x, box.y, box.z}) > limit) {
      throw Error(name_of(i),
                  fmt::format("its {}x{}x{} samples make a texture of {}x{}x{} texels, and this OpenGL takes {} a side "
                              "(GL_MAX_3D_TEXTURE_SIZE)",
                              size.x, size.y, size.z, box.x, box.y, box.z, limit),
                  "bake it with fewer samples");
    }
    boxes.push_back(box);
  }
  const std::optional<PackedBoxes> packed = pack_boxes(boxes, limit);
  if (!packed) {
    throw Error(name_of(0),
                fmt::format("it and {} tables more do not fit into one texture of {} texels a side "
                            "(GL_MAX_3D_TEXTURE_SIZE)",
                            tables.size() - 1, limit),
                "upload them as several sets, or bake them with fewer samples");
  }

  const std::size_t texels = std::size_t(packed->size.x) * std::size_t(packed->size.y) * std::size_t(packed->size.z);
  check_memory(name_of(0), 2 * double(texels) * sizeof(V4f), "bake it with fewer samples");
  std::vector<V4f> atlas(texels, V4f(0, 0, 0, 0));
  std::vector<TableBlock> blocks;
  std::vector<SphereBins> bins;
  std::size_t most = 1;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const float scale = params.half_floats ? half_scale(largest_level(tables[i])) : 1.0F;
    bins.push_back(make_bins(name_of(i), tables[i].radii));
    most = std::max(most, bins.back().knots.size());
    fill(tables[i], packed->corners[i], packed->size, 1 / scale, atlas);
    blocks.push_back(describe(tables[i], packed->corners[i], bins.back(), scale, int(i)));
  }
  blocks.resize(std::size_t(fiv_max_tables));
  std::vector<V4f> knots(most * tables.size(), V4f(0, 0, 0, 0));
  for (std::size_t i = 0; i < bins.size(); ++i)
    std::copy(bins[i].knots.begin(), bins[i].knots.end(), knots.begin() + std::ptrdiff_t(i * most));

  GpuFivTables out;
  out.atlas = gl::make_texture_3d(name_of(0), params.half_floats ? gl::Format::rgba16f : gl::Format::rgba32f,
                                  packed->size, atlas.data(), gl::Filter::linear);
  out.spheres = gl::make_texture_2d(name_of(0), gl::Format::rgba32f, int(most), int(tables.size()), knots.data(),
                                    gl::Filter::nearest);
  out.tables = uniform_buffer(blocks.data(), blocks.size() * sizeof(TableBlock), GL_STATIC_DRAW);
  out.occluders = uniform_buffer(nullptr, sizeof(OccluderBlock), GL_DYNAMIC_DRAW);
  out.table_count = int(tables.size());
  set_occluders(out, {});
  return out;
}

GpuFivTables load_fiv_tables(std::span<const std::string> paths, const FivUploadParams& params) {
  std::vector<FivTable> tables;
  for (const std::string& path : paths) tables.push_back(read_fiv(path));
  return upload(tables, params, paths);
}

void set_occluders(GpuFivTables& fiv, std::span<const GpuFivOccluder> occluders) {
  if (occluders.size() > std::size_t(fiv_max_occluders)) {
    throw Error("FIV occluders", fmt::format("there are {}, and a set takes {}", occluders.size(), fiv_max_occluders),
                "leave out the farthest");
  }
  auto block = std::make_unique<OccluderBlock>();
  block->count[0] = int(occluders.size());
  for (std::size_t i = 0; i < occluders.size(); ++i) {
    const GpuFivOccluder& o = occluders[i];
    assert(o.table >= 0 && o.table < fiv.table_count && o.radius_m > 0);
    block->place[i] = {o.center_m.x, o.center_m.y, o.center_m.z, o.radius_m};
    block->table_of[i][0] = o.table;
  }
  IVORY_GL(glBindBuffer, GL_UNIFORM_BUFFER, fiv.occluders.id());
  IVORY_GL(glBufferSubData, GL_UNIFORM_BUFFER, 0, GLsizeiptr(sizeof(OccluderBlock)), block.get());
}

std::string fiv_defines(FivOverlap overlap, bool self) {
  return fmt::format("#define IVORY_FIV_OVERLAP {}\n{}", int(overlap), self ? "#define IVORY_FIV_SELF\n" : "");
}

int bind(const GpuFivTables& fiv, const GpuDifMap& unshadowed, gl::Program& program, int first_unit,
         Straddling straddling, int self) {
  const int unit = bind(unshadowed, program, first_unit);
  program.set("ivory_fiv_use_difmap", 1);
  return bind_tables(fiv, program, unit, straddling, self);
}

int bind(const GpuFivTables& fiv, const GpuSh9& unshadowed, gl::Program& program, int first_unit, Straddling straddling,
         int self) {
  bind(unshadowed, program, first_unit);
  program.set("ivory_fiv_use_difmap", 0);
  // The map's sampler keeps a unit of its own: two kinds of texture must not share one, even unread.
  program.set("ivory_difmap_e", first_unit);
  return bind_tables(fiv, program, first_unit + 1, straddling, self);
}

AmbientSource ambient(const GpuFivTables& fiv, const GpuDifMap& unshadowed, const FivLightParams& params, int self) {
  return make_source(fiv, unshadowed, params, self);
}

AmbientSource ambient(const GpuFivTables& fiv, const GpuSh9& unshadowed, const FivLightParams& params, int self) {
  return make_source(fiv, unshadowed, params, self);
}

}  // namespace ivory
