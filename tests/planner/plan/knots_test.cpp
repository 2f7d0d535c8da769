// SPDX-License-Identifier: BSD-3-Clause
// Lattices of arcs whose nodes lie at knots, every few layers of the path: what is planned on them
// against plain searches by the definition (docs/model.md "Knots").
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include "answer_order.hpp"
#include "arms.hpp"
#include "axes_robots.hpp"
#include "brute_force.hpp"
#include "diagnosis_of.hpp"
#include "grid_windows.hpp"
#include "knot_problems.hpp"
#include "knot_search.hpp"
#include "planners.hpp"
#include "random_problem.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

/// Returns the least cost of a path through a lattice's nodes with all steps halved to every layer.
double least_on_all_layers(const PreparedRobot& robot, std::unique_ptr<Lattice> lattice) {
  for (;;) {
    std::set<int> steps;
    for (int step = 0; step + 1 < lattice->layers(); ++step) steps.insert(step);
    std::unique_ptr<Lattice> finer = lattice->with_knots(steps, {});
    if (!finer) break;
    lattice = std::move(finer);
  }
  const EdgeRule rule = robot.world().edge_rule(robot.radii());
  const BruteForcePath best =
      brute_force(*lattice, robot.world(), rule,
                  [&](int layer, int a, int b) { return lattice->in_window(layer, a, b); });
  return best.solved ? best.cost : kNone;
}

struct KnotCounts {
  int solved = 0, infeasible = 0, halved = 0, halved_to_solve = 0, dearer_than_bound = 0;
};

void check_agreement(const PathProblem& problem, const std::string& what, KnotCounts& counts) {
  const PreparedRobot robot(problem);
  const ToolPath path = problem_path(problem, robot.arm().chain);
  const JoinableOnGrid joinable(problem);
  const bool on_grid = robot.arm_class().srs.has_value();
  PlainAnswer truth = plan_plainly(
      robot, problem, make_lattice(robot.arm().chain, robot.arm_class(), path, problem),
      [&](const Lattice& lattice, int layer, int a, int b) {
        return !on_grid || joinable(dynamic_cast<const KnotGrid&>(lattice), layer, a, b);
      });
  std::optional<PlanResult> first;
  for (const PlannerKind planner : kPlanners) {
    const PlanResult result = plan(robot, problem, with_all_evidence(planner));
    ASSERT_EQ(result.status == PlanStatus::kSolved, !truth.rows.empty()) << what << result.planner;
    if (!first) first = result;
    ASSERT_EQ(diagnosis_of(result).cause, diagnosis_of(*first).cause) << what << result.planner;
    ASSERT_EQ(diagnosis_of(result).reached_layer, diagnosis_of(*first).reached_layer)
        << what << result.planner;
    if (result.lattice.knots && result.lattice.knots->bound) {
      ASSERT_EQ(*result.lattice.knots->bound, truth.bound) << what << result.planner;
    }
    if (truth.rows.empty()) continue;
    ASSERT_NEAR(result.cost, truth.cost, 1e-9) << what << result.planner;
    ASSERT_EQ(result.trajectory.size(), truth.rows.size()) << what << result.planner;
    for (std::size_t i = 0; i < truth.rows.size(); ++i)
      ASSERT_EQ(result.trajectory[i].q, truth.rows[i].q) << what << result.planner << " row " << i;
  }
  counts.halved += truth.halvings > 0;
  (truth.rows.empty() ? counts.infeasible : counts.solved)++;
  if (truth.rows.empty()) {
    ASSERT_EQ(diagnosis_of(*first).reached_layer.value_or(-1), truth.deepest) << what;
    return;
  }
  const CheckResult check = check_trajectory(robot, problem, first->trajectory);
  ASSERT_TRUE(check.passed) << what << ": " << (check.failures.empty() ? "" : check.failures[0]);
  ASSERT_NEAR(check.cost, first->cost, 1e-9) << what;
  if (!first->lattice.knots) return;  // every layer is a knot
  const double least = least_on_all_layers(robot, std::move(truth.last));
  if (!first->lattice.knots->bound) return;  // nodes are only near the joints of their rows
  ASSERT_LE(*first->lattice.knots->bound, least + 1e-9) << what;
  ASSERT_GE(*first->lattice.knots->gap, truth.cost / least - 1 - 1e-9) << what;
  counts.dearer_than_bound += *first->lattice.knots->gap > 1e-6;
}

/// Every planner finds what the definition says, at all levels of halving.
TEST(Knots, FourPlannersAndBruteForceOnRandomProblems) {
  const std::uint64_t base = seed("Knots");
  const auto robots = arms_of_one_turn();
  KnotCounts counts;
  const int count = trials(300);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem =
        random_task(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    if (trial % 4 != 0) put_in_the_way(problem, random);
    check_agreement(problem,
                    "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                        " robot " + problem.source + ' ',
                    counts);
    if (HasFatalFailure()) return;
  }
  std::printf("%d problems: %d solved, %d infeasible, %d with steps halved, %d above the bound\n",
              count, counts.solved, counts.infeasible, counts.halved, counts.dearer_than_bound);
  EXPECT_GE(counts.solved, at_least_among(count / 4));
  EXPECT_GE(counts.infeasible, at_least_among(count / 20));
  EXPECT_GE(counts.halved, at_least_among(count / 20));
}

/// Moves a body of the scene a little, or far.
void move_some_object(Planner& planner, Random& random) {
  const std::vector<SceneObject>& scene = planner.problem().scene;
  const SceneObject& object =
      scene[static_cast<std::size_t>(random.below(static_cast<int>(scene.size())))];
  Pose pose = object.pose;
  const double far = random.coin(0.7) ? 0.02 : 0.2;
  for (int k = 0; k < 3; ++k) pose.translation()[k] += random.uniform(-far, far);
  planner.move(object.name, pose);
}

void expect_same(const PlanResult& result, const PlanResult& other, const std::string& what) {
  ASSERT_EQ(result.status, other.status) << what;
  ASSERT_EQ(result.cost, other.cost) << what;
  ASSERT_EQ(result.lattice.nodes, other.lattice.nodes) << what;
  ASSERT_EQ(result.lattice.knots.has_value(), other.lattice.knots.has_value()) << what;
  if (result.lattice.knots) {
    ASSERT_EQ(result.lattice.knots->bound, other.lattice.knots->bound) << what;
  }
  ASSERT_EQ(result.trajectory.size(), other.trajectory.size()) << what;
  for (std::size_t i = 0; i < result.trajectory.size(); ++i)
    ASSERT_EQ(result.trajectory[i].q, other.trajectory[i].q) << what << " row " << i;
  ASSERT_EQ(diagnosis_of(result).reached_layer, diagnosis_of(other).reached_layer) << what;
  ASSERT_EQ(diagnosis_of(result).cause, diagnosis_of(other).cause) << what;
}

/// Moves, adds or removes a body, or asks for another clearance.
void change_something(Planner& planner, int again, Random& random) {
  const int kind = random.below(8);
  if (kind == 0) {
    SceneObject object = planner.problem().scene.front();
    object.name = "again_" + std::to_string(again);
    for (int k = 0; k < 3; ++k) object.pose.translation()[k] += random.uniform(-0.1, 0.1);
    planner.add(object);
  } else if (kind == 1 && planner.problem().scene.size() > 1) {
    planner.remove(planner.problem().scene.front().name);
  } else if (kind == 2) {
    Task task = planner.problem();
    task.limits.clearance = random.uniform(0, 0.02);
    planner.set_task(task);
  } else {
    move_some_object(planner, random);
  }
}

/// A planner that plans again after changes of bodies and clearances, at one thread or two, answers
/// as a fresh one does, halvings included.
TEST(Knots, PlansAgainAsAFreshPlannerDoes) {
  const std::uint64_t base = seed("Knots.Again");
  const auto robots = arms_of_one_turn();
  const int count = trials(50);
  int plans = 0, halved = 0, solved = 0;
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem =
        random_task(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    put_in_the_way(problem, random);
    if (problem.scene.empty()) continue;
    Planner planner(problem);
    for (int again = 0; again < 8; ++again) {
      if (again > 0) change_something(planner, again, random);
      const PlannerKind kind = random.coin() ? PlannerKind::kLazy : PlannerKind::kParallel;
      const PlanResult result = planner.plan(with_all_evidence(kind));
      const PlanResult fresh = plan(planner.problem(), with_all_evidence(PlannerKind::kLazy));
      expect_same(result, fresh,
                  "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                      " plan " + std::to_string(again));
      if (HasFatalFailure()) return;
      ++plans;
      solved += result.status == PlanStatus::kSolved;
      const PreparedRobot robot(planner.problem());
      const ToolPath path = problem_path(planner.problem(), robot.arm().chain);
      halved +=
          result.lattice.layers >
          make_lattice(robot.arm().chain, robot.arm_class(), path, planner.problem())->layers();
    }
  }
  std::printf("%d plans of planners used again: %d solved, %d with steps halved\n", plans, solved,
              halved);
  EXPECT_GE(plans, at_least_among(3 * count));
  EXPECT_GE(solved, at_least_among(plans / 5));
  EXPECT_GE(halved, at_least_among(plans / 20));
}

/// Returns whether the first search of a problem has an answer, and steps worth halving.
bool halves_after_an_answer(const PathProblem& problem) {
  const PreparedRobot robot(problem);
  const ToolPath path = problem_path(problem, robot.arm().chain);
  const EdgeRule rule = robot.world().edge_rule(robot.radii());
  const ArcLattice lattice(robot.arm().chain, robot.arm_class().lock, path, problem);
  PlainLattice plain(lattice, robot.world(), rule, [](int, int, int) { return true; });
  const PlainSearch found = PlainKnotSearch(plain, lattice.layers() - 1, kNone).run();
  return !found.path.empty() && !found.narrow.empty() && found.cost > 1.01 * found.bound;
}

/// Where time ends while steps are halved, the answer is that of the search before, and proved.
TEST(Knots, AStopWhileStepsAreHalvedKeepsTheAnswer) {
  const std::uint64_t base = seed("Knots.Stop");
  auto robots = arms_of_one_turn();
  std::erase_if(robots, [](const TestRobot& robot) { return has_arm_angle(robot); });
  int stopped = 0;
  for (std::uint64_t trial = 0; trial < 3000 && stopped < 2; ++trial) {
    Random random(base + trial);
    const PathProblem problem = random_task(robots[trial % robots.size()], random);
    if (!halves_after_an_answer(problem)) continue;
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    options.timeout_s = 2;
    const auto begin = std::chrono::steady_clock::now();
    bool searched = false;
    options.progress = [&](const Progress& progress) {
      if (progress.stage == Stage::kSearch) searched = true;
      if (progress.stage == Stage::kSweep && searched)
        std::this_thread::sleep_until(begin + std::chrono::milliseconds(1700));
    };
    const PlanResult result = plan(problem, options);
    ASSERT_EQ(result.status, PlanStatus::kSolved) << "trial " << trial;
    ASSERT_TRUE(result.lattice.knots && !result.lattice.knots->halved) << "trial " << trial;
    ASSERT_TRUE(result.checked) << "trial " << trial;
    ++stopped;
  }
  EXPECT_EQ(stopped, 2);
}

/// Says where every layer has nodes although the problem asks for knots.
TEST(Knots, IsWarnedOfWhereEveryLayerHasNodes) {
  const std::string line =
      "resolution.knot is given in vain: strokes in several runs have nodes at every layer of the "
      "path";
  const auto told = [&](const Answer& answer) {
    return std::count(answer.warnings.begin(), answer.warnings.end(), line);
  };
  Problem job = io::load_problem(data_dir() / "problems/kr6_weld_pipe_job.yaml");
  for (Stroke& stroke : job.arm().strokes) stroke.resolution.knot = 0.06;
  EXPECT_EQ(told(plan_job(job)), 0);
  job = with_lift_offs(job, {{0, 0.05, 0.05}});
  const Answer cut = plan_job(job);
  EXPECT_EQ(cut.status, PlanStatus::kSolved);
  EXPECT_EQ(told(cut), 1);
  for (const RunAnswer& run : cut.arm().runs)
    EXPECT_EQ(run.lattice.knots.has_value(), !job.arm().strokes[run.run.stroke].piece);
}

/// Where a free roll has a weight, the cost of rows between knots is that of the check: what the
/// tool turns about its own axis, not what the roll says that is counted from the waypoints.
TEST(Knots, RowsOfAFreeRollCostWhatTheCheckSays) {
  PathProblem problem = io::load_path_problem(data_dir() / "problems/kr6_weld_pipe.yaml");
  problem.cost.weights = {1, 1, 1, 1, 1, 1, 1};
  const PreparedRobot robot(problem);
  const PlanResult found = plan(robot, problem);
  ASSERT_EQ(found.status, PlanStatus::kSolved);
  EXPECT_NEAR(check_trajectory(robot, problem, found.trajectory).cost, found.cost, 1e-9);
  EXPECT_GE(found.cost, *found.lattice.knots->bound - 1e-9);
}

/// With knots of 60 mm and nodes 0.07 rad apart, the defaults, the problems of data/ along arcs
/// cost hardly more than their refined paths, however fine the layers are.
/// Paths of S-R-S arms at knots cost little more than those with nodes at every layer, near
/// singular poses too, where rows between knots drift.
TEST(Knots, CostLittleMoreThanNodesAtEveryLayer) {
  const std::uint64_t base = seed("Knots.CostLittleMoreThanNodesAtEveryLayer");
  int compared = 0, dear = 0;
  double most = 0;
  for (int trial = 0; trial < trials(160); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const auto robots = all_robots();
    const TestRobot& robot = robots[static_cast<std::size_t>(trial) % robots.size()];
    PathProblem problem = problem_for(robot);
    problem.resolution = {};
    problem.limits = {};
    const Chain chain = arm_of(robot).chain;
    Config q = random_config(chain, random);
    if (random.coin()) q[random.one_of({1, 5})] = random.uniform(-0.1, 0.1);
    if (random.coin()) problem.start = q;
    for (int k = 0; k < 3; ++k) {
      problem.waypoints.push_back(waypoint_of(chain.tool(q)));
      for (int j = 0; j < kDof; ++j) q[j] += random.uniform(-0.3, 0.3);
    }
    const PreparedRobot prepared(problem);
    const PlanResult at_knots = plan(prepared, problem);
    problem.resolution.knot = 0;
    const PlanResult at_layers = plan(prepared, problem);
    if (at_knots.status != PlanStatus::kSolved || at_layers.status != PlanStatus::kSolved) continue;
    ++compared;
    const double ratio = at_knots.cost / at_layers.cost;
    // Starts beside a singular pose may leave it by arcs of self-motion that no grid at knots has.
    if (problem.start)
      dear += ratio > 1.05;
    else
      most = std::max(most, ratio);
  }
  std::printf(
      "%d paths compared; with a start %d dearer by 5 %%, without at most %.3f times as dear\n",
      compared, dear, most);
  EXPECT_GE(compared, at_least(100));
  EXPECT_LE(dear, 2 + compared / 50);
  EXPECT_LE(most, 1.05);
}

TEST(Knots, PlansComeNearTheirRefinedPaths) {
  for (const char* const name : {"panda_weld_seam", "panda_polish_cover", "gen3_glue_bead",
                                 "xarm7_polish_raster", "fetch_wipe_table", "ur5e_deburr_edge",
                                 "kr6_weld_pipe", "ur10e_rail_seam", "kr6_turntable_pipe"}) {
    PathProblem problem =
        io::load_path_problem(data_dir() / "problems" / (std::string(name) + ".yaml"));
    PathProblem at_layers = problem;
    at_layers.resolution.knot = 0;
    const double every_layer = plan(at_layers).cost;
    const PreparedRobot robot(problem);
    const PlanResult found = plan(robot, problem);
    ASSERT_EQ(found.status, PlanStatus::kSolved) << name;
    const Refined refined = refine(robot, problem, found.trajectory);
    std::printf("%s: %.4f at every layer, %.4f at knots, %.4f refined\n", name, every_layer,
                found.cost, refined.cost);
    EXPECT_LE(found.cost, 1.02 * refined.cost) << name;
    ASSERT_TRUE(found.lattice.knots && found.lattice.knots->bias) << name;
    EXPECT_LE(found.cost, (1 + *found.lattice.knots->bias) * refined.cost) << name;
    EXPECT_LE(found.cost, 1.001 * every_layer) << name;
  }
  PathProblem seam = io::load_path_problem(data_dir() / "problems/panda_weld_seam.yaml");
  // The bias goes with the square of `arc`; of other metrics there is none.
  const double bias = *plan(seam).lattice.knots->bias;
  seam.resolution.arc = 0.5 * seam.resolution.arc_of_nodes();
  EXPECT_NEAR(*plan(seam).lattice.knots->bias, bias / 4, 0.02 * bias);
  seam.resolution.arc.reset();
  seam.cost.metric = CostMetric::kMax;
  EXPECT_FALSE(plan(seam).lattice.knots->bias);
  seam.cost.metric = CostMetric::kL2;
  double least = kNone, most = 0;
  for (const double ds : {0.0025, 0.005, 0.01, 0.02}) {
    seam.resolution.ds = ds;
    const double cost = plan(seam).cost;
    least = std::min(least, cost), most = std::max(most, cost);
  }
  std::printf("panda_weld_seam with ds from 2.5 to 20 mm: %.4f to %.4f\n", least, most);
  EXPECT_LE(most, 1.02 * least);
}

}  // namespace
}  // namespace swivel
