// SPDX-License-Identifier: BSD-3-Clause
#include "files/csv.hpp"
#include "swivel/io/tables/placement.hpp"
#include "tables/table_rows.hpp"

namespace swivel::io {

std::string csv_line(const PlacementRow& row) {
  std::string text = std::to_string(row.cell);
  for (const double value : row.offset) text += ',' + csv_number(value);
  text += std::string(",") + to_string(row.status);
  for (const auto& value : {row.cost, row.clearance, row.clearance_margin, row.joint_margin,
                            row.tool_speed, row.failed_s})
    text += ',' + csv_number(value);
  return text + ',' + row.cause + ',' + csv_line_field(row.by) + ',' + csv_line_field(row.reason) +
         '\n';
}

std::optional<PlacementRow> placement_row(std::string_view line) {
  constexpr std::size_t kColumns = 17;
  const std::vector<std::string> fields = csv_fields(line, kColumns);
  if (fields.size() != kColumns) return std::nullopt;
  PlacementRow row;
  auto field = fields.begin();
  bool read = read_field(*field++, row.cell);
  for (double& value : row.offset) read = read_field(*field++, value) && read;
  read = read_field(*field++, row.status) && read;
  for (std::optional<double>* const value : {&row.cost, &row.clearance, &row.clearance_margin,
                                             &row.joint_margin, &row.tool_speed, &row.failed_s})
    read = read_field(*field++, *value) && read;
  row.cause = *field++;
  row.by = *field++;
  row.reason = *field++;
  return read ? std::optional(row) : std::nullopt;
}

std::string to_csv(const std::vector<PlacementRow>& rows) {
  std::string text = kPlacementHeader;
  for (const PlacementRow& row : rows) text += csv_line(row);
  return text;
}

}  // namespace swivel::io
