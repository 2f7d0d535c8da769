// SPDX-License-Identifier: BSD-3-Clause
// Converts rows of campaigns and placements to lines of CSV and back.
#pragma once
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/bad_input.hpp"
#include "files/text_number.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/core/study/placement.hpp"

namespace swivel::io {

/// Returns the header of episode rows, with its line end; it has a column for each of the
/// coordinates whose offsets the rows have.
[[nodiscard]] std::string episode_header(const std::vector<std::string>& coordinates);
/// Returns the coordinates of a header, given without its line end; none if the line is no such
/// header.
[[nodiscard]] std::optional<std::vector<std::string>> coordinates_of(std::string_view line);
/// Returns the line of an episode, with its end.
[[nodiscard]] std::string csv_line(const EpisodeRow& row);
/// Returns the episode of a line, given without its end; none if it is not a row with this number
/// of offsets.
[[nodiscard]] std::optional<EpisodeRow> episode_row(std::string_view line, std::size_t coordinates);

/// Returns the header of placement rows, with its line end; it has a column for each of the joints
/// whose positions the rows have.
[[nodiscard]] std::string placement_header(const std::vector<std::string>& joints);
/// Returns the joints of a header, given without its line end; none if the line is no such header.
[[nodiscard]] std::optional<std::vector<std::string>> joints_of(std::string_view line);
/// Returns the line of a placement, with its end.
[[nodiscard]] std::string csv_line(const PlacementRow& row);
/// Returns the placement of a line, given without its end; none if it is not a row with positions
/// of these joints.
[[nodiscard]] std::optional<PlacementRow> placement_row(std::string_view line,
                                                        const std::vector<std::string>& joints);

/// Returns a field that says whether something is so; empty where that is not known.
[[nodiscard]] inline std::string csv_bool(const std::optional<bool>& is) {
  return !is ? "" : *is ? "true" : "false";
}

/// Reads a field of a row: a finite number, a number that may be missing, true or false or neither,
/// or the status of a row. Returns false if the field is not that.
template <class Number>
bool read_field(const std::string& field, Number& number) {
  const auto read = to_number<Number>(field);
  if (read) number = *read;
  return read && std::isfinite(static_cast<double>(number));
}
inline bool read_field(const std::string& field, std::optional<double>& number) {
  return field.empty() || read_field(field, number.emplace());
}
inline bool read_field(const std::string& field, std::optional<bool>& is) {
  if (!field.empty()) is = field == "true";
  return field.empty() || *is || field == "false";
}
inline bool read_field(const std::string& field, PlanStatus& status) {
  for (const PlanStatus known : {PlanStatus::kSolved, PlanStatus::kInfeasible, PlanStatus::kError})
    if (field == to_string(known)) return status = known, true;
  return false;
}

/// Reads the rows of a text from byte `begin`, which begins a line, whose number is `line`.
/// row_of(line) parses a line; visit(row, where, end) gets each row, its place for messages, and
/// the byte after it. The text must end with a line end. Throws InputError for a line that is no
/// row.
template <class RowOf, class Visit>
void read_lines(std::string_view text, std::size_t begin, const std::string& file, int line,
                const std::string& allowed, const RowOf& row_of, const Visit& visit) {
  for (; begin < text.size(); ++line) {
    const std::size_t end = text.find('\n', begin) + 1;
    const std::string where = at_line(file, line);
    const auto row = row_of(text.substr(begin, end - 1 - begin));
    if (!row) bad_input(where, "not a row of results", allowed);
    visit(*row, where, end);
    begin = end;
  }
}

}  // namespace swivel::io
