// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "bad_input.hpp"
#include "files.hpp"
#include "schema.hpp"
#include "swivel/io/motion.hpp"
#include "trajectory_columns.hpp"

namespace swivel::io {

const Schema& motion_schema() {
  static const Schema schema = [] {
    std::vector<Schema::Key> keys = trajectory_schema().keys;
    for (Schema::Key& key : keys) key.group = "trajectory";
    keys.insert(keys.begin(), {"t", number(), "s", required(), "since the motion began; ascends"});
    keys.push_back({"JOINT_v", number(), "rad/s", required(), "its speed"});
    keys.push_back({"JOINT_a", number(), "rad/s²", required(), "its acceleration"});
    return section("timed", std::move(keys));
  }();
  return schema;
}

std::string to_timed_csv(const TimedPath& motion, const JointNames& joint_names) {
  std::string text;
  const bool roll = std::any_of(motion.rows.begin(), motion.rows.end(), [](const TimedRow& row) { return row.row.roll != 0; });
  for (const std::string& name : csv_header(motion_schema(), joint_names, roll))
    text += (text.empty() ? "" : ",") + csv_field(name);
  text += '\n';
  for (const TimedRow& row : motion.rows) {
    text += format_double(row.t) + ',' + trajectory_fields(row.row, roll);
    for (const Config* values : {&row.v, &row.a})
      for (const double value : *values) text += ',' + format_double(value);
    text += '\n';
  }
  return text;
}

TrajectoryFile load_trajectory_file(const std::filesystem::path& csv, const JointNames& joint_names) {
  const CsvTable table(csv, {csv_header(trajectory_schema(), joint_names, false), csv_header(motion_schema(), joint_names, false),
                             csv_header(trajectory_schema(), joint_names, true), csv_header(motion_schema(), joint_names, true)});
  const bool timed = table.header() % 2 == 1, roll = table.header() >= 2;
  TrajectoryFile file;
  for (std::size_t k = 0; k < table.rows(); ++k) {
    const ReadRow read = read_trajectory_row(table, k, timed ? 1 : 0, roll);
    file.rows.push_back(read.row);
    if (!timed) continue;
    const std::span<const double> values = table.row(k);
    TimedRow row;
    row.t = values[0];
    row.row = file.rows.back();
    row.v = Config::Map(values.data() + 1 + read.columns);
    row.a = Config::Map(values.data() + 1 + read.columns + kDof);
    if (k > 0 && !(row.t > file.timed.back().t))
      bad_input(table.where(k) + ": t", "is " + format_double(row.t), "times that ascend from row to row");
    file.timed.push_back(row);
  }
  return file;
}

}  // namespace swivel::io
