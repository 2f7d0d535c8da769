// SPDX-License-Identifier: BSD-3-Clause
#include "csv.hpp"

#include <cmath>
#include <string_view>

#include "bad_input.hpp"
#include "files.hpp"
#include "text_number.hpp"

namespace swivel::io {

namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const auto comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& file, const std::vector<std::string>& header)
    : file_(file.string()), columns_(header.size()) {
  constexpr std::size_t kMostRows = 1'000'000;
  const std::string text = read_file(file, "CSV file", kMostTableBytes);
  std::string_view rest = text;
  if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
  bool header_seen = false;
  for (int line_number = 1; !rest.empty(); ++line_number) {
    const auto end = rest.find('\n');
    const std::string_view line = trimmed(rest.substr(0, end));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (line.empty()) continue;
    const std::vector<std::string_view> fields = fields_of(line);
    if (!header_seen) {
      if (!std::equal(fields.begin(), fields.end(), header.begin(), header.end()))
        bad_input(at_line(file_, line_number), "header is '" + std::string(line) + "'", "the header " + joined(header));
      header_seen = true;
      continue;
    }
    if (rows() == kMostRows) bad_input(at_line(file_, line_number), "too many data rows", "at most " + std::to_string(kMostRows));
    lines_.push_back(line_number);
    if (fields.size() != columns_)
      bad_input(where(rows() - 1), "has " + std::to_string(fields.size()) + " columns",
                std::to_string(columns_) + " columns: " + joined(header));
    for (std::size_t k = 0; k < columns_; ++k) {
      const auto value = to_number<double>(fields[k]);
      if (!value || !std::isfinite(*value))
        bad_input(where(rows() - 1) + ": " + header[k], "'" + std::string(fields[k]) + "' is not a number", "a finite number");
      values_.push_back(*value);
    }
  }
  if (!header_seen) bad_input(file_, "is empty", "the header " + joined(header) + " and at least two data rows");
  if (rows() < 2) bad_input(file_, "has " + std::to_string(rows()) + " data row(s)", "at least two data rows after the header");
}

std::string CsvTable::where(std::size_t k) const {
  return at_line(file_, lines_[k]) + ": data row " + std::to_string(k + 1) + " (counted from 1 after the header)";
}

}  // namespace swivel::io
