// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/robot_model.hpp"
#include "swivel/ros/path_service.hpp"

namespace swivel::ros {

/// Where the joints of a robot are, and with them its links.
class RobotState {
 public:
  explicit RobotState(const RobotModel& model) : model_(&model), known_(model.joints.size()) {}
  /// Sets joints by name. Returns the first name that the robot does not have, "" if it has all of
  /// them; the others are set all the same. Throws std::invalid_argument if there are not as many
  /// positions as names, or one is not finite.
  std::string set(const JointValues& joints);
  /// Returns the position of a joint, rad or m, none if it was never set. A joint that mimics
  /// another is where that one takes it.
  [[nodiscard]] std::optional<double> known(int joint) const;
  /// Returns the position of a joint, rad or m; of one that was never set, 0 or its limit nearest
  /// to 0.
  [[nodiscard]] double position(int joint) const;
  /// Returns the pose of a link in the frame of the root link.
  [[nodiscard]] Pose link(int link) const;
  /// Returns all joints that move.
  [[nodiscard]] JointValues values() const;

 private:
  const RobotModel* model_;
  std::vector<std::optional<double>> known_;
};

/// Returns a position moved into the limits of a joint.
[[nodiscard]] double within_limits(const Joint& joint, double position);

/// Returns a pose of messages as a transform. A quaternion of zeros, which messages have where none
/// was set, is no turn.
[[nodiscard]] Pose to_pose(const Pose7& pose);
[[nodiscard]] Pose7 to_pose7(const Pose& pose);

}  // namespace swivel::ros
