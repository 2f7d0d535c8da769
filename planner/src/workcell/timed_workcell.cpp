// SPDX-License-Identifier: BSD-3-Clause
#include "workcell/timed_workcell.hpp"

#include <algorithm>
#include <limits>

#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "workcell/prepared/arm_problems.hpp"

namespace swivel {

namespace {

double turn_from(const Pose& a, const Pose& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

/// Returns the pose of the follower's tool in the frame of the leader's, as joints have turned it.
Pose on_real_leader(const PreparedWorkcell& prepared, const std::array<Config, 2>& q) {
  const auto follower = static_cast<std::size_t>(prepared.follower());
  return turned_tool(prepared.robot(1 - follower).arm().chain, q[1 - follower]).inverse() *
         prepared.robot(follower).arm().chain.tool(q[follower]);
}

FollowerError error_between(const Pose& there, const Pose& tool) {
  return {(tool.translation() - there.translation()).norm(), turn_from(there, tool)};
}

}  // namespace

void require_motion_defaults(const PreparedWorkcell& prepared) {
  for (std::size_t k = 0; k < 2; ++k)
    if (!prepared.problem(k).smooth && static_cast<int>(k) != prepared.follower())
      throw InvalidArgument(
          "the workcell has no motion defaults: allowed for motions are those of "
          "with_motion_defaults()");
}

void require_tool_speed_of_arms(const PreparedWorkcell& prepared, double speed) {
  const Chain &one = prepared.robot(0).arm().chain, &other = prepared.robot(1).arm().chain;
  require_tool_speed(most_reach(one) > most_reach(other) ? one : other, speed, "speed");
}

FollowerError follower_error(const PreparedWorkcell& prepared, const std::array<Config, 2>& q,
                             int layer) {
  return error_between(prepared.on_leader(layer), on_real_leader(prepared, q));
}

FollowerMeter::FollowerMeter(const PreparedWorkcell& prepared, const Budget& budget)
    : prepared_(&prepared),
      follower_(static_cast<std::size_t>(prepared.follower())),
      path_(problem_path(prepared.problem(1 - follower_), prepared.robot(1 - follower_).arm().chain,
                         budget, PathSmoothing{})) {}

FollowerError FollowerMeter::at(const std::array<Config, 2>& q, double leader_s) const {
  constexpr double kSame = 1e-6;  // m
  const Pose leader = prepared_->robot(1 - follower_).arm().chain.tool(q[1 - follower_]);
  const Pose tool = on_real_leader(*prepared_, q);
  FollowerError least{std::numeric_limits<double>::infinity(),
                      std::numeric_limits<double>::infinity()};
  for (int i = 0; i + 1 < path_.size(); ++i) {
    const PathLayer& from = path_.layer(i);
    if (leader_s < from.s - kSame || leader_s > from.s + from.step_length + kSame) continue;
    // Where the path only turns, s repeats: the orientation tells the place.
    const double share = from.step_length > 0 ? (leader_s - from.s) / from.step_length
                         : from.step_angle > 0
                             ? turn_from(path_.at_travel(from.travel), leader) / from.step_angle
                             : 0;
    const Pose there = prepared_->on_leader(i + std::clamp(share, 0.0, 1.0));
    const FollowerError error = error_between(there, tool);
    if (error.position + error.angle < least.position + least.angle) least = error;
  }
  return least;
}

}  // namespace swivel
