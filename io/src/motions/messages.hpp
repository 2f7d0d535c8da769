// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "motions/moved_joints.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

/// A moment of a motion at which the tool's process is switched, as a JSON object on one line.
struct EventMessage {
  double t = 0;  ///< s
  std::string json;
};

/// A timed motion as messages of ROS 2 hold it.
struct MotionMessages {
  std::span<const TimedRow> rows;
  bool roll = false;  ///< the last joint of rows is the roll of the tool, which is not written
  const JointNames& joint_names;
  const std::string& frame_id;                ///< the arm's base link
  const std::vector<EventMessage>* events{};  ///< of a job, by time; null: no job
  /// The motion of a second arm by the same clock, with as many rows: its joints come after. Null:
  /// there is one arm.
  const MotionMessages* second = nullptr;

  /// Returns the names of the joints that controllers move.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Returns what `of` makes of a row (positions, speeds or accelerations), of these joints.
  template <class Of>
  [[nodiscard]] std::vector<double> values(std::size_t row, const Of& of) const {
    const auto own = moved_joints(roll, of(rows[row]));
    std::vector<double> all(own.begin(), own.end());
    if (second != nullptr)
      for (const double value : second->values(row, of)) all.push_back(value);
    return all;
  }
};

/// Returns the motion as trajectory_msgs/msg/JointTrajectory in JSON; of a job with the key
/// `events` besides.
[[nodiscard]] std::string trajectory_json(const MotionMessages& motion);
/// Returns the motion as trajectory_msgs/msg/JointTrajectory in YAML; of a job with the key
/// `events` besides.
[[nodiscard]] std::string trajectory_yaml(const MotionMessages& motion);
/// Returns the motion as a log of sensor_msgs/msg/JointState in MCAP; of a job with the topic
/// /process besides, whose messages are the events.
[[nodiscard]] std::string mcap_log(const MotionMessages& motion);

}  // namespace swivel::io
