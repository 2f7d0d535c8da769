// SPDX-License-Identifier: BSD-3-Clause
// Refined paths and motions in time on random problems, held against the check that knows nothing
// of either.
#include "swivel/planner/refine/motion.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/planner/plan/plan_view.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "inexact_robots.hpp"
#include "motion_problem.hpp"
#include "robots.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

/// Calls each(problem, robot, rows) for problems with a path; returns how many.
template <class Each>
int for_solved(const char* name, int count, const Each& each) {
  const std::uint64_t base = seed(name);
  const std::vector<TestRobot> robots = all_robots();
  int solved = 0;
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathProblem problem =
        motion_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    const PreparedRobot robot(problem);
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    const PlanResult found = plan(robot, problem, options);
    if (found.status != PlanStatus::kSolved) continue;
    ++solved;
    SCOPED_TRACE(problem.source + " " + std::to_string(trial));
    each(problem, robot, found);
  }
  return solved;
}

TEST(Refine, IsValidNeverDearerAndKeepsLabels) {
  int refined = 0, cheaper = 0, starts = 0, turns = 0, seconds = 0;
  std::set<CostMetric> metrics;
  double sum = 0;
  const int solved = for_solved(
      "Refine", trials(40),
      [&](const PathProblem& problem, const PreparedRobot& robot, const PlanResult& found) {
        const Refined result = refine(robot, problem, found.trajectory);
        EXPECT_NEAR(result.cost_before, found.cost, 1e-9 * (1 + found.cost));
        EXPECT_LE(result.cost, result.cost_before);
        ASSERT_EQ(result.rows.size(), found.trajectory.size());
        EXPECT_EQ(result.refined, result.reason.empty());
        const CheckResult check = check_trajectory(robot, problem, result.rows);
        EXPECT_TRUE(check.passed) << (check.failures.empty() ? "" : check.failures[0]);
        EXPECT_NEAR(check.cost, result.cost, 1e-6);
        if (problem.start) {
          EXPECT_EQ(result.rows[0].q, *problem.start);
          ++starts;
        }
        for (std::size_t k = 0; k < result.rows.size(); ++k) {
          EXPECT_EQ(result.rows[k].s, found.trajectory[k].s);
          EXPECT_TRUE(result.from_second_seed ||
                      result.rows[k].branch == found.trajectory[k].branch);
          EXPECT_TRUE(result.refined || result.rows[k].q == found.trajectory[k].q);
          if (k > 0) turns += result.rows[k].s == result.rows[k - 1].s;
        }
        refined += result.refined;
        cheaper += result.cost < result.cost_before - 1e-6;
        seconds += result.from_second_seed;
        metrics.insert(problem.cost.metric);
        sum += result.cost / result.cost_before;
        // A second refinement gives the same joints, bit for bit.
        const Refined again = refine(robot, problem, found.trajectory);
        for (std::size_t k = 0; k < result.rows.size(); ++k)
          EXPECT_EQ(again.rows[k].q, result.rows[k].q);
      });
  std::printf(
      "%d solved, %d refined, %d cheaper, %d with start, %d turning steps, %d from the second "
      "seed; mean cost %.4f of before\n",
      solved, refined, cheaper, starts, turns, seconds, sum / solved);
  EXPECT_GE(solved, at_least(12));
  EXPECT_GE(cheaper, solved / 2);
  EXPECT_GE(starts, at_least(1));
  EXPECT_GE(turns, at_least(1));
  EXPECT_GE(metrics.size(), 3u);
}

/// The kinds of paths that people have: valid by the check, and never dearer.
TEST(Refine, IsValidOnWhatUsersHave) {
  Random making(seed("UsersRobots"));
  std::vector<TestRobot> robots = inexact_robots(making);
  const std::size_t inexact = robots.size();
  robots.push_back(continuous_robot());
  robots.push_back(windings_robot());
  robots.push_back(data_robot("iiwa14"));
  std::map<std::string, int> met;
  const std::uint64_t base = seed("Users");
  for (int trial = 0; trial < trials(40); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const std::size_t which = static_cast<std::size_t>(trial) % robots.size();
    PathProblem problem = motion_problem(robots[which], random);
    problem.start.reset();
    const auto refined = [&](const PathProblem& kind, const char* name) -> std::optional<Refined> {
      const PreparedRobot robot(kind);
      PlanOptions options;
      options.planner = PlannerKind::kLazy;
      const PlanResult found = plan(robot, kind, options);
      if (found.status != PlanStatus::kSolved) return std::nullopt;
      const Refined result = refine(robot, kind, found.trajectory);
      EXPECT_LE(result.cost, found.cost + 1e-9) << name << ' ' << trial;
      const CheckResult check = check_trajectory(robot, kind, result.rows);
      EXPECT_TRUE(check.passed) << name << ' ' << trial << ' '
                                << (check.failures.empty() ? "" : check.failures[0]);
      ++met[name];
      if (which < inexact) ++met["inexact"];
      if (result.refined) ++met["refined"];
      return result;
    };
    const auto whole = refined(problem, "whole");
    PathProblem reversed = problem;
    std::reverse(reversed.waypoints.begin(), reversed.waypoints.end());
    refined(reversed, "reversed");
    PathProblem turns = problem;
    for (Waypoint& waypoint : turns.waypoints) waypoint.position = turns.waypoints[0].position;
    refined(turns, "turns");
    if (!whole) continue;
    const std::size_t row = whole->rows.size() / 2;
    PathProblem rest = problem;
    rest.start = whole->rows[row].q;
    rest.start_at = whole->rows[row].s;
    const auto after = refined(rest, "start_at");
    if (after) {
      EXPECT_EQ(after->rows[0].q, *rest.start);
    }
  }
  for (const auto& [kind, count] : met) std::printf("%s %d, ", kind.c_str(), count);
  std::printf("\n");
  for (const char* kind : {"whole", "reversed", "turns", "start_at"})
    EXPECT_GE(met[kind], at_least(10)) << kind;
  EXPECT_GE(met["inexact"], at_least(10));
  EXPECT_GE(met["refined"], at_least(40));
}

TEST(Motion, DenseWaypointsAreAsFastAsFewOnes) {
  PathProblem problem =
      io::load_path_problem(std::string(SWIVEL_DATA_DIR) + "/problems/experiment_a.yaml");
  const Waypoint first = problem.waypoints[0];
  problem.waypoints.clear();
  constexpr int kCount = 5000;
  for (int k = 0; k < kCount; ++k) {
    const double t = static_cast<double>(k) / (kCount - 1);
    Waypoint waypoint = first;
    waypoint.position +=
        Vector3d(0.04 * std::sin(kTwoPi * t), 0.5 * t, 0.03 * std::sin(2 * kTwoPi * t));
    waypoint.orientation = first.orientation * Quaterniond(Eigen::AngleAxisd(
                                                   0.1 * std::sin(kTwoPi * t), Vector3d::UnitY()));
    problem.waypoints.push_back(waypoint);
  }
  problem = with_motion_defaults(problem);
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  Planner planner(problem);
  const MotionPlan plan = plan_motion(planner, options, true,
                                      TimingOptions{.speed = 0.1, .turn_speed = {}, .rate = 250});
  ASSERT_EQ(plan.result.status, PlanStatus::kSolved);
  // A run of waypoints within half a micrometre of a chord has layers at its ends alone.
  EXPECT_LE(plan.result.trajectory.size(), static_cast<std::size_t>(kCount));
  EXPECT_GE(plan.result.trajectory.size(), 500u);
  EXPECT_LE(plan.result.cost, plan.refinement->cost_before);
  ASSERT_TRUE(plan.motion->motion) << plan.motion->failure->reason;
  EXPECT_LE(plan.motion->motion->duration, 1.1 * plan.motion->motion->ideal);
  EXPECT_TRUE(plan.motion->motion->stops.empty());
  const PreparedRobot robot(problem);
  EXPECT_TRUE(check_trajectory(robot, problem, plan.result.trajectory).passed);
  EXPECT_TRUE(check_motion(robot, problem, plan.motion->motion->rows).passed);
}

TEST(Refine, TheResolutionStopsMattering) {
  PathProblem problem =
      io::load_path_problem(std::string(SWIVEL_DATA_DIR) + "/problems/experiment_b.yaml");
  keep_clearance_between_layers(problem.limits);
  double dearest_before = 0;
  for (const auto& [ds, dphi] : {std::pair(0.02, 0.2), std::pair(0.01, 0.1), std::pair(0.005, 0.05),
                                 std::pair(0.001, 0.05)}) {
    problem.resolution.ds = ds;
    problem.resolution.dphi = dphi;
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    Planner planner(problem);
    const MotionPlan plan = plan_motion(planner, options, true, {});
    ASSERT_TRUE(plan.refinement);
    EXPECT_LE(plan.result.cost, 4.43) << ds << ' ' << dphi;
    EXPECT_LE(plan.refinement->bend, 200) << ds << ' ' << dphi;
    dearest_before = std::max(dearest_before, plan.refinement->cost_before);
  }
  EXPECT_GT(dearest_before, 5);
}

PlanResult planned(const PreparedRobot& robot, const PathProblem& problem) {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  return plan(robot, problem, options);
}

/// Door poses where refinement used to end dearer than it need: its path lay on bounds over most of
/// its length (4, 73), or the cheaper way past an obstacle began with a path that is not valid
/// between its own layers (83). Costs are those of fine lattices about the best path known
/// (bench/basin_benchmark data/problems/experiment_c.yaml --episodes 1 --first 4).
TEST(Refine, EndsWithinAThousandthOfItsBasinsOptimum) {
  const PathProblem base = with_motion_defaults(
      io::load_path_problem(std::string(SWIVEL_DATA_DIR) + "/problems/experiment_c.yaml"));
  const PreparedRobot robot(base);
  for (const auto& [episode, fine_lattice] :
       {std::pair(4u, 1.98137), std::pair(73u, 3.35499), std::pair(83u, 2.22246)}) {
    SCOPED_TRACE(episode);
    const PathProblem problem = episode_problem(base, 1, episode);
    const PlanResult found = planned(robot, problem);
    ASSERT_EQ(found.status, PlanStatus::kSolved);
    const Refined refined = refine(robot, problem, found.trajectory);
    EXPECT_LE(refined.cost, 1.001 * fine_lattice);
    EXPECT_TRUE(check_trajectory(robot, problem, refined.rows).passed);
  }
}

/// Door poses whose cheapest path changes branch at the wrist's singularity: to lead past it at a
/// distance costs a turn of the outer joints, and bends that no smoothing takes away.
TEST(Refine, CrossesSingularitiesStraight) {
  const PathProblem base = with_motion_defaults(
      io::load_path_problem(std::string(SWIVEL_DATA_DIR) + "/problems/experiment_c.yaml"));
  const PreparedRobot robot(base);
  for (const unsigned episode : {60u, 88u}) {
    SCOPED_TRACE(episode);
    const PathProblem problem = episode_problem(base, 1, episode);
    const PlanResult found = planned(robot, problem);
    ASSERT_EQ(found.status, PlanStatus::kSolved);
    ASSERT_NE(found.trajectory.front().branch, found.trajectory.back().branch);
    const Refined refined = refine(robot, problem, found.trajectory);
    EXPECT_LE(refined.cost, 0.8 * refined.cost_before);
    EXPECT_LE(refined.bend, 0.2 * refined.bend_before);
    EXPECT_TRUE(check_trajectory(robot, problem, refined.rows).passed);
    for (std::size_t k = 0; k < refined.rows.size(); ++k)
      EXPECT_EQ(refined.rows[k].branch, found.trajectory[k].branch);
  }
}

/// Refuses one joint beyond a bound.
class Beyond final : public StateCheck {
 public:
  Beyond(int joint, double most) : joint_(joint), most_(most) {}
  [[nodiscard]] std::string name() const override { return "beyond"; }
  void states(std::span<const Config> states, std::span<bool> allowed) override {
    for (std::size_t k = 0; k < states.size(); ++k) allowed[k] = states[k][joint_] <= most_;
    asked += static_cast<int>(states.size());
  }
  [[nodiscard]] bool checks_motions() const override { return true; }
  void motions(std::span<const Motion> motions, std::span<bool> allowed) override {
    for (std::size_t k = 0; k < motions.size(); ++k)
      allowed[k] = std::max(motions[k].from[joint_], motions[k].to[joint_]) <= most_;
    asked += static_cast<int>(motions.size());
  }
  int asked = 0;

 private:
  int joint_;
  double most_;
};
class NoCost final : public StateCost {
 public:
  [[nodiscard]] std::string name() const override { return "none"; }
  void costs(std::span<const Config>, std::span<double> costs) override {
    std::fill(costs.begin(), costs.end(), 0.0);
  }
};

TEST(Refine, AsksTheCallersCheck) {
  int beyond = 0, kept = 0, refined = 0;
  const auto most = [](const std::vector<TrajectoryRow>& rows, int joint) {
    double value = -1e9;
    for (const TrajectoryRow& row : rows) value = std::max(value, row.q[joint]);
    return value;
  };
  const int solved = for_solved(
      "CallersCheck", trials(40),
      [&](const PathProblem& problem, const PreparedRobot& robot, const PlanResult& found) {
        const Refined free = refine(robot, problem, found.trajectory);
        for (const int joint : {0, 2, 4}) {
          const double bound = most(found.trajectory, joint);
          if (!(most(free.rows, joint) > bound + 1e-6)) continue;
          ++beyond;
          const auto check = std::make_shared<Beyond>(joint, bound);
          PlanOptions options;
          options.planner = PlannerKind::kLazy;
          options.hooks.check = check;
          Planner planner(problem);
          const MotionPlan plan = plan_motion(planner, options, true, {});
          ASSERT_EQ(plan.result.status, PlanStatus::kSolved);
          kept += most(plan.result.trajectory, joint) <= bound;
          refined += plan.refinement->refined;
          EXPECT_GT(check->asked, 0);
          options.hooks.cost = std::make_shared<NoCost>();
          options.evidence.postures = true;
          const MotionPlan costly = plan_motion(planner, options, true, {});
          EXPECT_FALSE(costly.refinement->refined);
          EXPECT_EQ(costly.refinement->reason, "the caller's own cost is not refined");
          EXPECT_TRUE(costly.result.evidence.postures);
          return;
        }
      });
  std::printf(
      "%d solved, %d go beyond a bound when refined freely, %d keep it, %d of them refined\n",
      solved, beyond, kept, refined);
  EXPECT_EQ(kept, beyond);
  EXPECT_GE(beyond, at_least(4));
  EXPECT_GE(refined, at_least(2));
}

TEST(Refine, RefusesRowsOfAnotherResolution) {
  const int solved = for_solved(
      "Refine", 12,
      [&](const PathProblem& problem, const PreparedRobot& robot, const PlanResult& found) {
        PathProblem other = problem;
        other.resolution.ds /= 2;
        EXPECT_THROW(static_cast<void>(refine(robot, other, found.trajectory)), InvalidArgument);
        EXPECT_THROW(static_cast<void>(refine(robot, problem, found.trajectory, {}, Budget(1e-9))),
                     Stopped);
      });
  EXPECT_GE(solved, 2);
}

TEST(Motion, PassesTheCheckOfMotions) {
  int timed = 0, not_executable = 0;
  std::size_t samples = 0;
  const int solved = for_solved(
      "Motion", trials(40),
      [&](const PathProblem& problem, const PreparedRobot& robot, const PlanResult& found) {
        const Refined refined = refine(robot, problem, found.trajectory, {.second_seed = false});
        const TimingOptions options{.speed = 0.1, .turn_speed = 0.5, .rate = 250};
        const MotionResult result = time_trajectory(robot, problem, refined.rows, options);
        ASSERT_NE(result.motion.has_value(), result.failure.has_value());
        if (!result.motion) {
          ++not_executable;
          std::printf("%s at s = %.4f\n", result.failure->reason.c_str(), result.failure->s);
          return;
        }
        ++timed;
        samples += result.motion->rows.size();
        const CheckResult check = check_motion(robot, problem, result.motion->rows);
        EXPECT_TRUE(check.passed) << (check.failures.empty() ? "" : check.failures[0]);
        ASSERT_TRUE(check.motion);
        EXPECT_LE(check.motion->tool_speed, options.speed * 1.001);
        for (const auto& peak : check.motion->peaks) EXPECT_LE(peak.ratio, 1 + 1e-6);
        // What the motion says of itself is what the check finds.
        for (std::size_t order = 0; order < 3; ++order) {
          double most = 0;
          for (const auto& peak : result.motion->peaks[order]) most = std::max(most, peak.ratio);
          EXPECT_NEAR(most, check.motion->peaks[order].ratio, 1e-6);
        }
        // A tenth faster is too fast.
        auto fast = result.motion->rows;
        for (TimedRow& row : fast) row.t /= 1.1;
        const bool near_limit = check.motion->peaks[2].ratio > 0.8;
        EXPECT_TRUE(!near_limit || !check_motion(robot, problem, fast).passed);
      });
  std::printf("%d solved, %d timed, %d not executable, %zu samples\n", solved, timed,
              not_executable, samples);
  EXPECT_GE(timed, at_least(10));
  EXPECT_LE(not_executable, solved / 3);
}

/// Counts the motions that are executed and the points that are asked about on them.
struct ClearanceCounts {
  int executed = 0, refused = 0, near = 0;
  std::int64_t asked = 0;
  double least = 1;  ///< margin to the clearance, m
};

/// Draws a problem before a ball, with layers that lie far apart or close together at times.
PathProblem random_before_ball(const TestRobot& robot, Random& random) {
  PathProblem problem = motion_problem(robot, random);
  problem = with_motion_defaults(problem);
  EXPECT_EQ(problem.limits.edge_clearance, problem.limits.clearance);
  if (random.coin(0.3)) problem.limits.edges = EdgeMode::kNodes;
  const double ds = random.uniform(0, 1);
  if (ds < 0.3) problem.resolution.ds = 0.04, problem.limits.tool_path_error.reset();
  if (ds > 0.8) problem.resolution.ds = 0.002;
  return problem;
}

/// The ball is as large as leaves a path, so that the path must pass near it.
void enlarge_ball(PathProblem& problem, const PlanOptions& options) {
  double solvable = 0.02, blocked = 0.2;
  for (int k = 0; k < 5; ++k) {
    problem.scene[0].shape = Sphere{(solvable + blocked) / 2};
    const bool solved = swivel::plan(problem, options).status == PlanStatus::kSolved;
    (solved ? solvable : blocked) = (solvable + blocked) / 2;
  }
  problem.scene[0].shape = Sphere{solvable};
}

/// Margins are told of the path that is executed.
void expect_margin_of_path(const PlanResult& result, World::Query& query) {
  double margin = std::numeric_limits<double>::infinity();
  for (const TrajectoryRow& row : result.trajectory)
    if (const auto clearance = query.clearance(row.q))
      margin = std::min(margin, clearance->margin());
  if (result.min_margin) {
    EXPECT_NEAR(result.min_margin->margin, margin, 1e-9);
  }
}

/// Expects the clearance on every seventh move of the motion: at its row alone where only nodes are
/// asked for, else at eleven points.
void expect_clearance(const PathProblem& problem, const std::vector<TimedRow>& rows,
                      World::Query& query, int trial, ClearanceCounts& counts) {
  constexpr double kForgiven = kVerdictBand + 1e-6;
  bool comes_near = false;
  for (std::size_t k = 0; k + 1 < rows.size(); k += 7)
    for (int part = 0; part <= (problem.limits.edges == EdgeMode::kNodes ? 0 : 10); ++part) {
      const Config q = rows[k].row.q + part / 10. * (rows[k + 1].row.q - rows[k].row.q);
      const auto clearance = query.clearance(q);
      if (!clearance) continue;
      ++counts.asked;
      counts.least = std::min(counts.least, clearance->margin());
      EXPECT_GE(clearance->margin(), -kForgiven)
          << "trial " << trial << " t = " << rows[k].t << " part " << part;
      comes_near = comes_near || clearance->margin() < 2e-3;
    }
  counts.near += comes_near;
}

/// Plans, refines and times one problem before a ball and checks the clearance of its motion.
void check_clearance(PathProblem problem, int trial, ClearanceCounts& counts) {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.evidence.postures = true;
  enlarge_ball(problem, options);
  Planner planner(problem);
  const MotionPlan plan = plan_motion(planner, options, true,
                                      TimingOptions{.speed = 0.1, .turn_speed = 0.5, .rate = 250});
  if (plan.result.status != PlanStatus::kSolved) return;
  ASSERT_TRUE(plan.refinement);
  ASSERT_TRUE(plan.motion);
  EXPECT_FALSE(plan.stopped);
  EXPECT_NEAR(plan.result.cost, plan.refinement->cost, 1e-9);
  EXPECT_LE(plan.result.cost, plan.result.lattice.cost + 0.05);  // of rows, of nodes
  ASSERT_EQ(plan.result.trajectory.size(), plan.lattice_path.size());
  if (!plan.motion->motion) {
    ++counts.refused;
    std::printf("trial %d: %s at s = %.4f\n", trial, plan.motion->failure->reason.c_str(),
                plan.motion->failure->s);
    return;
  }
  ++counts.executed;
  const PreparedRobot robot(problem);
  const World world(robot.world(), problem);
  World::Query query(world);
  expect_margin_of_path(plan.result, query);
  const auto& rows = plan.motion->motion->rows;
  expect_clearance(problem, rows, query, trial, counts);
  EXPECT_TRUE(check_motion(robot, problem, rows).passed);
}

TEST(Motion, KeepsTheClearanceAskedForBetweenSamplesToo) {
  ClearanceCounts counts;
  const std::uint64_t base = seed("Between");
  const std::vector<TestRobot> robots = all_robots();
  for (int trial = 0; trial < trials(16); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    check_clearance(
        random_before_ball(robots[static_cast<std::size_t>(trial) % robots.size()], random), trial,
        counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d executed, %d refused, %lld points, %d motions within 2 mm of the clearance, least margin "
      "%.4f mm\n",
      counts.executed, counts.refused, static_cast<long long>(counts.asked), counts.near,
      1e3 * counts.least);
  EXPECT_GE(counts.executed, at_least(5));
  EXPECT_GE(counts.near, at_least(3));
  EXPECT_LE(counts.refused, counts.executed / 4);
}

std::string said_of_postures(const TimedPath& motion) {
  for (const std::string& warning : motion.warnings)
    if (warning.find("between layers (") != std::string::npos) return warning;
  return "";
}

/// The lattice's path runs along the limit of a joint, which leaves it between two layers.
TEST(Motion, IsLedThroughOtherPosturesWhereItIsAtFaultBetweenLayers) {
  const PathProblem base = with_motion_defaults(
      io::load_path_problem(std::string(SWIVEL_DATA_DIR) + "/problems/experiment_c.yaml"));
  Planner planner(episode_problem(base, 1, 25));
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  const MotionPlan plan = plan_motion(planner, options, false,
                                      TimingOptions{.speed = 0.05, .turn_speed = {}, .rate = 250});
  ASSERT_TRUE(plan.motion && plan.motion->motion) << plan.motion->failure->reason;
  const TimedPath& motion = *plan.motion->motion;
  EXPECT_NE(said_of_postures(motion).find("'arm_left_joint_6_b' leaves its limits"),
            std::string::npos)
      << said_of_postures(motion);
  const CheckResult check = check_motion(planner.view().robot, planner.view().problem, motion.rows);
  EXPECT_TRUE(check.passed) << check.failures[0];
  EXPECT_LT(motion.duration, 1.05 * motion.ideal);
  const JointLimit& limit = planner.view().robot.arm().chain.limit[5];
  double least = 1;
  for (const TimedRow& row : motion.rows)
    least = std::min(least, std::min(row.row.q[5] - limit.lower, limit.upper - row.row.q[5]));
  EXPECT_GE(least, -1e-9);
}

/// Layers that lie far apart before a ball, and nothing asked between them: motions of the
/// lattice's own path.
TEST(Motion, OfCoarseLayersIsFreeOrNamesThePair) {
  int executed = 0, led = 0, refused = 0;
  const std::uint64_t base = seed("Coarse");
  const std::vector<TestRobot> robots = all_robots();
  for (int trial = 0; trial < trials(40); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem =
        motion_problem(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    problem = with_motion_defaults(problem);
    problem.limits.edges = EdgeMode::kNodes;
    problem.resolution.ds = 0.06;
    problem.limits.tool_path_error.reset();
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    enlarge_ball(problem, options);
    Planner planner(problem);
    const MotionPlan plan = plan_motion(
        planner, options, false, TimingOptions{.speed = 0.1, .turn_speed = 0.5, .rate = 250});
    if (plan.result.status != PlanStatus::kSolved) continue;
    ASSERT_TRUE(plan.motion);
    if (!plan.motion->motion) {
      ++refused;
      const NoMotion& failure = *plan.motion->failure;
      std::printf("trial %d: %s at s = %.4f\n", trial, failure.reason.c_str(), failure.s);
      EXPECT_GE(failure.s, 0);
      EXPECT_LE(failure.s, plan.lattice_path.back().s);
      EXPECT_FALSE(failure.reason.empty());
      continue;
    }
    ++executed;
    led += !said_of_postures(*plan.motion->motion).empty();
    const CheckResult check =
        check_motion(planner.view().robot, planner.view().problem, plan.motion->motion->rows);
    EXPECT_TRUE(check.passed) << "trial " << trial << ": " << check.failures[0];
  }
  std::printf("%d executed, %d of them led through other postures, %d refused\n", executed, led,
              refused);
  EXPECT_GE(executed, at_least(15));
  EXPECT_GE(led, at_least(1));
  EXPECT_LE(refused, executed / 2);
}

/// A path that changes its branch at a singular pose has a motion; where its joints would have to
/// jump there, the cheapest path that keeps its branch is planned instead.
TEST(Motion, LeadsFromBranchToBranchUnlessJointsWouldJump) {
  const PathProblem base = with_motion_defaults(
      io::load_path_problem(std::string(SWIVEL_DATA_DIR) + "/problems/experiment_c.yaml"));
  for (const std::uint64_t episode : {60u, 88u, 153u}) {
    const bool jumps = episode == 153;
    Planner planner(episode_problem(base, 1, episode));
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    const auto branches = [](const std::vector<TrajectoryRow>& rows) {
      std::set<int> found;
      for (const TrajectoryRow& row : rows) found.insert(row.branch);
      return found.size();
    };
    const MotionPlan path = plan_motion(planner, options, false, {});
    ASSERT_EQ(path.result.status, PlanStatus::kSolved);
    EXPECT_EQ(branches(path.result.trajectory), 2u);
    EXPECT_FALSE(path.motion);
    const MotionPlan motion = plan_motion(
        planner, options, false, TimingOptions{.speed = 0.05, .turn_speed = {}, .rate = 100});
    ASSERT_TRUE(motion.motion && motion.motion->motion) << motion.motion->failure->reason;
    EXPECT_EQ(branches(motion.result.trajectory), jumps ? 1u : 2u);
    std::vector<TrajectoryRow> rows;
    for (const TimedRow& row : motion.motion->motion->rows) rows.push_back(row.row);
    EXPECT_EQ(branches(rows), jumps ? 1u : 2u);
    EXPECT_EQ(motion.result.lattice.cost > path.result.lattice.cost, jumps);
    EXPECT_EQ(std::any_of(motion.result.warnings.begin(), motion.result.warnings.end(),
                          [](const std::string& warning) {
                            return warning.find("asks joints to jump") != std::string::npos;
                          }),
              jumps);
  }
}

/// The path bends sharply in the joints at s = 0.16 m; the tool can pass there at 240 of 250 mm/s.
TEST(Motion, SlowsDownNoMoreThanBendsAsk) {
  Planner planner(with_motion_defaults(
      io::load_path_problem(std::string(SWIVEL_DATA_DIR) + "/problems/experiment_b.yaml")));
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  const MotionPlan plan = plan_motion(planner, options, true,
                                      TimingOptions{.speed = 0.25, .turn_speed = {}, .rate = 1000});
  ASSERT_TRUE(plan.motion && plan.motion->motion);
  const TimedPath& motion = *plan.motion->motion;
  EXPECT_LE(motion.duration,
            1.05 * 2.2525);  // s: the shortest that bench/evidence/yardstick.py finds on this path
  for (const TimedPath::Slow& slow : motion.slow) EXPECT_GE(slow.share, 0.9) << slow.from_s;
}

TEST(Motion, SlowsDownWhereTheToolWouldStrayBetweenSamples) {
  Planner planner(with_motion_defaults(
      io::load_path_problem(std::string(SWIVEL_DATA_DIR) + "/problems/experiment_b.yaml")));
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  const auto motion = [&](double rate, std::optional<double> chord) {
    const MotionPlan plan =
        plan_motion(planner, options, true,
                    TimingOptions{.speed = 0.25, .turn_speed = {}, .rate = rate, .chord = chord});
    EXPECT_TRUE(plan.motion && plan.motion->motion);
    // Measured again: joints half way, against the straight line that the path is.
    double most = 0;
    const Chain& chain = planner.view().robot.arm().chain;
    const std::vector<TimedRow>& rows = plan.motion->motion->rows;
    for (std::size_t k = 1; k < rows.size(); ++k) {
      const Vector3d tool = chain.tool((rows[k - 1].row.q + rows[k].row.q) / 2).translation();
      most = std::max(most, std::hypot(tool.x() - 0.6, tool.z() - 0.9));
    }
    EXPECT_NEAR(most, plan.motion->motion->between_position, 1e-9);
    return *plan.motion->motion;
  };
  for (const double rate : {250.0, 50.0}) {
    const TimedPath free = motion(rate, {}), exact = motion(rate, 1e-6 * 250 / rate);
    EXPECT_GT(free.between_position, 1.1e-6 * 250 / rate);
    EXPECT_LE(exact.between_position, 1e-6 * 250 / rate);
    EXPECT_GT(exact.between_position, 0.8e-6 * 250 / rate);
    EXPECT_GT(exact.duration, free.duration);
    EXPECT_LT(exact.duration, (rate == 250 ? 1.02 : 2) * free.duration);
  }
}

TEST(Motion, KeepsThePathWhenTheTimeIsUp) {
  const PathProblem problem = with_motion_defaults(
      io::load_path_problem(std::string(SWIVEL_DATA_DIR) + "/problems/experiment_a.yaml"));
  // Stopped as soon as the lattice's path is known.
  std::stop_source stop;
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.stop = stop.get_token();
  Planner planner(problem);
  const PlanResult lattice = planner.plan(options);
  ASSERT_EQ(lattice.status, PlanStatus::kSolved);
  int stopped = 0, whole = 0;
  for (double timeout = 1e-4; timeout < 4; timeout *= 1.5) {
    options.timeout_s = timeout;
    const MotionPlan plan = plan_motion(
        planner, options, true, TimingOptions{.speed = 0.05, .turn_speed = {}, .rate = 250});
    if (plan.result.status != PlanStatus::kSolved) {
      EXPECT_FALSE(plan.refinement || plan.motion);
      continue;
    }
    ASSERT_TRUE(plan.refinement && plan.motion);
    (plan.stopped ? stopped : whole)++;
    EXPECT_EQ(plan.stopped, !plan.motion->motion);
    EXPECT_EQ(plan.result.trajectory.size(), lattice.trajectory.size());
    if (!plan.stopped) continue;
    EXPECT_EQ(plan.motion->failure->reason, "stopped");
    if (!plan.refinement->refined) {
      EXPECT_EQ(plan.refinement->reason, "stopped");
      EXPECT_EQ(plan.result.trajectory[1].q, lattice.trajectory[1].q);
      EXPECT_EQ(plan.result.cost, lattice.cost);
    }
  }
  std::printf("%d stopped after the path was known, %d not\n", stopped, whole);
  EXPECT_GT(whole, 0);
}

TEST(Motion, RefusesSpeedsThatMakeNoSense) {
  Random random(1);
  const PathProblem some = motion_problem(data_robot("iiwa14"), random);
  const PreparedRobot robot(some);
  for (const TimingOptions& options :
       {TimingOptions{.speed = 0, .turn_speed = {}, .rate = 250},
        TimingOptions{.speed = std::nan(""), .turn_speed = {}, .rate = 250},
        TimingOptions{.speed = 0.1, .turn_speed = -1, .rate = 250},
        TimingOptions{.speed = 0.1, .turn_speed = {}, .rate = 0},
        TimingOptions{.speed = 0.1, .turn_speed = {}, .rate = 250, .chord = 0}})
    EXPECT_THROW(static_cast<void>(time_trajectory(robot, some, {}, options)), InvalidArgument);
}

}  // namespace
}  // namespace swivel
