// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/core/answer/stated.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/complete_rows.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "workcell/arm_problems.hpp"

namespace swivel {

namespace {

/// Returns what the bodies of both arms keep from each other: the stricter of what either arm keeps
/// from its own.
Limits stricter(const Limits& a, const Limits& b) {
  Limits limits = a;
  limits.self_clearance = std::max(a.d_self(), b.d_self());
  limits.edge_clearance = std::max(a.d_self_edge(), b.d_self_edge());
  limits.edge_tolerance = std::min(a.edge_tolerance, b.edge_tolerance);
  return limits;
}

/// Returns rows with joints `q` at the layers of a path.
std::vector<TrajectoryRow> rows_along(const std::vector<Config>& q, const ToolPath& path) {
  std::vector<TrajectoryRow> rows;
  for (int layer = 0; layer < path.size(); ++layer)
    rows.push_back({.s = path.layer(layer).s, .q = q[static_cast<std::size_t>(layer)]});
  return rows;
}

}  // namespace

struct PreparedWorkcell::Impl {
  std::array<std::string, 2> names;
  std::array<Problem, 2> problems;
  std::array<PreparedRobot, 2> robots;
  InterArmWorld between;
  std::optional<std::size_t> given_arm;
  std::vector<TrajectoryRow> given_rows;

  Impl(const Workcell& cell, const Budget& budget)
      : names{cell.arms[0].name, cell.arms[1].name},
        problems(problems_of_arms(cell, budget)),
        robots{PreparedRobot(problems[0], budget), PreparedRobot(problems[1], budget)},
        between(*cell.arms[0].model,
                {ArmInPair{&robots[0].arm(), &cell.arms[0].attached},
                 ArmInPair{&robots[1].arm(), &cell.arms[1].attached}},
                cell.may_touch, stricter(cell.arms[0].limits, cell.arms[1].limits), budget),
        given_arm(cell.given_arm()) {
    if (!given_arm) return;
    const PreparedRobot& robot = robots[*given_arm];
    given_rows = rows_along(cell.arms[*given_arm].given,
                            path_within_scale(problems[*given_arm], robot.arm().chain, budget));
    given_rows = complete_rows(robot, problems[*given_arm], std::move(given_rows),
                               Stated{.phi = false, .branch = false}, budget);
  }
};

namespace {

const Workcell& checked(const Workcell& cell) {
  validate(cell);
  return cell;
}

}  // namespace

PreparedWorkcell::PreparedWorkcell(const Workcell& cell, const Budget& budget)
    : impl_(std::make_unique<const Impl>(checked(cell), budget)) {}
PreparedWorkcell::~PreparedWorkcell() = default;
PreparedWorkcell::PreparedWorkcell(PreparedWorkcell&&) noexcept = default;
PreparedWorkcell& PreparedWorkcell::operator=(PreparedWorkcell&&) noexcept = default;

const std::string& PreparedWorkcell::name(std::size_t arm) const {
  return impl_->names[arm];
}
const Problem& PreparedWorkcell::problem(std::size_t arm) const {
  return impl_->problems[arm];
}
const PreparedRobot& PreparedWorkcell::robot(std::size_t arm) const {
  return impl_->robots[arm];
}
const InterArmWorld& PreparedWorkcell::between() const {
  return impl_->between;
}
std::optional<std::size_t> PreparedWorkcell::given_arm() const {
  return impl_->given_arm;
}
const std::vector<TrajectoryRow>& PreparedWorkcell::given_rows() const {
  return impl_->given_rows;
}

}  // namespace swivel
