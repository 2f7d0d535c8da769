// SPDX-License-Identifier: BSD-3-Clause
#include "world/robot_part.hpp"

#include <algorithm>
#include <random>

#include "world/pair_rules.hpp"

namespace swivel::detail {

namespace {

/// Returns a warning for each joint that moves no collision shape: what it moves is kept clear of
/// nothing.
std::vector<std::string> shapeless_links(const RobotModel& robot, const ArmModel& arm,
                                         const std::vector<RobotBody>& bodies) {
  std::vector<bool> has_shape(kDof + 1 + arm.chain.followers.size());
  for (const RobotBody& body : bodies) has_shape[body.group] = true;
  if (std::find(has_shape.begin() + 1, has_shape.end(), true) == has_shape.end())
    return {robot.name + ": the arm has no collision shape at all: it is kept clear of nothing"};
  std::vector<std::string> warnings;
  // a roll is no joint of the arm
  for (std::size_t group = 1; group <= (arm.chain.roll ? kDof - 1 : kDof); ++group) {
    if (has_shape[group]) continue;
    std::string links;
    for (std::size_t l = 0; l < robot.links.size(); ++l)
      if (arm.links[l].group == static_cast<int>(group))
        links += (links.empty() ? "" : ", ") + robot.links[l].name;
    warnings.push_back(links + ": no collision shape on what joint " +
                       arm.chain.joint_names[group - 1] + " moves: it is kept clear of nothing");
  }
  return warnings;
}

std::vector<CandidatePair> candidates_of(const RobotModel& robot,
                                         const std::vector<RobotBody>& bodies) {
  std::vector<CandidatePair> candidates;
  const auto attached = [&](int i) { return bodies[i].attached; };
  for (const BodyPair& pair : candidate_robot_pairs(robot, bodies))
    candidates.push_back({pair, !robot.has_srdf || attached(pair.a) || attached(pair.b)});
  return candidates;
}

}  // namespace

RobotPart::RobotPart(const RobotModel& robot, const ArmModel& arm, const PathProblem& problem,
                     MeshStore& meshes, const Budget& budget)
    : chain(arm.chain),
      bodies(robot_bodies(robot, arm, problem.attached)),
      followers(follower_motion(chain, bodies)),
      pairs_(candidates_of(robot, bodies)),
      warnings_(shapeless_links(robot, arm, bodies)) {
  for (const RobotBody& body : bodies) {
    budget.poll();
    shapes.push_back(make_fcl_shape(body.shape, meshes));
  }
  pairs_.drop_always_touching(sampled(), budget);
  pairs_.find_medians(sampled(), problem.limits, budget);
}

SampledBodies RobotPart::sampled() const {
  return {bodies, shapes, [this] {
            return [this, random = std::mt19937_64(20141)]() mutable {
              return chain.all_displacements(sampled_config(chain, random));
            };
          }};
}

std::shared_ptr<const RobotPart> RobotPart::for_limits(const std::shared_ptr<const RobotPart>& part,
                                                       const Limits& limits, const Budget& budget) {
  if (part->pairs_.suffices(limits)) return part;
  auto more = std::make_shared<RobotPart>(*part);
  more->pairs_.find_medians(more->sampled(), limits, budget);
  return more;
}

std::vector<RobotPair> RobotPart::pairs_with_medians(const Limits& limits) const {
  RobotPairs all = pairs_;
  all.find_all_medians(sampled());
  return all.pairs(limits);
}

}  // namespace swivel::detail
