#include "runtime/assets/fiv.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/base/half.h"
#include "grid/base/memory.h"
#include "grid/base/placement.h"
#include "grid/io/fiv.h"
#include "runtime/assets/fiv_pack.h"
#include "runtime/gl/boxes.h"
#include "runtime/gl/check.h"

namespace ivory {

namespace {

// IvoryFivOccluders of the shaders, in layout std140.
struct OccluderBlock {
  std::array<std::int32_t, 4> count{};
  std::array<V4f, std::size_t(fiv_max_occluders)> place;
  std::array<std::array<std::int32_t, 4>, std::size_t(fiv_max_occluders)> table_of{};
};

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
  program.set("ivory_fiv_from_world", turn_about_y(-double(fiv.environment_turn_rad)));
  return unit;
}

template <typename Environment>
AmbientSource make_source(const GpuFivTables& fiv, const Environment& unshadowed, const FivLightParams& params,
                          int self) {
  return {fiv_defines(params.overlap, self >= 0, fiv.turns()) + "#include \"ambient/fiv.glsl\"\n",
          [&fiv, &unshadowed, straddling = params.straddling, self](gl::Program& program, int first_unit) {
            return bind(fiv, unshadowed, program, first_unit, straddling, self);
          }};
}

static_assert(int(FivOverlap::none) == 0 && int(FivOverlap::discs) == 1 && int(FivOverlap::covers) == 2 &&
              int(FivOverlap::product) == 3);

}  // namespace

std::size_t GpuFivTables::bytes() const {
  return atlas.bytes() + spheres.bytes() + std::size_t(fiv_max_tables) * sizeof(FivTableBlock) + sizeof(OccluderBlock);
}

bool GpuFivTables::turns() const {
  return std::any_of(sets.begin(), sets.end(), [](const Set& set) { return set.turns > 1; });
}

namespace {

// `most_hidden`: the most that a table hides, or the next turns of its set.
GpuFivTables upload_all(const std::vector<const FivTable*>& pointers, const std::vector<float>& most_hidden,
                        const FivUploadParams& params, const std::vector<std::string>& names) {
  gl::require_context();
  const auto name_of = [&](std::size_t i) { return names[i]; };
  struct {
    const std::vector<const FivTable*>& all;
    const FivTable& operator[](std::size_t i) const { return *all[i]; }
    std::size_t size() const { return all.size(); }
    bool empty() const { return all.empty(); }
  } const tables{pointers};
  if (tables.empty() || tables.size() > std::size_t(fiv_max_tables)) {
    throw Error("FIV tables", fmt::format("there are {}, and a set takes 1 to {}", tables.size(), fiv_max_tables),
                "upload them as several sets");
  }
  GLint limit = 0;
  IVORY_GL(glGetIntegerv, GL_MAX_3D_TEXTURE_SIZE, &limit);
  std::vector<V3i> boxes;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const V3i& size = tables[i].size;
    const V3i box = fiv_box_of(tables[i]);
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
  std::vector<FivTableBlock> blocks;
  std::vector<FivSphereBins> bins;
  std::size_t most = 1;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const float scale = params.half_floats ? half_scale(largest_fiv_level(tables[i])) : 1.0F;
    bins.push_back(make_fiv_bins(name_of(i), tables[i].radii));
    most = std::max(most, bins.back().knots.size());
    fill_fiv_box(tables[i], packed->corners[i], packed->size, 1 / scale, atlas);
    blocks.push_back(describe_fiv(tables[i], packed->corners[i], bins.back(), scale, int(i)));
    blocks.back().scale.y = most_hidden[i];
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
  out.tables = uniform_buffer(blocks.data(), blocks.size() * sizeof(FivTableBlock), GL_STATIC_DRAW);
  out.occluders = uniform_buffer(nullptr, sizeof(OccluderBlock), GL_DYNAMIC_DRAW);
  return out;
}

std::string numbered(std::span<const std::string> names, std::size_t i) {
  return names.empty() ? fmt::format("FIV table {}", i) : names[i];
}

}  // namespace

GpuFivTables upload(std::span<const FivTable> tables, const FivUploadParams& params,
                    std::span<const std::string> names) {
  assert(names.empty() || names.size() == tables.size());
  std::vector<const FivTable*> all;
  std::vector<std::string> texts;
  std::vector<float> most;
  std::vector<GpuFivTables::Set> sets;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    sets.push_back({int(i), 1});
    all.push_back(&tables[i]);
    most.push_back(most_hidden(tables[i]));
    texts.push_back(numbered(names, i));
  }
  GpuFivTables out = upload_all(all, most, params, texts);
  out.sets = std::move(sets);
  set_occluders(out, {});
  return out;
}

GpuFivTables upload(std::span<const FivSet> sets, const FivUploadParams& params, std::span<const std::string> names) {
  assert(names.empty() || names.size() == sets.size());
  std::vector<const FivTable*> all;
  std::vector<std::string> texts;
  std::vector<float> most;
  std::vector<GpuFivTables::Set> of_file;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    of_file.push_back({int(all.size()), int(sets[i].turns.size())});
    float of_set = 0;
    for (const FivTable& table : sets[i].turns) {
      all.push_back(&table);
      texts.push_back(numbered(names, i));
      of_set = std::max(of_set, most_hidden(table));
    }
    most.resize(all.size(), of_set);
  }
  GpuFivTables out = upload_all(all, most, params, texts);
  out.sets = std::move(of_file);
  set_occluders(out, {});
  return out;
}

bool can_turn(const GpuFivTables& fiv, const GpuFivOccluder& occluder, float environment_turn_rad) {
  const int turns = fiv.sets[std::size_t(occluder.table)].turns;
  return blend_of_turn(turns, double(occluder.turn_rad) - double(environment_turn_rad)).has_value();
}

GpuFivTables load_fiv_tables(std::span<const std::string> paths, const FivUploadParams& params) {
  std::vector<FivSet> sets;
  for (const std::string& path : paths) sets.push_back(read_fiv_set(path));
  return upload(sets, params, paths);
}

void set_occluders(GpuFivTables& fiv, std::span<const GpuFivOccluder> occluders, float environment_turn_rad) {
  if (occluders.size() > std::size_t(fiv_max_occluders)) {
    throw Error("FIV occluders", fmt::format("there are {}, and a set takes {}", occluders.size(), fiv_max_occluders),
                "leave out the farthest");
  }
  auto block = std::make_unique<OccluderBlock>();
  const M33f back = turn_about_y(-double(environment_turn_rad));
  block->count[0] = int(occluders.size());
  for (std::size_t i = 0; i < occluders.size(); ++i) {
    const GpuFivOccluder& o = occluders[i];
    assert(o.table >= 0 && o.table < int(fiv.sets.size()) && o.radius_m > 0);
    const GpuFivTables::Set& set = fiv.sets[std::size_t(o.table)];
    const std::optional<FivBlend> blend = blend_of_turn(set.turns, double(o.turn_rad) - double(environment_turn_rad));
    if (!blend) {
      throw Error("FIV occluders", fmt::format("number {} is turned, and its table holds one turn only", i),
                  "bake it with ivory bake fiv --turns N");
    }
    // To where the environment has its own axes; the shaders take receivers there.
    const V3f center = environment_turn_rad == 0 ? o.center_m : o.center_m * back;
    block->place[i] = {center.x, center.y, center.z, o.radius_m};
    block->table_of[i] = {set.first + blend->first, set.first + blend->second,
                          std::bit_cast<std::int32_t>(blend->share), 0};
  }
  fiv.environment_turn_rad = environment_turn_rad;
  IVORY_GL(glBindBuffer, GL_UNIFORM_BUFFER, fiv.occluders.id());
  IVORY_GL(glBufferSubData, GL_UNIFORM_BUFFER, 0, GLsizeiptr(sizeof(OccluderBlock)), block.get());
}

std::string fiv_defines(FivOverlap overlap, bool self, bool turns) {
  return fmt::format("#define IVORY_FIV_OVERLAP {}\n{}{}", int(overlap), self ? "#define IVORY_FIV_SELF\n" : "",
                     turns ? "#define IVORY_FIV_TURNS\n" : "");
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
