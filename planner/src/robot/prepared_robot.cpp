// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/validate.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

namespace {

bool same(const AttachedBody& a, const AttachedBody& b) {
  return a.name == b.name && a.shape == b.shape && a.pose.matrix() == b.pose.matrix() && a.link == b.link;
}

/// The robot of a problem that makes sense.
const Robot& checked(const Problem& problem) {
  validate(problem);
  validate(*problem.model);
  return problem;
}

}  // namespace

PlanningArm planning_arm(const Robot& robot) {
  ArmModel model = build_arm(*robot.model, robot.base_link, robot.tip_link, robot.hold, robot.tool, robot.roll);
  ArmClass kind = classify(model.chain, robot.model->source);
  return {std::move(model), std::move(kind)};
}

PreparedRobot::PreparedRobot(const Problem& problem, PlanningArm arm, const Budget& budget)
    : basis_(problem),
      arm_(std::move(arm)),
      world_(*problem.model, arm_.model, problem, budget),
      radii_(motion_radii(arm_.model.chain, world_.bodies())) {}

PreparedRobot::PreparedRobot(const Problem& problem, const Budget& budget)
    : PreparedRobot(problem, planning_arm(checked(problem)), budget) {}

PreparedRobot::PreparedRobot(const PreparedRobot& like, const Problem& problem, const Budget& budget)
    : basis_(checked(problem)),
      arm_(like.arm_),
      world_(like.world_, *problem.model, arm_.model, problem, budget),
      radii_(motion_radii(arm_.model.chain, world_.bodies())) {}

const SrsArm& PreparedRobot::srs(const char* what) const {
  if (!arm_.kind.srs)
    throw InputError(basis_.model->source,
                     arm_.kind.not_srs + ": allowed for " + what + " are arms with a spherical shoulder and wrist");
  return *arm_.kind.srs;
}

void PreparedRobot::require_prepared_for(const Problem& problem) const {
  const auto require = [&](bool holds, const char* what) {
    if (!holds)
      throw InvalidArgument((problem.source.empty() ? "" : problem.source + ": ") + what +
                            " differs from what the robot was prepared for: allowed is a PreparedRobot made of this problem");
  };
  require(problem.model == basis_.model, "model");
  require(problem.base_link == basis_.base_link, "base_link");
  require(problem.tip_link == basis_.tip_link, "tip_link");
  require(problem.tool.matrix() == basis_.tool.matrix(), "tool");
  require(problem.hold == basis_.hold, "hold");
  require(problem.roll == basis_.roll, "roll");
  require(std::equal(problem.attached.begin(), problem.attached.end(), basis_.attached.begin(), basis_.attached.end(), same),
          "attached");
}

}  // namespace swivel
