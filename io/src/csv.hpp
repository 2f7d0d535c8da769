// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace swivel::io {

/// In quotes where it needs them.
[[nodiscard]] std::string csv_field(const std::string& text);

/// A comma-separated table of numbers with a fixed header, or with one of several.
class CsvTable {
 public:
  /// Blank lines are skipped, spaces about fields and a byte-order mark ignored. Fewer than two rows and more than a million are
  /// bad input.
  CsvTable(const std::filesystem::path& file, const std::vector<std::string>& header)
      : CsvTable(file, std::vector<std::vector<std::string>>{header}) {}
  CsvTable(const std::filesystem::path& file, const std::vector<std::vector<std::string>>& headers);
  /// Which of the headers it has.
  [[nodiscard]] std::size_t header() const { return header_; }
  [[nodiscard]] std::size_t rows() const { return lines_.size(); }
  /// One finite number a column.
  [[nodiscard]] std::span<const double> row(std::size_t k) const { return std::span(values_).subspan(k * columns_, columns_); }
  /// "<file>:<line>: data row <n> (counted from 1 after the header)"
  [[nodiscard]] std::string where(std::size_t k) const;

 private:
  std::string file_;
  std::size_t header_ = 0, columns_ = 0;
  std::vector<double> values_;
  std::vector<int> lines_;
};

}  // namespace swivel::io
