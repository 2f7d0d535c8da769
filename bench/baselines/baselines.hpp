// SPDX-License-Identifier: BSD-3-Clause
// The paper's two local methods, for comparison. Both follow the path from PathProblem::start in
// small steps and know only the arm's present posture.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/problem/path_problem.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel::baselines {

enum class StopReason {
  kFinished,
  kJointLimit,    ///< the next step leaves the limits
  kCollision,     ///< clearance below Limits::clearance
  kLocalMinimum,  ///< as kCollision, and no self-motion raises the clearance
  kDiverged,      ///< the tool cannot be held on the path: out of reach or singular
};
[[nodiscard]] const char* to_string(StopReason reason);

struct TrackOptions {
  double step = 0.001;       ///< m of path between rows
  double turn_step = 0.01;   ///< rad of tool rotation between rows
  double tool_error = 1e-9;  ///< m and rad, at which the Newton steps of a row end
  /// rad of any joint between rows; the tracker counts as diverged beyond that.
  double largest_move = 0.2;
  // The members below are for track_null_space() alone.
  double influence = 0.03;  ///< m of clearance below which the arm is pushed away; an SDA5F is
                            ///< often within 0.04 of itself
  double gain =
      0.5;  ///< rad of self-motion for a gradient of 1 m/rad at contact; fades to 0 at `influence`
  double largest_push = 0.02;  ///< rad, joint-space norm of one push
  int pushes =
      20;  ///< per row; more while the clearance is below Limits::clearance, up to `most_pushes`
  int most_pushes = 2000;
  double probe = 5e-4;  ///< rad of self-motion, for the difference quotients of the clearance
  double vanishing =
      1e-3;  ///< m/rad, projected gradient that counts as zero; an arm's gradients are about 0.1
};

struct TrackResult {
  bool finished = false;
  StopReason reason = StopReason::kDiverged;
  double s = 0;              ///< m along the path, of the last row
  std::vector<Config> rows;  ///< one for each step, all within limits and clear
  Config end =
      Config::Zero();  ///< where it stopped: the configuration that failed, or the last row
  std::optional<double>
      clearance;         ///< m, the last one asked: at `end` unless a joint limit was in the way
  std::string blocking;  ///< "body - body" or the joint; empty when finished or diverged
  /// For a track_null_space() that stopped for clearance, m/rad: the norm of the least element of
  /// the clearance's generalised gradient along the self-motion. It is 0 if the clearance falls
  /// both ways, even across a ridge between two obstacles.
  std::optional<double> projected_gradient;
  /// Clearance gained by self-motion forth and back, m/rad; set only under the same condition.
  std::array<double, 2> slopes{};
};

/// Follows the path by dq = J^+ dx, which is least joint motion, without regard to limits and
/// obstacles. Throws InputError without a start or with one off the path.
[[nodiscard]] TrackResult track_jacobian(const PreparedRobot& robot, const PathProblem& problem,
                                         const TrackOptions& options = {});

/// Follows the path by dq = J^+ dx + gain (I - J^+ J) grad(clearance). The arm is pushed until the
/// clearance reaches `influence`, the pushes of a row are used up, or the projected gradient
/// vanishes. A push never lowers the clearance nor leaves the limits. Throws as track_jacobian()
/// does.
[[nodiscard]] TrackResult track_null_space(const PreparedRobot& robot, const PathProblem& problem,
                                           const TrackOptions& options = {});

}  // namespace swivel::baselines
