// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

/// Which columns a trajectory's file states besides the joints. The rest follows from the joints
/// and the problem: complete_rows() in planner/verify/complete_rows.hpp.
struct Stated {
  bool s = true, phi = true, branch = true;  ///< of TrajectoryRow
  bool roll = true;                          ///< TrajectoryRow::roll
  /// False: the last joint is named "roll" and the file has the six before it alone, as controllers
  /// do.
  bool last_joint = true;
  bool v = true, a = true;  ///< of TimedRow
  /// Returns true if the file states every member of TrajectoryRow.
  [[nodiscard]] bool rows() const { return s && phi && branch && roll && last_joint; }
  /// Returns true if the file states every member of TrajectoryRow and TimedRow.
  [[nodiscard]] bool motions() const { return rows() && v && a; }
};

}  // namespace swivel
