// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

class PreparedRobot;

/// The result of an independent check of a trajectory, which uses the problem, the exact chain and
/// FCL, but nothing of the planners or their search.
struct CheckResult {
  bool passed = false;
  std::vector<std::string> failures;  ///< one line each, with the row; at most 20
  std::int64_t failure_count = 0;     ///< number of all failures
  double worst_position = 0;          ///< m, tool against path at the rows
  double worst_angle = 0;             ///< rad
  double worst_path_error = 0;        ///< m, between rows
  double worst_path_angle = 0;        ///< rad, the same at the nearest points of the path
  /// a joint's largest move between two rows, divided by what joint_step and speeds allow it
  double largest_step = 0;
  double cost = 0;  ///< of the rows as given, by the problem's metric
  /// the rows were judged on the path of with_motion_defaults(), whose corners are rounded
  bool rounded = false;
  std::optional<double> min_clearance;  ///< m, of any pair at the rows
  std::optional<double> min_margin;     ///< m, least clearance of a pair less what it must keep
  /// among the pairs that are allowed to touch; unset if none was found to touch
  std::optional<DeepestContact> deepest_contact;
  /// Whether min_clearance and min_margin are known, of the rows examined; and deepest_contact.
  Known min_clearance_status = Known::kNotMeasured, deepest_contact_status = Known::kNotMeasured;
  /// The row and joint that come nearest to a joint limit.
  struct LimitDistance {
    int joint = 0;  ///< 0..6
    double by = 0;  ///< inside the limits less joint_margin, rad; of a joint that slides m
    std::size_t row = 0;
  };
  std::optional<LimitDistance> nearest_limit;  ///< of joints that turn; unset if none has limits
  std::optional<LimitDistance> nearest_slide_limit;  ///< of the joint that slides; unset: none does
  /// Rates of a timed motion, by differences between samples, with rest before the first and after
  /// the last sample.
  struct Motion {
    /// The greatest rate of any joint.
    struct Peak {
      double ratio = 0;  ///< divided by what the joint can do
      int joint = 0;     ///< 0..6
      double t = 0;      ///< s
    };
    std::array<Peak, 3> peaks;              ///< speed, acceleration, jerk
    double duration = 0;                    ///< s, from the first row to the last
    double tool_speed = 0, turn_speed = 0;  ///< m/s and rad/s, the highest between two rows
  };
  std::optional<Motion> motion;
  // Work done. A row that fails by its values, its pose or its limits is not examined further, nor
  // are moves from or to it.
  std::int64_t rows_examined = 0, moves_examined = 0, fcl_calls = 0;
};

/// The result of an independent check of an answer with several parts or arms.
struct AnswerCheck {
  bool passed = false;
  /// One line for each failure of strokes, with its part, or of two arms together; failures of one
  /// path and of one arm of two are in `runs`. At most 20.
  std::vector<std::string> failures;
  std::int64_t failure_count = 0;  ///< number of all failures of which `failures` has the first
  double cost = 0;  ///< of all moves, by the problem's metric; 0 where there are two arms
  /// The check of each part that is a run of a stroke, in their order, or of each of two arms.
  std::vector<CheckResult> runs;
  std::optional<LeastMargin> between;  ///< of bodies of two arms at rows; with margins only
};

/// Options of check_trajectory() and check_motion().
struct CheckOptions {
  /// true: compute worst errors and least clearances, and ask FCL alone. false: reach the verdict
  /// sooner. Distance proofs then answer where they can, the second bodies that come too near are
  /// not looked for, worst_path_error and worst_path_angle cover only moves that fail by them, and
  /// min_clearance, min_margin and deepest_contact stay unset.
  bool margins = true;
  Budget budget = {};  ///< Stopped is thrown once it is spent
  /// Speed of the tool along all strokes, m/s, that check_job_motion() asks for instead of those of
  /// the job, like TimingOptions::speed of time_job(). Other checks do not read it.
  std::optional<double> speed = {};
};

/// Proves a trajectory from the problem alone, or tells what is wrong with it. The problem's
/// resolution matters: it divides the path into layers and the steps between them. Rows may lie
/// anywhere on the path, each further along it than the one before.
///
/// At a row:
/// - all values are finite, and joints are within their limits less joint_margin (1e-9 rad);
/// - the tool is within 1e-6 m and 1e-6 rad of the path at s (1e-9 m). Where the path only turns, s
///   repeats and the orientation tells the place; rows are matched to places so that they come in
///   order. Rows of check_trajectory() that leave the path are judged on the path of
///   with_motion_defaults() if that gives fewer failures, because plans from which motions are made
///   follow that path;
/// - manipulability (1e-9) and clearance (0.05 mm) are kept; contact is never forgiven;
/// - a tool that may turn about its own axis is turned as far as its range and waypoints allow;
/// - for S-R-S arms, phi is the arm angle of the joints (1e-3 rad, whole turns aside), carried
///   along the layers or, for a row between two layers, from the layer before it; branch tells the
///   joints' signs where they are further than 0.01 rad (0.05 on inexact arms) from a change. For
///   an arm whose last joint is the roll, phi is the roll (1e-3 rad).
/// The first row is at the path's beginning and has the given start, if there is one; the last is
/// at its end and has the given end, if there is one.
///
/// From one row to the next, with joints moving straight:
/// - the tool advances: rows at the same place fail;
/// - tool and path can be traversed together, neither ever going back, within tool_path_error and
///   tool_angle_error of each other (Frechet distance). If one of the two is not set, 1 mm or 0.02
///   rad holds at the waypoints that the move passes, each of which is a layer of its own. A move
///   from a layer to the next is judged by the lattice's rule, at t = 1/4, 1/2, 3/4;
/// - each joint moves by at most joint_step, and by what its speed allows in the step's time, for
///   each step that the move touches; between any two rows by at most one step's share more; a
///   continuous joint, or one of over 64 turns, by less than pi;
/// - the roll of a tool that may turn changes by no more than roll_slope allows;
/// - step_error is kept if both rows are neighbouring layers; elsewhere it is not defined;
/// - nothing comes nearer than d_edge (0.05 mm), with `edges: continuous`.
/// Throws InvalidArgument and InputError as plan() does, and Stopped.
[[nodiscard]] CheckResult check_trajectory(const PathProblem& problem,
                                           const std::vector<TrajectoryRow>& rows,
                                           const CheckOptions& options = {});
/// Proves a trajectory, as check_trajectory() of the problem alone does, with a robot prepared
/// before. Throws InvalidArgument unless it was prepared for this problem
/// (PreparedRobot::require_prepared_for), otherwise InputError, InvalidArgument and Stopped as that
/// function does.
[[nodiscard]] CheckResult check_trajectory(const PreparedRobot& robot, const PathProblem& problem,
                                           const std::vector<TrajectoryRow>& rows,
                                           const CheckOptions& options = {});
/// Proves a timed motion from the problem alone, or tells what is wrong with it. The problem is
/// completed by with_motion_defaults(). Every row and every move must satisfy what
/// check_trajectory() demands, with these differences:
/// - the tool may rest at both ends of the path and at corners. Joints may move there, from one
///   posture to another of the same tool pose, as long as the tool stays within tool_path_error and
///   tool_angle_error of that pose (1 mm or 0.02 rad if one is not set) and nothing comes too near
///   on the way;
/// - times are finite and ascend.
/// In addition, for a controller that moves joints straight from row to row, at rest before the
/// first and after the last:
/// - the speed of each move, the change of speed at each row, and the change of acceleration from
///   row to row are within joint_rates() (1e-6 of them). A change is made within the mean of the
///   steps that it belongs to, and within no more than the usual step: the median of the steps in
///   which a joint moves. So the speed may not jump on either side of a gap in time. Steps that
///   differ by 2 ns are equal;
/// - v and a of every row, the first and the last as well, are those of the joints, within what
///   acceleration and jerk change in a step;
/// - limits.tool_speed and tool_turn_speed, if given, are kept (0.1 %).
/// Throws InvalidArgument, InputError and Stopped as check_trajectory() does.
[[nodiscard]] CheckResult check_motion(const PreparedRobot& robot, const PathProblem& problem,
                                       const std::vector<TimedRow>& rows,
                                       const CheckOptions& options = {});
/// Throws std::logic_error, with the first failure, if the result has not passed. For a program's
/// own answers, which must never fail.
void require_passed(const CheckResult& result);
void require_passed(const AnswerCheck& result);

}  // namespace swivel
