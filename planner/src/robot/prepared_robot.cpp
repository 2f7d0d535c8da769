// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/robot/prepared_robot.hpp"

#include <algorithm>
#include <utility>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/planner/robot/planning_arm.hpp"

namespace swivel {

namespace {

bool same(const AttachedBody& a, const AttachedBody& b) {
  return a.name == b.name && a.shape == b.shape && a.pose.matrix() == b.pose.matrix() &&
         a.link == b.link;
}

/// Returns the robot of a problem. Throws for what validate() refuses.
const Robot& checked(const PathProblem& problem) {
  validate(problem);
  validate(*problem.model);
  return problem;
}

}  // namespace

PlanningArm planning_arm(const Robot& robot) {
  ArmModel model =
      build_arm(*robot.model, robot.base_link, robot.tip_link, robot.hold, robot.tool, robot.roll);
  ArmClass kind = classify(model.chain, robot.model->source);
  return {std::move(model), std::move(kind)};
}

struct PreparedRobot::Impl {
  Impl(const PathProblem& problem, PlanningArm of, const Budget& budget)
      : basis(problem),
        arm(std::move(of)),
        world(*problem.model, arm.model, problem, budget),
        radii(motion_radii(arm.model.chain, world.bodies())) {}
  Impl(const Impl& like, const PathProblem& problem, const Budget& budget)
      : basis(checked(problem)),
        arm(like.arm),
        world(like.world, *problem.model, arm.model, problem, budget),
        radii(motion_radii(arm.model.chain, world.bodies())) {}

  Robot basis;  // holds the model, so that no other takes its address
  PlanningArm arm;
  World world;
  std::array<double, kDof> radii;
};

PreparedRobot::PreparedRobot(const PathProblem& problem, PlanningArm arm, const Budget& budget)
    : impl_(std::make_unique<const Impl>(problem, std::move(arm), budget)) {}

PreparedRobot::PreparedRobot(const PathProblem& problem, const Budget& budget)
    : PreparedRobot(problem, planning_arm(checked(problem)), budget) {}

PreparedRobot::PreparedRobot(const PreparedRobot& like, const PathProblem& problem,
                             const Budget& budget)
    : impl_(std::make_unique<const Impl>(*like.impl_, problem, budget)) {}

PreparedRobot::~PreparedRobot() = default;
PreparedRobot::PreparedRobot(PreparedRobot&&) noexcept = default;
PreparedRobot& PreparedRobot::operator=(PreparedRobot&&) noexcept = default;

const ArmModel& PreparedRobot::arm() const {
  return impl_->arm.model;
}
const ArmClass& PreparedRobot::arm_class() const {
  return impl_->arm.kind;
}
const std::array<double, kDof>& PreparedRobot::radii() const {
  return impl_->radii;
}
const World& PreparedRobot::world() const {
  return impl_->world;
}

const SrsArm& PreparedRobot::srs(const char* what) const {
  if (!impl_->arm.kind.srs)
    throw InputError(impl_->basis.model->source,
                     impl_->arm.kind.not_srs + ": allowed for " + what +
                         " are arms with a spherical shoulder and wrist");
  return *impl_->arm.kind.srs;
}

const char* PreparedRobot::difference_from(const Robot& robot) const {
  const Robot& own = impl_->basis;
  if (robot.model != own.model) return "model";
  if (robot.base_link != own.base_link) return "base_link";
  if (robot.tip_link != own.tip_link) return "tip_link";
  if (robot.tool.matrix() != own.tool.matrix()) return "tool";
  if (robot.hold != own.hold) return "hold";
  if (robot.roll != own.roll) return "roll";
  if (!std::equal(robot.attached.begin(), robot.attached.end(), own.attached.begin(),
                  own.attached.end(), same))
    return "attached";
  return nullptr;
}

void PreparedRobot::require_prepared_for(const PathProblem& problem) const {
  if (const char* const what = difference_from(problem))
    throw InvalidArgument((problem.source.empty() ? "" : problem.source + ": ") + what +
                          " differs from what the robot was prepared for: allowed is a "
                          "PreparedRobot made of this problem");
}

}  // namespace swivel
