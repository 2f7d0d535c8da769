// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

/// Returns the first layer of a path that is not before an arc length, m; the last where all are.
[[nodiscard]] int layer_at(const ToolPath& path, double s);

/// Returns the planes from which a run of a stroke in several runs measures arm angles on a grid,
/// by layer of its path: those of the whole stroke, carried along the approach and the retract as
/// well, so that the run has the nodes of the stroke's lattice. Empty where the run's own planes
/// are these, or where the arm has no grid.
[[nodiscard]] std::vector<ArmPlane> planes_of_piece(const Stroke& stroke,
                                                    const PathProblem& problem,
                                                    const PreparedRobot& robot,
                                                    const ToolPath& path, const Budget& budget);

/// Returns the lattice of a run, which measures arm angles from `planes`; from the path's own where
/// these are empty. `problem`, `path` and the robot must outlive it.
[[nodiscard]] std::unique_ptr<Lattice> make_piece_lattice(const PreparedRobot& robot,
                                                          const ToolPath& path,
                                                          const PathProblem& problem,
                                                          std::vector<ArmPlane> planes,
                                                          const Budget& budget);

}  // namespace swivel
