// Comma-separated text, line by line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ivory {

struct CsvLine {
  std::size_t number = 0;  // from 1
  std::string text;        // without blanks around it
};

// The lines of a file, without a byte order mark and without empty lines at its end. `remedy` ends the messages of the
// Error thrown for a folder, a file that cannot be read, and a line of more than 64 KiB.
std::vector<CsvLine> read_csv_lines(const std::string& path, const std::string& remedy);

// Without blanks around them; they point into `line`.
std::vector<std::string_view> csv_cells(std::string_view line);

// Throws Error, which names line and column, for a cell that is no finite number.
double csv_number(const std::string& path, const CsvLine& line, std::string_view cell, std::string_view column,
                  const std::string& remedy);

}  // namespace ivory
