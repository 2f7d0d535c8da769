// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/problem/workcell.hpp"

#include <algorithm>

#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/problem/validate.hpp"

namespace swivel {

namespace {

void require(bool holds, const std::string& what) {
  if (!holds) throw InvalidArgument("arms: " + what);
}

void validate_names(const Workcell& cell) {
  for (std::size_t k = 0; k < 2; ++k) {
    const WorkcellArm& arm = cell.arms[k];
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
std::vector<SceneObject> scene_of(const Workcell& cell, std::size_t arm) {
  std::vector<SceneObject> scene = cell.scene;
  const std::vector<AttachedBody>& others = cell.arms[1 - arm].attached;
  for (SceneObject& object : scene)
    std::erase_if(object.allow, [&](const Allowed& allowed) {
      return std::any_of(others.begin(), others.end(),
                         [&](const AttachedBody& body) { return body.name == allowed.body; });
    });
  return scene;
}

}  // namespace

void validate(const Workcell& cell) {
  validate_names(cell);
  const WorkcellArm &first = cell.arms[0], &second = cell.arms[1];
  require(first.model == second.model, "model: allowed is one model for both arms");
  require(first.base_link == second.base_link, "base_link: allowed is one for both arms");
  require(first.hold == second.hold, "hold: allowed is one for both arms");
  require(cell.leader_of(0) < 0 || cell.leader_of(1) < 0,
          "path_frame: the arms lead each other: allowed is one leader");
  require(first.waypoints.size() == second.waypoints.size(),
          "waypoints: " + std::to_string(first.waypoints.size()) + " and " +
              std::to_string(second.waypoints.size()) +
              ": allowed is the same number for both arms, since they are at them at one time");
  for (std::size_t k = 0; k < 2; ++k) {
    const WorkcellArm& arm = cell.arms[k];
    require(!arm.smooth || cell.leader_of(k) < 0,
            "smooth: allowed for a follower is none: it keeps to the leader's curve");
    require(arm.rolls.empty() && arm.steps.empty(), "rolls, steps: allowed are none");
    for (const Waypoint& waypoint : arm.waypoints)
      require(!waypoint.roll,
              "waypoints: roll: allowed in a workcell is the roll of the whole path");
    Problem alone;
    static_cast<Robot&>(alone) = arm;
    static_cast<Task&>(alone) = arm;
    alone.scene = scene_of(cell, k);
    alone.vary = cell.vary;
    alone.source =
        cell.source.empty() ? "arm '" + arm.name + "'" : cell.source + ": arm '" + arm.name + "'";
    if (cell.leader_of(k) >= 0) alone.path_frame.clear();
    validate(alone);
  }
}

}  // namespace swivel
