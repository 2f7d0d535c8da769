// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "swivel/core/invalid_argument.hpp"
#include "swivel/core/validate.hpp"
#include "swivel/planner/prepared_robot.hpp"

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

PreparedRobot::PreparedRobot(const Problem& problem, const Budget& budget)
    : basis_(checked(problem)),
      arm_(build_arm(*problem.model, problem.base_link, problem.tip_link, problem.hold, problem.tool)),
      srs_(fit_srs(arm_.chain, problem.model->source)),
      world_(*problem.model, arm_, problem, budget),
      radii_(motion_radii(arm_.chain, world_.bodies())) {}

PreparedRobot::PreparedRobot(const PreparedRobot& like, const Problem& problem, const Budget& budget)
    : basis_(checked(problem)),
      arm_(like.arm_),
      srs_(like.srs_),
      world_(like.world_, *problem.model, arm_, problem, budget),
      radii_(motion_radii(arm_.chain, world_.bodies())) {}

void PreparedRobot::require_prepared_for(const Problem& problem) const {
  const auto require = [&](bool holds, const char* what) {
    if (!holds)
      throw InvalidArgument(problem.source + ": " + what +
                            " differs from what the robot was prepared for: allowed is a PreparedRobot made of this problem");
  };
  require(problem.model == basis_.model, "model");
  require(problem.base_link == basis_.base_link, "base_link");
  require(problem.tip_link == basis_.tip_link, "tip_link");
  require(problem.tool.matrix() == basis_.tool.matrix(), "tool");
  require(problem.hold == basis_.hold, "hold");
  require(std::equal(problem.attached.begin(), problem.attached.end(), basis_.attached.begin(), basis_.attached.end(), same),
          "attached");
}

}  // namespace swivel
