// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/answer/workcell_certificate.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/verify/check.hpp"
#include "swivel/planner/workcell/prepared/prepared_workcell.hpp"

namespace swivel {

/// Proves the trajectories of two arms from the workcell alone, or tells what is wrong with them.
/// Each passes check_trajectory() by itself; rows are at the layers of the paths, as many as there
/// are, so that row k of one arm and row k of the other are simultaneous; and at every row, and on
/// every motion from one row to the next in which both arms move at one time, each straight in
/// joint space, bodies of the two arms keep clear of each other (0.05 mm are forgiven, contact
/// never). At every row the tool of a follower is on its path on the leader's tool, where the
/// leader's joints have that tool. Throws InvalidArgument and InputError as PreparedWorkcell does,
/// and Stopped.
[[nodiscard]] AnswerCheck check_workcell(const PreparedWorkcell& prepared,
                                         const std::array<std::vector<TrajectoryRow>, 2>& rows,
                                         const CheckOptions& options = {});
[[nodiscard]] AnswerCheck check_workcell(const Problem& cell,
                                         const std::array<std::vector<TrajectoryRow>, 2>& rows,
                                         const CheckOptions& options = {});
/// Proves a timed motion of two arms from the workcell alone, or tells what is wrong with it. The
/// workcell is one with_motion_defaults(). Each arm passes check_motion() by itself; rows are at
/// the same times; at every row, and on every motion from one to the next in which both arms move
/// at one time, each straight in joint space, bodies of the two arms keep clear of each other (0.05
/// mm are forgiven, contact never). Both tools are at their waypoints together: when one is there,
/// the other is within its limits.tool_path_error (1 mm if that is not set) of its own. The tool of
/// a follower is within tool_path_error and tool_angle_error (1 mm, 0.02 rad) of its path on the
/// leader's tool at every row. Throws as check_workcell() does.
[[nodiscard]] AnswerCheck check_workcell_motion(const PreparedWorkcell& prepared,
                                                const std::array<std::vector<TimedRow>, 2>& rows,
                                                const CheckOptions& options = {});
/// The verdict on a certificate that a workcell has no plan.
struct WorkcellCertificateCheck {
  bool passed = false;
  std::string failure;  ///< one line: the first fault; empty if passed
  /// true: all IK solutions of both arms are known; else the proof covers those that were found
  bool complete = true;
  std::int64_t regions = 0, cuts = 0;  ///< sets that are divided, and sets that are empty
  std::int64_t pairs = 0;              ///< pairs of nodes and of moves in regions
  std::int64_t nodes = 0, edges = 0;   ///< tests of witnesses in cuts
};

/// Verifies a certificate that a workcell has no plan, from the workcell alone and without a
/// planner: that the tree is whole, that no pair of a region is apart, by FCL without distance
/// proofs, and that every cut leaves its arm no path, as for one arm. Throws InputError if a
/// lattice differs from the certificate's (resolution, edges, layers), and Stopped.
[[nodiscard]] WorkcellCertificateCheck verify_certificate(const PreparedWorkcell& prepared,
                                                          const WorkcellCertificate& certificate,
                                                          const Budget& budget = {});

}  // namespace swivel
