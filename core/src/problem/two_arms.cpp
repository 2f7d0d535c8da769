// SPDX-License-Identifier: BSD-3-Clause
#include "problem/two_arms.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/validate.hpp"

namespace swivel {

namespace {

void require(bool holds, const std::string& what) {
  if (!holds) throw InvalidArgument("arms: " + what);
}

void validate_names(const Problem& cell) {
  for (std::size_t k = 0; k < 2; ++k) {
    const ArmTask& arm = cell.arms[k];
    require(!arm.name.empty(), "name: allowed are non-empty names");
    require(arm.name != arm.base_link &&
                std::none_of(cell.scene.begin(), cell.scene.end(),
                             [&](const SceneObject& object) { return object.name == arm.name; }),
            "name '" + arm.name +
                "' is taken by the base link or a scene object: allowed are new names");
  }
  require(cell.arms[0].name != cell.arms[1].name,
          "name '" + cell.arms[0].name + "' is taken: allowed are new names");
  for (const AttachedBody& one : cell.arms[0].attached)
    for (const AttachedBody& other : cell.arms[1].attached)
      require(one.name != other.name,
              "attached: '" + one.name + "' is on both arms: allowed are names of their own");
}

/// Returns the scene without what it allows to bodies that are attached to the other arm.
std::vector<SceneObject> scene_of(const Problem& cell, std::size_t arm) {
  std::vector<SceneObject> scene = cell.scene;
  const std::vector<AttachedBody>& others = cell.arms[1 - arm].attached;
  for (SceneObject& object : scene)
    std::erase_if(object.allow, [&](const Allowed& allowed) {
      return std::any_of(others.begin(), others.end(),
                         [&](const AttachedBody& body) { return body.name == allowed.body; });
    });
  return scene;
}

void validate_given(const Problem& cell, std::size_t number) {
  const ArmTask &arm = cell.arms[number], &other = cell.arms[1 - number];
  require(other.given.empty(), "given: both motions are given: allowed is one");
  require(arm.given.size() >= 2, "given: 1 row: allowed are two or more");
  for (std::size_t row = 0; row < arm.given.size(); ++row)
    require(arm.given[row].allFinite(),
            "given: row " + std::to_string(row) + ": allowed are finite joints");
  require(arm.path().waypoints.empty() && !arm.path().start && !arm.path().end &&
              !arm.path().smooth && cell.leader_of(number) < 0,
          "waypoints, start, end, smooth, path_frame: allowed for an arm whose motion is given are "
          "none");
  require(!arm.roll || arm.roll->circle(),
          "roll: allowed for an arm whose motion is given is a whole turn, of six joints, or none");
  const std::size_t last = arm.given.size() - 1, waypoints = other.path().waypoints.size();
  if (other.path().steps.empty()) {
    require(waypoints == 2 || waypoints == arm.given.size(),
            "waypoints: " + std::to_string(waypoints) + ", and the given motion has " +
                std::to_string(arm.given.size()) +
                " rows: allowed are two, one for each row, or `steps` that say at which rows they "
                "are");
    return;
  }
  const auto sum =
      std::accumulate(other.path().steps.begin(), other.path().steps.end(), std::int64_t{0});
  require(sum == static_cast<std::int64_t>(last), "steps: together " + std::to_string(sum) +
                                                      ": allowed are " + std::to_string(last) +
                                                      ", since the given motion ends then");
}

/// Refuses a leader whose tool would not be where its path says: nobody knows then where its
/// follower must go before the leader is planned.
void validate_leader(const ArmTask& leader, const std::string& follower) {
  require(!leader.roll, "roll: '" + leader.name + "' leads '" + follower +
                            "', whose path would turn with its tool: allowed for a leader is no "
                            "roll, or a motion that is given");
  require(!leader.path().start_at && leader.path().start_tolerance <= Task().start_tolerance,
          "start_at, start_tolerance: '" + leader.name + "' leads '" + follower +
              "': allowed for a leader are the start of its path and the default tolerance");
}

/// Returns the problem of an arm by itself, for its validation. An arm whose motion is given takes
/// the other arm's waypoints for this.
PathProblem alone(const Problem& cell, std::size_t number) {
  const ArmTask& arm = cell.arms[number];
  PathProblem problem = problem_of_path(cell, arm, arm.path());
  problem.scene = scene_of(cell, number);
  problem.source =
      cell.source.empty() ? "arm '" + arm.name + "'" : cell.source + ": arm '" + arm.name + "'";
  if (!arm.given.empty()) problem.waypoints = cell.arms[1 - number].path().waypoints;
  if (cell.leader_of(number) >= 0) problem.path_frame.clear();
  return problem;
}

}  // namespace

void validate_two_arms(const Problem& cell) {
  for (const ArmTask& arm : cell.arms)
    require(is_path_alone(arm), "strokes: allowed is one path for each of two arms");
  validate_names(cell);
  const ArmTask &first = cell.arms[0], &second = cell.arms[1];
  require(first.model == second.model, "model: allowed is one model for both arms");
  require(first.base_link == second.base_link, "base_link: allowed is one for both arms");
  require(first.hold == second.hold, "hold: allowed is one for both arms");
  require(cell.leader_of(0) < 0 || cell.leader_of(1) < 0,
          "path_frame: the arms lead each other: allowed is one leader");
  const auto given = cell.given_arm();
  if (given) validate_given(cell, *given);
  require(given || first.path().waypoints.size() == second.path().waypoints.size(),
          "waypoints: " + std::to_string(first.path().waypoints.size()) + " and " +
              std::to_string(second.path().waypoints.size()) +
              ": allowed is the same number for both arms, since they are at them at one time");
  for (std::size_t k = 0; k < 2; ++k) {
    const ArmTask& arm = cell.arms[k];
    if (cell.leader_of(k) >= 0 && given != 1 - k) validate_leader(cell.arms[1 - k], arm.name);
    require(!arm.path().smooth || cell.leader_of(k) < 0,
            "smooth: allowed for a follower is none: it keeps to the leader's curve");
    require(arm.path().rolls.empty() && (arm.path().steps.empty() || given == 1 - k),
            "rolls, steps: allowed are none");
    for (const Waypoint& waypoint : arm.path().waypoints)
      require(!waypoint.roll,
              "waypoints: roll: allowed in a workcell is the roll of the whole path");
    validate(alone(cell, k));
  }
}

}  // namespace swivel
