// SPDX-License-Identifier: BSD-3-Clause
#include "bad_input.hpp"
#include "csv.hpp"
#include "files.hpp"
#include "swivel/io/io.hpp"
#include "trajectory_columns.hpp"

namespace swivel::io {

std::vector<std::string> trajectory_header(const std::array<std::string, kDof>& joint_names) {
  std::vector<std::string> header{"s", "phi", "branch"};
  header.insert(header.end(), joint_names.begin(), joint_names.end());
  return header;
}

std::string trajectory_fields(const TrajectoryRow& row) {
  std::string text = format_double(row.s) + ',' + format_double(row.phi) + ',' + std::to_string(row.branch);
  for (const double angle : row.q) text += ',' + format_double(angle);
  return text;
}

TrajectoryRow read_trajectory_row(const CsvTable& table, std::size_t k, std::size_t first) {
  const std::span<const double> values = table.row(k).subspan(first);
  const double branch = values[2];
  if (!(branch >= 0 && branch <= 7) || branch != static_cast<int>(branch))
    bad_input(table.where(k) + ": branch", "is " + format_double(branch), "a whole number from 0 to 7");
  TrajectoryRow row;
  row.s = values[0];
  row.phi = values[1];
  row.branch = static_cast<int>(branch);
  row.q = Config::Map(values.data() + 3);
  return row;
}

std::string to_csv(const PlanResult& result) {
  std::string text;
  for (const std::string& name : trajectory_header(result.joint_names)) text += (text.empty() ? "" : ",") + csv_field(name);
  text += '\n';
  for (const TrajectoryRow& row : result.trajectory) text += trajectory_fields(row) + '\n';
  return text;
}

void write_trajectory(const std::filesystem::path& csv, const PlanResult& result) {
  write_file(csv, to_csv(result));
}

std::vector<TrajectoryRow> load_trajectory(const std::filesystem::path& csv, const std::array<std::string, kDof>& joint_names) {
  const CsvTable table(csv, trajectory_header(joint_names));
  std::vector<TrajectoryRow> rows;
  rows.reserve(table.rows());
  for (std::size_t k = 0; k < table.rows(); ++k) rows.push_back(read_trajectory_row(table, k, 0));
  return rows;
}

}  // namespace swivel::io
