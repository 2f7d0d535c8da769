// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <nlohmann/json.hpp>

#include "files/files.hpp"
#include "motions/messages.hpp"
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
std::string list(const MotionMessages& motion, const Config& values) {
  std::string text;
  for (const double value : moved_joints(motion.roll, values))
    text += (text.empty() ? "[" : ", ") + format_double(value);
  return text + "]";
}

std::string list(const MotionMessages& motion, const JointNames& names) {
  std::string text;
  for (const std::string& name : moved_joints(motion.roll, names))
    text += (text.empty() ? "[" : ", ") + quoted(name);
  return text + "]";
}

/// Returns the events of a motion, each after `before`, separated by `between`.
std::string event_lines(const MotionMessages& motion, const std::string& before,
                        const std::string& between) {
  std::string text;
  for (const EventMessage& event : *motion.events)
    text += (text.empty() ? before : between + before) + event.json;
  return text;
}

}  // namespace

std::string trajectory_json(const MotionMessages& motion) {
  std::string text = "{\"header\": {\"stamp\": {\"sec\": 0, \"nanosec\": 0}, \"frame_id\": " +
                     quoted(motion.frame_id) +
                     "},\n \"joint_names\": " + list(motion, motion.joint_names) +
                     ",\n \"points\": [";
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
  text += "\n ]";
  if (motion.events) text += ",\n \"events\": [\n" + event_lines(motion, "  ", ",\n") + "\n ]";
  return text + "}\n";
}

std::string trajectory_yaml(const MotionMessages& motion) {
  std::string text =
      "header:\n  stamp: {sec: 0, nanosec: 0}\n  frame_id: " + quoted(motion.frame_id) +
      "\njoint_names: " + list(motion, motion.joint_names) + "\npoints:\n";
  for (const TimedRow& row : motion.rows) {
    const Stamp stamp = stamp_of(row.t);
    text += "- positions: " + list(motion, row.row.q) + "\n  velocities: " + list(motion, row.v) +
            "\n  accelerations: " + list(motion, row.a) +
            "\n  effort: []\n  time_from_start: {sec: " + std::to_string(stamp.sec) +
            ", nanosec: " + std::to_string(stamp.nanosec) + "}\n";
  }
  if (motion.events) text += "events:\n" + event_lines(motion, "- ", "\n") + "\n";
  return text;
}

std::string to_trajectory_json(const TimedPath& motion, const JointNames& joint_names,
                               const std::string& frame_id) {
  return trajectory_json({motion.rows, motion.roll, joint_names, frame_id});
}

std::string to_trajectory_yaml(const TimedPath& motion, const JointNames& joint_names,
                               const std::string& frame_id) {
  return trajectory_yaml({motion.rows, motion.roll, joint_names, frame_id});
}

}  // namespace swivel::io
