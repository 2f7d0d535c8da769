// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

/// One arm of a workcell: its chain and what it carries, and the path of its tool, or its motion
/// where that is given. `rolls` of its task are unset, and so are `steps` unless the motion of the
/// other arm is given.
struct WorkcellArm : Robot, Task {
  std::string name;
  /// Joints at each row of a given motion, rad, base to tip: the arm moves straight in joint space
  /// from row to row, and is not planned. It has no waypoints then. Robot::roll of an arm of six
  /// joints is a whole circle then, and the seventh number of a row says how far these joints have
  /// turned the tool about its z axis. Empty: the arm is planned.
  std::vector<Config> given;
};

/// Two arms of one robot model that work at one time: at every waypoint both arms are at theirs,
/// and between two waypoints both paths are cut into the same number of steps. The arms have the
/// same model, base_link and `hold`.
///
/// The motion of one arm may be given; its rows are the layers then. Task::steps of the other arm
/// says at which rows its waypoints are: so many rows after the one before. Empty: it has one
/// waypoint for each row, or two, at the first and at the last row.
///
/// Task::path_frame of one arm may be the name of the other one. That other arm leads: its tool, as
/// its joints have turned it, carries the path of this arm, the follower. The leader has no roll
/// unless its motion is given: which roll the plan would choose is not known where the follower's
/// path is laid out.
struct Workcell {
  std::string source;  ///< workcell file, for messages
  std::array<WorkcellArm, 2> arms;
  std::vector<SceneObject> scene;
  std::vector<Variation> vary;
  /// Pairs of bodies, one of either arm, that may touch at any depth: names of links or of attached
  /// bodies.
  std::vector<std::array<std::string, 2>> may_touch;
  /// Returns the number of the arm that leads the arm of number `arm`, if one does: 1 - arm; else
  /// -1.
  [[nodiscard]] int leader_of(std::size_t arm) const {
    const std::string& frame = arms[arm].path_frame;
    return !frame.empty() && frame == arms[1 - arm].name ? static_cast<int>(1 - arm) : -1;
  }
  /// Returns the number of the arm whose motion is given, if one is; else nothing.
  [[nodiscard]] std::optional<std::size_t> given_arm() const {
    for (std::size_t arm = 0; arm < 2; ++arm)
      if (!arms[arm].given.empty()) return arm;
    return std::nullopt;
  }
};

/// Throws InvalidArgument for a workcell that makes no sense whatever the robot: names of arms that
/// are empty, equal or those of a scene object or the base link; arms whose model, base_link or
/// hold differ, which lead each other, or whose paths have different numbers of waypoints; two
/// given motions, or one of fewer than two rows, with joints that are not finite, or of an arm with
/// a path, a start, an end or a bounded roll; `steps` that do not lead to its last row; windows of
/// the roll at waypoints; a leader that is planned with a roll, or whose start may be off its path;
/// attached bodies of one name; and what validate(PathProblem) refuses of either arm.
void validate(const Workcell& cell);

}  // namespace swivel
