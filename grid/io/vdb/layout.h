// The .vdb file without OpenVDB: its names, which numbers of a vertex go into which grid, its transform.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "grid/field/accumulator.h"
#include "grid/field/irradiance_grid.h"

namespace ivory {

inline constexpr std::int64_t vdb_format_version = 1;
inline constexpr const char* vdb_grid_kind = "irradiance grid";
inline constexpr const char* vdb_accumulator_kind = "photon sums";

// File metadata: facts of the file itself begin with file_prefix, the caller's Metadata (whose keys never begin with
// "file_") with meta_prefix.
inline const std::string file_prefix = "ivory_file_";
inline const std::string counter_prefix = "ivory_file_counter_";
inline const std::string meta_prefix = "ivory_";
inline const std::string anchor_key = "anchor_m";  // of grids that have one, behind file_prefix; origin_m is less it
inline const std::string light_key = "light";      // of StoredLight, behind meta_prefix

inline constexpr const char* visible_fraction_name = "visible_fraction";
inline constexpr const char* variance_name = "variance";

// Grids of several spacings (lattice.h) have the grids of each level, whose names end in "_level1" and so on for the
// finer ones; the coarsest, complete level bears the plain names. Those of a level share its transform. In a finer
// level visible_fraction_levelN is active in whole bricks, which says where they are.
inline constexpr const char* levels_key = "levels";  // behind file_prefix; absent in uniform grids
std::string level_suffix(int level);

// Grids and sums that keep groups of lights apart have, behind meta_prefix, the groups' names with a space between
// (light_groups_key), and for each group the moments and the variance, or the sums, again: "hall_I_px_r",
// "hall_variance_level1". `grid_name` itself for the group without a name: all lights.
std::string in_group(const std::string& group, const std::string& grid_name);

// A guard record as six floats of 24 bits each, lowest first, in two Vec3f grids guard_0 and guard_1: python-openvdb
// refuses whole files that hold a grid of integers.
std::string guard_name(int half);
std::array<float, 6> floats_from_guard(const GuardRecord& record);
// Nothing where the floats hold no record.
std::optional<GuardRecord> guard_from_floats(const std::array<float, 6>& floats);

// A vertex's floats as the file keeps them: the moments, or for Basis::vectors the six hemispherical vectors,
// [hemisphere][xyz][rgb]; lux.
int file_stride(Basis basis);
std::vector<float> file_values_from_moments(Basis basis, std::span<const float> moments);
std::vector<float> moments_from_file_values(Basis basis, const std::vector<float>& values);

// One Vec3f grid of the file.
struct VectorField {
  std::string name;
  bool is_vector = false;     // a vector in the grid's local frame, else three scalars (RGB, or moments)
  std::array<int, 3> offset;  // of its components among the vertex's file values
};
std::vector<VectorField> vector_fields(Basis basis);

// One int64 grid a number of a GridAccumulator: sum_<slot>_<function>_<r|g|b>, and sum_<slot>_square_<r|g|b> for the
// second moments; in the order of GridAccumulator::sums.
std::vector<std::string> sum_field_names(const SumLayout& layout);

// Where a grid stands: GridVertices' frame and anchor.
struct PlacedFrame {
  GridFrame frame;
  V3d anchor_m{0, 0, 0};
};

// Index to world as a 4x4 matrix for row vectors, row by row; exact but for the anchor's place, which is rounded to
// double.
std::array<double, 16> transform_matrix(const PlacedFrame& placed);

// `stored` where the matrix is still its own; otherwise, in a file that another program has moved, rotated or scaled
// evenly, the frame that the matrix describes, relative to an anchor of its own where it went far from the stored
// one's. Throws Error for any other matrix; `path` is for its message.
PlacedFrame frame_from_transform(const std::string& path, const std::array<double, 16>& matrix,
                                 const PlacedFrame& stored);

}  // namespace ivory
