// SPDX-License-Identifier: BSD-3-Clause
// Starts anywhere along the path: a motion that was stopped goes on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "planners.hpp"
#include "random_problem.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

PlanOptions options_for(PlannerKind planner) {
  PlanOptions options;
  options.planner = planner;
  options.threads = 2;
  return options;
}

/// A random problem; every third turns on the spot first.
PathProblem turning_problem(const TestRobot& robot, Random& random, int trial) {
  PathProblem problem = random_problem(robot, random);
  if (trial % 3 == 0) {
    Waypoint turned = problem.waypoints[0];
    turned.orientation = problem.waypoints[1].orientation;
    problem.waypoints.insert(problem.waypoints.begin() + 1, turned);
    problem.resolution.dalpha = std::min(problem.resolution.dalpha, 0.1);
  }
  return problem;
}

ToolPath whole_path(const PathProblem& problem) {
  return {waypoints_in_base(problem), problem.resolution, problem.source};
}

TEST(StartAt, TheRestOfAPathIsTheWholePathsOwn) {
  const std::uint64_t base = seed("StartAt.Path");
  const auto robots = all_robots();
  int on_layers = 0, between = 0, aside = 0, on_turns = 0;
  const int count = trials(300);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const TestRobot& robot = robots[static_cast<std::size_t>(trial) % robots.size()];
    const PathProblem problem = turning_problem(robot, random, trial);
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    const SrsArm arm = fit_srs(arm_of(robot).chain, what);
    const ToolPath whole = whole_path(problem);
    const std::vector<ArmPlane> planes = carried_planes(arm, whole);
    ASSERT_EQ(static_cast<int>(planes.size()), whole.size());
    const int first = random.below(whole.size() - 1);
    const bool cuts_a_step = random.coin();
    const double t = cuts_a_step ? random.uniform(0.01, 0.99) : 0;
    const PathLayer& layer = whole.layer(first);
    const double s = layer.s + t * (whole.layer(first + 1).s - layer.s);
    const Pose there = t > 0 ? whole.at(first, t) : layer.tool;
    Pose tool = there;
    const double off = random.coin(0.3) ? random.uniform(2e-6, 9e-4) : 0;
    tool.translation() +=
        off * Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), 1).normalized();

    ToolPath rest = whole;
    rest.begin_at(s, tool, 1e-3, what);
    ASSERT_EQ(rest.size(), whole.size() - first) << what;
    ASSERT_EQ(rest.begins_on_layer(), !cuts_a_step && off == 0) << what;
    ASSERT_EQ(static_cast<int>(rest.before().size()), first + !rest.begins_on_layer()) << what;
    ASSERT_NEAR(rest.layer(0).s, s, 1e-12) << what;
    ASSERT_EQ(rest.layer(0).waypoint, cuts_a_step ? -1 : layer.waypoint) << what;
    ASSERT_LE((rest.layer(0).tool.matrix() - tool.matrix()).cwiseAbs().maxCoeff(), 1e-7) << what;
    const Pose next = rest.at(0, 1);
    ASSERT_LE((next.matrix() - whole.layer(first + 1).tool.matrix()).cwiseAbs().maxCoeff(), 1e-12)
        << what;
    ASSERT_NEAR(rest.layer(0).step_length,
                (whole.layer(first + 1).tool.translation() - tool.translation()).norm(), 1e-9)
        << what;
    const std::vector<ArmPlane> rest_planes = carried_planes(arm, rest);
    for (int i = rest.begins_on_layer() ? 0 : 1; i < rest.size(); ++i) {
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(first + i);
      ASSERT_EQ(rest.layer(i).s, whole.layer(first + i).s) << what;
      ASSERT_EQ(rest.layer(i).tool.matrix(), whole.layer(first + i).tool.matrix()) << what;
      ASSERT_EQ(rest.layer(i).waypoint, whole.layer(first + i).waypoint) << what;
      ASSERT_EQ(rest.layer(i).step_rotation, whole.layer(first + i).step_rotation) << what;
      ASSERT_EQ(rest_planes[a].u, planes[b].u) << what;
      ASSERT_EQ(rest_planes[a].r, planes[b].r) << what;
    }
    (off > 0 ? aside : cuts_a_step ? between : on_layers) += 1;
    on_turns += layer.step_length == 0;
  }
  std::printf("%d on layers, %d between, %d beside the path; %d where it turns on the spot\n",
              on_layers, between, aside, on_turns);
  EXPECT_GE(on_layers, at_least_among(count / 5 + 1));
  EXPECT_GE(between, at_least_among(count / 5 + 1));
  EXPECT_GE(aside, at_least_among(count / 6 + 1));
  EXPECT_GE(on_turns, at_least_among(count / 20 + 1));
}

TEST(StartAt, FromARowOfATrajectoryTheRestIsTheSame) {
  const std::uint64_t base = seed("StartAt.Rows");
  const auto robots = all_robots();
  int solved = 0, compared = 0, rows = 0, at_turns = 0, refused = 0;
  const int count = trials(150);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const TestRobot& robot_model = robots[static_cast<std::size_t>(trial) % robots.size()];
    const PathProblem problem = turning_problem(robot_model, random, trial);
    const std::string what = "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                             std::to_string(trial) + " robot " + problem.source;
    const PreparedRobot robot(problem);
    PlanOptions options = options_for(kPlanners[trial % 4]);
    const PlanResult whole = plan(robot, problem, options);
    if (whole.status != PlanStatus::kSolved) continue;
    ++solved;
    const ToolPath path = whole_path(problem);
    const SrsLattice lattice(robot.arm().chain, robot.srs(), path, problem);
    double spent = 0;
    for (std::size_t cut = 0; cut + 1 < whole.trajectory.size(); ++cut) {
      PathProblem rest = problem;
      rest.start = whole.trajectory[cut].q;
      rest.start_at = whole.trajectory[cut].s;
      options.planner = kPlanners[random.below(4)];
      const PlanResult result = plan(robot, rest, options);
      const std::string where =
          what + " cut at row " + std::to_string(cut) + " planner " + result.planner;
      ASSERT_EQ(result.status, PlanStatus::kSolved) << where;
      ASSERT_EQ(result.trajectory.size(), whole.trajectory.size() - cut) << where;
      for (std::size_t k = 0; k < result.trajectory.size(); ++k) {
        const TrajectoryRow &a = result.trajectory[k], &b = whole.trajectory[cut + k];
        ASSERT_EQ(a.q, b.q) << where << " row " << k;
        ASSERT_EQ(a.s, b.s) << where << " row " << k;
        ASSERT_EQ(a.branch, b.branch) << where << " row " << k;
        if (k > 0) {
          ASSERT_EQ(a.phi, b.phi) << where << " row " << k;
        }
        ASSERT_NEAR(std::remainder(a.phi - b.phi, kTwoPi), 0, 1e-9) << where << " row " << k;
        ++rows;
      }
      ASSERT_NEAR(result.cost, whole.cost - spent, 1e-11 * (1 + lattice.cost_unit())) << where;
      const CheckResult checked = check_trajectory(robot, rest, result.trajectory);
      ASSERT_TRUE(checked.passed) << where << ": "
                                  << (checked.failures.empty() ? "" : checked.failures[0]);
      if (cut > 0) {  // a trajectory that begins elsewhere is not this problem's
        refused += !check_trajectory(robot, rest, whole.trajectory).passed;
        at_turns += path.layer(static_cast<int>(cut)).step_length == 0;
        ++compared;
      }
      spent +=
          lattice.edge_cost(lattice.delta(whole.trajectory[cut].q, whole.trajectory[cut + 1].q));
    }
  }
  std::printf("%d solved, %d cuts (%d on turns), %d rows\n", solved, compared, at_turns, rows);
  EXPECT_GE(solved, at_least_among(count / 4));
  EXPECT_GT(compared, 3 * solved / 2);
  EXPECT_GE(at_turns, at_least(4));
  EXPECT_EQ(refused, compared);
}

/// Holds a place between two rows of a trajectory, and the problem to go on from there.
struct Stop {
  std::size_t cut = 0;  // row before the place
  double t = 0;         // part of the way to the next row
  bool on_path = false;
  Config q;
  PathProblem rest;
};

/// Returns the configuration of the node nearest to `q` whose tool is on the path at the stop;
/// none where there is no node.
std::optional<Config> nearest_on_path(const PreparedRobot& robot, const PathProblem& problem,
                                      const Stop& stop, const Config& q, const std::string& what) {
  PathProblem free = problem;
  free.start.reset();
  const ToolPath all = whole_path(problem);
  ToolPath there = all;
  there.begin_at(*stop.rest.start_at, all.at(static_cast<int>(stop.cut), stop.t), 1e-6, what);
  const SrsLattice lattice(robot.arm().chain, robot.srs(), there, free);
  std::vector<Lattice::Node> nodes;
  lattice.layer_nodes(0, nodes);
  const auto distance = [&](const Lattice::Node& node) {
    return joint_norm(lattice.delta(q, node.q));
  };
  const auto nearest =
      std::min_element(nodes.begin(), nodes.end(),
                       [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  if (nearest == nodes.end()) return std::nullopt;
  return q + lattice.delta(q, nearest->q);
}

/// Draws a stop on the way along a trajectory; none where no node is on the path there.
std::optional<Stop> random_stop(const PreparedRobot& robot, const PathProblem& problem,
                                const PlanResult& whole, Random& random, const std::string& what) {
  Stop stop;
  stop.cut = static_cast<std::size_t>(random.below(static_cast<int>(whole.trajectory.size()) - 1));
  stop.t = random.uniform(0.1, 0.9);
  const TrajectoryRow &from = whole.trajectory[stop.cut], &to = whole.trajectory[stop.cut + 1];
  stop.rest = problem;
  stop.rest.start_at = from.s + stop.t * (to.s - from.s);
  // The start is where the joints stopped on the way, beside the path, or a node of the path
  // there.
  stop.q = from.q + stop.t * (to.q - from.q);
  stop.on_path = random.coin();
  if (stop.on_path) {
    const auto nearest = nearest_on_path(robot, problem, stop, stop.q, what);
    if (!nearest) return std::nullopt;
    stop.q = *nearest;
  } else {
    stop.rest.start_tolerance = 0.1;
  }
  stop.rest.start = stop.q;
  return stop;
}

/// Checks that the rest of a trajectory begins with the stop as it is, and then keeps the rows'
/// places on the path.
void expect_rest_from_stop(const PreparedRobot& robot, const Stop& stop, const PlanResult& result,
                           const PlanResult& whole, const std::string& what) {
  ASSERT_EQ(result.trajectory.size(), whole.trajectory.size() - stop.cut) << what;
  ASSERT_EQ(result.trajectory[0].q, stop.q) << what;
  ASSERT_NEAR(result.trajectory[0].s, *stop.rest.start_at, 1e-6) << what;
  for (std::size_t k = 1; k < result.trajectory.size(); ++k)
    ASSERT_EQ(result.trajectory[k].s, whole.trajectory[stop.cut + k].s) << what;
  const CheckResult checked = check_trajectory(robot, stop.rest, result.trajectory);
  ASSERT_TRUE(checked.passed) << what << ": "
                              << (checked.failures.empty() ? "" : checked.failures[0]);
}

/// Checks that all planners find the path of `result`.
void expect_planners_agree(const PreparedRobot& robot, const PathProblem& problem,
                           const PlanResult& result, const std::string& what) {
  for (const PlannerKind planner : kPlanners) {
    const PlanResult other = plan(robot, problem, options_for(planner));
    ASSERT_EQ(other.cost, result.cost) << what;
    for (std::size_t k = 0; k < result.trajectory.size(); ++k)
      ASSERT_EQ(other.trajectory[k].q, result.trajectory[k].q) << what;
  }
}

/// Counts the plans from stops by how they end and by where the stops are.
struct StopCounts {
  int solved = 0, exact = 0, aside = 0, infeasible = 0;
};

/// Stops a trajectory on its way and checks what is planned from there.
void check_stop(const PathProblem& problem, const PlanOptions& options, Random& random,
                const std::string& what, StopCounts& counts) {
  const PreparedRobot robot(problem);
  const PlanResult whole = plan(robot, problem, options);
  if (whole.status != PlanStatus::kSolved) return;
  const std::optional<Stop> stop = random_stop(robot, problem, whole, random, what);
  if (!stop) return;
  PlanResult result;
  try {
    result = plan(robot, stop->rest, options);
  } catch (const InputError&) {  // the node nearest to the joints has another image than fits
    return;
  }
  if (result.status == PlanStatus::kInfeasible) {
    ++counts.infeasible;
    return;
  }
  ASSERT_EQ(result.status, PlanStatus::kSolved) << what;
  ++counts.solved;
  expect_rest_from_stop(robot, *stop, result, whole, what);
  if (::testing::Test::HasFatalFailure()) return;
  counts.exact += stop->on_path;
  const ToolPath path = problem_path(stop->rest, robot.arm().chain);
  counts.aside += !stop->on_path &&
                  (whole_path(problem).at(static_cast<int>(stop->cut), stop->t).translation() -
                   path.layer(0).tool.translation())
                          .norm() > 1e-5;
  expect_planners_agree(robot, stop->rest, result, what);
}

TEST(StartAt, BetweenLayersTheFirstRowIsTheStartAsItIs) {
  const std::uint64_t base = seed("StartAt.Between");
  const auto robots = all_robots();
  StopCounts counts;
  const int count = trials(150);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem =
        turning_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random, trial);
    problem.limits.clearance =
        0.001;  // motions keep half of it, rows all: a stop may be too near for a row
    const std::string what = "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                             std::to_string(trial) + " robot " + problem.source;
    check_stop(problem, options_for(kPlanners[trial % 4]), random, what, counts);
    if (HasFatalFailure()) return;
  }
  std::printf("%d solved: %d on the path, %d beside it; %d have no path from there\n",
              counts.solved, counts.exact, counts.aside, counts.infeasible);
  EXPECT_GE(counts.solved, at_least_among(count / 5));
  EXPECT_GE(counts.exact, at_least_among(count / 15));
  EXPECT_GE(counts.aside, at_least_among(count / 15));
  EXPECT_LE(counts.infeasible, counts.solved);
}

PathProblem experiment_a() {
  PathProblem problem = io::load_path_problem(data_dir() / "problems/experiment_a.yaml");
  problem.resolution = {.ds = 0.02, .dphi = 0.1};
  return problem;
}

TEST(StartAt, WhatDoesNotFitIsBadInput) {
  const PathProblem problem = experiment_a();
  const PreparedRobot robot(problem);
  const PlanResult whole = plan(robot, problem);
  ASSERT_EQ(whole.status, PlanStatus::kSolved);
  const double length = whole.trajectory.back().s;
  const auto message_of = [&](double at, const Config& start, double tolerance) -> std::string {
    PathProblem rest = problem;
    rest.start = start;
    rest.start_at = at;
    rest.start_tolerance = tolerance;
    try {
      static_cast<void>(plan(robot, rest));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto expect_said = [](const std::string& message,
                              std::initializer_list<const char*> words) {
    for (const char* word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  };
  const TrajectoryRow& row = whole.trajectory[3];
  EXPECT_EQ(message_of(row.s, row.q, 1e-6), "");
  expect_said(message_of(length, whole.trajectory.back().q, 1e-6),
              {"start_at", "before the end of the path"});
  expect_said(message_of(length + 0.1, whole.trajectory.back().q, 0.1),
              {"start_at", "before the end of the path"});
  expect_said(message_of(row.s + 0.001, row.q, 1e-6),
              {"start.joints", "0.001 m", "start_at", "1e-06", "start_tolerance"});
  EXPECT_EQ(message_of(row.s + 0.001, row.q, 0.0011), "");
  expect_said(message_of(row.s + 0.001, row.q, 0.0009), {"start.joints", "0.0009"});
  // A given start without a place stands at the path's beginning, within the tolerance.
  PathProblem first = problem;
  first.start = whole.trajectory[0].q;
  (*first.start)[kDof - 1] += 1e-4;
  EXPECT_THROW(static_cast<void>(plan(robot, first)), InputError);
  first.start_tolerance = 1e-3;
  const PlanResult result = plan(robot, first);
  ASSERT_EQ(result.status, PlanStatus::kSolved);
  EXPECT_EQ(result.trajectory[0].q, *first.start);
  EXPECT_EQ(result.trajectory[0].s, 0);
  EXPECT_TRUE(check_trajectory(robot, first, result.trajectory).passed);
}

}  // namespace
}  // namespace swivel
