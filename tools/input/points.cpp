#include "tools/input/points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/io/file.h"
#include "tools/cli/csv.h"

namespace ivory {

namespace {

constexpr std::array<std::string_view, 6> input_columns{"x", "y", "z", "nx", "ny", "nz"};
constexpr std::array<std::string_view, 6> output_columns{"r", "g", "b", "r_se", "g_se", "b_se"};

}  // namespace

std::vector<V3f> local_points(const PointsTable& table, const V3d& anchor_m) {
  std::vector<V3f> points;
  points.reserve(table.p.size());
  for (const V3d& p : table.p) points.push_back(to_local(p, anchor_m));
  return points;
}

PointsTable read_points_csv(const std::string& path) {
  const std::string remedy = "give columns x,y,z,nx,ny,nz, a number in each";
  const std::vector<CsvLine> lines = read_csv_lines(path, remedy);
  PointsTable table;
  if (!lines.empty()) table.header = lines.front().text;
  const auto names = csv_cells(table.header);
  std::array<std::size_t, 6> column{};
  for (std::size_t i = 0; i < column.size(); ++i) {
    const auto found = std::find(names.begin(), names.end(), input_columns[i]);
    if (found == names.end()) throw Error(path, fmt::format("line 1 names no column '{}'", input_columns[i]), remedy);
    column[i] = std::size_t(found - names.begin());
  }
  for (const std::string_view name : output_columns) {
    if (std::find(names.begin(), names.end(), name) != names.end())
      throw Error(path, fmt::format("already has a column '{}'", name), "remove or rename the column");
  }
  for (std::size_t row = 1; row < lines.size(); ++row) {
    const CsvLine& line = lines[row];
    if (line.text.empty()) throw Error(path, fmt::format("line {} is empty", line.number), remedy);
    const auto cells = csv_cells(line.text);
    if (cells.size() != names.size()) {
      throw Error(path, fmt::format("line {} has {} cells, line 1 has {}", line.number, cells.size(), names.size()),
                  remedy);
    }
    std::array<double, 6> values{};
    for (std::size_t i = 0; i < column.size(); ++i)
      values[i] = csv_number(path, line, cells[column[i]], input_columns[i], remedy);
    // In double, as the squares of small floats underflow.
    const V3d n(V3f(V3d(values[3], values[4], values[5])));
    const double length = n.length();
    if (!(length > 0)) throw Error(path, fmt::format("line {}: the normal is zero", line.number), remedy);
    table.rows.push_back(line.text);
    table.p.emplace_back(values[0], values[1], values[2]);
    table.n.emplace_back(n / length);
  }
  if (table.rows.empty()) throw Error(path, "holds no points", remedy);
  return table;
}

void write_points_csv(const std::string& path, bool force, const PointsTable& table, const std::vector<Rgb>& e,
                      const std::vector<Rgb>& standard_error) {
  std::string text = table.header;
  for (const std::string_view name : output_columns) text += fmt::format(",{}", name);
  text += '\n';
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const Rgb& s = standard_error[i];
    text += fmt::format("{},{:.9g},{:.9g},{:.9g}", table.rows[i], e[i].x, e[i].y, e[i].z);
    for (unsigned c = 0; c < 3; ++c) text += std::isnan(s[c]) ? std::string(",") : fmt::format(",{:.9g}", s[c]);
    text += '\n';
  }
  write_file(path, text, force);
}

}  // namespace ivory
