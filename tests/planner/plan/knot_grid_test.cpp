// SPDX-License-Identifier: BSD-3-Clause
// S-R-S arms whose tool may stand turned about its own z axis: roll and arm angle are chosen
// together.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "brute_force.hpp"
#include "diagnosis_of.hpp"
#include "grid_windows.hpp"
#include "inexact_robots.hpp"
#include "knot_search.hpp"
#include "planners.hpp"
#include "random_problem.hpp"
#include "roll_windows.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/lattice/kinds/knot_grid.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"
#include "swivel/graph/search/path_first.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

/// Arms of the data folder and made here, with limits of less and of more than a turn, without
/// limits, and not exactly S-R-S.
std::vector<TestRobot> robots(Random& random) {
  std::vector<TestRobot> all = all_robots();
  all.push_back(perturbed(all.front(), 1, random));
  return all;
}

/// Small enough for brute force. Some tools stand at an angle to the last joint, so that their
/// wrist centre moves with the roll.
PathProblem roll_problem(const TestRobot& robot, Random& random) {
  PathProblem problem = random_problem(robot, random);
  if (random.coin(0.4)) {
    const Pose angled = Eigen::Translation3d(0.05, 0, 0.1) *
                        Eigen::AngleAxisd(random.uniform(0.2, 1), Vector3d::UnitY());
    problem.tool = problem.tool * angled;
    for (Waypoint& waypoint : problem.waypoints) {
      const Pose moved =
          Pose(Eigen::Translation3d(waypoint.position) * waypoint.orientation) * angled;
      waypoint = {moved.translation(), Quaterniond(moved.linear())};
    }
  }
  problem.limits.step_error.reset();
  problem.roll = random.coin(0.4) ? Roll{} : Roll{random.uniform(-2, -0.1), random.uniform(0.1, 2)};
  if (random.coin(0.2)) problem.roll = Roll{random.uniform(0.2, 0.4), random.uniform(0.6, 4)};
  problem.resolution.ds /= 2;
  problem.resolution.knot = problem.resolution.ds * random.uniform(1.5, 4);
  problem.resolution.droll = random.uniform(0.5, 1.2);
  problem.resolution.dphi = robot.name == "windings" ? 1.2 : random.uniform(0.5, 0.9);
  problem.resolution.dalpha = random.uniform(0.3, 0.6);
  problem.limits.arm_slope =
      random.uniform(0.8, 2) * problem.resolution.dphi / *problem.resolution.knot;
  problem.limits.roll_slope =
      random.uniform(1.01, 2) * problem.resolution.droll / *problem.resolution.knot;
  if (problem.limits.tool_path_error) problem.limits.tool_path_error = random.uniform(0.02, 0.1);
  if (problem.limits.tool_angle_error) problem.limits.tool_angle_error = random.uniform(0.1, 0.4);
  if (problem.waypoints.size() > 3) problem.waypoints.resize(3);
  if (problem.start && !(problem.roll->upper - problem.roll->lower >= kTwoPi) &&
      problem.roll->lower > 0)
    problem.start.reset();
  if (!problem.roll->circle() && random.coin())
    draw_windows(problem, random, problem.start ? std::optional(0.0) : std::nullopt);
  if (random.coin(0.3))
    problem.cost.roll = std::array{0.3, 3.0, 30.0}[static_cast<std::size_t>(random.below(3))];
  return problem;
}

/// Checks poses, arm angles and labels of all rows by forward kinematics, on a path whose roll and
/// arm angle change.
void expect_rows_on_path(const PreparedRobot& robot, const PathProblem& problem,
                         const std::vector<TrajectoryRow>& rows, const std::string& what) {
  const Chain& chain = robot.arm().chain;
  const SrsArm& arm = robot.srs();
  const ToolPath path = problem_path(problem, chain);
  const std::vector<ArmPlane> planes = carried_planes(arm, path);
  ASSERT_EQ(static_cast<int>(rows.size()), path.size()) << what;
  for (int i = 0; i < path.size(); ++i) {
    const TrajectoryRow& row = rows[static_cast<std::size_t>(i)];
    const double turn = row.roll + path.waypoint_turn(path.layer(i).travel);
    const Pose wanted = path.layer(i).tool * Eigen::AngleAxisd(turn, Vector3d::UnitZ()),
               tool = chain.tool(row.q);
    const double tolerance = i == 0 && problem.start ? 1e-6 : 1e-9;
    ASSERT_LE((wanted.matrix() - tool.matrix()).norm(), tolerance) << what << " row " << i;
    const ArmPlane plane = carry_plane(arm, planes[static_cast<std::size_t>(i)], wanted);
    ASSERT_LE(std::abs(wrap_angle(arm_angle(arm, plane, row.q) - row.phi)), 1e-6)
        << what << " row " << i;
    if (problem.roll->upper - problem.roll->lower < kTwoPi) {
      ASSERT_GE(row.roll, problem.roll->lower - 1e-6) << what;
      ASSERT_LE(row.roll, problem.roll->upper + 1e-6) << what;
    }
    if (problem.waypoints[0].roll)
      ASSERT_LE(outside_windows(problem, path, i, row.roll), 1e-6) << what << " row " << i;
  }
}

/// Counts the problems by what they have and by how they end.
struct Counts {
  int solved = 0, infeasible = 0, started = 0, continuous = 0, obstacles = 0, circles = 0,
      inexact = 0, turned = 0, between = 0;
  int at_rest = 0, moved_after_all = 0, windows = 0, costly = 0, halved = 0;
};

/// Holds a lattice of one problem and its answer by plain searches.
struct Truth {
  std::unique_ptr<const KnotGrid> lattice;  // the first one
  PlainAnswer answer;
  [[nodiscard]] bool solved() const { return !answer.rows.empty(); }
};

/// Plans by plain searches: with joint 7 at rest where that is enough, else with all rolls.
Truth truth_of(const PreparedRobot& robot, const ToolPath& path, const PathProblem& problem,
               Counts& counts) {
  const Chain& chain = robot.arm().chain;
  const JoinableOnGrid joinable(problem);
  const auto on = [&](const std::optional<double>& rest) {
    Truth truth;
    truth.lattice = KnotGrid::make(chain, robot.srs(), path, problem, {}, rest);
    truth.answer =
        plan_plainly(robot, problem, KnotGrid::make(chain, robot.srs(), path, problem, {}, rest),
                     [&](const Lattice& lattice, int layer, int a, int b) {
                       return joinable(dynamic_cast<const KnotGrid&>(lattice), layer, a, b);
                     });
    return truth;
  };
  // Joint 7 at rest where that is enough.
  const std::optional<double> rest = last_joint_at_rest(chain, robot.arm_class(), problem);
  Truth truth = on(rest);
  counts.at_rest += rest && truth.solved();
  if (rest && !truth.solved()) {
    truth = on({});
    counts.moved_after_all += truth.solved();
  }
  counts.halved += truth.answer.halvings > 0;
  return truth;
}

/// Checks a planner's answer, with its rows and reasons, against the first planner's.
void expect_same_answer(const PlanResult& result, const PlanResult& first, const Truth& truth,
                        const std::string& what) {
  ASSERT_EQ(result.status == PlanStatus::kSolved, truth.solved()) << what << ' ' << result.planner;
  ASSERT_TRUE(result.lattice.grid && result.lattice.grid->rolls == truth.lattice->rolls()) << what;
  ASSERT_EQ(result.cost, first.cost) << what << ' ' << result.planner;
  ASSERT_EQ(result.trajectory.size(), first.trajectory.size()) << what;
  for (std::size_t i = 0; i < result.trajectory.size(); ++i)
    ASSERT_EQ(result.trajectory[i].q, first.trajectory[i].q)
        << what << ' ' << result.planner << " row " << i;
  ASSERT_EQ(diagnosis_of(result).reached_layer, diagnosis_of(first).reached_layer)
      << what << ' ' << result.planner;
  ASSERT_EQ(diagnosis_of(result).cause, diagnosis_of(first).cause) << what << ' ' << result.planner;
}

/// Checks the cost and the rows of a path, and counts what it has.
void expect_path(const PreparedRobot& robot, const PathProblem& problem, const PlanResult& result,
                 const Truth& truth, const std::string& what, Counts& counts) {
  ASSERT_NEAR(result.lattice.cost, truth.answer.chords, 1e-9) << what;
  ASSERT_NEAR(result.cost, truth.answer.cost, 1e-9) << what;
  const auto& rows = result.trajectory;
  expect_rows_on_path(robot, problem, rows, what);
  counts.between += static_cast<int>(rows.size()) > truth.lattice->layers();
  counts.turned += std::any_of(rows.begin(), rows.end(),
                               [&](const TrajectoryRow& row) { return row.roll != rows[0].roll; });
  counts.windows += problem.waypoints[0].roll.has_value();
  counts.costly += problem.cost.roll > 0;
  const CheckResult check = check_trajectory(robot, problem, rows);
  ASSERT_TRUE(check.passed) << what << ": " << (check.failures.empty() ? "" : check.failures[0]);
  ASSERT_NEAR(check.cost, result.cost, 1e-9) << what;
}

/// Checks all planners on one problem against brute force.
void check_problem(const PathProblem& problem, const std::string& what, Counts& counts) {
  const PreparedRobot robot(problem);
  const ToolPath path = problem_path(problem, robot.arm().chain);
  const Truth truth = truth_of(robot, path, problem, counts);
  std::optional<PlanResult> first;
  for (const PlannerKind planner : kPlanners) {
    const PlanResult result = plan(robot, problem, with_all_evidence(planner));
    if (!first) first = result;
    expect_same_answer(result, *first, truth, what);
    if (::testing::Test::HasFatalFailure()) return;
  }
  counts.started += problem.start.has_value();
  counts.continuous += problem.limits.edges == EdgeMode::kContinuous;
  counts.obstacles += !problem.scene.empty();
  counts.circles += problem.roll->upper - problem.roll->lower >= kTwoPi;
  counts.inexact += !robot.srs().exact;
  if (truth.solved()) {
    ++counts.solved;
    expect_path(robot, problem, *first, truth, what, counts);
  } else {
    ++counts.infeasible;
    ASSERT_GE(diagnosis_of(*first).reached_layer.value_or(-1), truth.answer.deepest) << what;
    ASSERT_FALSE(words(diagnosis_of(*first).cause).empty()) << what;
  }
}

TEST(KnotGrid, FourPlannersAndBruteForceOnRandomProblems) {
  const std::uint64_t base = seed("KnotGrid");
  Random any(base);
  const auto arms = robots(any);
  Counts counts;
  const int count = trials(80);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathProblem problem =
        roll_problem(arms[static_cast<std::size_t>(trial) % arms.size()], random);
    check_problem(problem,
                  "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                      " robot " + problem.source,
                  counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d problems: %d solved (%d turn the tool, %d with layers between), %d infeasible, %d with a "
      "start, %d continuous, %d with "
      "obstacles, "
      "%d with all rolls, %d on arms that are not exactly S-R-S; joint 7 at rest in %d, moved "
      "after all in %d; solved with windows "
      "of roll %d, with a cost of it %d; steps halved in %d\n",
      count, counts.solved, counts.turned, counts.between, counts.infeasible, counts.started,
      counts.continuous, counts.obstacles, counts.circles, counts.inexact, counts.at_rest,
      counts.moved_after_all, counts.windows, counts.costly, counts.halved);
  EXPECT_GE(counts.windows, at_least_among(count / 20));
  EXPECT_GE(counts.costly, at_least_among(count / 12));
  EXPECT_GE(counts.solved, at_least_among(count / 4));
  EXPECT_GE(counts.infeasible, at_least_among(count / 20));
  EXPECT_GE(counts.started, at_least_among(count / 10));
  EXPECT_GE(counts.continuous, at_least_among(count / 5));
  EXPECT_GE(counts.turned, at_least_among(count / 20));
  EXPECT_GE(counts.between, at_least_among(count / 5));
  EXPECT_GE(counts.circles, at_least_among(count / 5));
  EXPECT_GE(counts.inexact, at_least_among(count / 20));
  EXPECT_GE(counts.at_rest, at_least_among(count / 40));
}

/// Makes a random path without obstacles or a start, along which all rolls are free.
PathProblem free_roll_problem(const TestRobot& robot, CostMetric metric, Random& random) {
  PathProblem problem = random_problem(robot, random);
  problem.limits = {};
  problem.limits.joint_step = 2;
  problem.limits.roll_slope = 1000;
  problem.cost.metric = metric;
  problem.scene.clear();
  problem.start.reset();
  problem.roll = Roll{};
  problem.resolution.knot = 2 * problem.resolution.ds;
  problem.resolution.droll = 0.2;
  return problem;
}

/// Counts paths along which joint 7 rests, and those along which it moves.
struct RestCounts {
  int both = 0, cheaper = 0, neither = 0, refined = 0, inexact = 0;
};

/// Checks that the least path with joint 7 at rest costs no more than the least of all rolls.
void compare_rest_with_motion(const PreparedRobot& robot, const PathProblem& problem,
                              const std::string& what, RestCounts& counts) {
  const Chain& chain = robot.arm().chain;
  const ToolPath path = problem_path(problem, chain);
  const auto least = [&](const std::unique_ptr<Lattice>& lattice) {
    const auto cost_to_go = make_cost_to_go(*lattice);
    cost_to_go->sweep(lattice->layers() - 1);
    return cost_to_go->best();
  };
  const double resting = least(make_coaxial_lattice(chain, robot.arm_class(), path, problem));
  const double moving = least(make_lattice(chain, robot.arm_class(), path, problem));
  ASSERT_LE(resting, moving + 1e-9) << what;
  counts.both += moving < kUnreachable;
  counts.cheaper += resting < moving - 1e-6;
  counts.neither += resting == kUnreachable;
  counts.inexact += !robot.srs().exact;
}

/// Checks that joint 7 keeps `rest`, rad, in the path over the lattice and in the refined one.
void expect_refined_at_rest(const PreparedRobot& robot, const PathProblem& problem, double rest,
                            const std::string& what, RestCounts& counts) {
  Planner planner(with_motion_defaults(problem));
  const MotionPlan plan = plan_motion(planner, {.check = true}, true, std::nullopt);
  if (plan.result.status != PlanStatus::kSolved || plan.result.lattice.grid->rolls > 1) return;
  ASSERT_LE(plan.result.cost, plan.refinement->cost_before) << what;
  counts.refined += plan.refinement->refined;
  for (const auto* rows : {&plan.lattice_path, &plan.result.trajectory}) {
    expect_rows_on_path(robot, planner.problem(), *rows, what);
    for (const TrajectoryRow& row : *rows)
      ASSERT_NEAR(row.q[kDof - 1], rest, robot.srs().exact ? 0 : 1e-3) << what;
    const CheckResult check = check_trajectory(with_motion_defaults(problem), *rows);
    ASSERT_TRUE(check.passed) << what << ": " << check.failures[0];
  }
}

/// Where the tool turns about joint 7's axis, a path along which that joint rests costs no more
/// than the least of all rolls.
TEST(KnotGrid, JointSevenRests) {
  const std::uint64_t base = seed("KnotGrid.JointSevenRests");
  Random any(base);
  auto arms = all_robots();
  arms.push_back(rounded(arms.front(), 1e-4));
  RestCounts counts;
  const int count = trials(24);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const PathProblem problem =
        free_roll_problem(arms[static_cast<std::size_t>(trial) % arms.size()],
                          trial % 3 == 0   ? CostMetric::kMax
                          : trial % 6 == 1 ? CostMetric::kL1
                                           : CostMetric::kL2,
                          random);
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    const PreparedRobot robot(problem);
    const auto rest = last_joint_at_rest(robot.arm().chain, robot.arm_class(), problem);
    if (!rest) continue;  // its tool turns about another axis
    compare_rest_with_motion(robot, problem, what, counts);
    if (HasFatalFailure()) return;
    expect_refined_at_rest(robot, problem, *rest, what, counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d problems: %d solved both ways, %d cheaper at rest, %d not at all; %d refined; %d on arms "
      "that are not exact\n",
      count, counts.both, counts.cheaper, counts.neither, counts.refined, counts.inexact);
  EXPECT_GE(counts.both, at_least_among(count / 4));
  EXPECT_GE(counts.cheaper, at_least_among(count / 20));
  EXPECT_GE(counts.refined, at_least_among(count / 8));
  EXPECT_GE(counts.inexact, at_least_among(count / 10));
}

/// A URDF or a tool that rounds pi, or writes lengths to a tenth of a millimetre, does not hide
/// that the tool turns about joint 7's axis.
TEST(KnotGrid, JointSevenRestsUnderARoundedTool) {
  PathProblem problem = io::load_path_problem(data_dir() / "problems/torch_door.yaml");
  problem.attached.clear();
  problem.resolution.droll = 0.3;
  problem.resolution.dphi = 0.3;
  for (const double angle : {0.0, 5e-8, 3e-6, 2e-3}) {
    problem.tool =
        Eigen::Translation3d(1e-2 * angle, 0, 0.2) * Eigen::AngleAxisd(angle, Vector3d::UnitX());
    const PreparedRobot robot(problem);
    EXPECT_TRUE(robot.srs().coaxial) << angle;
    EXPECT_EQ(robot.srs().exact, angle == 0) << angle;
    const PlanResult result = plan(robot, problem);
    ASSERT_EQ(result.status, PlanStatus::kSolved) << angle;
    EXPECT_EQ(result.lattice.grid->rolls, 1) << angle;
    const CheckResult check = check_trajectory(robot, problem, result.trajectory);
    EXPECT_TRUE(check.passed) << angle << ": " << check.failures[0];
  }
  problem.tool = Eigen::Translation3d(0, 0, 0.2) * Eigen::AngleAxisd(0.02, Vector3d::UnitX());
  EXPECT_FALSE(PreparedRobot(problem).srs().coaxial);
}

/// Where joint 7 rests determines what the tool meets: joint 7 moves if there is no path otherwise.
TEST(KnotGrid, JointSevenMovesWhereItCannotRest) {
  class NotNear final : public StateCheck {
   public:
    explicit NotNear(double rest) : rest_(rest) {}
    [[nodiscard]] std::string name() const override { return "rest"; }
    void states(std::span<const Config> states, std::span<bool> allowed) override {
      for (std::size_t k = 0; k < states.size(); ++k)
        allowed[k] = std::abs(states[k][kDof - 1] - rest_) > 0.5;
    }

   private:
    double rest_;
  };
  class Away final : public StateCost {
   public:
    explicit Away(double liked) : liked_(liked) {}
    [[nodiscard]] std::string name() const override { return "away"; }
    void costs(std::span<const Config> states, std::span<double> costs) override {
      for (std::size_t k = 0; k < states.size(); ++k)
        costs[k] = 10 * std::abs(states[k][kDof - 1] - liked_);
    }

   private:
    double liked_;
  };
  PathProblem problem = io::load_path_problem(data_dir() / "problems/torch_door.yaml");
  problem.tool = Eigen::Translation3d(0, 0, 0.2) * Pose::Identity();
  problem.attached.clear();
  problem.resolution.knot = 0.025;
  problem.resolution.droll = 0.3;
  problem.resolution.dphi = 0.3;
  Planner planner(problem);
  const PreparedRobot& robot = planner.prepare();
  const double rest = last_joint_at_rest(robot.arm().chain, robot.arm_class(), problem).value();
  for (const PlannerKind kind : kPlanners) {
    PlanOptions options{.planner = kind};
    const PlanResult resting = planner.plan(options);
    ASSERT_EQ(resting.status, PlanStatus::kSolved);
    EXPECT_EQ(resting.lattice.grid->rolls, 1);
    for (const TrajectoryRow& row : resting.trajectory) EXPECT_EQ(row.q[kDof - 1], rest);
    options.hooks.check = std::make_shared<NotNear>(rest);
    const PlanResult moving = planner.plan(options);
    ASSERT_EQ(moving.status, PlanStatus::kSolved) << to_string(kind);
    EXPECT_GT(moving.lattice.grid->rolls, 1);
    EXPECT_GE(moving.cost, resting.cost);
    EXPECT_TRUE(check_trajectory(robot, problem, moving.trajectory).passed);
    // A caller's cost may be of joint 7.
    options.hooks = {.check = nullptr, .cost = std::make_shared<Away>(rest + 1)};
    const PlanResult liked = planner.plan(options);
    ASSERT_EQ(liked.status, PlanStatus::kSolved) << to_string(kind);
    for (const TrajectoryRow& row : liked.trajectory) EXPECT_NEAR(row.q[kDof - 1], rest + 1, 0.5);
  }
}

/// Values after removals, few and many at once, are those of a sweep over what is left.
TEST(KnotGrid, RepairsAreSweeps) {
  const std::uint64_t base = seed("KnotGrid.RepairsAreSweeps");
  PathProblem problem = io::load_path_problem(data_dir() / "problems/torch_door.yaml");
  problem.resolution.droll = 0.25;
  problem.resolution.dphi = 0.3;
  const PreparedRobot robot(problem);
  const ToolPath path = problem_path(problem, robot.arm().chain);
  int compared = 0, many = 0, edges = 0;
  const int count = trials(6);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    if (trial % 3 == 2) {
      problem.start = plan(robot, problem).trajectory[0].q;
      problem.resolution.droll = 0.35;
    }
    const auto lattice = KnotGrid::make(robot.arm().chain, robot.srs(),
                                        problem_path(problem, robot.arm().chain), problem);
    const auto repaired = make_cost_to_go(*lattice);
    repaired->sweep(lattice->layers() - 1);
    std::vector<std::pair<int, int>> nodes;
    std::vector<std::array<int, 3>> certificate;
    for (int round = 0; round < 5; ++round) {
      const bool at_once = round % 2 == 1;
      for (int k = 0; k < (at_once ? 2 : 20); ++k) {
        const int layer = 1 + random.below(lattice->layers() - 1),
                  first = random.below(lattice->slots(layer));
        for (int slot = first; slot < std::min(lattice->slots(layer), first + (at_once ? 3000 : 3));
             ++slot) {
          if (repaired->verdicts().node(layer, slot) == Verdict::kRemoved) continue;
          repaired->verdicts().remove_node(layer, slot);
          nodes.emplace_back(layer, slot);
        }
      }
      std::int64_t expansions = 0;
      const SlotPath best =
          repaired->best() == kUnreachable ? SlotPath() : best_path(*repaired, expansions);
      for (int layer = 0; layer + 1 < static_cast<int>(best.size()); layer += 3) {
        const int a = best[static_cast<std::size_t>(layer)],
                  b = best[static_cast<std::size_t>(layer) + 1];
        repaired->remove_edge(layer, a, b);
        certificate.push_back({layer, a, b});
      }
      repaired->repair();
      many += at_once;
    }
    edges += static_cast<int>(certificate.size());
    const auto swept = make_cost_to_go(*lattice);
    for (const auto& [layer, slot] : nodes) swept->verdicts().remove_node(layer, slot);
    for (const auto& [layer, a, b] : certificate) swept->remove_edge(layer, a, b);
    swept->sweep(lattice->layers() - 1);
    for (int layer = 0; layer < lattice->layers(); ++layer)
      for (int slot = 0; slot < lattice->slots(layer); ++slot, ++compared)
        ASSERT_EQ(repaired->at(layer, slot), swept->at(layer, slot))
            << "SWIVEL_TEST_SEED " << base << " trial " << trial << " layer " << layer << " slot "
            << slot;
  }
  std::printf("%d values compared, %d repairs of many, %d edges\n", compared, many, edges);
  EXPECT_GE(many, at_least(12));
  EXPECT_GE(edges, at_least(20));
}

/// Makes an episode of a problem: the door in a random pose, with random ranges and cost of roll.
PathProblem random_episode(const PathProblem& problem, Random& random) {
  PathProblem episode = problem;
  for (SceneObject& object : episode.scene)
    if (object.name == "door")
      object.pose = object.pose *
                    Eigen::Translation3d(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1),
                                         random.uniform(-0.1, 0.1)) *
                    Eigen::AngleAxisd(random.uniform(-0.3, 0.3), Vector3d::UnitZ());
  if (random.coin()) episode.roll = Roll{-0.5, 0.5};
  if (!episode.roll->circle() && random.coin())
    draw_windows(episode, random, random.uniform(-0.3, 0.3));
  if (random.coin(0.4)) episode.cost.roll = random.uniform(0.5, 10);
  return episode;
}

/// Counts the refined paths and the motions, and what their episodes have.
struct RefinementCounts {
  int moved = 0, refined = 0, turning = 0, timed = 0, partial = 0, windows = 0, costly = 0,
      timed_windows = 0;
};

/// Checks that a refined path passes the check and costs no more than before.
void expect_refined(const PathProblem& episode, const MotionPlan& plan, const std::string& what,
                    RefinementCounts& counts) {
  counts.partial += episode.roll->upper < kPi;
  const auto& before = plan.lattice_path;
  const auto& rows = plan.result.trajectory;
  ASSERT_EQ(rows.size(), before.size()) << what;
  ASSERT_LE(plan.result.cost, plan.refinement->cost_before) << what;
  for (std::size_t i = 0; i < rows.size(); ++i)
    counts.moved += std::abs(wrap_angle(rows[i].roll - before[i].roll)) > 1e-6;
  const CheckResult check = check_trajectory(with_motion_defaults(episode), rows);
  ASSERT_TRUE(check.passed) << what << ": " << check.failures[0];
  ASSERT_NEAR(check.cost, plan.result.cost, 1e-6) << what;
  counts.refined += plan.refinement->refined;
  counts.windows += plan.refinement->refined && episode.waypoints[0].roll;
  counts.costly += plan.refinement->refined && episode.cost.roll > 0;
  counts.turning += std::any_of(rows.begin(), rows.end(),
                                [&](const TrajectoryRow& row) { return row.roll != rows[0].roll; });
}

/// Checks that the motion along a refined path passes the check, or prints why there is none.
void expect_timed(const PathProblem& episode, const PreparedRobot& robot, const MotionPlan& plan,
                  const std::string& what, RefinementCounts& counts) {
  if (!plan.motion->motion) {
    std::printf("%s%s: no motion: %s\n", what.c_str(),
                episode.waypoints[0].roll ? " with windows" : "",
                plan.motion->failure->reason.c_str());
    return;
  }
  ++counts.timed;
  counts.timed_windows += episode.waypoints[0].roll.has_value();
  const CheckResult motion =
      check_motion(robot, with_motion_defaults(episode), plan.motion->motion->rows, {});
  ASSERT_TRUE(motion.passed) << what << ": " << motion.failures[0];
}

/// The door's nozzle, from random poses: refined paths and motions pass the check, with the roll
/// that was chosen.
TEST(KnotGrid, PathsAreRefinedAndTimed) {
  PathProblem problem = io::load_path_problem(data_dir() / "problems/torch_door.yaml");
  problem.resolution.droll = 0.1;
  problem.resolution.dphi = 0.2;
  Random random(seed("KnotGrid.PathsAreRefinedAndTimed"));
  const PreparedRobot robot(problem);
  RefinementCounts counts;
  const int count = trials(24);
  for (int trial = 0; trial < count; ++trial) {
    const PathProblem episode = random_episode(problem, random);
    Planner planner(with_motion_defaults(episode));
    const MotionPlan plan =
        plan_motion(planner, {.check = true}, true, TimingOptions{.speed = 0.05});
    if (plan.result.status != PlanStatus::kSolved) continue;
    const std::string what = "trial " + std::to_string(trial);
    expect_refined(episode, plan, what, counts);
    if (HasFatalFailure()) return;
    expect_timed(episode, planner.prepare(), plan, what, counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d problems: %d refined (%d with windows of roll, %d with a cost of it), %d turn the tool, "
      "%d timed (%d with windows), %d "
      "within "
      "half a radian\n",
      count, counts.refined, counts.windows, counts.costly, counts.turning, counts.timed,
      counts.timed_windows, counts.partial);
  EXPECT_GE(counts.windows, at_least(2));
  EXPECT_GE(counts.timed_windows, at_least(1));
  EXPECT_GE(counts.costly, at_least(3));
  EXPECT_GE(counts.refined, at_least_among(count / 2));
  EXPECT_GE(counts.timed, at_least_among(count / 2));
  EXPECT_GE(counts.turning, at_least(2));
  EXPECT_GE(counts.moved, at_least(100));  // rolls of rows
}

/// Proofs that there is no path are verified without the planner, and forged ones refused.
TEST(KnotGrid, CutsAreVerified) {
  const std::uint64_t base = seed("KnotGrid.CutsAreVerified");
  Random any(base);
  const auto arms = robots(any);
  int cuts = 0, forged = 0, edges = 0;
  for (int trial = 0; trial < 400 && cuts < trials(20); ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    PathProblem problem = roll_problem(arms[static_cast<std::size_t>(trial) % arms.size()], random);
    if (trial % 2 == 1) {  // what lies between the layers of the lattice ends the paths
      problem.scene.clear();
      problem.limits.tool_path_error = 1e-4;
    }
    Planner planner(problem);
    if (planner.plan().status != PlanStatus::kInfeasible) continue;
    ++cuts;
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    const InfeasibilityCertificate certificate = prove_infeasible(planner.view());
    const CertificateCheck check =
        verify_certificate(planner.prepare(), planner.problem(), certificate);
    ASSERT_TRUE(check.passed) << what << ": " << check.failure;
    edges += std::any_of(
        certificate.band.begin(), certificate.band.end(),
        [](const InfeasibilityCertificate::Layer& layer) { return !layer.edges.empty(); });
    InfeasibilityCertificate wrong = certificate;
    const auto with_removed = std::find_if(
        wrong.band.begin(), wrong.band.end(),
        [](const InfeasibilityCertificate::Layer& layer) { return !layer.removed.empty(); });
    if (with_removed == wrong.band.end()) continue;
    with_removed->removed.pop_back();
    ++forged;
    ASSERT_FALSE(verify_certificate(planner.prepare(), planner.problem(), wrong).passed) << what;
  }
  std::printf("%d cuts, %d with edges, %d forged\n", cuts, edges, forged);
  EXPECT_GE(cuts, at_least(20));
  EXPECT_GE(edges, at_least(3));
  EXPECT_GE(forged, at_least(6));
}

/// The caller's check is asked about what lies between the layers of the lattice, too.
TEST(KnotGrid, AsksTheCallersCheckBetween) {
  class NotBeyond final : public StateCheck {
   public:
    NotBeyond(const Chain& chain, double x) : chain_(&chain), x_(x) {}
    [[nodiscard]] std::string name() const override { return "beyond"; }
    void states(std::span<const Config> states, std::span<bool> allowed) override {
      for (std::size_t k = 0; k < states.size(); ++k)
        allowed[k] = !(chain_->tool(states[k]).translation().x() > x_);
      asked += static_cast<int>(states.size());
    }
    int asked = 0;

   private:
    const Chain* chain_;
    double x_;
  };
  PathProblem problem = io::load_path_problem(data_dir() / "problems/torch_door.yaml");
  problem.resolution.droll = 0.4;
  problem.resolution.dphi = 0.4;
  Planner planner(problem);
  const Chain& chain = planner.prepare().arm().chain;
  const PlanResult free = planner.plan();
  ASSERT_EQ(free.status, PlanStatus::kSolved);
  double most = 0;  // x of the tool at rows between knots
  for (const TrajectoryRow& row : free.trajectory)
    most = std::max(most, chain.tool(row.q).translation().x());
  PlanOptions options;
  const auto lets = std::make_shared<NotBeyond>(chain, most + 1e-6),
             bars = std::make_shared<NotBeyond>(chain, most - 1e-6);
  options.hooks.check = lets;
  const PlanResult same = planner.plan(options);
  EXPECT_EQ(same.cost, free.cost);
  EXPECT_GE(lets->asked, static_cast<int>(free.trajectory.size()));
  options.hooks.check = bars;  // every tool pose of that layer is the same for all nodes
  EXPECT_EQ(planner.plan(options).status, PlanStatus::kInfeasible);
}

/// What is wrong with a trajectory whose tool turns is found.
TEST(KnotGrid, CheckRefusesOtherRolls) {
  Random random(seed("KnotGrid.CheckRefusesOtherRolls"));
  int tried = 0;
  for (int trial = 0; tried < 5 && trial < 200; ++trial) {
    PathProblem problem = roll_problem(all_robots().front(), random);
    problem.scene.clear();
    problem.roll = Roll{-0.8, 0.8};
    for (Waypoint& waypoint : problem.waypoints) waypoint.roll.reset();
    problem.start.reset();
    const PreparedRobot robot(problem);
    const PlanResult result = plan(robot, problem);
    if (result.status != PlanStatus::kSolved) continue;
    ++tried;
    const auto fails = [&](const PathProblem& other, auto change, const char* words) {
      std::vector<TrajectoryRow> rows = result.trajectory;
      change(rows);
      const CheckResult check = check_trajectory(other, rows);
      EXPECT_FALSE(check.passed) << words;
      EXPECT_TRUE(std::any_of(
          check.failures.begin(), check.failures.end(),
          [&](const std::string& line) { return line.find(words) != std::string::npos; }))
          << words << ": " << (check.failures.empty() ? "" : check.failures[0]);
    };
    fails(
        problem, [](auto& rows) { rows[1].roll += rows[1].roll > 0 ? -0.01 : 0.01; },
        "from the path");
    fails(
        problem, [](auto& rows) { rows[1].roll = 0.9; }, "roll 0.9 is outside its range");
    fails(
        problem, [](auto& rows) { rows[1].roll = std::nan(""); }, "not finite");
    PathProblem narrow = problem;
    const double least =
        std::min_element(result.trajectory.begin(), result.trajectory.end(),
                         [](const auto& a, const auto& b) { return a.roll < b.roll; })
            ->roll;
    narrow.roll->lower = least + 0.05;
    if (narrow.roll->lower < narrow.roll->upper)
      fails(
          narrow, [](auto&) {}, "is outside its range");
    PathProblem windows = problem;
    for (Waypoint& waypoint : windows.waypoints) waypoint.roll = Roll{-0.8, 0.8};
    EXPECT_TRUE(check_trajectory(windows, result.trajectory).passed);
    const double there = result.trajectory[0].roll;
    windows.waypoints[0].roll = there > 0 ? Roll{-0.8, there - 0.01} : Roll{there + 0.01, 0.8};
    fails(
        windows, [](auto&) {}, "row 0: roll");
    fails(
        windows, [](auto&) {}, "is outside what its waypoints allow");
  }
  EXPECT_EQ(tried, 5);
}

TEST(KnotGrid, RefusesWhatItCannotDo) {
  Random random(seed("KnotGrid.RefusesWhatItCannotDo"));
  PathProblem problem = roll_problem(all_robots().front(), random);
  const auto expect = [&](const PathProblem& wrong, const std::string& words) {
    try {
      static_cast<void>(plan(wrong));
      FAIL() << words;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  for (Waypoint& waypoint : problem.waypoints) waypoint.roll.reset();
  PathProblem wrong = problem;
  wrong.limits.step_error = 0.1;
  expect(wrong, "limits.step_error: allowed without path.roll");
  wrong = problem;
  wrong.limits.roll_slope = 0.1 * wrong.resolution.droll / *wrong.resolution.knot;
  expect(wrong, "limits.roll_slope: is less than a step");
  wrong = problem_for(offset_robot());
  wrong.waypoints = problem.waypoints;
  wrong.roll = Roll{};
  expect(wrong,
         "path.roll: of arms of seven joints allowed for those with spherical shoulder and wrist");
}

}  // namespace
}  // namespace swivel
