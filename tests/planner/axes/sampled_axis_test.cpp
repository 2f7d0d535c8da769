// SPDX-License-Identifier: BSD-3-Clause
// Arms of six joints and one more axis, planned on arcs of self-motion, against a reference that
// samples that axis: closed forms of the six others at values a quarter of the nodes' distance
// apart, and a dynamic program over all pairs of neighbouring layers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "axes_robots.hpp"
#include "inner_posture.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/kinematics/closed_form/closed_form.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

/// An arm and the name of its axis beside the six joints.
struct Case {
  TestRobot robot;
  std::string axis;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const TestRobot& robot : slide_robots()) all.push_back({robot, "slide"});
  TestRobot table = data_robot("kr6_turntable_like");
  table.base_link = "plate";
  table.tip_link = "flange";
  const std::string turn = arm_of(table).chain.joint_names[0];
  all.push_back({table, turn});
  all.push_back({torso_robot(), "torso"});
  return all;
}

/// Plans with one axis sampled.
class SampledAxis {
 public:
  SampledAxis(const PreparedRobot& robot, const PathProblem& problem, int axis, double step)
      : chain_(robot.arm().chain),
        problem_(problem),
        path_(problem_path(problem, chain_)),
        query_(robot.world()),
        axis_(axis) {
    const JointLimit& limit = chain_.limit[static_cast<std::size_t>(axis)];
    const double low = std::max(limit.lower, limit.slides ? limit.lower : -kPi),
                 high = std::min(limit.upper, limit.slides ? limit.upper : kPi);
    const int parts = static_cast<int>(std::ceil((high - low) / step));
    for (int k = 0; k <= parts; ++k)
      if (auto form = ClosedForm::of(lock_joint(chain_, axis, low + k * (high - low) / parts)))
        forms_.emplace_back(low + k * (high - low) / parts, *form);
  }

  /// Returns the least cost of a path through the samples; infinity where there is none.
  double cost() {
    std::vector<Config> nodes = layer(0);
    std::vector<double> costs(nodes.size(), 0);
    for (int i = 1; i < path_.size(); ++i) {
      const std::vector<Config> next = layer(i);
      std::vector<double> costs_there(next.size(), std::numeric_limits<double>::infinity());
      for (std::size_t b = 0; b < next.size(); ++b)
        for (std::size_t a = 0; a < nodes.size(); ++a)
          if (const auto step = edge(nodes[a], next[b]))
            costs_there[b] = std::min(costs_there[b], costs[a] + *step);
      nodes = next;
      costs.swap(costs_there);
    }
    return costs.empty() ? std::numeric_limits<double>::infinity()
                         : *std::min_element(costs.begin(), costs.end());
  }

 private:
  [[nodiscard]] std::vector<Config> layer(int i) {
    std::vector<Config> nodes;
    for (const auto& [value, form] : forms_)
      for (const Config6& six : form.solve(path_.layer(i).tool)) {
        Config q;
        for (int j = 0; j < kDof; ++j) q[j] = j == axis_ ? value : six[j < axis_ ? j : j - 1];
        if (inside(q) && !query_.find_violating_pair(q, ClearanceRule::kNode)) nodes.push_back(q);
      }
    return nodes;
  }
  /// Returns whether an image of q keeps the limits, and puts q there.
  [[nodiscard]] bool inside(Config& q) const {
    for (int j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain_.limit[static_cast<std::size_t>(j)];
      if (limit.continuous || limit.slides) continue;
      const double middle = (limit.lower + limit.upper) / 2;
      q[j] = middle + std::remainder(q[j] - middle, kTwoPi);
      if (q[j] < limit.lower || q[j] > limit.upper) return false;
    }
    return true;
  }
  [[nodiscard]] std::optional<double> edge(const Config& a, const Config& b) const {
    double sum = 0;
    for (int j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain_.limit[static_cast<std::size_t>(j)];
      const double move = limit.continuous ? std::remainder(b[j] - a[j], kTwoPi) : b[j] - a[j];
      if (std::abs(move) > problem_.limits.joint_step * (limit.slides ? kSlideForTurn : 1))
        return std::nullopt;
      sum += move * move;
    }
    return std::sqrt(sum);
  }

  const Chain& chain_;
  const PathProblem& problem_;
  ToolPath path_;
  World::Query query_;
  int axis_;
  std::vector<std::pair<double, ClosedForm>> forms_;
};

/// Draws a path of 0.3 m to 0.6 m, with a turn of the tool, from a posture well inside the limits.
PathProblem random_seam(const TestRobot& robot, Random& random) {
  PathProblem problem = problem_for(robot);
  const Chain chain = arm_of(robot).chain;
  problem.waypoints.push_back(waypoint_of(chain.tool(inner_posture(chain, random))));
  Waypoint to = problem.waypoints[0];
  to.position += random_vector(random, random.uniform(0.3, 0.6));
  const Vector3d turn = random_vector(random, random.uniform(0.05, 0.8));
  to.orientation = to.orientation * Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  problem.waypoints.push_back(to);
  problem.resolution.ds = 0.02;
  problem.resolution.dalpha = 0.5;
  problem.resolution.arc = 0.175;
  problem.limits.clearance = 0;
  problem.limits.edges = EdgeMode::kNodes;
  problem.limits.joint_margin = 0;
  problem.limits.tool_path_error.reset();
  return problem;
}

/// The cost is near that of the sampled reference, and every problem that it solves is solved.
TEST(SampledAxis, IsHardlyEverCheaper) {
  const std::uint64_t base = seed("SampledAxis");
  const std::vector<Case> all = cases();
  const int count = trials(200);
  std::vector<double> ratios;
  int missed = 0, solved = 0;
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const Case& one = all[static_cast<std::size_t>(trial) % all.size()];
    const PathProblem problem = random_seam(one.robot, random);
    const PreparedRobot robot(problem);
    const auto& names = robot.arm().chain.joint_names;
    const auto axis =
        static_cast<int>(std::find(names.begin(), names.end(), one.axis) - names.begin());
    SCOPED_TRACE("SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                 " " + one.robot.name);
    const double reference =
        SampledAxis(robot, problem, axis, problem.resolution.arc_of_nodes() / 4).cost();
    const PlanResult result = plan(robot, problem, {});
    const bool has_path = result.status == PlanStatus::kSolved;
    solved += has_path;
    if (has_path) {
      const CheckResult check = check_trajectory(robot, problem, result.trajectory);
      ASSERT_TRUE(check.passed) << (check.failures.empty() ? "" : check.failures[0]);
    }
    if (!std::isfinite(reference)) continue;
    missed += !has_path;
    if (has_path) ratios.push_back(result.cost / reference);
  }
  std::sort(ratios.begin(), ratios.end());
  ASSERT_FALSE(ratios.empty());
  const double median = ratios[ratios.size() / 2], most = ratios[ratios.size() * 95 / 100];
  std::printf(
      "%d problems, %d solved, %zu by the reference too, %d by it alone; cost over its: "
      "median %.4f, 95 %% %.4f, most %.4f\n",
      count, solved, ratios.size(), missed, median, most, ratios.back());
  EXPECT_EQ(missed, 0);
  EXPECT_GE(ratios.size(), static_cast<std::size_t>(at_least_among(count / 2)));
  EXPECT_LE(median, 1.01);
  EXPECT_LE(most, 1.05);
}

}  // namespace
}  // namespace swivel
