// SPDX-License-Identifier: BSD-3-Clause
#include "problems/path_table.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "files/bad_input.hpp"
#include "files/text_number.hpp"
#include "swivel/core/messages/bounds.hpp"

namespace swivel::io {

namespace {

constexpr std::size_t kMostPathRows = 1'000'000, kMostPathLine = std::size_t{1} << 20;
constexpr const char* kHeaderFirst =
    "a first line with the names of the columns, as x,y,z,qw,qx,qy,qz or x,y,z,nx,ny,nz";

std::string_view without_spaces(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Returns what a comment says, without the mark that begins it; none of a line that is none.
std::optional<std::string_view> comment_of(std::string_view line) {
  for (const std::string_view mark : {"#", "%", "//"})
    if (line.starts_with(mark)) return without_spaces(line.substr(mark.size()));
  return std::nullopt;
}

/// Returns the character that separates the columns of a header.
char separator_of(std::string_view header) {
  for (const char separator : {'\t', ';', ','})
    if (header.find(separator) != std::string_view::npos) return separator;
  return ' ';
}

const char* words_for(char separator) {
  switch (separator) {
    case '\t':
      return "tabs";
    case ';':
      return "semicolons";
    case ',':
      return "commas";
    default:
      return "spaces";
  }
}

/// Returns a number with a decimal point, or a decimal comma; none of another text.
std::optional<double> number_of(const std::string& field) {
  const auto comma = field.find(',');
  if (comma == std::string::npos) return to_number<double>(field);
  if (field.find_first_of(".,", comma + 1) != std::string::npos ||
      field.find('.') != std::string::npos)
    return std::nullopt;
  std::string text = field;
  text[comma] = '.';
  return to_number<double>(text);
}

/// Splits a column's name from its unit.
TableColumn column_of(std::string_view field) {
  std::string lower(field);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  const std::string_view text = lower;
  for (const char* const brackets : {"[]", "()"}) {
    const auto open = text.find(brackets[0]);
    if (open == std::string_view::npos || text.back() != brackets[1]) continue;
    return {std::string(without_spaces(text.substr(0, open))),
            std::string(without_spaces(text.substr(open + 1, text.size() - open - 2)))};
  }
  return {lower, ""};
}

class PathTableReader {
 public:
  PathTableReader(const std::string& file, std::string_view text, const ChooseColumns& choose)
      : file_(file), rest_(text), choose_(choose) {}

  template <class Take>
  void read(const Take& take) {
    if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
    if (rest_.starts_with("\xff\xfe") || rest_.starts_with("\xfe\xff"))
      bad_input(file_, "is UTF-16 text", "UTF-8 (CSV UTF-8, where a program asks)");
    while (next_line()) {
      if (const auto comment = comment_of(line_)) {
        if (columns_.empty()) comment_ = *comment, comment_line_ = number_;
        continue;
      }
      if (columns_.empty() && !read_header()) continue;
      if (is_header_) {
        is_header_ = false;
        continue;
      }
      read_row(take);
    }
    if (columns_.empty())
      bad_input(file_, "is empty", std::string(kHeaderFirst) + ", and at least two data rows");
    if (rows_ < 2)
      bad_input(file_, "has " + std::to_string(rows_) + " data row(s)",
                "at least two data rows after the header");
  }

 private:
  /// Takes the next line that is not empty. A line ends with CR, LF or both.
  bool next_line() {
    while (!rest_.empty()) {
      ++number_;
      const auto end = std::min(rest_.find_first_of("\r\n"), rest_.size());
      const std::string_view whole = rest_.substr(0, end);
      line_ = without_spaces(whole);
      std::size_t ends = end;
      if (ends < rest_.size()) ends += rest_.substr(ends, 2) == "\r\n" ? 2 : 1;
      rest_.remove_prefix(ends);
      if (line_.empty()) continue;
      // A tab at the beginning or the end of a line separates columns.
      if (separator_ == '\t') line_ = whole;
      // A field takes many times its bytes.
      if (line_.size() > kMostPathLine)
        bad_input(at_line(file_, number_), "has " + std::to_string(line_.size()) + " bytes",
                  "a line of at most 1 MiB");
      return true;
    }
    return false;
  }

  /// Splits a line into fields by the table's separator.
  [[nodiscard]] std::vector<std::string> fields_of(std::string_view line) const {
    if (separator_ != ' ') return csv_fields(line, line.size(), separator_);
    std::vector<std::string> fields;
    for (;;) {
      line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
      if (line.empty()) return fields;
      const auto end = std::min(line.find_first_of(" \t\r"), line.size());
      std::string_view word = line.substr(0, end);
      if (word.size() >= 2 && word.front() == '"' && word.back() == '"')
        word = word.substr(1, word.size() - 2);
      fields.emplace_back(word);
      line.remove_prefix(end);
    }
  }

  /// Reads the header, which is this line, or the last comment where this line is a row already.
  /// Returns false for a line that says what separates columns. Throws InputError.
  bool read_header() {
    if (line_.size() == 5 && line_.starts_with("sep=") && !separator_) {
      separator_ = line_.back();
      if (std::string_view("\t;, ").find(separator_) == std::string_view::npos)
        bad_input(at_line(file_, number_), "is '" + printable(line_) + "'",
                  "columns separated by commas, semicolons, tabs or spaces");
      return false;
    }
    std::string_view header = line_;
    int at = number_;
    is_header_ = true;
    if (begins_with_number(line_)) {
      if (!comment_.starts_with('x') && !comment_.starts_with('X'))
        bad_input(at_line(file_, number_),
                  "is no header: it begins with a number, and nothing before it names the columns",
                  kHeaderFirst);
      header = comment_, at = comment_line_, is_header_ = false;
    }
    if (!separator_) separator_ = separator_of(header);
    std::vector<std::string> fields = fields_of(header);
    ends_empty_ = fields.size() > 1 && fields.back().empty();
    if (ends_empty_) fields.pop_back();
    for (const std::string& field : fields) columns_.push_back(column_of(field));
    const std::string where = at_line(file_, at);
    if (columns_.empty()) bad_input(where, "has an open quote", kHeaderFirst);
    chosen_ = choose_(columns_, where);
    numbers_.resize(chosen_.size());
    return true;
  }

  static bool begins_with_number(std::string_view line) {
    if (line.starts_with('"')) line.remove_prefix(1);
    const auto end = std::min(line.find_first_of("\t;, \""), line.size());
    return to_number<double>(line.substr(0, end)).has_value();
  }

  template <class Take>
  void read_row(const Take& take) {
    if (rows_ == kMostPathRows)
      bad_input(at_line(file_, number_), "too many data rows",
                "at most " + std::to_string(kMostPathRows));
    const CsvPlace place{file_, rows_++, number_};
    std::vector<std::string> fields = fields_of(line_);
    if (ends_empty_ && fields.size() == columns_.size() + 1 && fields.back().empty())
      fields.pop_back();
    if (fields.size() != columns_.size()) refuse_count(place, fields.size());
    for (std::size_t k = 0; k < chosen_.size(); ++k)
      numbers_[k] = read_number(fields[chosen_[k]], columns_[chosen_[k]].name, place);
    take(place, numbers_);
  }

  [[noreturn]] void refuse_count(const CsvPlace& place, std::size_t count) const {
    std::string names;
    for (const TableColumn& column : columns_) {
      names += (names.empty() ? "" : ",") + csv_field(printable(column.name));
      if (names.size() > 200) {
        names += "...";
        break;
      }
    }
    const bool decimal_commas = separator_ == ',' && count == 2 * columns_.size();
    bad_input(place.where(),
              "has " + std::to_string(count) + " columns" +
                  (decimal_commas ? ": are these decimal commas? They need semicolons or tabs "
                                    "between columns"
                                  : ""),
              std::to_string(columns_.size()) + " columns: " + names + ", separated by " +
                  words_for(separator_));
  }

  double read_number(const std::string& field, const std::string& column, const CsvPlace& place) {
    const auto value = number_of(field);
    if (!value || !std::isfinite(*value))
      bad_input(place.where() + ": " + printable(column),
                "'" + printable(field.substr(0, 60)) + "' is not a number", "a finite number");
    if (const auto mark = field.find_first_of(".,"); mark != std::string::npos) {
      if (!decimal_mark_) decimal_mark_ = field[mark];
      if (decimal_mark_ != field[mark])
        bad_input(place.where() + ": " + printable(column),
                  "'" + printable(field.substr(0, 60)) +
                      "' is written otherwise than the numbers before it",
                  "decimal points or decimal commas, not both in one file");
    }
    return *value;
  }

  const std::string& file_;
  std::string_view rest_, line_, comment_;
  const ChooseColumns& choose_;
  int number_ = 0, comment_line_ = 0;
  bool is_header_ = false;
  bool ends_empty_ = false;  // each line ends with a separator
  char separator_ = 0;       // 0: not known yet
  char decimal_mark_ = 0;
  std::vector<TableColumn> columns_;
  std::vector<std::size_t> chosen_;
  std::vector<double> numbers_;
  std::size_t rows_ = 0;
};

}  // namespace

void read_path_table(const std::string& file, std::string_view text, const ChooseColumns& choose,
                     const std::function<void(const CsvPlace&, std::span<const double>)>& take) {
  PathTableReader(file, text, choose).read(take);
}

}  // namespace swivel::io
