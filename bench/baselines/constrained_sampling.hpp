// SPDX-License-Identifier: BSD-3-Clause
// The paper's sampling-based relatives, through OMPL. They plan between two configurations on a
// constraint manifold. To follow a tool path, they are given the path parameter t as an eighth
// coordinate: F(q, t) compares the pose of the tool at q with that of the path at t, from the start
// at t = 0 to valid nodes of the last layer at t = 1. They know no order along the path; motions
// that go back along it are refused, and what they find is checked afterwards.
#pragma once
#include <string>

#include "swivel/core/problem/path_problem.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel::baselines {

enum class Manifold {
  kProjected,      ///< samples of the ambient space projected: CBiRRT (Berenson et al. 2009)
  kTangentBundle,  ///< samples in tangent spaces: TB-RRT (Kim et al. 2016)
};

struct ConstrainedResult {
  bool connected = false;  ///< a path from the start to t = 1, whatever its order
  bool finished = false;   ///< it also follows the tool path in order, valid at every row, within
                           ///< tool_path_error and joint_step
  std::string reason;      ///< empty when finished
  double ms = 0;           ///< planning alone
  double error_mm = 0, error_max_mm = 0;  ///< when finished; mean and largest, as for the planners
};

/// Plans with a bidirectional RRT (OMPL's RRTConnect) for at most `seconds`. PathProblem::start
/// must be set and valid.
[[nodiscard]] ConstrainedResult plan_constrained(const PreparedRobot& robot,
                                                 const PathProblem& problem, Manifold manifold,
                                                 double seconds);

}  // namespace swivel::baselines
