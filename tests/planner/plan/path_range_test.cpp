// SPDX-License-Identifier: BSD-3-Clause
// Stretches of paths against the same paths cut by hand, and how far an arm reaches from a place on
// a path, forwards and backwards, against brute force over all nodes of the stretch.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "rings.hpp"
#include "seed.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/plan/path_range.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel {
namespace {

using namespace test;

/// Returns how far each waypoint is along the path, m.
std::vector<double> distances(const std::vector<Waypoint>& waypoints) {
  std::vector<double> s{0};
  for (std::size_t k = 1; k < waypoints.size(); ++k)
    s.push_back(s.back() + (waypoints[k].position - waypoints[k - 1].position).norm());
  return s;
}

/// Returns the waypoints from one arc length to another, neither of which is that of a waypoint.
std::vector<Waypoint> cut_by_hand(const std::vector<Waypoint>& waypoints, double from, double to) {
  const std::vector<double> s = distances(waypoints);
  const auto at = [&](double length) {
    std::size_t k = 1;
    while (s[k] < length) ++k;
    const Waypoint &a = waypoints[k - 1], &b = waypoints[k];
    const double t = (length - s[k - 1]) / (s[k] - s[k - 1]);
    Waypoint found = a;
    found.position = (1 - t) * a.position + t * b.position;
    found.orientation = a.orientation.normalized().slerp(t, b.orientation.normalized());
    return found;
  };
  std::vector<Waypoint> cut{at(from)};
  for (std::size_t k = 0; k < waypoints.size(); ++k)
    if (s[k] > from && s[k] < to) cut.push_back(waypoints[k]);
  cut.push_back(at(to));
  return cut;
}

struct RangeCounts {
  int ranges = 0, solved = 0, whole = 0, part = 0, none = 0;
};

void expect_cut_path(const PreparedRobot& robot, const PathProblem& problem, Random& random,
                     const std::string& what, RangeCounts& counts) {
  const double length = distances(problem.waypoints).back(),
               from = random.uniform(0.05, 0.5) * length, to = random.uniform(0.55, 0.95) * length;
  const PathProblem range = problem_of_range(problem, {from, to});
  PathProblem by_hand = problem;
  by_hand.closed = false;
  by_hand.waypoints = cut_by_hand(problem.waypoints, from, to);
  ASSERT_EQ(range.waypoints.size(), by_hand.waypoints.size()) << what;
  for (std::size_t k = 0; k < range.waypoints.size(); ++k) {
    ASSERT_LE((range.waypoints[k].position - by_hand.waypoints[k].position).norm(), 1e-12) << what;
    ASSERT_LE(range.waypoints[k].orientation.normalized().angularDistance(
                  by_hand.waypoints[k].orientation.normalized()),
              1e-7)
        << what;
  }
  const PlanResult found = plan(robot, range), cut = plan(robot, by_hand);
  ++counts.ranges;
  counts.solved += found.status == PlanStatus::kSolved;
  ASSERT_EQ(found.status, cut.status) << what;
  ASSERT_NEAR(found.cost, cut.cost, 1e-6) << what;
}

void expect_reach(const PreparedRobot& robot, const PathProblem& problem, RingNodes nodes,
                  PathDirection direction, double from, const std::string& what,
                  RangeCounts& counts) {
  const bool backwards = direction == PathDirection::kBackwards;
  const double length = distances(problem.waypoints).back();
  const PathReach reach = reach_from(robot, problem, from, direction);
  PathProblem ahead = problem_of_range(problem, backwards ? PathRange{0, from} : PathRange{from});
  if (backwards) std::reverse(ahead.waypoints.begin(), ahead.waypoints.end());
  const ToolPath path = problem_path(ahead, robot.arm().chain);
  const RingTruth truth = ring_truth(robot, robot.world(), path, ahead, nodes);
  ASSERT_EQ(reach.plan.status == PlanStatus::kSolved, truth.open.solved) << what;
  const int deepest = truth.open.solved ? path.size() - 1 : truth.open.deepest;
  const double along = deepest < 0 ? 0 : path.layer(deepest).s;
  ASSERT_NEAR(reach.s, backwards ? from - along : from + along, 1e-9) << what;
  if (truth.open.solved) {
    ASSERT_NEAR(reach.s, backwards ? 0 : length, 1e-9) << what;
  }
  if (!truth.open.solved && deepest > 0) {
    ASSERT_EQ(static_cast<int>(reach.plan.partial.size()), deepest + 1) << what;
  }
  ++(truth.open.solved ? counts.whole : deepest > 0 ? counts.part : counts.none);
}

TEST(PathRange, PlansAndReachAreThoseOfTheCutPath) {
  const std::uint64_t base = seed("PathRange");
  Random any(base);
  const std::vector<RingArm> arms = ring_arms(any);
  RangeCounts counts;
  const int count = trials(120);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const RingArm& arm = arms[static_cast<std::size_t>(trial) % arms.size()];
    const PathProblem problem = coarse_ring(arm, random, random.coin());
    const PreparedRobot robot(problem);
    const std::string what = "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                             std::to_string(trial) + " robot " + arm.robot.name;
    expect_cut_path(robot, problem, random, what, counts);
    const double from = random.uniform(0.2, 0.8) * distances(problem.waypoints).back();
    for (const PathDirection direction : {PathDirection::kForwards, PathDirection::kBackwards})
      if (!HasFatalFailure())
        expect_reach(robot, problem, arm.nodes, direction, from, what, counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "seed %llu: %d ranges, %d of them solved; %d ways reach the end, %d part of it, %d "
      "nothing\n",
      static_cast<unsigned long long>(base), counts.ranges, counts.solved, counts.whole,
      counts.part, counts.none);
  EXPECT_GE(counts.solved, at_least(40));
  EXPECT_GE(counts.whole, at_least(60));
  EXPECT_GE(counts.part, at_least(10));
}

TEST(PathRange, RangesLeadForwardsWithinThePath) {
  Random random(seed("PathRange.Refused"));
  PathProblem problem = ring_problem(ring_arms(random).front(), random);
  const double length = distances(problem.waypoints).back();
  EXPECT_EQ(problem_of_range(problem, {}).waypoints.size(), problem.waypoints.size());
  EXPECT_FALSE(problem_of_range(problem, {}).closed);
  const PathRange bad[] = {{-0.01, 0.1}, {0.02, 0.01}, {length + 0.1}, {length}};
  for (const PathRange& range : bad)
    EXPECT_THROW((void)problem_of_range(problem, range), InvalidArgument);
  const PreparedRobot robot(problem);
  EXPECT_THROW((void)reach_from(robot, problem, 0, PathDirection::kBackwards), InvalidArgument);
  problem.steps = {1, 1};
  EXPECT_THROW((void)problem_of_range(problem, {}), InvalidArgument);
}

}  // namespace
}  // namespace swivel
