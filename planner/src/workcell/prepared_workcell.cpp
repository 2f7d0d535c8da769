// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>

#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
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

}  // namespace

struct PreparedWorkcell::Impl {
  std::array<std::string, 2> names;
  std::array<Problem, 2> problems;
  std::array<PreparedRobot, 2> robots;
  InterArmWorld between;

  Impl(const Workcell& cell, const Budget& budget)
      : names{cell.arms[0].name, cell.arms[1].name},
        problems(problems_of_arms(cell, budget)),
        robots{PreparedRobot(problems[0], budget), PreparedRobot(problems[1], budget)},
        between(*cell.arms[0].model,
                {ArmInPair{&robots[0].arm(), &cell.arms[0].attached},
                 ArmInPair{&robots[1].arm(), &cell.arms[1].attached}},
                cell.may_touch, stricter(cell.arms[0].limits, cell.arms[1].limits), budget) {}
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

}  // namespace swivel
