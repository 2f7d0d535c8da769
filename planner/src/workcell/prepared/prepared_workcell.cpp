// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/core/answer/stated.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/complete_rows.hpp"
#include "swivel/planner/workcell/prepared/prepared_workcell.hpp"
#include "verify/between_samples.hpp"
#include "workcell/prepared/arm_problems.hpp"

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

/// Returns rows with joints `q` at the layers of a path.
std::vector<TrajectoryRow> rows_along(const std::vector<Config>& q, const ToolPath& path) {
  std::vector<TrajectoryRow> rows;
  for (int layer = 0; layer < path.size(); ++layer)
    rows.push_back({.s = path.layer(layer).s, .q = q[static_cast<std::size_t>(layer)]});
  return rows;
}

}  // namespace

struct PreparedWorkcell::Impl {
  std::array<std::string, 2> names;
  int follower;
  std::shared_ptr<const RobotModel> model;  // of the whole robot
  std::vector<std::array<std::string, 2>> may_touch;
  ArmProblems of_arms;
  const std::array<PathProblem, 2>& problems;
  std::array<std::shared_ptr<const PreparedRobot>, 2> robots;  // shared by workcells alike
  InterArmWorld between;
  std::optional<std::size_t> given_arm;
  std::vector<TrajectoryRow> given_rows;

  /// `like`: a workcell whose robots are taken where they are the same; or null.
  Impl(const Impl* like, const Problem& cell, const Budget& budget)
      : names{cell.arms[0].name, cell.arms[1].name},
        follower(cell.leader_of(0) >= 0   ? 0
                 : cell.leader_of(1) >= 0 ? 1
                                          : -1),
        model(cell.arms[0].model),
        may_touch(cell.may_touch),
        of_arms(problems_of_arms(cell, budget)),
        problems(of_arms.problems),
        robots(robots_of(like, budget)),
        between(world(problems[0].limits, problems[1].limits, budget)),
        given_arm(cell.given_arm()) {
    if (!given_arm) return;
    const PreparedRobot& robot = *robots[*given_arm];
    given_rows = rows_along(cell.arms[*given_arm].given,
                            path_within_scale(problems[*given_arm], robot.arm().chain, budget));
    given_rows = complete_rows(robot, problems[*given_arm], std::move(given_rows),
                               Stated{.phi = false, .branch = false}, budget);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  /// Returns the prepared robots of both arms. Robots whose links an arm moves are those of the
  /// whole model without the other arm's, so that both arms are taken from `like`, or none.
  [[nodiscard]] std::array<std::shared_ptr<const PreparedRobot>, 2> robots_of(
      const Impl* like, const Budget& budget) {
    if (like != nullptr && like->model == model) {
      std::array<PathProblem, 2> same = of_arms.problems;
      for (std::size_t k = 0; k < 2; ++k) same[k].model = like->problems[k].model;
      if (like->robots[0]->difference_from(same[0]) == nullptr &&
          like->robots[1]->difference_from(same[1]) == nullptr) {
        of_arms.problems = std::move(same);
        return like->robots;
      }
    }
    return {std::make_shared<const PreparedRobot>(of_arms.problems[0], budget),
            std::make_shared<const PreparedRobot>(of_arms.problems[1], budget)};
  }

  /// Returns the world between the arms with what their limits keep.
  [[nodiscard]] InterArmWorld world(const Limits& a, const Limits& b, const Budget& budget) const {
    return InterArmWorld(*model,
                         {ArmInPair{&robots[0]->arm(), &problems[0].attached},
                          ArmInPair{&robots[1]->arm(), &problems[1].attached}},
                         may_touch, stricter(a, b), budget);
  }
};

namespace {

const Problem& checked(const Problem& cell) {
  validate(cell);
  return cell;
}

}  // namespace

PreparedWorkcell::PreparedWorkcell(const Problem& cell, const Budget& budget)
    : impl_(std::make_unique<const Impl>(nullptr, checked(cell), budget)) {}
PreparedWorkcell::PreparedWorkcell(const PreparedWorkcell& like, const Problem& cell,
                                   const Budget& budget)
    : impl_(std::make_unique<const Impl>(like.impl_.get(), checked(cell), budget)) {}
PreparedWorkcell::~PreparedWorkcell() = default;
PreparedWorkcell::PreparedWorkcell(PreparedWorkcell&&) noexcept = default;
PreparedWorkcell& PreparedWorkcell::operator=(PreparedWorkcell&&) noexcept = default;

const std::string& PreparedWorkcell::name(std::size_t arm) const {
  return impl_->names[arm];
}
const PathProblem& PreparedWorkcell::problem(std::size_t arm) const {
  return impl_->problems[arm];
}
const PreparedRobot& PreparedWorkcell::robot(std::size_t arm) const {
  return *impl_->robots[arm];
}
const InterArmWorld& PreparedWorkcell::between() const {
  return impl_->between;
}
std::optional<std::size_t> PreparedWorkcell::given_arm() const {
  return impl_->given_arm;
}
const std::vector<TrajectoryRow>& PreparedWorkcell::given_rows() const {
  return impl_->given_rows;
}
InterArmWorld PreparedWorkcell::between_samples(const Budget& budget) const {
  return impl_->world(problem_of_samples(problem(0)).limits, problem_of_samples(problem(1)).limits,
                      budget);
}
int PreparedWorkcell::follower() const {
  return impl_->follower;
}
Pose PreparedWorkcell::on_leader(double layer) const {
  const std::vector<int>& steps = problem(static_cast<std::size_t>(1 - follower())).steps;
  const std::vector<Waypoint>& waypoints = impl_->of_arms.on_leader;
  std::size_t k = 0;
  while (k + 1 < steps.size() && layer >= steps[k]) layer -= steps[k++];
  return pose_between(waypoints[k], waypoints[k + 1], std::clamp(layer / steps[k], 0.0, 1.0));
}

}  // namespace swivel
