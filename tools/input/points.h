// Tables of points with normals, as comma-separated text.
#pragma once

#include <string>
#include <vector>

#include "grid/base/types.h"

namespace ivory {

struct PointsTable {
  std::string header;             // as read, without line end
  std::vector<std::string> rows;  // as read
  std::vector<V3d> p;             // world, metres
  std::vector<V3f> n;             // unit
};

// Its points less the anchor (grid/base/anchor.h).
std::vector<V3f> local_points(const PointsTable& table, const V3d& anchor_m);

// Reads a table whose first line names its columns, among them x,y,z,nx,ny,nz in any order; other
// columns are kept as text. Throws Error with the line number for rows of another length, cells that
// are no finite number and normals of no length; and for columns that write_points_csv() would add.
PointsTable read_points_csv(const std::string& path);

// The table with columns r,g,b (E in lux) and r_se,g_se,b_se (standard errors; empty where they are not numbers) added,
// nine significant digits.
void write_points_csv(const std::string& path, bool force, const PointsTable& table, const std::vector<Rgb>& e,
                      const std::vector<Rgb>& standard_error);

}  // namespace ivory
