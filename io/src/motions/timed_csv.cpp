// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "files/csv.hpp"
#include "files/files.hpp"
#include "motions/trajectory_columns.hpp"
#include "schema/schema.hpp"
#include "swivel/io/motions/motion.hpp"

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
  const bool roll = std::any_of(motion.rows.begin(), motion.rows.end(),
                                [](const TimedRow& row) { return row.row.roll != 0; });
  for (const std::string& name : csv_header(motion_schema(), joint_names, roll))
    text.append(text.empty() ? "" : ",").append(csv_field(name));
  text += '\n';
  const std::size_t joints = named_joints(joint_names);
  for (const TimedRow& row : motion.rows) {
    text += format_double(row.t) + ',' + trajectory_fields(row.row, roll, joints) +
            joint_fields(row.v, joints) + joint_fields(row.a, joints) + '\n';
  }
  return text;
}

}  // namespace swivel::io
