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

std::int64_t longest_side(const V3i& vertices, const V3i& tiles) {
  return std::max(
      {std::int64_t(vertices.x) * tiles.x, std::int64_t(vertices.y) * tiles.y, std::int64_t(vertices.z) * tiles.z});
}

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
  if (words.back() < no_guard_plane)
    words = {0, 0, 0, 1};
  else
    words.front() = 0;
  return out;
}

}  // namespace

GpuGrid upload(const IrradianceGrid& grid, const GridUploadParams& params, const std::string& what) {
  if (params.form == GridForm::norms_and_directions && grid.basis != Basis::vectors)
    throw ParameterError("form",
                         fmt::format("norms and directions hold the basis vectors only, not {}", name_of(grid.basis)));
  if (grid.levels() > 1)
    throw Error(what, fmt::format("has {} levels of spacing", grid.levels()), "bake it without --levels for the GPU");
  gl::require_context();
  GpuGrid out;
  out.frame = grid.frame;
  out.anchor_m = grid.anchor_m;
  out.basis = grid.basis;
  out.form = params.form;
  out.guarded = !grid.guard.empty();
  const V3i size = grid.frame.size;
  const int count = function_count(grid.basis);
  GLint limit = 0;
  IVORY_GL(glGetIntegerv, GL_MAX_3D_TEXTURE_SIZE, &limit);
  out.tiles = arrange_volumes(size, count, limit);
  if (out.tiles.x == 0) {
    throw Error(
        what,
        fmt::format("{} x {} x {} vertices of {} functions do not fit into a 3D texture of {} texels a side, the "
                    "most that this OpenGL takes",
                    size.x, size.y, size.z, count, limit),
        "bake it coarser");
  }

  // The trust as the texture will hold it, so that dividing by it undoes what multiplying did.
  const std::size_t vertices = grid.frame.vertex_count();
  std::vector<float> trust(vertices);
  for (std::size_t v = 0; v < vertices; ++v) trust[v] = rounded_to_half(vertex_trust(grid.visible_fraction[v]));

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
  std::size_t vertex = 0;
  for (int k = 0; k < size.z; ++k) {
    for (int j = 0; j < size.y; ++j) {
      for (int i = 0; i < size.x; ++i, ++vertex) {
        const std::size_t texel = std::size_t(k) * slice + std::size_t(j) * row + std::size_t(i);
        if (trust[vertex] == 0) continue;
        const float* values = grid.at(vertex);
        std::array<float, 36> compact;
        float factor = trust[vertex] / out.scale;
        if (params.form == GridForm::norms_and_directions) {
          compact = compact_from_moments(std::span<const float, 36>(values, 36));
          for (std::size_t d = 18; d < 36; ++d) compact[d] *= out.scale;  // directions stay unit vectors
          values = compact.data();
        }
        for (std::size_t f = 0; f < std::size_t(count); ++f) {
          for (std::size_t c = 0; c < 3; ++c) texels[3 * (first[f] + texel) + c] = values[3 * f + c] * factor;
        }
      }
    }
  }
  out.volumes = gl::make_texture_3d(what, gl::Format::rgb16f, extent, texels.data(), gl::Filter::linear);
  out.trust = gl::make_texture_3d(what, gl::Format::r16f, size, trust.data(), gl::Filter::linear);
  // A sampler needs a complete texture even where nothing reads it.
  std::vector<GuardRecord> guard(out.guarded ? vertices : 1);
  for (std::size_t v = 0; v < grid.guard.size(); ++v) guard[v] = ordered(grid.guard[v], is_lit(grid, v));
  out.guard = gl::make_texture_3d(what, gl::Format::rgba32ui, out.guarded ? size : V3i(1, 1, 1), guard.data(),
                                  gl::Filter::nearest);
  return out;
}

// Along z where that fits, as then each volume is contiguous; else the arrangement with the shortest longest side.
V3i arrange_volumes(const V3i& vertices, int count, int limit) {
  V3i best(1, 1, count);
  if (longest_side(vertices, best) <= limit) return best;
  for (int x = 1; x <= count; ++x) {
    for (int y = 1; x * y <= count; ++y) {
      const V3i tiles(x, y, count / (x * y));
      if (count % (x * y) == 0 && longest_side(vertices, tiles) < longest_side(vertices, best)) best = tiles;
    }
  }
  return longest_side(vertices, best) <= limit ? best : V3i(0, 0, 0);
}

V3i volume_place(const V3i& vertices, const V3i& tiles, int f) {
  return V3i(f % tiles.x, f / tiles.x % tiles.y, f / (tiles.x * tiles.y)) * vertices;
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
    program.set(fmt::format("ivory_grid.slab[{}]", f), V3f(volume_place(grid.frame.size, grid.tiles, f)));
  program.set("ivory_grid.texel", V3f(1, 1, 1) / V3f(grid.volumes.size));
  program.set("ivory_grid.scale", grid.scale);
  program.set("ivory_grid.nudge_m", nudge_m(grid.frame, params));
  program.set("ivory_grid.basis", choices.basis);
  program.set("ivory_grid.form", choices.form);
  program.set("ivory_grid.guard", choices.guard);
  program.set("ivory_grid.interpolation", choices.interpolation);
  program.set("ivory_grid.reconstruction", choices.reconstruction);
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
      "#define IVORY_GRID_INTERPOLATION {}\n#define IVORY_GRID_RECONSTRUCTION {}\n",
      choices.basis, choices.form, choices.guard, choices.interpolation, choices.reconstruction);
}

AmbientSource ambient(const GpuGrid& grid, const LookupParams& params) {
  return {grid_defines(grid, params) + "#include \"ambient/grid.glsl\"\n",
          [&grid, params](gl::Program& program, int first_unit) { return bind(grid, program, first_unit, params); }};
}

}  // namespace ivory
