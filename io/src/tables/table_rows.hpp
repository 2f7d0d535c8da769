// SPDX-License-Identifier: BSD-3-Clause
// Rows of campaigns and placements as lines of CSV.
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

/// The header, with its end; a column for each of the coordinates whose offsets the rows have.
[[nodiscard]] std::string episode_header(const std::vector<std::string>& coordinates);
/// The coordinates of a header without its end; none where it is not one.
[[nodiscard]] std::optional<std::vector<std::string>> coordinates_of(std::string_view line);
[[nodiscard]] std::string csv_line(const EpisodeRow& row);
/// Of a line without its end; none where it is not a row with so many offsets.
[[nodiscard]] std::optional<EpisodeRow> episode_row(std::string_view line, std::size_t coordinates);

inline constexpr const char* kPlacementHeader =
    "cell,x,y,z,roll,pitch,yaw,status,cost,clearance,clearance_margin,joint_margin,tool_speed,failed_s,cause,by,reason\n";
[[nodiscard]] std::string csv_line(const PlacementRow& row);
[[nodiscard]] std::optional<PlacementRow> placement_row(std::string_view line);

/// One field of a row: a finite number, one that may be missing, or a status that a row can have. False where it is none.
template <class Number>
bool read_field(const std::string& field, Number& number) {
  const auto read = to_number<Number>(field);
  if (read) number = *read;
  return read && std::isfinite(static_cast<double>(number));
}
inline bool read_field(const std::string& field, std::optional<double>& number) {
  return field.empty() || read_field(field, number.emplace());
}
inline bool read_field(const std::string& field, PlanStatus& status) {
  for (const PlanStatus known : {PlanStatus::kSolved, PlanStatus::kInfeasible, PlanStatus::kError})
    if (field == to_string(known)) return status = known, true;
  return false;
}

/// The rows of a text from a byte on that is the beginning of a line; `line` is its number, `row_of` one of the functions above.
/// `visit` gets each, what names its place, and the byte after it. The text ends with the end of a line.
template <class RowOf, class Visit>
void read_lines(std::string_view text, std::size_t begin, const std::string& file, int line, const std::string& allowed,
                const RowOf& row_of, const Visit& visit) {
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
