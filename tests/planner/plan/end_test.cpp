// SPDX-License-Identifier: BSD-3-Clause
// Paths that end in a given posture: every planner against brute force on every kind of lattice,
// the check, and the certificate that there is no such path.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "brute_force.hpp"
#include "diagnosis_of.hpp"
#include "grid_windows.hpp"
#include "inexact_robots.hpp"
#include "knot_search.hpp"
#include "motion_problem.hpp"
#include "planners.hpp"
#include "random_problem.hpp"
#include "roll_windows.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/lattice/kinds/knot_grid.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/advise.hpp"
#include "swivel/planner/verify/check.hpp"
#include "window.hpp"

namespace swivel {
namespace {

using namespace test;

/// What a layer's nodes are: arm angles, points on arcs of self-motion of seven joints or of six
/// and the roll, or rolls and arm angles.
enum class Nodes { kArmAngles, kArcs, kSixJoints, kRolls };

struct EndArm {
  TestRobot robot;
  Nodes nodes;
};

TestRobot at_flange(const char* name) {
  TestRobot robot = data_robot(name);
  robot.tip_link = "flange";
  return robot;
}

/// Arms with limits, without, of several turns, exactly S-R-S, nearly and not at all.
std::vector<EndArm> end_arms(Random& random) {
  std::vector<EndArm> arms;
  for (const TestRobot& robot : all_robots()) arms.push_back({robot, Nodes::kArmAngles});
  arms.push_back({perturbed(data_robot("iiwa14"), 1, random), Nodes::kArmAngles});
  const TestRobot turns = with_limits(at_flange("xarm7_like"), [](int number, Joint& joint) {
    if (number % 2 == 0) joint.upper = number < 4 ? 3.1 : kTwoPi, joint.lower = -joint.upper;
  });
  for (const TestRobot& robot : {at_flange("panda_like"), at_flange("gen3_like"), turns})
    arms.push_back({robot, Nodes::kArcs});
  for (const char* name : {"kr6_like", "ur5e_like"})
    arms.push_back({at_flange(name), Nodes::kSixJoints});
  for (const TestRobot& robot :
       {data_robot("iiwa14"), windings_robot(), perturbed(data_robot("iiwa14"), 1, random)})
    arms.push_back({robot, Nodes::kRolls});
  return arms;
}

/// Draws a posture that keeps 0.12 rad from the limits. The roll of an arm of six joints is small.
Config inside_posture(const Chain& chain, Random& random) {
  Config q = random_config(chain, random);
  if (chain.roll) q[kDof - 1] = random.uniform(-0.2, 0.2);
  return q;
}

void keep_inside(const Chain& chain, Config& q) {
  constexpr double kInside = 0.12;  // rad, more than any joint margin
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    if (!limit.continuous) q[j] = std::clamp(q[j], limit.lower + kInside, limit.upper - kInside);
  }
}

/// Sets how fine the lattice is, and limits that suit it.
void draw_lattice(PathProblem& problem, Nodes nodes, double length, Random& random) {
  Resolution& resolution = problem.resolution;
  resolution.ds = std::max(0.01, length / (3 + random.below(3)));
  resolution.dalpha = random.uniform(0.3, 0.8);
  resolution.dphi = problem.source == "windings" ? 0.9 : random.uniform(0.3, 0.6);
  resolution.arc = random.uniform(0.3, 0.6);
  problem_parts::draw_limits(problem, random);
  Limits& limits = problem.limits;
  if (nodes == Nodes::kArmAngles) {
    resolution.arcs = random.coin();
    return;
  }
  limits.step_error.reset();
  if (limits.tool_path_error) limits.tool_path_error = random.uniform(0.02, 0.1);
  if (limits.tool_angle_error) limits.tool_angle_error = random.uniform(0.1, 0.4);
  limits.joint_step = 1;
  if (nodes == Nodes::kRolls) {
    resolution.ds /= 2;
    resolution.knot = resolution.ds * random.uniform(1.5, 4);
    resolution.droll = random.uniform(0.5, 1.0);
    resolution.dphi = problem.source == "windings" ? 1.2 : random.uniform(0.6, 0.9);
    limits.arm_slope = random.uniform(0.8, 2) * resolution.dphi / *resolution.knot;
    limits.roll_slope = random.uniform(1.01, 2) * resolution.droll / *resolution.knot;
  } else {
    limits.arm_slope = Limits().arm_slope;
    limits.roll_slope = random.uniform(5, 15);
  }
}

/// Draws a path whose last waypoint is where the tool stands in the posture that is given as its
/// end, sometimes with a start that is given likewise.
PathProblem ending_problem(const EndArm& arm, Random& random) {
  PathProblem problem = problem_for(arm.robot);
  const bool rolls = arm.nodes == Nodes::kRolls;
  if (rolls || arm.nodes == Nodes::kSixJoints)
    problem.roll = random.coin() ? Roll{} : Roll{random.uniform(-2, -0.5), random.uniform(0.5, 2)};
  const Chain chain =
      build_arm(*problem.model, problem.base_link, problem.tip_link, {}, problem.tool, problem.roll)
          .chain;
  Config q = inside_posture(chain, random);
  keep_inside(chain, q);
  const Config first = q;
  const auto add = [&] {
    problem.waypoints.push_back(
        waypoint_of(rolled(chain.tool(q), rolls ? random.uniform(-0.3, 0.3) : 0.0)));
  };
  add();
  for (int more = 1 + random.below(2); more > 0; --more) {
    for (int j = 0; j < kDof; ++j) q[j] += random.uniform(-0.2, 0.2);
    keep_inside(chain, q);
    add();
  }
  double length = 0;
  for (std::size_t k = 1; k < problem.waypoints.size(); ++k)
    length += (problem.waypoints[k].position - problem.waypoints[k - 1].position).norm();
  if (random.coin(0.7))
    problem_parts::draw_obstacles(problem, chain, q, 1 + random.below(3), random);
  draw_lattice(problem, arm.nodes, length, random);
  if (random.coin(0.3)) problem.cost.metric = random.one_of({CostMetric::kL1, CostMetric::kMax});
  if (random.coin(0.4)) problem.start = first;
  for (int j = 0; j < kDof; ++j)  // another turn, where a joint has one
    if (const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)]; random.coin(0.2)) {
      const double other = q[j] + (q[j] > 0 ? -kTwoPi : kTwoPi);
      if (limit.continuous || (other > limit.lower + 0.12 && other < limit.upper - 0.12))
        q[j] = other;
    }
  problem.end = q;
  if (rolls && !problem.roll->circle() && random.coin()) {
    draw_windows(problem, random);
    for (Waypoint& waypoint : problem.waypoints)  // around the rolls of start and end
      waypoint.roll =
          Roll{std::min(waypoint.roll->lower, -0.35), std::max(waypoint.roll->upper, 0.35)};
  }
  return problem;
}

/// A lattice that tells everything apart, and its answer by brute force.
struct Truth {
  std::unique_ptr<const Lattice> lattice;
  BruteForcePath answer;
};

Truth truth_of(const PreparedRobot& robot, const ToolPath& path, const PathProblem& problem,
               Nodes nodes) {
  const Chain& chain = robot.arm().chain;
  const auto answer = [&](const Lattice& lattice,
                          const std::function<bool(int, int, int)>& in_window) {
    return brute_force(lattice, robot.world(), robot.world().edge_rule(robot.radii()), in_window);
  };
  Truth truth;
  if (nodes == Nodes::kArmAngles) {
    auto lattice = std::make_unique<SrsLattice>(chain, robot.srs(), path, problem);
    truth.answer = answer(
        *lattice, [&](int layer, int a, int b) { return window_allows(*lattice, layer, a, b); });
    truth.lattice = std::move(lattice);
  } else if (nodes == Nodes::kRolls) {
    const JoinableOnGrid joinable(problem);
    PlainAnswer found =
        plan_plainly(robot, problem, KnotGrid::make(chain, robot.srs(), path, problem),
                     [&](const Lattice& lattice, int layer, int a, int b) {
                       return joinable(dynamic_cast<const KnotGrid&>(lattice), layer, a, b);
                     });
    truth.answer.solved = !found.rows.empty();
    truth.answer.cost = found.chords;
    truth.answer.deepest = found.deepest;
    truth.lattice = std::move(found.last);
  } else {
    const ArcLattice circles(chain, robot.arm_class().lock, path, problem);
    truth.lattice = circles.with_windings(circles.circles());
    const Lattice& lattice = *truth.lattice;
    truth.answer = answer(lattice, [&](int layer, int a, int b) {
      const double turn =
          (*lattice.node(layer + 1, b))[kDof - 1] - (*lattice.node(layer, a))[kDof - 1];
      return nodes == Nodes::kArcs ||
             std::abs(std::remainder(turn, kTwoPi)) <=
                 roll_step_bound(path, layer, problem.limits, problem.resolution);
    });
  }
  return truth;
}

struct EndCounts {
  int solved = 0, infeasible = 0, started = 0, obstacles = 0, other_turn = 0, refused = 0,
      certified = 0, freed = 0, windows = 0;
  std::array<int, 4> solved_by_kind{}, infeasible_by_kind{};
};

/// Expects that the path ends in the given posture, in the same turn where it is not bound to a
/// start, that it passes the check, and that the check refuses it for another end.
void expect_ends(const PreparedRobot& robot, const PathProblem& problem, const PlanResult& result,
                 const std::string& what, EndCounts& counts) {
  const Config off = result.trajectory.back().q - *problem.end;
  for (std::size_t j = 0; j < kDof; ++j) {
    const double by = off[static_cast<Eigen::Index>(j)];
    const bool any_turn = problem.start && robot.arm().chain.limit[j].continuous;
    counts.other_turn += any_turn && std::abs(by) > 1;
    // The roll of an arm of six joints is counted from the path's own frames and back.
    const bool is_roll = robot.arm().chain.roll && j + 1 == kDof;
    ASSERT_LE(std::abs(any_turn ? std::remainder(by, kTwoPi) : by), any_turn  ? 1e-9
                                                                    : is_roll ? 1e-12
                                                                              : 0.0)
        << what << " joint " << j;
  }
  const CheckResult check = check_trajectory(robot, problem, result.trajectory);
  ASSERT_TRUE(check.passed) << what << ": " << (check.failures.empty() ? "" : check.failures[0]);
  ASSERT_NEAR(check.cost, result.cost, 1e-9) << what;
  if (problem.limits.step_error) return;  // whose estimate asks for an end that is on the path
  PathProblem other = problem;
  (*other.end)[3] += 2e-6;
  const CheckResult refused = check_trajectory(robot, other, result.trajectory);
  ASSERT_EQ(refused.failure_count, 1) << what;
  ASSERT_NE(refused.failures[0].find("not the given end"), std::string::npos) << what;
  ++counts.refused;
}

/// Expects a certificate that there is no path with this end, which is none for the problem
/// without.
void expect_certified(const std::shared_ptr<const PreparedRobot>& robot, const PathProblem& problem,
                      const std::string& what, EndCounts& counts) {
  Planner planner(robot, problem);
  ASSERT_EQ(planner.plan().status, PlanStatus::kInfeasible) << what;
  const InfeasibilityCertificate certificate = prove_infeasible(planner.view());
  const CertificateCheck check = verify_certificate(*robot, problem, certificate);
  ASSERT_TRUE(check.passed) << what << ": " << check.failure;
  ++counts.certified;
  PathProblem free = problem;
  free.end.reset();
  if (plan(*robot, free).status != PlanStatus::kSolved) return;
  ++counts.freed;
  ASSERT_FALSE(verify_certificate(*robot, free, certificate).passed) << what;
}

void check_end(const EndArm& arm, const PathProblem& problem, const std::string& what,
               EndCounts& counts) {
  const auto robot = std::make_shared<const PreparedRobot>(problem);
  const ToolPath path = problem_path(problem, robot->arm().chain);
  const Truth truth = truth_of(*robot, path, problem, arm.nodes);
  std::vector<PlanResult> results;
  for (const PlannerKind planner : kPlanners) {
    results.push_back(plan(*robot, problem, with_all_evidence(planner)));
    const PlanResult &result = results.back(), &first = results.front();
    const std::string who = what + ' ' + result.planner;
    ASSERT_EQ(result.status == PlanStatus::kSolved, truth.answer.solved) << who;
    ASSERT_EQ(result.cost, first.cost) << who;
    ASSERT_EQ(result.trajectory.size(), first.trajectory.size()) << who;
    for (std::size_t i = 0; i < result.trajectory.size(); ++i)
      ASSERT_EQ(result.trajectory[i].q, first.trajectory[i].q) << who << " row " << i;
    ASSERT_EQ(diagnosis_of(result).reached_layer, diagnosis_of(first).reached_layer) << who;
    ASSERT_EQ(diagnosis_of(result).cause, diagnosis_of(first).cause) << who;
  }
  counts.started += problem.start.has_value();
  counts.obstacles += !problem.scene.empty();
  counts.windows += problem.waypoints[0].roll.has_value();
  const auto kind = static_cast<std::size_t>(arm.nodes);
  if (truth.answer.solved) {
    ++counts.solved, ++counts.solved_by_kind[kind];
    ASSERT_EQ(results[0].lattice.cost, truth.answer.cost) << what;
    expect_ends(*robot, problem, results[0], what, counts);
    return;
  }
  ++counts.infeasible, ++counts.infeasible_by_kind[kind];
  ASSERT_GE(diagnosis_of(results[0]).reached_layer.value_or(-1), truth.answer.deepest) << what;
  ASSERT_FALSE(words(diagnosis_of(results[0]).cause).empty()) << what;
  if (arm.nodes != Nodes::kRolls) expect_certified(robot, problem, what, counts);
}

TEST(End, FourPlannersAndBruteForceOnRandomProblems) {
  const std::uint64_t base = seed("End");
  Random any(base);
  const std::vector<EndArm> arms = end_arms(any);
  EndCounts counts;
  const int count = trials(224);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const EndArm& arm = arms[static_cast<std::size_t>(trial) % arms.size()];
    const PathProblem problem = ending_problem(arm, random);
    check_end(arm, problem,
              "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial) +
                  " robot " + problem.source,
              counts);
    if (HasFatalFailure()) return;
  }
  std::printf(
      "%d problems: %d solved, %d infeasible (arm angles %d and %d, arcs %d and %d, six joints %d "
      "and %d, rolls %d and %d), %d with a start, %d with obstacles, %d with windows of roll; %d "
      "paths refused for another "
      "end, %d end whole turns away; %d certificates, %d of problems that have a path with a free "
      "end\n",
      count, counts.solved, counts.infeasible, counts.solved_by_kind[0],
      counts.infeasible_by_kind[0], counts.solved_by_kind[1], counts.infeasible_by_kind[1],
      counts.solved_by_kind[2], counts.infeasible_by_kind[2], counts.solved_by_kind[3],
      counts.infeasible_by_kind[3], counts.started, counts.obstacles, counts.windows,
      counts.refused, counts.other_turn, counts.certified, counts.freed);
  for (std::size_t kind = 0; kind < 4; ++kind) {
    EXPECT_GE(counts.solved_by_kind[kind], at_least_among(5));
    EXPECT_GE(counts.infeasible_by_kind[kind], at_least_among(3));
  }
  EXPECT_GE(counts.started, at_least_among(count / 5));
  EXPECT_GE(counts.obstacles, at_least_among(count / 3));
  EXPECT_GE(counts.refused, at_least_among(count / 6));
  EXPECT_GE(counts.freed, at_least_among(10));
  EXPECT_GE(counts.windows, at_least_among(4));
}

/// Expects plan() to refuse the problem with one line that has all of `words`.
void expect_refused(const PathProblem& problem, const std::vector<std::string>& words) {
  try {
    static_cast<void>(plan(problem));
    FAIL() << "not refused: " << words[0];
  } catch (const InputError& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << error.what() << "\nlacks: " << word;
  }
}

TEST(End, PosturesThatDoNotFitAreRefused) {
  for (const char* name : {"iiwa14", "panda_like"}) {
    TestRobot robot = data_robot(name);
    if (std::string(name) != "iiwa14") robot = at_flange(name);
    const Chain chain = arm_of(robot).chain;
    PathProblem problem = problem_for(robot);
    Config q{0.1, 0.6, 0.2, -1.4, 0.1, 1.2, 0.3};
    problem.waypoints = {waypoint_of(chain.tool(q)), waypoint_of(chain.tool(q))};
    problem.waypoints[0].position.x() -= 0.02;
    problem.end = q;
    EXPECT_EQ(plan(problem).status, PlanStatus::kSolved) << name;
    PathProblem off = problem;
    (*off.end)[0] += 1e-3;
    expect_refused(off, {"path.end.joints", "not on the path", " mm and ", "1e-06"});
    off = problem;
    (*off.end)[1] = 9;
    expect_refused(off, {"path.end.joints: joint", "outside its limits"});
  }
}

/// Draws a problem for motions that ends where a path on another grid does.
std::optional<PathProblem> ending_motion(const TestRobot& robot, const std::optional<Roll>& roll,
                                         Random& random) {
  PathProblem problem = motion_problem(robot, random, roll);
  PathProblem elsewhere = problem;
  elsewhere.resolution.dphi = 0.13;
  elsewhere.resolution.arc = 0.11;
  const PlanResult found = plan(elsewhere);
  if (found.status != PlanStatus::kSolved) return std::nullopt;
  problem.end = found.trajectory.back().q;
  return problem;
}

/// Refined paths keep the end, bit for bit, and motions end in it.
TEST(End, RefinedPathsAndMotionsEndThere) {
  const std::uint64_t base = seed("End.Motion");
  Random any(base);
  const Roll turn{-1, 1};
  const std::vector<std::pair<TestRobot, std::optional<Roll>>> arms{
      {data_robot("iiwa14"), {}},
      {perturbed(data_robot("iiwa14"), 1, any), {}},
      {at_flange("xarm7_like"), {}},
      {at_flange("kr6_like"), turn}};
  int refined = 0, timed = 0;
  const int count = trials(24);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const auto& [robot_of, roll] = arms[static_cast<std::size_t>(trial) % arms.size()];
    const std::string what = "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                             std::to_string(trial) + " robot " + robot_of.name;
    const auto problem = ending_motion(robot_of, roll, random);
    if (!problem) continue;
    Planner planner(with_motion_defaults(*problem));
    TimingOptions timing;
    timing.speed = 0.05;
    const MotionPlan found = plan_motion(planner, {}, true, timing);
    if (found.result.status != PlanStatus::kSolved) continue;
    ASSERT_EQ(found.result.trajectory.back().q, *problem->end) << what;
    refined += found.refinement && found.refinement->refined;
    if (!found.motion || !found.motion->motion) continue;
    ++timed;
    const std::vector<TimedRow>& rows = found.motion->motion->rows;
    ASSERT_LE((rows.back().row.q - *problem->end).lpNorm<Eigen::Infinity>(), 1e-8) << what;
  }
  std::printf("%d problems, %d refined, %d timed\n", count, refined, timed);
  EXPECT_GE(refined, at_least_among(count / 3));
  EXPECT_GE(timed, at_least_among(count / 4));
}

/// Laps of a ring that ends in the joints of its start repeat.
TEST(End, ARingThatEndsInItsStartCanBeRepeated) {
  PathProblem problem = problem_for(data_robot("iiwa14"));
  const Chain chain = arm_of(data_robot("iiwa14")).chain;
  Config q{0.1, 0.6, 0.2, -1.4, 0.1, 1.2, 0.3};
  const Pose first = chain.tool(q);
  constexpr int kCorners = 24;
  for (int k = 0; k <= kCorners; ++k) {
    const double angle = kTwoPi * (k % kCorners) / kCorners;
    Waypoint waypoint = waypoint_of(first);
    waypoint.position += 0.1 * Vector3d(0, std::sin(angle), std::cos(angle) - 1);
    problem.waypoints.push_back(waypoint);
  }
  problem.start = q;
  const PlanResult open = plan(problem);
  ASSERT_EQ(open.status, PlanStatus::kSolved);
  EXPECT_GT(joint_norm(open.trajectory.back().q - q), 1e-3);  // it drifts
  problem.end = q;
  const PlanResult ring = plan(problem);
  ASSERT_EQ(ring.status, PlanStatus::kSolved);
  EXPECT_EQ(ring.trajectory.back().q, ring.trajectory.front().q);
  EXPECT_GE(ring.cost, open.cost);
  std::printf("a ring of %zu rows: cost %.6g, %.6g where it need not close\n",
              ring.trajectory.size(), ring.cost, open.cost);
}

/// Returns the last rows of a job's runs, by stroke.
std::vector<Config> ends_of(const Answer& result, std::size_t strokes) {
  std::vector<Config> ends(strokes, Config::Zero());
  for (const Part& part : result.arm().parts)
    if (part.run) ends[part.run->stroke] = part.rows.back().q;
  return ends;
}

/// Strokes end where they are told to, in that very turn of joints of more than a turn.
TEST(End, StrokesOfAJobEndThere) {
  for (const char* name : {"kr6_weld_pipe_job.yaml", "iiwa14_bench_job.yaml"}) {
    Problem job = io::load_job(std::string(SWIVEL_DATA_DIR) + "/problems/" + name);
    const PreparedRobot robot(problem_of_run(job, {0, false}));
    const Chain& chain = robot.arm().chain;
    job.arm().order = StrokeOrder::kGiven;
    Problem elsewhere = job;
    for (Stroke& stroke : elsewhere.arm().strokes) {
      stroke.resolution.dphi *= 1.3;
      stroke.resolution.arc = 0.7 * stroke.resolution.arc_of_nodes();
    }
    const Answer first = plan_job(robot, elsewhere);
    ASSERT_EQ(first.status, PlanStatus::kSolved) << name;
    const std::vector<Config> wanted = ends_of(first, job.arm().strokes.size());
    for (std::size_t k = 0; k < wanted.size(); k += 2) {
      job.arm().strokes[k].end = wanted[k];
      job.arm().strokes[k].reversible = false;
    }
    const Answer found = plan_job(robot, job);
    ASSERT_EQ(found.status, PlanStatus::kSolved) << name;
    const AnswerCheck check = check_job(robot, job, found.arm().parts);
    ASSERT_TRUE(check.passed) << name << ": " << check.failures.front();
    const std::vector<Config> ends = ends_of(found, job.arm().strokes.size());
    for (std::size_t k = 0; k < ends.size(); k += 2)
      for (Eigen::Index j = 0; j < kDof; ++j) {
        const double off = ends[k][j] - (*job.arm().strokes[k].end)[j];
        const bool bounded = !chain.limit[static_cast<std::size_t>(j)].continuous;
        EXPECT_NEAR(bounded ? off : std::remainder(off, kTwoPi), 0, 1e-9) << name << ' ' << j;
      }
    (*job.arm().strokes[0].end)[1] += 1e-5;
    EXPECT_FALSE(check_job(robot, job, found.arm().parts).passed) << name;
    EXPECT_THROW(static_cast<void>(plan_job(robot, job)), InputError) << name;
    job.arm().strokes[0].reversible = true;
    EXPECT_THROW(static_cast<void>(plan_job(robot, job)), InvalidArgument) << name;
  }
}

/// An end in collision is told and can be freed.
TEST(End, APostureInCollisionIsToldAndAFreeEndIsAdvised) {
  PathProblem problem = problem_for(data_robot("iiwa14"));
  const Chain chain = arm_of(data_robot("iiwa14")).chain;
  Config q{0.1, 0.6, 0.2, -1.4, 0.1, 1.2, 0.3};
  problem.waypoints = {waypoint_of(chain.tool(q)), waypoint_of(chain.tool(q))};
  problem.waypoints[0].position.x() -= 0.05;
  const Vector3d elbow = chain.displacements(q)[3] * chain.point[3];
  Pose at = Pose::Identity();
  at.translation() = elbow;
  problem.scene.push_back({"ball", Sphere{0.05}, at, {}});
  problem.end = q;
  Planner planner(problem);
  const PlanResult result = planner.plan();
  ASSERT_EQ(result.status, PlanStatus::kInfeasible);
  EXPECT_EQ(diagnosis_of(result).cause.bodies[1], "ball");
  EXPECT_EQ(diagnosis_of(result).reached_layer, result.lattice.layers - 2);
  const std::vector<Advice> advice = advise(planner, result);
  const auto freed = std::find_if(advice.begin(), advice.end(), [](const Advice& one) {
    return one.change == Advice::Change::kFreeEnd;
  });
  ASSERT_NE(freed, advice.end());
  EXPECT_EQ(freed->outcome, Advice::Outcome::kSolved);
}

}  // namespace
}  // namespace swivel
