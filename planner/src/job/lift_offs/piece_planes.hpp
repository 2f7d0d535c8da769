// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

/// Returns the planes from which a run of a stroke in several runs measures arm angles on a grid,
/// by layer of its path: those of the whole stroke, carried along the approach and the retract as
/// well, so that the run has the nodes of the stroke's lattice. Empty where the run's own planes
/// are these, or where the arm has no grid.
[[nodiscard]] std::vector<ArmPlane> planes_of_piece(const Stroke& stroke,
                                                    const PathProblem& problem,
                                                    const PreparedRobot& robot,
                                                    const ToolPath& path, const Budget& budget);

}  // namespace swivel
