// The .vdb file: a finished IrradianceGrid, or the exact integer sums of a partial bake.
//
// Basis vectors: Vec3f grids I_px_r, I_px_g, I_px_b, I_mx_r ... I_mz_b (p plus, m minus), each an irradiance vector in
// the grid's local frame (vector type contravariant relative, local space). vectors9: F_r.., S_r.., C_r... The others:
// one Vec3f RGB grid a function (L00, L1m1, L10, ...; E_px, E_mx, ...), vector type invariant. Beside them
// visible_fraction (float), variance (Vec3f) and the guard (guard_0, guard_1: Vec3f, see layout.h). Sparse: a vertex
// that stores nothing is inactive.
//
// A grid of several spacings has all of these for each level, the finer ones' names ending in _level1, _level2 and so
// on, with a transform a level: see layout.h.
//
// Grids and sums that keep groups of lights apart have the moments and the variance, or the sums, of each group too:
// hall_I_px_r, hall_variance ... In a grid what bears the plain names is the light of all groups.
//
// Files by ivory bear a checksum of all their bytes, and damage is told by it. Files that another program has saved
// again bear none: OpenVDB's parser, which trusts its input and may crash over damage, meets their bytes first. Who
// cannot bear that calls resave_vdb() in a process of its own and reads what that returns.
#pragma once

#include <string>

#include "grid/field/accumulator.h"
#include "grid/field/irradiance_grid.h"

namespace ivory {

// Throws Error where the voxels are too small for the file's transform: OpenVDB takes no volume below 3e-15, edges of
// 15 micrometres. To be asked before a bake: write_vdb() throws so after it.
void check_voxels(const std::string& path, const GridFrame& frame);

// Whole or not at all: written under a temporary name in the same folder, then renamed. Throw Error where the file
// exists and not `force`, or cannot be written.
void write_vdb(const std::string& path, const IrradianceGrid& grid, bool force);
void write_vdb(const std::string& path, const GridAccumulator& accumulator, bool force);

// Throw Error for files that are missing, damaged, foreign, of another format version, too large for this machine's
// memory, or that hold the other kind; values that are not finite are an error too. `copy`, where given, is a file that
// is read in place of `path`, which then serves messages only. A grid's groups of lights are left out unless asked for.
IrradianceGrid read_grid_vdb(const std::string& path, const std::string& copy = {}, bool with_groups = false);
GridAccumulator read_accumulator_vdb(const std::string& path, const std::string& copy = {});

// What the file is and holds, without reading the voxels: metadata plus grid names and sizes. Throws as the others do.
Metadata read_vdb_info(const std::string& path, const std::string& copy = {});

// The bytes of the file that the same bake gives without groups of lights. Throws as read_grid_vdb() does.
std::string ungrouped_vdb(const std::string& path);

// The bytes of a file with the same grids and metadata that bears ivory's checksum. Throws what OpenVDB throws.
std::string resave_vdb(const std::string& path);

}  // namespace ivory
