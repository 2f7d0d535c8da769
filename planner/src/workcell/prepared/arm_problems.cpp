// SPDX-License-Identifier: BSD-3-Clause
#include "workcell/prepared/arm_problems.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

namespace {

/// Returns the models of both arms in the whole robot. Throws InputError where a joint or a link is
/// of both.
std::array<ArmModel, 2> arms_of(const Problem& cell) {
  const auto build = [](const ArmTask& arm) {
    return build_arm(*arm.model, arm.base_link, arm.tip_link, arm.hold, arm.tool, arm.roll);
  };
  std::array<ArmModel, 2> arms{build(cell.arms[0]), build(cell.arms[1])};
  for (std::size_t l = 0; l < arms[0].links.size(); ++l)
    if (arms[0].links[l].group != 0 && arms[1].links[l].group != 0)
      throw InputError(cell.source, "arms: link '" + cell.arms[0].model->links[l].name +
                                        "' moves with both arms: allowed are arms that have no "
                                        "joint in common; `hold` holds a torso");
  return arms;
}

/// Returns a robot model without the collision shapes of the links that an arm moves.
std::shared_ptr<const RobotModel> without_shapes_of(const RobotModel& model, const ArmModel& arm) {
  auto left = std::make_shared<RobotModel>(model);
  for (std::size_t l = 0; l < left->links.size(); ++l)
    if (arm.links[l].group != 0) left->links[l].collision.clear();
  return left;
}

/// Returns the scene without what it allows to bodies that the other arm carries or moves.
std::vector<SceneObject> scene_of(const Problem& cell, std::size_t arm, const ArmModel& other) {
  std::vector<SceneObject> scene = cell.scene;
  const std::vector<AttachedBody>& carried = cell.arms[1 - arm].attached;
  for (SceneObject& object : scene)
    std::erase_if(object.allow, [&](const Allowed& allowed) {
      const int link = cell.arms[arm].model->find_link(allowed.body);
      return (link >= 0 && other.links[static_cast<std::size_t>(link)].group != 0) ||
             std::any_of(carried.begin(), carried.end(),
                         [&](const AttachedBody& body) { return body.name == allowed.body; });
    });
  return scene;
}

/// Returns the problem of an arm by itself, but for its path. `other` is the other arm.
PathProblem problem_of(const Problem& cell, std::size_t arm, const ArmModel& other) {
  PathProblem problem = problem_of_path(cell, cell.arms[arm], cell.arms[arm].path());
  problem.model = without_shapes_of(*cell.arms[arm].model, other);
  problem.scene = scene_of(cell, arm, other);
  problem.source = cell.source.empty() ? "arm '" + cell.arms[arm].name + "'"
                                       : cell.source + ": arm '" + cell.arms[arm].name + "'";
  return problem;
}

bool turns_freely(const PathProblem& problem) {
  return problem.roll && problem.roll->circle();
}

ToolPath path_of(const PathProblem& problem, const std::vector<Waypoint>& waypoints,
                 const std::vector<int>& steps, const Budget& budget) {
  return ToolPath(waypoints, problem.resolution, problem.source, budget, problem.smooth,
                  turns_freely(problem), steps);
}

/// Makes each entry of `steps` at least that of `more`.
void raise(std::vector<int>& steps, const std::vector<int>& more) {
  for (std::size_t k = 0; k < steps.size(); ++k) steps[k] = std::max(steps[k], more[k]);
}

Waypoint waypoint_at(const Pose& tool) {
  Waypoint waypoint;
  waypoint.position = tool.translation();
  waypoint.orientation = Quaterniond(tool.linear()).normalized();
  return waypoint;
}

/// Returns the poses of a follower's tool in the leader's tool frame, one at each layer. `steps`:
/// those of both paths between waypoints.
std::vector<Pose> at_layers(const std::vector<Waypoint>& on_tool, const std::vector<int>& steps) {
  std::vector<Pose> poses{pose_between(on_tool[0], on_tool[1], 0)};
  for (std::size_t k = 0; k < steps.size(); ++k)
    for (int step = 1; step <= steps[k]; ++step)
      poses.push_back(
          pose_between(on_tool[k], on_tool[k + 1], static_cast<double>(step) / steps[k]));
  return poses;
}

/// Returns the waypoints of a follower, one at each layer, in the base frame: each is the leader's
/// tool at that layer times the follower's pose in the frame of that tool.
std::vector<Waypoint> carried(const ToolPath& leader, const std::vector<Pose>& on_tool) {
  std::vector<Waypoint> waypoints;
  for (const Pose& pose : on_tool)
    waypoints.push_back(waypoint_at(leader.layer(static_cast<int>(waypoints.size())).tool * pose));
  return waypoints;
}

/// Returns by how much more steps each of `steps` needs so that no step of a follower's path in the
/// base frame is longer than its resolution says; all 1 where none is.
std::vector<int> too_long(const std::vector<Waypoint>& carried, const std::vector<int>& steps,
                          const Resolution& resolution, const std::string& source) {
  const std::vector<int> needed = steps_between(carried, resolution, source);
  std::vector<int> times(steps.size(), 1);
  std::size_t layer = 0;
  for (std::size_t k = 0; k < steps.size(); ++k)
    for (int step = 0; step < steps[k]; ++step) times[k] = std::max(times[k], needed[layer++]);
  return times;
}

/// Cuts the paths of a leader and its follower into as many steps each, and gives the follower its
/// path in the base frame. Returns the follower's waypoints in the leader's tool frame.
std::vector<Waypoint> follow(PathProblem& leader, PathProblem& follower, const Budget& budget) {
  const auto carrying = given_waypoints_in_base(leader);
  follower.path_frame = follower.base_link;
  const auto on_tool = waypoints_in_base(follower);  // in the leader's tool frame
  std::vector<int> steps =
      steps_between(carrying, leader.resolution, leader.source, turns_freely(leader));
  raise(steps,
        steps_between(on_tool, follower.resolution, follower.source, turns_freely(follower)));
  for (;;) {
    const std::vector<Waypoint> waypoints =
        carried(path_of(leader, carrying, steps, budget), at_layers(on_tool, steps));
    const std::vector<int> times = too_long(waypoints, steps, follower.resolution, follower.source);
    if (std::all_of(times.begin(), times.end(), [](int n) { return n == 1; })) {
      follower.waypoints = waypoints;
      follower.steps.assign(waypoints.size() - 1, 1);
      break;
    }
    for (std::size_t k = 0; k < steps.size(); ++k) steps[k] *= times[k];
  }
  leader.steps = std::move(steps);
  return on_tool;
}

/// Cuts the paths of two arms into as many steps each.
void cut_alike(std::array<PathProblem, 2>& problems, const Budget& budget) {
  std::vector<int> steps(problems[0].waypoints.size() - 1, 1);
  for (const PathProblem& problem : problems)
    raise(steps, steps_between(waypoints_in_base(problem), problem.resolution, problem.source,
                               turns_freely(problem)));
  for (PathProblem& problem : problems) {
    problem.steps = steps;
    static_cast<void>(path_of(problem, waypoints_in_base(problem), steps, budget));  // or throws
  }
}

/// Returns the waypoints of a given motion, one for each row: where its tool is, in the base frame.
/// Throws InputError for a row at which the tool is where it was at the row before, or turned by
/// 180 deg.
std::vector<Waypoint> waypoints_of_rows(const Chain& chain, const std::vector<Config>& rows,
                                        const std::string& source) {
  constexpr double kSamePlace = 1e-9;  // m and rad
  std::vector<Waypoint> waypoints;
  for (const Config& q : rows) {
    const Waypoint waypoint = waypoint_at(chain.tool(q));
    const std::size_t row = waypoints.size();
    if (row > 0) {
      const Waypoint& before = waypoints.back();
      const double angle = before.orientation.angularDistance(waypoint.orientation);
      if ((before.position - waypoint.position).norm() <= kSamePlace && angle <= kSamePlace)
        throw InputError(source, formatted("given motion: row %zu: the tool is where it is at the "
                                           "row before: allowed is a tool that moves on",
                                           row));
      if (angle > kPi - 1e-6)
        throw InputError(source, formatted("given motion: row %zu: the tool turns by 180 deg from "
                                           "the row before: allowed is less",
                                           row));
    }
    waypoints.push_back(waypoint);
  }
  return waypoints;
}

/// Gives an arm the path that its given rows lead its tool along, with a layer at each row. Limits
/// of the tool's path are those of a leader, whose follower keeps to it; else there is none.
void lay_along_rows(PathProblem& problem, const ArmTask& arm, const Chain& chain, bool leads) {
  problem.waypoints = waypoints_of_rows(chain, arm.given, problem.source);
  problem.steps.assign(arm.given.size() - 1, 1);
  problem.path_frame = problem.base_link;
  if (!leads) problem.limits.tool_path_error = problem.limits.tool_angle_error = std::nullopt;
}

/// Cuts the path of an arm beside a given motion into steps that end where those of the motion do.
/// `steps` of the problem says how, or is empty (Problem).
void cut_along(std::size_t rows, PathProblem& planned) {
  if (!planned.steps.empty()) return;
  if (planned.waypoints.size() == rows)
    planned.steps.assign(rows - 1, 1);
  else
    planned.steps = {static_cast<int>(rows - 1)};
}

/// Gives the follower of a given motion its path in the base frame, at the tool of each row as the
/// joints have turned it. `chain`: of the leader. Returns the follower's waypoints in the leader's
/// tool frame, one for each row.
std::vector<Waypoint> follow_rows(const PathProblem& leader, const Chain& chain,
                                  const std::vector<Config>& rows, PathProblem& follower,
                                  const Budget& budget) {
  std::vector<Waypoint> tools, waypoints;
  for (const Config& q : rows) tools.push_back(waypoint_at(turned_tool(chain, q)));
  follower.path_frame = follower.base_link;
  const std::vector<Pose> on_tool = at_layers(waypoints_in_base(follower), follower.steps);
  follower.waypoints = carried(path_of(leader, tools, leader.steps, budget), on_tool);
  follower.steps = leader.steps;
  for (const Pose& pose : on_tool) waypoints.push_back(waypoint_at(pose));
  return waypoints;
}

}  // namespace

Pose pose_between(const Waypoint& from, const Waypoint& to, double t) {
  Pose pose = Pose::Identity();
  pose.translation() = from.position + t * (to.position - from.position);
  pose.linear() = from.orientation.slerp(t, to.orientation).toRotationMatrix();
  return pose;
}

Pose turned_tool(const Chain& chain, const Config& q) {
  const Pose tool = chain.tool(q);
  return chain.roll ? rolled(tool, q[kDof - 1]) : tool;
}

ArmProblems problems_of_arms(const Problem& cell, const Budget& budget) {
  const std::array<ArmModel, 2> arms = arms_of(cell);
  ArmProblems of_arms{{problem_of(cell, 0, arms[1]), problem_of(cell, 1, arms[0])}, {}};
  std::array<PathProblem, 2>& problems = of_arms.problems;
  for (std::size_t k = 0; k < 2; ++k)
    if (arms[k].chain.free_roll)
      throw InputError(problems[k].source,
                       "path.roll: of an arm with an arm angle: allowed in a workcell are arms of "
                       "six joints with a roll, or none");
  for (std::size_t k = 0; k < 2; ++k)
    if (const int slide = arms[k].chain.slide(); slide >= 0)
      throw InputError(problems[k].source,
                       "joint '" + arms[k].chain.joint_names[static_cast<std::size_t>(slide)] +
                           "' is prismatic: allowed in a workcell are arms whose joints turn: "
                           "hold it by its `hold`");
  if (const auto given = cell.given_arm()) {
    const std::size_t planned = 1 - *given;
    const bool follows = cell.leader_of(planned) >= 0;
    const std::vector<Config>& rows = cell.arms[*given].given;
    lay_along_rows(problems[*given], cell.arms[*given], arms[*given].chain, follows);
    cut_along(rows.size(), problems[planned]);
    if (follows)
      of_arms.on_leader =
          follow_rows(problems[*given], arms[*given].chain, rows, problems[planned], budget);
    // Throws for a path that has no such steps.
    static_cast<void>(path_of(problems[planned], waypoints_in_base(problems[planned]),
                              problems[planned].steps, budget));
    return of_arms;
  }
  for (std::size_t k = 0; k < 2; ++k)
    if (cell.leader_of(k) >= 0) {
      of_arms.on_leader = follow(problems[1 - k], problems[k], budget);
      return of_arms;
    }
  cut_alike(problems, budget);
  return of_arms;
}

}  // namespace swivel
