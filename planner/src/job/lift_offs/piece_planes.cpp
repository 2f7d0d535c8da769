// SPDX-License-Identifier: BSD-3-Clause
#include "job/lift_offs/piece_planes.hpp"

#include <cstddef>
#include <optional>

#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"

namespace swivel {

std::vector<ArmPlane> planes_of_piece(const Stroke& stroke, const PathProblem& problem,
                                      const PreparedRobot& robot, const ToolPath& path,
                                      const Budget& budget) {
  const std::optional<SrsArm>& arm = robot.arm_class().srs;
  if (robot.arm_class().kind != ArmKind::kSrs || robot.arm().chain.free_roll || !stroke.piece ||
      (stroke.piece->before.empty() && stroke.approach.isZero(0)))
    return {};
  PathProblem before = problem;
  before.end.reset();
  before.smooth.reset();
  before.steps.clear();
  before.waypoints = stroke.piece->before;
  before.waypoints.push_back(stroke.waypoints.front());
  if (stroke.piece->before.empty()) before.waypoints = stroke.waypoints;
  const std::vector<ArmPlane> known =
      carried_planes(*arm, problem_path(before, robot.arm().chain, budget), budget);
  const ArmPlane& begin = stroke.piece->before.empty() ? known.front() : known.back();
  int first = 0;
  while (first + 1 < path.size() && path.layer(first).s < stroke.approach.norm() - 1e-9) ++first;
  std::vector<ArmPlane> planes(static_cast<std::size_t>(path.size()));
  const auto carry = [&](const ArmPlane& from, int layer) {
    ArmPlane& to = planes[static_cast<std::size_t>(layer)];
    to = carry_plane(*arm, from, path.layer(layer).tool);
    return to;
  };
  const ArmPlane middle = carry(begin, first);
  ArmPlane last = middle;
  for (int layer = first + 1; layer < path.size(); ++layer) last = carry(last, layer);
  last = middle;
  for (int layer = first - 1; layer >= 0; --layer) last = carry(last, layer);
  return planes;
}

}  // namespace swivel
