// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace swivel::io {

/// Returns a field, in quotes if it needs them.
[[nodiscard]] std::string csv_field(const std::string& text);
/// Returns a field, in quotes if it needs them, with control characters replaced by spaces: it
/// stays on one line, so that a row that was cut off can be recognised.
[[nodiscard]] std::string csv_line_field(std::string text);
/// Returns the shortest digits that read back as the same double.
[[nodiscard]] std::string csv_number(double value);
/// Returns the shortest digits that read back as the same double; empty if there is no value.
[[nodiscard]] std::string csv_number(const std::optional<double>& value);

/// Returns the fields of a line given without its end (RFC 4180, with another separator than the
/// comma if one is given), without outer spaces that are not quoted; none if a quote is left open.
/// Bytes behind a quoted field belong to it. Stops after `most` + 1 fields, because a field takes
/// many times its bytes.
[[nodiscard]] std::vector<std::string> csv_fields(std::string_view line, std::size_t most,
                                                  char separator = ',');

/// The headers that a table may have.
struct CsvHeader {
  std::string allowed;  ///< completes "allowed is ..." for an empty file
  /// Throws InputError, prefixed by `where`, for a header that is not allowed.
  std::function<void(const std::vector<std::string>& columns, const std::string& where)> require;
};

/// The place of a data row in a file.
struct CsvPlace {
  const std::string& file;
  std::size_t row = 0;  ///< from 0
  int line = 0;         ///< from 1
  /// Returns it for messages: "<file>:<line>: data row <n> (counted from 1 after the header)".
  [[nodiscard]] std::string where() const;
};

/// Calls `take` with the fields of every data row of a comma-separated table: as many as its header
/// has columns. Blank lines are skipped, spaces around fields and a byte-order mark ignored. Throws
/// InputError, also for fewer than two rows or more than a million.
void read_csv_rows(
    const std::string& file, std::string_view text, const CsvHeader& header,
    const std::function<void(const CsvPlace&, const std::vector<std::string>&)>& take);

/// A comma-separated table of numbers with a header.
class CsvTable {
 public:
  using Header = CsvHeader;
  /// Parses a table, as read_csv_rows() does. Throws InputError.
  CsvTable(std::string file, std::string_view text, const Header& header);
  CsvTable(const std::filesystem::path& file, const std::vector<std::string>& header)
      : CsvTable(file, std::vector<std::vector<std::string>>{header}) {}
  CsvTable(const std::filesystem::path& file, const std::vector<std::vector<std::string>>& headers);
  /// Returns the index of the table's header among those allowed.
  [[nodiscard]] std::size_t header() const { return header_; }
  [[nodiscard]] const std::vector<std::string>& columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return lines_.size(); }
  /// Returns a row: one finite number for each column.
  [[nodiscard]] std::span<const double> row(std::size_t k) const {
    return std::span(values_).subspan(k * columns_.size(), columns_.size());
  }
  /// Returns the place of a row for messages: "<file>:<line>: data row <n> (counted from 1 after
  /// the header)".
  [[nodiscard]] std::string where(std::size_t k) const;

 private:
  std::string file_;
  std::size_t header_ = 0;
  std::vector<std::string> columns_;
  std::vector<double> values_;
  std::vector<int> lines_;
};

}  // namespace swivel::io
