// SPDX-License-Identifier: BSD-3-Clause
#include "csv.hpp"

#include <charconv>
#include <cmath>
#include <string_view>

#include "bad_input.hpp"
#include "files.hpp"

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

double parse_number(std::string_view field, const std::string& where) {
  std::string_view digits = field;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size())
    bad_input(where, "'" + std::string(field) + "' is not a number", "a finite number");
  if (!std::isfinite(value)) bad_input(where, "'" + std::string(field) + "' is not finite", "a finite number");
  return value;
}

}  // namespace

CsvTable read_csv(const std::filesystem::path& file, const std::vector<std::string>& header) {
  const std::string text = read_file(file, "CSV file");
  std::string_view rest = text;
  if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
  CsvTable table;
  bool header_seen = false;
  for (int line_number = 1; !rest.empty(); ++line_number) {
    const auto end = rest.find('\n');
    const std::string_view line = trimmed(rest.substr(0, end));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (line.empty()) continue;
    const std::vector<std::string_view> fields = fields_of(line);
    const std::string at = at_line(file.string(), line_number);
    if (!header_seen) {
      if (!std::equal(fields.begin(), fields.end(), header.begin(), header.end()))
        bad_input(at, "header is '" + std::string(line) + "'", "the header " + joined(header));
      header_seen = true;
      continue;
    }
    CsvTable::Row row;
    row.where = at + ": data row " + std::to_string(table.rows.size() + 1) + " (counted from 1 after the header)";
    if (fields.size() != header.size())
      bad_input(row.where, "has " + std::to_string(fields.size()) + " columns",
                std::to_string(header.size()) + " columns: " + joined(header));
    for (std::size_t k = 0; k < fields.size(); ++k) row.values.push_back(parse_number(fields[k], row.where + ": " + header[k]));
    table.rows.push_back(std::move(row));
  }
  if (!header_seen) bad_input(file.string(), "is empty", "the header " + joined(header) + " and at least two data rows");
  if (table.rows.size() < 2)
    bad_input(file.string(), "has " + std::to_string(table.rows.size()) + " data row(s)",
              "at least two data rows after the header");
  return table;
}

}  // namespace swivel::io
