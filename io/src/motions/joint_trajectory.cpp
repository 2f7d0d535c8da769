// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <nlohmann/json.hpp>

#include "files/files.hpp"
#include "motions/moved_joints.hpp"
#include "motions/stamp.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

namespace {

/// Returns the text in the quotes of JSON, which YAML reads too.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump();
}

/// Returns a list of the values of the joints that controllers move.
std::string list(const TimedPath& motion, const Config& values) {
  std::string text;
  for (const double value : moved_joints(motion, values))
    text += (text.empty() ? "[" : ", ") + format_double(value);
  return text + "]";
}

std::string list(const TimedPath& motion, const JointNames& names) {
  std::string text;
  for (const std::string& name : moved_joints(motion, names))
    text += (text.empty() ? "[" : ", ") + quoted(name);
  return text + "]";
}

}  // namespace

std::string to_trajectory_json(const TimedPath& motion, const JointNames& joint_names,
                               const std::string& frame_id) {
  std::string text =
      "{\"header\": {\"stamp\": {\"sec\": 0, \"nanosec\": 0}, \"frame_id\": " + quoted(frame_id) +
      "},\n \"joint_names\": " + list(motion, joint_names) + ",\n \"points\": [";
  const char* before = "\n";
  for (const TimedRow& row : motion.rows) {
    const Stamp stamp = stamp_of(row.t);
    text += before;
    text += "  {\"positions\": " + list(motion, row.row.q) +
            ", \"velocities\": " + list(motion, row.v) +
            ", \"accelerations\": " + list(motion, row.a) +
            ", \"effort\": [], \"time_from_start\": {\"sec\": " + std::to_string(stamp.sec) +
            ", \"nanosec\": " + std::to_string(stamp.nanosec) + "}}";
    before = ",\n";
  }
  return text + "\n ]}\n";
}

std::string to_trajectory_yaml(const TimedPath& motion, const JointNames& joint_names,
                               const std::string& frame_id) {
  std::string text = "header:\n  stamp: {sec: 0, nanosec: 0}\n  frame_id: " + quoted(frame_id) +
                     "\njoint_names: " + list(motion, joint_names) + "\npoints:\n";
  for (const TimedRow& row : motion.rows) {
    const Stamp stamp = stamp_of(row.t);
    text += "- positions: " + list(motion, row.row.q) + "\n  velocities: " + list(motion, row.v) +
            "\n  accelerations: " + list(motion, row.a) +
            "\n  effort: []\n  time_from_start: {sec: " + std::to_string(stamp.sec) +
            ", nanosec: " + std::to_string(stamp.nanosec) + "}\n";
  }
  return text;
}

}  // namespace swivel::io
