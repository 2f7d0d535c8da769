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

/// In quotes where it needs them.
[[nodiscard]] std::string csv_field(const std::string& text);
/// The same on one line, whatever is in it, so that the rows of a file that was cut off can be told apart.
[[nodiscard]] std::string csv_line_field(std::string text);
/// The shortest digits that read back as the same double; nothing where there is none.
[[nodiscard]] std::string csv_number(double value);
[[nodiscard]] std::string csv_number(const std::optional<double>& value);

/// The fields of a line without its end (RFC 4180), without outer spaces that are not quoted; none where a quote is left open.
/// Bytes behind a quoted field are part of it. Ends with the field after the first `most`: a field takes many times its bytes.
[[nodiscard]] std::vector<std::string> csv_fields(std::string_view line, std::size_t most);

/// A comma-separated table of numbers with a header.
class CsvTable {
 public:
  /// Which headers a table may have.
  struct Header {
    std::string allowed;  ///< completes "allowed is ..." for an empty file
    /// Throws InputError, prefixed by `where`, for a header that is not allowed.
    std::function<void(const std::vector<std::string>& columns, const std::string& where)> require;
  };
  /// Blank lines are skipped, spaces about fields and a byte-order mark ignored. Fewer than two rows and more than a million are
  /// bad input.
  CsvTable(std::string file, std::string_view text, const Header& header);
  CsvTable(const std::filesystem::path& file, const std::vector<std::string>& header)
      : CsvTable(file, std::vector<std::vector<std::string>>{header}) {}
  CsvTable(const std::filesystem::path& file, const std::vector<std::vector<std::string>>& headers);
  /// Which of the headers it has.
  [[nodiscard]] std::size_t header() const { return header_; }
  [[nodiscard]] const std::vector<std::string>& columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return lines_.size(); }
  /// One finite number a column.
  [[nodiscard]] std::span<const double> row(std::size_t k) const {
    return std::span(values_).subspan(k * columns_.size(), columns_.size());
  }
  /// "<file>:<line>: data row <n> (counted from 1 after the header)"
  [[nodiscard]] std::string where(std::size_t k) const;

 private:
  std::string file_;
  std::size_t header_ = 0;
  std::vector<std::string> columns_;
  std::vector<double> values_;
  std::vector<int> lines_;
};

}  // namespace swivel::io
