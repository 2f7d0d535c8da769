// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace swivel {

/// What a trajectory's file states of its rows, besides their joints. The rest can be worked out from the joints and the problem:
/// complete_rows() in planner/verify/complete_rows.hpp.
struct Stated {
  bool s = true, phi = true, branch = true;  ///< TrajectoryRow's
  bool roll = true;                          ///< TrajectoryRow::roll
  /// False: the last joint is named "roll" and the file has the six before it alone, as controllers do.
  bool last_joint = true;
  bool v = true, a = true;  ///< TimedRow's
  [[nodiscard]] bool rows() const { return s && phi && branch && roll && last_joint; }
  [[nodiscard]] bool motions() const { return rows() && v && a; }
};

}  // namespace swivel
