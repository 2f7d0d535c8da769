// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "swivel/core/invalid_argument.hpp"
#include "swivel/core/validate.hpp"
#include "swivel/planner/planner.hpp"

namespace swivel {

namespace {

bool same(const AttachedBody& a, const AttachedBody& b) {
  return a.name == b.name && a.shape == b.shape && a.pose.matrix() == b.pose.matrix() && a.link == b.link;
}

}  // namespace

PreparedRobot::Basis::Basis(const Problem& problem) {
  validate(problem);
  validate(*problem.robot);
  model = problem.robot;
  base_link = problem.base_link;
  tip_link = problem.tip_link;
  tool = problem.tool;
  hold = problem.hold;
  attached = problem.attached;
}

PreparedRobot::PreparedRobot(const Problem& problem, const Budget& budget)
    : basis_(problem),
      arm_(build_arm(*problem.robot, problem.base_link, problem.tip_link, problem.hold, problem.tool)),
      srs_(fit_srs(arm_.chain, problem.robot->source)),
      world_(*problem.robot, arm_, problem, budget),
      radii_(motion_radii(arm_.chain, world_.bodies())) {}

void PreparedRobot::require_prepared_for(const Problem& problem) const {
  const auto require = [&](bool holds, const char* what) {
    if (!holds)
      throw InvalidArgument(problem.source + ": " + what +
                            " differs from what the robot was prepared for: allowed is a PreparedRobot made of this problem");
  };
  require(problem.robot == basis_.model, "robot (the model)");
  require(problem.base_link == basis_.base_link, "base_link");
  require(problem.tip_link == basis_.tip_link, "tip_link");
  require(problem.tool.matrix() == basis_.tool.matrix(), "tool");
  require(problem.hold == basis_.hold, "hold");
  require(std::equal(problem.attached.begin(), problem.attached.end(), basis_.attached.begin(), basis_.attached.end(), same),
          "attached");
}

}  // namespace swivel
