// SPDX-License-Identifier: BSD-3-Clause
#include <limits>

#include "files/csv.hpp"
#include "swivel/io/tables/placement.hpp"
#include "tables/table_rows.hpp"

namespace swivel::io {

namespace {

constexpr const char *kBefore = "cell,x,y,z,roll,pitch,yaw",
                     *kAfter =
                         ",status,cost,clearance,clearance_margin,joint_margin,slide_margin,"
                         "tool_speed,failed_s,cause,by,reason,checked";
constexpr std::size_t kColumnsBefore = 7, kColumnsAfter = 12;
constexpr std::string_view kHold = "hold.";  // before the name of a joint

}  // namespace

std::string placement_header(const std::vector<std::string>& joints) {
  std::string header = kBefore;
  for (const std::string& joint : joints)
    header += ',' + csv_line_field(std::string(kHold) + joint);
  return header + kAfter + '\n';
}

std::optional<std::vector<std::string>> joints_of(std::string_view line) {
  const std::vector<std::string> fields = csv_fields(line, std::numeric_limits<int>::max());
  std::vector<std::string> joints;
  for (std::size_t k = kColumnsBefore; k + kColumnsAfter < fields.size(); ++k) {
    if (!fields[k].starts_with(kHold)) return std::nullopt;
    joints.push_back(fields[k].substr(kHold.size()));
  }
  std::string header = placement_header(joints);
  header.pop_back();
  return header == line ? std::optional(joints) : std::nullopt;
}

std::string csv_line(const PlacementRow& row) {
  std::string text = std::to_string(row.cell);
  for (const double value : row.offset) text += ',' + csv_number(value);
  for (const auto& [joint, position] : row.hold) text += ',' + csv_number(position);
  text += std::string(",") + to_string(row.status);
  for (const auto& value : {row.cost, row.clearance, row.clearance_margin, row.joint_margin,
                            row.slide_margin, row.tool_speed, row.failed_s})
    text += ',' + csv_number(value);
  return text + ',' + row.cause + ',' + csv_line_field(row.by) + ',' + csv_line_field(row.reason) +
         ',' + csv_bool(row.checked) + '\n';
}

std::optional<PlacementRow> placement_row(std::string_view line,
                                          const std::vector<std::string>& joints) {
  const std::size_t columns = kColumnsBefore + joints.size() + kColumnsAfter;
  const std::vector<std::string> fields = csv_fields(line, columns);
  if (fields.size() != columns) return std::nullopt;
  PlacementRow row;
  auto field = fields.begin();
  bool read = read_field(*field++, row.cell);
  for (double& value : row.offset) read = read_field(*field++, value) && read;
  for (const std::string& joint : joints) read = read_field(*field++, row.hold[joint]) && read;
  read = read_field(*field++, row.status) && read;
  for (std::optional<double>* const value :
       {&row.cost, &row.clearance, &row.clearance_margin, &row.joint_margin, &row.slide_margin,
        &row.tool_speed, &row.failed_s})
    read = read_field(*field++, *value) && read;
  row.cause = *field++;
  row.by = *field++;
  row.reason = *field++;
  read = read_field(*field++, row.checked) && read;
  return read ? std::optional(row) : std::nullopt;
}

std::string to_csv(const std::vector<PlacementRow>& rows) {
  std::vector<std::string> joints;
  if (!rows.empty())
    for (const auto& [joint, position] : rows.front().hold) joints.push_back(joint);
  std::string text = placement_header(joints);
  for (const PlacementRow& row : rows) text += csv_line(row);
  return text;
}

}  // namespace swivel::io
