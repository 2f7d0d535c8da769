// SPDX-License-Identifier: BSD-3-Clause
#include "job/lift_offs/piece_planes.hpp"

#include <cstddef>
#include <optional>
#include <utility>

#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"

namespace swivel {

int layer_at(const ToolPath& path, double s) {
  constexpr double kSameLength = 1e-9;  // m
  int layer = 0;
  while (layer + 1 < path.size() && path.layer(layer).s < s - kSameLength) ++layer;
  return layer;
}

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
  const int first = layer_at(path, stroke.approach.norm());
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

std::unique_ptr<Lattice> make_piece_lattice(const PreparedRobot& robot, const ToolPath& path,
                                            const PathProblem& problem,
                                            std::vector<ArmPlane> planes, const Budget& budget) {
  const Chain& chain = robot.arm().chain;
  const ArmClass& arm = robot.arm_class();
  if (planes.empty()) return make_lattice(chain, arm, path, problem, budget);
  return std::make_unique<SrsLattice>(chain, *arm.srs, path, problem, budget, std::move(planes),
                                      std::nullopt,
                                      SrsLattice::possible_circles(chain, *arm.srs, path, problem));
}

}  // namespace swivel
