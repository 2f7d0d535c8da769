// SPDX-License-Identifier: BSD-3-Clause
#include "files/csv.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "files/bad_input.hpp"
#include "files/files.hpp"
#include "files/text_number.hpp"

namespace swivel::io {

std::string csv_field(const std::string& text) {
  const bool plain = text.find_first_of(",\"") == std::string::npos && !text.starts_with(' ') &&
                     !text.ends_with(' ');
  if (plain) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? "\"\"" : std::string(1, c);
  return field + '"';
}

std::string csv_line_field(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return csv_field(text);
}

std::string csv_number(double value) {
  std::array<char, 32> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

std::string csv_number(const std::optional<double>& value) {
  return value ? csv_number(*value) : "";
}

namespace {

std::string_view trimmed(std::string_view text, const char* spaces = " \t\r") {
  const auto first = text.find_first_not_of(spaces);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(spaces) - first + 1);
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + csv_field(name);
  return text;
}

}  // namespace

std::vector<std::string> csv_fields(std::string_view line, std::size_t most, char separator) {
  const char* const spaces = separator == '\t' ? " \r" : " \t\r";
  std::vector<std::string> fields;
  while (true) {
    std::string field;
    line.remove_prefix(std::min(line.find_first_not_of(spaces), line.size()));
    if (line.starts_with('"')) {
      line.remove_prefix(1);
      for (; !line.empty() && (line[0] != '"' || line.substr(0, 2) == "\"\"");
           line.remove_prefix(line[0] == '"' ? 2 : 1))
        field += line[0];
      if (line.empty()) return {};  // left open
      line.remove_prefix(1);
    }
    const auto end = line.find(separator);
    field += trimmed(line.substr(0, end), spaces);
    fields.push_back(std::move(field));
    if (end == std::string_view::npos || fields.size() > most) return fields;
    line.remove_prefix(end + 1);
  }
}

namespace {

/// Returns the requirement that the header is one of these.
CsvTable::Header one_of(const std::vector<std::vector<std::string>>& headers) {
  std::string allowed;
  for (const std::vector<std::string>& header : headers)
    allowed += (allowed.empty() ? "" : " or ") + joined(header);
  return {"the header " + allowed,
          [headers, allowed](const std::vector<std::string>& fields, const std::string& where) {
            if (std::find(headers.begin(), headers.end(), fields) == headers.end())
              bad_input(where, "header is '" + joined(fields) + "'", "the header " + allowed);
          }};
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& file,
                   const std::vector<std::vector<std::string>>& headers)
    : CsvTable(file.string(), read_file(file, "CSV file", kMostTableBytes), one_of(headers)) {
  header_ = static_cast<std::size_t>(std::find(headers.begin(), headers.end(), columns_) -
                                     headers.begin());
}

void read_csv_rows(
    const std::string& file, std::string_view rest, const CsvHeader& header,
    const std::function<void(const CsvPlace&, const std::vector<std::string>&)>& take) {
  constexpr std::size_t kMostRows = 1'000'000, kMostLineBytes = std::size_t{1} << 20;
  if (rest.starts_with("\xef\xbb\xbf")) rest.remove_prefix(3);
  std::vector<std::string> columns;
  bool header_seen = false;
  std::size_t rows = 0;
  for (int line_number = 1; !rest.empty(); ++line_number) {
    const auto end = rest.find('\n');
    const std::string_view line = trimmed(rest.substr(0, end));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (line.empty()) continue;
    // A field takes many times its bytes.
    if (line.size() > kMostLineBytes)
      bad_input(at_line(file, line_number), "has " + std::to_string(line.size()) + " bytes",
                "a line of at most 1 MiB");
    std::vector<std::string> fields = csv_fields(line, line.size());
    if (!header_seen) {
      header.require(fields, at_line(file, line_number));
      columns = std::move(fields);
      header_seen = true;
      continue;
    }
    if (rows == kMostRows)
      bad_input(at_line(file, line_number), "too many data rows",
                "at most " + std::to_string(kMostRows));
    const CsvPlace place{file, rows++, line_number};
    if (fields.size() != columns.size())
      bad_input(place.where(), "has " + std::to_string(fields.size()) + " columns",
                std::to_string(columns.size()) + " columns: " + joined(columns));
    take(place, fields);
  }
  if (!header_seen) bad_input(file, "is empty", header.allowed + " and at least two data rows");
  if (rows < 2)
    bad_input(file, "has " + std::to_string(rows) + " data row(s)",
              "at least two data rows after the header");
}

std::string CsvPlace::where() const {
  return at_line(file, line) + ": data row " + std::to_string(row + 1) +
         " (counted from 1 after the header)";
}

CsvTable::CsvTable(std::string file, std::string_view text, const Header& header)
    : file_(std::move(file)) {
  const Header keep{header.allowed,
                    [&](const std::vector<std::string>& columns, const std::string& where) {
                      header.require(columns, where);
                      columns_ = columns;
                    }};
  read_csv_rows(file_, text, keep,
                [&](const CsvPlace& place, const std::vector<std::string>& fields) {
                  lines_.push_back(place.line);
                  for (std::size_t k = 0; k < columns_.size(); ++k) {
                    const auto value = to_number<double>(fields[k]);
                    if (!value || !std::isfinite(*value))
                      bad_input(place.where() + ": " + columns_[k],
                                "'" + fields[k] + "' is not a number", "a finite number");
                    values_.push_back(*value);
                  }
                });
}

std::string CsvTable::where(std::size_t k) const {
  return CsvPlace{file_, k, lines_[k]}.where();
}

}  // namespace swivel::io
