// SPDX-License-Identifier: BSD-3-Clause
// Arms that are not S-R-S, planned on arcs of their self-motion: the whole way from a problem to a
// trajectory that is checked.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "axes_robots.hpp"
#include "brute_force.hpp"
#include "diagnosis_of.hpp"
#include "motion_problem.hpp"
#include "planners.hpp"
#include "random_problem.hpp"
#include "roll_windows.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

TestRobot arm_of_data(const std::string& name) {
  TestRobot robot = data_robot(name);
  robot.tip_link = "flange";
  return robot;
}

/// Offsets in the wrist, in the shoulder, in both; continuous joints; one without a closed form;
/// one with two joints of two turns, one whose last joint alone has a range of more than a turn.
std::vector<TestRobot> arms() {
  TestRobot wound = with_limits(arm_of_data("xarm7_like"), [](int number, Joint& joint) {
    if (number % 2 == 0)
      joint.lower = number == 6 ? -3.4 : -3.1, joint.upper = number == 6 ? 3.3 : 3.1;
  });
  wound.name = "xarm7_like, one joint of more than a turn";
  TestRobot turns = with_limits(arm_of_data("xarm7_like"), [](int number, Joint& joint) {
    if (number % 2 == 0) joint.upper = number < 4 ? 3.1 : kTwoPi, joint.lower = -joint.upper;
  });
  turns.name = "xarm7_like, two joints of two turns";
  return {arm_of_data("panda_like"),
          arm_of_data("gen3_like"),
          arm_of_data("fetch_like"),
          offset_robot(),
          turns,
          wound};
}

PathProblem random_task(const TestRobot& robot, Random& random) {
  PathProblem problem = random_problem(robot, random);
  problem.limits.step_error.reset();
  problem.limits.arm_slope = Limits().arm_slope;
  problem.resolution.arc = random.uniform(0.3, 0.6);
  problem.limits.joint_step = random.uniform(0.4, 1.0);
  if (problem.limits.tool_path_error) problem.limits.tool_path_error = random.uniform(0.02, 0.1);
  problem.waypoints.resize(2);
  problem.resolution.ds = (problem.waypoints[1].position - problem.waypoints[0].position).norm() /
                          (2 + random.below(3));
  problem.resolution.dalpha = 0.5;
  return problem;
}

/// Counts the random problems by what they have.
struct ArmsCounts {
  int solved = 0, infeasible = 0, wound = 0, started = 0, continuous = 0, obstacles = 0,
      sampled = 0, chosen = 0;
};

/// Plans the problem with every planner, expects the same answer of each and the verdict of brute
/// force, and appends the results in the order of kPlanners.
void plan_with_all(const PreparedRobot& robot, const PathProblem& problem,
                   const BruteForcePath& truth, const std::string& what,
                   std::vector<PlanResult>& results) {
  for (const PlannerKind planner : kPlanners) {
    results.push_back(plan(robot, problem, with_all_evidence(planner)));
    const PlanResult& result = results.back();
    ASSERT_EQ(result.status == PlanStatus::kSolved, truth.solved) << what << ' ' << result.planner;
    ASSERT_TRUE(result.lattice.arcs && !result.lattice.grid) << what;
    ASSERT_EQ(result.lattice.complete, robot.arm_class().complete()) << what;
    ASSERT_EQ(result.cost, results[0].cost) << what << ' ' << result.planner;
    ASSERT_EQ(result.trajectory.size(), results[0].trajectory.size()) << what;
    for (std::size_t i = 0; i < result.trajectory.size(); ++i)
      ASSERT_EQ(result.trajectory[i].q, results[0].trajectory[i].q)
          << what << ' ' << result.planner << " row " << i;
    ASSERT_EQ(diagnosis_of(result).reached_layer, diagnosis_of(results[0]).reached_layer)
        << what << ' ' << result.planner;
    ASSERT_EQ(diagnosis_of(result).cause, diagnosis_of(results[0]).cause)
        << what << ' ' << result.planner;
    ASSERT_EQ(result.partial.size(), results[0].partial.size()) << what << ' ' << result.planner;
  }
}

/// Expects the path of least cost that brute force finds on the lattice, and that it passes the
/// check.
void expect_true_path(const PreparedRobot& robot, const PathProblem& problem,
                      const Lattice& lattice, const BruteForcePath& truth, const PlanResult& result,
                      const std::string& what) {
  const Chain& chain = robot.arm().chain;
  ASSERT_EQ(result.lattice.cost, truth.cost) << what;
  for (std::size_t i = 0; i < truth.slots.size(); ++i) {
    const Config off = result.trajectory[i].q - *lattice.node(static_cast<int>(i), truth.slots[i]);
    for (std::size_t j = 0; j < kDof; ++j)
      if (!chain.limit[j].continuous) {
        ASSERT_LT(std::abs(off[static_cast<Eigen::Index>(j)]), 1e-9) << what << " row " << i;
      }
  }
  const CheckResult check = check_trajectory(robot, problem, result.trajectory);
  ASSERT_TRUE(check.passed) << what << ": " << (check.failures.empty() ? "" : check.failures[0]);
  ASSERT_NEAR(check.cost, result.cost, 1e-9) << what;
}

/// Compares the answers of all planners to one problem with each other and with brute force.
void check_agreement(const PathProblem& problem, const std::string& what, ArmsCounts& counts) {
  const PreparedRobot robot(problem);
  const bool complete = robot.arm_class().complete();
  ASSERT_EQ(robot.arm_class().kind, complete ? ArmKind::kArcs : ArmKind::kSampled) << what;
  counts.sampled += !complete;
  const Chain& chain = robot.arm().chain;
  const ToolPath path = problem_path(problem, chain);
  const ArcLattice circles(chain, robot.arm_class().lock, path, problem);
  const std::unique_ptr<Lattice> turns_apart = circles.with_windings(circles.circles());
  const EdgeRule rule = robot.world().edge_rule(robot.radii());
  const BruteForcePath truth =
      brute_force(*turns_apart, robot.world(), rule, [](int, int, int) { return true; });

  std::vector<PlanResult> results;
  plan_with_all(robot, problem, truth, what, results);
  if (::testing::Test::HasFatalFailure()) return;
  counts.started += problem.start.has_value();
  counts.continuous += problem.limits.edges == EdgeMode::kContinuous;
  counts.obstacles += !problem.scene.empty();
  if (!truth.solved) {
    ++counts.infeasible;
    ASSERT_GE(diagnosis_of(results[0]).reached_layer.value_or(-1), truth.deepest) << what;
    ASSERT_FALSE(words(diagnosis_of(results[0]).cause).empty()) << what;
    return;
  }
  ++counts.solved;
  counts.chosen += truth.chosen;
  counts.wound += results[0].lattice.nodes != circles.nodes();
  expect_true_path(robot, problem, *turns_apart, truth, results[0], what);
}

/// Every planner finds what the definition says: the least cost over nodes whose joints' values are
/// all told apart.
TEST(Arms, FourPlannersAndBruteForceOnRandomProblems) {
  const std::uint64_t base = seed("Arms");
  const auto robots = arms();
  ArmsCounts counts;
  const int count = trials(120);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathProblem problem =
        random_task(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    check_agreement(problem,
                    "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                        " robot " + problem.source,
                    counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d problems: %d solved (%d with windings, %d whose start was chosen among equal costs), %d "
      "infeasible, %d with a start, %d "
      "continuous, %d with obstacles\n",
      count, counts.solved, counts.wound, counts.chosen, counts.infeasible, counts.started,
      counts.continuous, counts.obstacles);
  EXPECT_GE(counts.solved, at_least_among(count / 4));
  EXPECT_GE(counts.infeasible, at_least_among(count / 20));
  EXPECT_GE(counts.started, at_least_among(count / 10));
  EXPECT_GE(counts.continuous, at_least_among(count / 5));
  EXPECT_GE(counts.sampled, at_least_among(count / 8));
  EXPECT_GE(counts.chosen, at_least_among(count / 40));
}

/// An arm of six joints beside a turntable, whose plate is the base link: seven joints, of which
/// the first moves the room against the part. In every other problem a body stands in the room.
TEST(Arms, FourPlannersAndBruteForceBesideATurntable) {
  const std::uint64_t base = seed("Arms.Turntable");
  TestRobot robot = arm_of_data("kr6_turntable_like");
  robot.base_link = "plate";
  ArmsCounts counts;
  const int count = trials(200);
  int turned = 0;
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem = random_task(robot, random);
    if (trial % 2 == 0) {
      const Pose post = random_pose(random, Vector3d(0.5, 0, 0.6), 0.4);
      problem.attached.push_back({"post", Cylinder{0.04, 0.8}, post, "room"});
    }
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    const int solved = counts.solved;
    check_agreement(problem, what, counts);
    if (HasFatalFailure()) return;
    if (counts.solved == solved) continue;
    const std::vector<TrajectoryRow> rows = plan(problem).trajectory;
    turned += std::abs(rows.back().q[0] - rows.front().q[0]) > 0.01;
  }
  std::printf("%d problems: %d solved (%d with windings; in %d the table turns), %d infeasible\n",
              count, counts.solved, counts.wound, turned, counts.infeasible);
  EXPECT_GE(counts.solved, at_least_among(count / 4));
  EXPECT_GE(counts.infeasible, at_least_among(count / 20));
  EXPECT_GE(turned, at_least_among(count / 8));
}

/// Plans random problems of arms of six joints and one more axis with every planner. `axis` is
/// its name; it must move in some of the answers.
void plan_with_one_more_axis(const char* stream, const std::vector<TestRobot>& robots,
                             const std::string& axis) {
  const std::uint64_t base = seed(stream);
  ArmsCounts counts;
  const int count = trials(200);
  int moves = 0;
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathProblem problem =
        random_task(robots[static_cast<std::size_t>(trial) % robots.size()], random);
    const int solved = counts.solved;
    check_agreement(problem,
                    "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                        " robot " + problem.source,
                    counts);
    if (::testing::Test::HasFatalFailure()) return;
    if (counts.solved == solved) continue;
    const auto names = PreparedRobot(problem).arm().chain.joint_names;
    const auto j = std::find(names.begin(), names.end(), axis) - names.begin();
    const std::vector<TrajectoryRow> rows = plan(problem).trajectory;
    moves += std::abs(rows.back().q[j] - rows.front().q[j]) > 0.01;
  }
  std::printf(
      "%d problems: %d solved (%d with windings, in %d the axis moves), %d infeasible, %d with a "
      "start, %d continuous, %d with obstacles\n",
      count, counts.solved, counts.wound, moves, counts.infeasible, counts.started,
      counts.continuous, counts.obstacles);
  EXPECT_GE(counts.solved, at_least_among(count / 4));
  EXPECT_GE(counts.infeasible, at_least_among(count / 20));
  EXPECT_GE(counts.started, at_least_among(count / 10));
  EXPECT_GE(counts.continuous, at_least_among(count / 5));
  EXPECT_GE(moves, at_least_among(count / 8));
}

/// Arms on a rail, on a column, with a slide in the middle or at the wrist.
TEST(Arms, FourPlannersAndBruteForceWithASlide) {
  plan_with_one_more_axis("Arms.Slide", slide_robots(), "slide");
}

TEST(Arms, FourPlannersAndBruteForceOnATorso) {
  plan_with_one_more_axis("Arms.Torso", {torso_robot()}, "torso");
}

/// A path that turns the last joint on from near its limit: the first answer on circles leaves the
/// limits.
TEST(Arms, WindingsAreToldApartWhereAPathLeavesTheLimits) {
  const std::uint64_t base = seed("Arms.Windings");
  const TestRobot robot = arms().back();
  int wound = 0, replanned = 0;
  for (int trial = 0; trial < trials(100); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem = random_task(robot, random);
    problem.scene.clear();
    problem.start.reset();
    problem.limits.joint_margin = 0;
    problem.limits.manipulability = 0;
    problem.limits.joint_step = 0.8;
    const Chain chain = arm_of(robot).chain;
    Config q = random_config(chain, random), to = q;
    q[6] = random.uniform(2.4, 2.9);
    to[6] = q[6] + 1.2;
    problem.waypoints = {waypoint_of(chain.tool(q)), waypoint_of(chain.tool(to))};
    problem.resolution = {.ds = 0.02, .dphi = 0.3, .dalpha = 0.3, .arc = 0.4, .knot = 0};
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Planner planner(problem);
    const PlanResult first = planner.plan();
    const ArcLattice circles(planner.prepare().arm().chain, planner.prepare().arm_class().lock,
                             problem_path(problem, chain), problem);
    wound += first.lattice.nodes > circles.nodes();
    if (first.status != PlanStatus::kSolved) continue;
    const CheckResult check = check_trajectory(planner.prepare(), problem, first.trajectory);
    ASSERT_TRUE(check.passed) << what << ": " << (check.failures.empty() ? "" : check.failures[0]);
    // What a plan remembers does not change the next one's answer.
    const PlanResult again = planner.plan();
    ASSERT_EQ(again.cost, first.cost) << what;
    ASSERT_EQ(again.trajectory.size(), first.trajectory.size()) << what;
    for (std::size_t i = 0; i < again.trajectory.size(); ++i)
      ASSERT_EQ(again.trajectory[i].q, first.trajectory[i].q) << what;
    replanned += first.lattice.nodes > circles.nodes();
  }
  std::printf("%d paths left the limits, %d of them with an answer\n", wound, replanned);
  EXPECT_GE(wound, at_least(5));
  EXPECT_GE(replanned, at_least(2));
}

/// On arms of six joints whose tool may turn about its own axis, all planners return the same path,
/// check_trajectory() passes it, and the tool has the waypoints' poses apart from its roll.
TEST(Arms, SixJointsAndTheRollOfTheTool) {
  for (const char* const name : {"kr6_weld_pipe", "ur5e_deburr_edge"}) {
    PathProblem problem =
        io::load_path_problem(data_dir() / "problems" / (std::string(name) + ".yaml"));
    ASSERT_TRUE(problem.roll) << name;
    problem.resolution.ds = 0.02;
    problem.resolution.arc = 0.4;
    problem.limits.joint_step = 1;
    problem.limits.tool_path_error = 0.01;
    const PreparedRobot robot(problem);
    const Chain& chain = robot.arm().chain;
    ASSERT_TRUE(chain.roll) << name;
    EXPECT_EQ(chain.joint_names.back(), "roll");
    std::optional<PlanResult> first;
    for (const PlannerKind planner : kPlanners) {
      PlanOptions options;
      options.planner = planner;
      options.threads = 2;
      const PlanResult result = plan(robot, problem, options);
      ASSERT_EQ(result.status, PlanStatus::kSolved) << name << ' ' << result.planner;
      if (!first) first = result;
      ASSERT_EQ(result.cost, first->cost) << name << ' ' << result.planner;
      for (std::size_t i = 0; i < result.trajectory.size(); ++i)
        ASSERT_EQ(result.trajectory[i].q, first->trajectory[i].q)
            << name << ' ' << result.planner << " row " << i;
    }
    const CheckResult check = check_trajectory(robot, problem, first->trajectory);
    ASSERT_TRUE(check.passed) << name << ": " << (check.failures.empty() ? "" : check.failures[0]);
    const ToolPath path = problem_path(problem, chain);
    double most = 0;
    for (std::size_t i = 0; i < first->trajectory.size(); ++i) {
      const Config& q = first->trajectory[i].q;
      if (problem.roll->upper - problem.roll->lower < kTwoPi) {
        EXPECT_GE(q[6], problem.roll->lower) << name;
        EXPECT_LE(q[6], problem.roll->upper) << name;
      }
      // Links 1 to 6 do not know of the roll.
      Config other = q;
      other[6] += 0.3;
      const auto here = chain.displacements(q), there = chain.displacements(other);
      for (std::size_t k = 0; k < 6; ++k) EXPECT_TRUE(here[k].isApprox(there[k])) << name;
      const Pose wanted = path.layer(static_cast<int>(i)).tool, tool = chain.tool(q);
      EXPECT_LE((wanted.translation() - tool.translation()).norm(), 1e-9) << name;
      EXPECT_LE((wanted.linear().col(2) - tool.linear().col(2)).norm(), 1e-9) << name;
      most = std::max(most, std::abs(q[6]));
    }
    std::printf("%s: cost %.4f, %zu rows, a roll of up to %.2f rad\n", name, first->cost,
                first->trajectory.size(), most);
    EXPECT_GT(most, 0.01) << name;  // or it would be of no use
    // Without it the arm is another one, of six joints.
    PathProblem without = problem;
    without.roll.reset();
    EXPECT_TRUE(PreparedRobot(without).arm().chain.roll_fixed) << name;
    EXPECT_THROW(robot.require_prepared_for(without), InvalidArgument) << name;
  }
}

/// Computes the cost of the roll by its definition.
double plain_roll_cost(const PathProblem& problem, const std::vector<TrajectoryRow>& rows) {
  double sum = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double before = i > 0 ? rows[i].s - rows[i - 1].s : 0,
                 after = i + 1 < rows.size() ? rows[i + 1].s - rows[i].s : 0;
    sum +=
        problem.cost.roll * (before + after) / 2 * std::abs(std::remainder(rows[i].q[6], kTwoPi));
  }
  return sum;
}

/// Counts the random problems, and on how many of them the cost of the roll has an effect.
struct RollCounts {
  int solved = 0, infeasible = 0, straighter = 0, dearer = 0, hooked = 0, windows = 0;
};

/// A cost of the caller's own, a wave over the third joint.
struct Wave final : StateCost {
  [[nodiscard]] std::string name() const override { return "wave"; }
  void costs(std::span<const Config> states, std::span<double> costs) override {
    for (std::size_t k = 0; k < states.size(); ++k)
      costs[k] = 0.2 + 0.2 * std::sin(5 * states[k][2]);
  }
};

/// A random problem with the weight that `cost.roll` is to have in it, and the caller's own cost.
struct RollCostCase {
  PathProblem problem;
  double weight = 0;
  Hooks hooks;
};

/// Draws a problem of the arm of six joints whose tool may turn within `roll`.
RollCostCase random_roll_cost_case(const char* name, const Roll& roll, Random& random) {
  RollCostCase drawn;
  PathProblem& problem = drawn.problem;
  problem = motion_problem(arm_of_data(name), random, roll);
  problem.smooth.reset();
  if (problem.roll->lower > 0) problem.start.reset();  // it stands unturned
  problem.waypoints.resize(2 + static_cast<std::size_t>(random.below(2)));
  problem.resolution = {
      .ds = random.uniform(0.02, 0.04), .dalpha = 0.3, .arc = random.uniform(0.4, 0.6), .knot = 0};
  problem.limits.joint_step = 1;
  problem.limits.tool_path_error = 0.05;
  problem.limits.roll_slope = random.uniform(10, 30);
  problem.limits.edges = random.coin() ? EdgeMode::kContinuous : EdgeMode::kNodes;
  problem.limits.edge_tolerance = 0.005;
  if (random.coin(0.3)) problem.cost.weights = {1, 1, 1, 1, 1, 1, 0.5};
  if (!problem.roll->circle() && random.coin())
    draw_windows(problem, random, problem.start ? std::optional(0.0) : std::nullopt);
  drawn.weight = std::array{0.3, 3.0, 30.0, 1e5}[static_cast<std::size_t>(random.below(4))];
  if (random.coin(0.3)) drawn.hooks.cost = std::make_shared<Wave>();
  return drawn;
}

/// Finds the answer by brute force, where the roll turns no faster than `roll_slope` allows.
BruteForcePath truth_of(const PreparedRobot& robot, const PathProblem& problem,
                        const ToolPath& path, const Lattice& lattice, const Hooks& hooks) {
  const auto turns_slowly = [&](int layer, int a, int b) {
    const double most_turn = roll_step_bound(path, layer, problem.limits, problem.resolution);
    return std::abs(std::remainder((*lattice.node(layer + 1, b))[6] - (*lattice.node(layer, a))[6],
                                   kTwoPi)) <= most_turn;
  };
  return brute_force(lattice, robot.world(), robot.world().edge_rule(robot.radii()), turns_slowly,
                     hooks);
}

/// Plans the problem with every planner, expects the answer of brute force of each, and sets
/// `first` to the first planner's result where there is a path.
void plan_as_brute_force(const PreparedRobot& robot, const PathProblem& problem, const Hooks& hooks,
                         const BruteForcePath& truth, const std::string& what,
                         std::optional<PlanResult>& first) {
  for (const PlannerKind planner : kPlanners) {
    PlanOptions options;
    options.planner = planner;
    options.threads = 2;
    options.hooks = hooks;
    const PlanResult result = plan(robot, problem, options);
    ASSERT_EQ(result.status == PlanStatus::kSolved, truth.solved) << what << ' ' << result.planner;
    if (!truth.solved) continue;
    ASSERT_EQ(result.cost, truth.cost) << what << ' ' << result.planner;
    if (!first) first = result;
    ASSERT_EQ(result.trajectory.size(), first->trajectory.size()) << what;
    for (std::size_t i = 0; i < result.trajectory.size(); ++i)
      ASSERT_EQ(result.trajectory[i].q, first->trajectory[i].q)
          << what << ' ' << result.planner << " row " << i;
  }
}

/// Expects the path to cost its moves and its roll, and to be turned no more than the `free` one,
/// which is planned with a weight of `least` on the roll. `unit` is the lattice's unit of cost.
void expect_cost_of_roll(const PreparedRobot& robot, const PathProblem& problem,
                         const PlanResult& found, const PlanResult& free, double least, double unit,
                         bool hooked, const std::string& what, RollCounts& counts) {
  const CheckResult check = check_trajectory(robot, problem, found.trajectory);
  ASSERT_TRUE(check.passed) << what << ": " << (check.failures.empty() ? "" : check.failures[0]);
  PathProblem unturned = problem;
  unturned.cost.roll = 1e-6;  // with none at all the waypoints' own turn would not matter
  const double moves = check_trajectory(robot, unturned, found.trajectory).cost -
                       plain_roll_cost(unturned, found.trajectory);
  const double rounding =
      1e-9 * (1 + check.cost) + 2e-12 * unit * static_cast<double>(found.trajectory.size());
  ASSERT_NEAR(check.cost, moves + plain_roll_cost(problem, found.trajectory),
              1e-9 * (1 + check.cost))
      << what;
  if (hooked) {
    ++counts.hooked;
    return;
  }
  ASSERT_NEAR(check.cost, found.cost, rounding) << what;
  // With hardly any cost the moves are no dearer, and the tool is turned no less.
  const double here = plain_roll_cost(problem, found.trajectory),
               there = plain_roll_cost(problem, free.trajectory);
  ASSERT_LE(free.cost, moves + least * here / problem.cost.roll + rounding) << what;
  ASSERT_LE(here, there + 1e-9 * (1 + there)) << what;
  counts.straighter += here < 0.9 * there;
  counts.dearer += moves > free.cost + 1e-6;
}

/// Compares all planners with brute force on one problem and checks the cost of the path's roll.
void check_roll_cost(const RollCostCase& drawn, const std::string& what, RollCounts& counts) {
  PathProblem problem = drawn.problem;
  const PreparedRobot robot(problem);
  constexpr double kLeast = 1e-6;  // with some cost the nodes are the same
  problem.cost.roll = kLeast;
  const PlanResult free = plan(robot, problem);
  problem.cost.roll = drawn.weight;
  const Chain& chain = robot.arm().chain;
  const ToolPath path = problem_path(problem, chain);
  const ArcLattice circles(chain, robot.arm_class().lock, path, problem);
  const std::unique_ptr<Lattice> turns_apart = circles.with_windings(circles.circles());
  const BruteForcePath truth = truth_of(robot, problem, path, *turns_apart, drawn.hooks);
  std::optional<PlanResult> first;
  plan_as_brute_force(robot, problem, drawn.hooks, truth, what, first);
  if (::testing::Test::HasFatalFailure()) return;
  if (!truth.solved) {
    ++counts.infeasible;
    return;
  }
  ++counts.solved;
  if (problem.waypoints[0].roll) {
    ++counts.windows;
    for (int i = 0; i < path.size(); ++i)
      ASSERT_LE(
          outside_windows(problem, path, i, first->trajectory[static_cast<std::size_t>(i)].q[6]),
          1e-8)
          << what;
  }
  ASSERT_EQ(free.status, PlanStatus::kSolved) << what;
  expect_cost_of_roll(robot, problem, *first, free, kLeast, turns_apart->cost_unit(),
                      drawn.hooks.cost != nullptr, what, counts);
}

/// `cost.roll` is part of what all planners and brute force find least.
TEST(Arms, TheRollCostsWhatTheToolIsTurned) {
  const std::uint64_t base = seed("Arms.RollCost");
  const std::vector<std::pair<const char*, Roll>> robots{
      {"kr6_like", Roll{}}, {"ur5e_like", Roll{-0.8, 0.8}}, {"kr6_like", Roll{2.6, 4}}};
  RollCounts counts;
  const int count = trials(54);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const auto& [name, roll] = robots[static_cast<std::size_t>(trial) % robots.size()];
    check_roll_cost(
        random_roll_cost_case(name, roll, random),
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) + " " + name,
        counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d problems: %d solved, %d of them with a cost of the caller's own, %d with windows of "
      "roll, %d infeasible; %d straighter, "
      "%d "
      "of dearer moves\n",
      count, counts.solved, counts.hooked, counts.windows, counts.infeasible, counts.straighter,
      counts.dearer);
  EXPECT_GE(counts.windows, at_least_among(count / 18));
  EXPECT_GE(counts.solved, at_least_among(count / 3));
  EXPECT_GE(counts.hooked, at_least_among(count / 12));
  EXPECT_GE(counts.straighter, at_least_among(count / 6));
  EXPECT_GE(counts.dearer, at_least_among(count / 12));
}

TEST(Arms, AStartThatDoesNotFitIsBadInput) {
  for (const char* const name : {"panda_weld_seam", "ur5e_deburr_edge"}) {
    PathProblem problem =
        io::load_path_problem(data_dir() / "problems" / (std::string(name) + ".yaml"));
    const PlanResult whole = plan(problem);
    ASSERT_EQ(whole.status, PlanStatus::kSolved) << name;
    const auto message = [&](const Config& start) -> std::string {
      PathProblem started = problem;
      started.start = start;
      try {
        static_cast<void>(plan(started));
      } catch (const InputError& error) {
        return error.what();
      }
      return "";
    };
    const Config q = whole.trajectory[0].q;
    EXPECT_EQ(message(q), "") << name;
    Config off = q;
    off[1] += 0.01;
    EXPECT_NE(message(off).find("start.joints: the tool is"), std::string::npos)
        << name << ": " << message(off);
    off = q;
    off[1] += 2 * kTwoPi;
    EXPECT_NE(message(off).find("is outside its limits: allowed is"), std::string::npos)
        << name << ": " << message(off);
    if (!problem.roll) continue;
    for (Waypoint& waypoint : problem.waypoints) waypoint.roll = problem.roll;
    EXPECT_EQ(message(q), "");
    problem.waypoints[0].roll =
        q[6] > 0 ? Roll{problem.roll->lower, q[6] - 0.01} : Roll{q[6] + 0.01, problem.roll->upper};
    EXPECT_NE(message(q).find("the roll_min and roll_max of its waypoints"), std::string::npos)
        << message(q);
  }
}

TEST(Arms, WhatNeedsAnArmAngleSaysSo) {
  const auto message = [](const PathProblem& problem) -> std::string {
    try {
      (void)plan(problem);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  Random random(1);
  PathProblem problem = random_task(arms()[0], random);
  problem.limits.step_error = 0.1;
  EXPECT_EQ(message(problem),
            problem.source +
                ": limits.step_error: needs the closed form of an S-R-S arm: allowed is null");
  problem.limits.step_error.reset();
  problem.limits.arm_slope = 21;
  EXPECT_EQ(message(problem), problem.source +
                                  ": limits.arm_slope: the arm has no arm angle, since it is not "
                                  "S-R-S: allowed is to leave it out");
}

}  // namespace
}  // namespace swivel
