// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/motion.hpp"
#include "swivel/core/answer/stated.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

class PreparedRobot;

/// Computes what the file of a job's trajectory does not state about the rows of its runs, as
/// complete_rows() does of one path, and returns the parts. The roll of a six-joint arm, where the
/// file has none, turns in transitions as the other joints move, from run to run. Throws as
/// complete_rows() does, with the name of the stroke.
[[nodiscard]] std::vector<Part> complete_parts(const PreparedRobot& robot, const Problem& job,
                                               std::vector<Part> parts, const Stated& stated,
                                               const Budget& budget = {});

/// Computes what the file of a job's motion does not state about its rows, as complete_motion()
/// does of one path, for check_job_motion(), and returns the motion. `order` has its runs. The s of
/// an event becomes that of its row, if it is not a number or differs by at most 1e-6 m. Throws as
/// complete_motion() does, with the name of the stroke.
[[nodiscard]] ArmMotion complete_job_motion(const PreparedRobot& robot, const Problem& job,
                                            const std::vector<StrokeRun>& order, ArmMotion motion,
                                            const Stated& stated, const Budget& budget = {});

/// Returns the parts of a job's motion, whose times are left aside, for time_job(): the rows of
/// runs at the layers of with_motion_defaults(job), as rows_at_layers() finds them, and of
/// transitions the corners alone, between which the joints of all samples move straight (1e-6 rad).
/// `order` has the runs of the motion, whose rows state everything. Throws as rows_at_layers()
/// does, with the name of the stroke.
[[nodiscard]] std::vector<Part> parts_of_motion(const PreparedRobot& robot, const Problem& job,
                                                const std::vector<StrokeRun>& order,
                                                const ArmMotion& motion, const Budget& budget = {});

}  // namespace swivel
