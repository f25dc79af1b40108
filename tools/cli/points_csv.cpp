#include "tools/cli/points_csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/io/file.h"

namespace ivory {

namespace {

constexpr std::array<std::string_view, 6> input_columns{"x", "y", "z", "nx", "ny", "nz"};
constexpr std::array<std::string_view, 6> output_columns{"r", "g", "b", "r_se", "g_se", "b_se"};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    cells.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

std::optional<float> number_of(std::string_view cell) {
  if (cell.starts_with('+')) cell.remove_prefix(1);
  float value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

PointsTable read_points_csv(const std::string& path) {
  if (std::filesystem::is_directory(path)) throw Error(path, "is a folder", "give a .csv file");
  std::ifstream file(path);
  if (!file) throw Error(path, "cannot be opened", "check that it exists and is readable");
  const std::string remedy = "give columns x,y,z,nx,ny,nz, a number in each";

  PointsTable table;
  std::string line;
  std::getline(file, line);
  if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // byte order mark of spreadsheet programs
  table.header = std::string(trimmed(line));
  const auto names = cells_of(table.header);
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

  std::size_t number = 1;
  std::size_t blank_line = 0;
  while (std::getline(file, line)) {
    ++number;
    const std::string_view row = trimmed(line);
    if (row.empty()) {
      if (blank_line == 0) blank_line = number;
      continue;
    }
    if (blank_line != 0) throw Error(path, fmt::format("line {} is empty", blank_line), remedy);  // but at the end
    const auto cells = cells_of(row);
    if (cells.size() != names.size())
      throw Error(path, fmt::format("line {} has {} cells, line 1 has {}", number, cells.size(), names.size()), remedy);
    std::array<float, 6> values{};
    for (std::size_t i = 0; i < column.size(); ++i) {
      const auto value = number_of(cells[column[i]]);
      if (!value) {
        throw Error(path,
                    fmt::format("line {}: '{}' in column {} is not a finite number", number, cells[column[i]],
                                input_columns[i]),
                    remedy);
      }
      values[i] = *value;
    }
    // In double, as the squares of small floats underflow.
    const V3d n(values[3], values[4], values[5]);
    const double length = n.length();
    if (!(length > 0)) throw Error(path, fmt::format("line {}: the normal is zero", number), remedy);
    table.rows.emplace_back(row);
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
    text += fmt::format("{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", table.rows[i], e[i].x, e[i].y, e[i].z, s.x,
                        s.y, s.z);
  }
  PendingFile pending(path, force);
  std::ofstream file(pending.temporary(), std::ios::binary);
  file << text;
  file.close();
  if (!file) throw Error(path, "cannot be written", "check the free space of its disk");
  pending.commit();
}

}  // namespace ivory
