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

/// Returns a list of values of a row, of the joints that controllers move.
template <class Of>
std::string list(const MotionMessages& motion, std::size_t row, const Of& of) {
  std::string text;
  for (const double value : motion.values(row, of))
    text += (text.empty() ? "[" : ", ") + format_double(value);
  return text + "]";
}
const Config& positions(const TimedRow& row) {
  return row.row.q;
}
const Config& speeds(const TimedRow& row) {
  return row.v;
}
const Config& accelerations(const TimedRow& row) {
  return row.a;
}

std::string list_of_names(const MotionMessages& motion) {
  std::string text;
  for (const std::string& name : motion.names()) text += (text.empty() ? "[" : ", ") + quoted(name);
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

std::vector<std::string> MotionMessages::names() const {
  const auto own = moved_joints(roll, joint_names);
  std::vector<std::string> all(own.begin(), own.end());
  if (second != nullptr)
    for (std::string& name : second->names()) all.push_back(std::move(name));
  return all;
}

std::string trajectory_json(const MotionMessages& motion) {
  std::string text = "{\"header\": {\"stamp\": {\"sec\": 0, \"nanosec\": 0}, \"frame_id\": " +
                     quoted(motion.frame_id) + "},\n \"joint_names\": " + list_of_names(motion) +
                     ",\n \"points\": [";
  const char* before = "\n";
  for (std::size_t row = 0; row < motion.rows.size(); ++row) {
    const Stamp stamp = stamp_of(motion.rows[row].t);
    text += before;
    text += "  {\"positions\": " + list(motion, row, positions) +
            ", \"velocities\": " + list(motion, row, speeds) +
            ", \"accelerations\": " + list(motion, row, accelerations) +
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
      "\njoint_names: " + list_of_names(motion) + "\npoints:\n";
  for (std::size_t row = 0; row < motion.rows.size(); ++row) {
    const Stamp stamp = stamp_of(motion.rows[row].t);
    text += "- positions: " + list(motion, row, positions) +
            "\n  velocities: " + list(motion, row, speeds) +
            "\n  accelerations: " + list(motion, row, accelerations) +
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
