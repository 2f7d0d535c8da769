// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace swivel::io {

/// A comma-separated table of numbers with a fixed header.
struct CsvTable {
  struct Row {
    std::vector<double> values;  ///< one finite number a column
    std::string where;           ///< "<file>:<line>: data row <n> (counted from 1 after the header)"
  };
  std::vector<Row> rows;
};

/// Blank lines are skipped, spaces about fields and a byte-order mark ignored. Fewer than two rows are bad input.
[[nodiscard]] CsvTable read_csv(const std::filesystem::path& file, const std::vector<std::string>& header);

}  // namespace swivel::io
