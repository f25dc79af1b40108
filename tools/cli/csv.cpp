#include "tools/cli/csv.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "tools/cli/numbers.h"

namespace ivory {

namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n\v\f";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) + 1 - first);
}

}  // namespace

std::vector<CsvLine> read_csv_lines(const std::string& path, const std::string& remedy) {
  if (std::filesystem::is_directory(path)) throw Error(path, "is a folder", remedy);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path, "cannot be opened", "check that it exists and is readable");
  std::vector<CsvLine> lines;
  std::size_t filled = 0;
  std::string buffer(std::size_t(1) << 16U, '\0');
  while (file.getline(buffer.data(), std::streamsize(buffer.size())) || !file.eof()) {
    const std::size_t number = lines.size() + 1;
    // getline() fails on a line that does not fit: such a file is no table.
    if (file.fail()) throw Error(path, fmt::format("line {} is too long", number), remedy);
    std::string_view text(buffer.c_str());
    if (number == 1 && text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // of spreadsheet programs
    lines.push_back({number, std::string(trimmed(text))});
    if (!lines.back().text.empty()) filled = number;
  }
  lines.resize(filled);
  return lines;
}

std::vector<std::string_view> csv_cells(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    cells.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

double csv_number(const std::string& path, const CsvLine& line, std::string_view cell, std::string_view column,
                  const std::string& remedy) {
  const auto value = parse_number(cell.starts_with('+') ? cell.substr(1) : cell);
  if (!value || !std::isfinite(float(*value))) {
    throw Error(path, fmt::format("line {}: '{}' in column {} is not a finite number", line.number, cell, column),
                remedy);
  }
  return *value;
}

}  // namespace ivory
