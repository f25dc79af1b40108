#include "runtime/assets/irradiance_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/base/half.h"
#include "grid/field/compact_vectors.h"
#include "grid/field/guard.h"
#include "grid/field/lookup.h"
#include "grid/field/yield.h"
#include "grid/io/vdb/vdb.h"
#include "runtime/gl/check.h"

namespace ivory {

namespace {

struct Choices {
  int basis;
  int form;
  int guard;
  int interpolation;
  int reconstruction;
};

Choices choose(const GpuGrid& grid, const LookupParams& params) {
  if (params.guard == Guard::rays)
    throw ParameterError("guard", "the GPU has no rays to guard a grid with; planes or off");
  if (params.interpolation == Interpolation::fitted)
    throw ParameterError("interpolation", "the GPU reads trilinear and tricubic");
  if (!reads(params.reconstruction, grid.basis))
    throw ParameterError("reconstruction", "paper reads the basis vectors only");
  return {int(grid.basis), int(grid.form), params.guard == Guard::planes && grid.guarded ? 1 : 0,
          int(params.interpolation), int(params.reconstruction)};
}

// The record as shaders read it, in no more memory: its planes' order is free, and tells whether the vertex is lit.
// Words fall or stay equal from first to last where it is, else the last is larger than the first. Where all are equal,
// one is replaced by a word that says no less.
GuardRecord ordered(const GuardRecord& record, bool lit) {
  GuardRecord out = record;
  std::array<std::uint32_t, 4>& words = out.words;
  if (lit) {
    std::sort(words.begin(), words.end(), std::greater<>());
    return out;
  }
  std::sort(words.begin(), words.end());
  if (words.front() != words.back()) return out;
  if (words.back() < no_guard_plane) {
    words = {0, 0, 0, 1};
  } else {
    words.front() = 0;
  }
  return out;
}

}  // namespace

GpuGrid upload(const IrradianceGrid& grid, const GridUploadParams& params, const std::string& what) {
  if (params.form == GridForm::norms_and_directions && grid.basis != Basis::vectors) {
    throw ParameterError("form",
                         fmt::format("norms and directions hold the basis vectors only, not {}", name_of(grid.basis)));
  }
  gl::require_context();
  GpuGrid out;
  out.frame = grid.frame;
  out.anchor_m = grid.anchor_m;
  out.basis = grid.basis;
  out.form = params.form;
  out.guarded = !grid.guard.empty();
  const int count = function_count(grid.basis);
  GLint limit = 0;
  IVORY_GL(glGetIntegerv, GL_MAX_3D_TEXTURE_SIZE, &limit);
  out.levels = grid.levels();
  out.atlas = arrange_vertices(grid, count, limit);
  const V3i size = out.atlas.size;
  out.tiles = arrange_volumes(size, count, limit);
  if (out.tiles.x == 0 || size.z + out.atlas.table_slices > limit) {
    throw Error(
        what,
        fmt::format("{} x {} x {} vertices of {} functions do not fit into a 3D texture of {} texels a side, the "
                    "most that this OpenGL takes",
                    size.x, size.y, size.z, count, limit),
        "bake it coarser");
  }

  // The trust as the texture will hold it, so that dividing by it undoes what multiplying did.
  const std::size_t vertices = grid.vertex_count();
  std::vector<std::size_t> place(vertices);  // of a vertex' texel
  for (std::size_t v = 0; v < vertices; ++v) {
    const V3i at = out.atlas.texel_of(grid, std::uint32_t(v));
    place[v] = (std::size_t(at.z) * std::size_t(size.y) + std::size_t(at.y)) * std::size_t(size.x) + std::size_t(at.x);
  }
  const std::size_t texel_count = std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z);
  std::vector<float> trust(texel_count);
  for (std::size_t v = 0; v < vertices; ++v) trust[place[v]] = rounded_to_half(vertex_trust(grid.visible_fraction[v]));

  // No length of a vector in the compact form exceeds sqrt(3) times its largest component.
  float largest = 0;
  for (const float m : grid.moments) largest = std::max(largest, std::abs(m));
  out.scale = half_scale(params.form == GridForm::moments ? largest : 2 * largest);

  const V3i extent = size * out.tiles;
  const std::size_t row = std::size_t(extent.x);
  const std::size_t slice = row * std::size_t(extent.y);
  std::vector<float> texels(slice * std::size_t(extent.z) * 3);
  std::array<std::size_t, max_functions> first{};
  for (int f = 0; f < count; ++f) {
    const V3i at = volume_place(size, out.tiles, f);
    first[std::size_t(f)] = std::size_t(at.z) * slice + std::size_t(at.y) * row + std::size_t(at.x);
  }
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    const float vertex_trust = trust[place[vertex]];
    if (vertex_trust == 0) continue;
    const std::size_t in_row = place[vertex] % std::size_t(size.x);
    const std::size_t rows = place[vertex] / std::size_t(size.x);
    const std::size_t texel = rows / std::size_t(size.y) * slice + rows % std::size_t(size.y) * row + in_row;
    const float* values = grid.at(vertex);
    std::array<float, 36> compact;
    const float factor = vertex_trust / out.scale;
    if (params.form == GridForm::norms_and_directions) {
      compact = compact_from_moments(std::span<const float, 36>(values, 36));
      for (std::size_t d = 18; d < 36; ++d) compact[d] *= out.scale;  // directions stay unit vectors
      values = compact.data();
    }
    for (std::size_t f = 0; f < std::size_t(count); ++f) {
      for (std::size_t c = 0; c < 3; ++c) texels[3 * (first[f] + texel) + c] = values[3 * f + c] * factor;
    }
  }
  out.volumes = gl::make_texture_3d(what, gl::Format::rgb16f, extent, texels.data(), gl::Filter::linear);
  out.trust = gl::make_texture_3d(what, gl::Format::r16f, size, trust.data(), gl::Filter::linear);
  // A sampler needs a complete texture even where nothing reads it.
  out.atlas.table_slice = out.guarded ? size.z : 0;
  V3i words_size = out.guarded || out.levels > 1 ? size : V3i(1, 1, 1);
  if (out.levels > 1) words_size.z = out.atlas.table_slice + out.atlas.table_slices;
  std::vector<GuardRecord> words(std::size_t(words_size.x) * std::size_t(words_size.y) * std::size_t(words_size.z));
  for (std::size_t v = 0; v < grid.guard.size(); ++v) words[place[v]] = ordered(grid.guard[v], is_lit(grid, v));
  if (out.levels > 1) {
    const std::vector<std::uint32_t> tables = brick_tables(grid, out.atlas);
    auto* table = words.data() + std::size_t(out.atlas.table_slice) * std::size_t(size.x) * std::size_t(size.y);
    for (std::size_t i = 0; i < tables.size(); ++i) table[i / 4].words[i % 4] = tables[i];
  }
  out.guard = gl::make_texture_3d(what, gl::Format::rgba32ui, words_size, words.data(), gl::Filter::nearest);
  return out;
}

GpuGrid load_grid(const std::string& path, const GridUploadParams& params) {
  gl::require_context();
  return upload(read_grid_vdb(path), params, path);
}

int bind(const GpuGrid& grid, gl::Program& program, int first_unit, const LookupParams& params) {
  const Choices choices = choose(grid, params);
  program.set("ivory_grid.origin_m", grid.frame.origin_m);
  program.set("ivory_grid.spacing_m", grid.frame.spacing_m);
  program.set("ivory_grid.local_to_world", grid.frame.local_to_world);
  program.set("ivory_grid.size", grid.frame.size);
  for (int f = 0; f < function_count(grid.basis); ++f)
    program.set(fmt::format("ivory_grid.slab[{}]", f), V3f(volume_place(grid.atlas.size, grid.tiles, f)));
  program.set("ivory_grid.texel", V3f(1, 1, 1) / V3f(grid.volumes.size));
  program.set("ivory_grid.scale", grid.scale);
  program.set("ivory_grid.nudge_m", nudge_m(grid.frame, params));
  program.set("ivory_grid.basis", choices.basis);
  program.set("ivory_grid.form", choices.form);
  program.set("ivory_grid.guard", choices.guard);
  program.set("ivory_grid.interpolation", choices.interpolation);
  program.set("ivory_grid.reconstruction", choices.reconstruction);
  program.set("ivory_grid.levels", grid.levels);
  if (grid.levels > 1) {
    program.set("ivory_grid.atlas_bits", grid.atlas.bits);
    program.set("ivory_grid.table_slice", grid.atlas.table_slice);
    for (std::size_t level = 0; level < grid.atlas.tables.size(); ++level)
      program.set(fmt::format("ivory_grid.tables[{}]", level), grid.atlas.tables[level]);
    program.set("ivory_grid.bricks", (grid.frame.size + V3i(3, 3, 3)) / brick_side);
    program.set("ivory_grid.table", 0);
  }
  program.set("ivory_grid_volumes", first_unit);
  program.set("ivory_grid_trust", first_unit + 1);
  program.set("ivory_grid_guard", first_unit + 2);
  gl::bind(grid.volumes, first_unit);
  gl::bind(grid.trust, first_unit + 1);
  gl::bind(grid.guard, first_unit + 2);
  return first_unit + 3;
}

std::string grid_defines(const GpuGrid& grid, const LookupParams& params) {
  const Choices choices = choose(grid, params);
  return fmt::format(
      "#define IVORY_GRID_BASIS {}\n#define IVORY_GRID_FORM {}\n#define IVORY_GRID_GUARD {}\n"
      "#define IVORY_GRID_INTERPOLATION {}\n#define IVORY_GRID_RECONSTRUCTION {}\n#define IVORY_GRID_LEVELS {}\n",
      choices.basis, choices.form, choices.guard, choices.interpolation, choices.reconstruction, grid.levels);
}

AmbientSource ambient(const GpuGrid& grid, const LookupParams& params) {
  return {grid_defines(grid, params) + "#include \"ambient/grid.glsl\"\n",
          [&grid, params](gl::Program& program, int first_unit) { return bind(grid, program, first_unit, params); }};
}

}  // namespace ivory
