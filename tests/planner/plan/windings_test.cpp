// SPDX-License-Identifier: BSD-3-Clause
// Joints of more than a turn on S-R-S arms: planned as circles, they cost what they cost where all
// of their turns are told apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <ranges>
#include <string>
#include <vector>

#include "inexact_robots.hpp"
#include "planners.hpp"
#include "random_problem.hpp"
#include "swivel/core/lattice/kinds/knot_grid.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/plan/plan_view.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

/// Allows everything. A check of the caller's own has all turns told apart.
class AllowsAll final : public StateCheck {
 public:
  [[nodiscard]] std::string name() const override { return "all"; }
  void states(std::span<const Config> states, std::span<bool> allowed) override {
    std::fill_n(allowed.begin(), states.size(), true);
  }
};

/// The joints with a wider range, each within +-`limit`, rad.
struct Wide {
  std::array<bool, kDof> joints{};
  double limit = kTwoPi;
};

Wide draw_wide(Random& random) {
  constexpr std::array<double, 3> kLimits{4.5, kTwoPi, 9.5};
  Wide wide;
  wide.limit = kLimits[static_cast<std::size_t>(random.below(3))];
  const int most = wide.limit > 7 ? 1 : 2;
  for (int k = 0; k < most; ++k) wide.joints[static_cast<std::size_t>(2 * random.below(4))] = true;
  return wide;
}

/// Returns the robot with these joints widened, and all others within less than a turn.
TestRobot widened(const TestRobot& robot, const Wide& wide) {
  return with_limits(robot, [&](int number, Joint& joint) {
    if (wide.joints[static_cast<std::size_t>(number)])
      joint.lower = -wide.limit, joint.upper = wide.limit;
    else if (joint.type == Joint::Type::kContinuous)
      joint.lower = -3.1, joint.upper = 3.1;
    joint.type = Joint::Type::kRevolute;
  });
}

enum class PathShape { kLine, kRing, kScrew };

/// Draws a line, a ring or a screw of up to two turns that begins where the tool stands in `q`.
PathShape draw_path(PathProblem& problem, const Pose& tool, Random& random) {
  const auto shape = static_cast<PathShape>(random.below(3));
  const Vector3d x = tool.linear().col(0), z = tool.linear().col(2);
  const double turns = random.uniform(0.6, 2), radius = random.uniform(0.02, 0.1);
  problem.waypoints = {waypoint_of(tool)};
  if (shape == PathShape::kLine) {
    problem.waypoints.push_back(waypoint_of(random_pose(random, tool.translation(), 0.15)));
    return shape;
  }
  const int parts = static_cast<int>(std::ceil(6 * turns));
  for (int k = 1; k <= parts; ++k) {
    const double part = static_cast<double>(k) / parts;
    const Matrix3d turn = Eigen::AngleAxisd(kTwoPi * turns * part, z).toRotationMatrix();
    Pose pose = tool;
    pose.linear() = turn * tool.linear();
    pose.translation() +=
        shape == PathShape::kRing ? Vector3d(radius * (turn * x - x)) : Vector3d(part * radius * z);
    problem.waypoints.push_back(waypoint_of(pose));
  }
  return shape;
}

/// Adds whole turns to wide joints of `q` by chance, within their limits.
Config turned(Config q, const Wide& wide, Random& random) {
  for (std::size_t j = 0; j < kDof; ++j) {
    double& x = q[static_cast<Eigen::Index>(j)];
    const double other = x > 0 ? x - kTwoPi : x + kTwoPi;
    if (wide.joints[j] && random.coin() && std::abs(other) < wide.limit - 0.1) x = other;
  }
  return q;
}

/// What the trials met.
struct Counts {
  int solved = 0, none = 0, started = 0, ended = 0, wound = 0, several_wound = 0, solved_wound = 0,
      none_wound = 0, certified = 0, noted = 0, rolls = 0, inexact = 0;
  std::array<int, 3> solved_by_shape{};
};

PathProblem wide_problem(const TestRobot& robot, const Wide& wide, bool rolls, Random& random,
                         Counts& counts, PathShape& shape) {
  PathProblem problem = problem_for(widened(robot, wide));
  const Chain chain = arm_of(widened(robot, wide)).chain;
  Config q = random_config(chain, random);
  for (int j = 0; j < kDof; ++j)  // shoulder, elbow and wrist bent by half of what they can
    q[j] = j % 2 == 0 ? std::remainder(0.9 * q[j], kTwoPi) : 0.5 * q[j];
  shape = draw_path(problem, chain.tool(q), random);
  problem.resolution = {.ds = 0.03, .dphi = 0.35, .dalpha = 0.3};
  problem.limits.joint_step = 0.9;
  problem.limits.arm_slope = 25;
  problem.limits.tool_path_error = 0.02;
  if (random.coin(0.3)) problem.limits.joint_margin = 0.05;
  if (random.coin(0.2)) problem_parts::draw_obstacles(problem, chain, q, 2, random);
  if (random.coin(0.3)) problem.cost.metric = random.one_of({CostMetric::kL1, CostMetric::kMax});
  if (rolls) {
    problem.roll = random.coin() ? Roll{} : Roll{-0.6, 0.6};
    problem.resolution.droll = 0.4;
    problem.resolution.knot = 0.06;
    problem.resolution.dphi = 0.7;
    problem.limits.roll_slope = 15;
  }
  if (!random.coin(0.5)) return problem;
  // given ends: those of another path, in any of their turns
  const PlanResult other = plan(problem);
  if (other.status != PlanStatus::kSolved) return problem;
  const int which = random.below(3);
  if (which != 1) problem.start = turned(other.trajectory.front().q, wide, random);
  if (which != 0) problem.end = turned(other.trajectory.back().q, wide, random);
  counts.started += problem.start.has_value();
  counts.ended += problem.end.has_value();
  return problem;
}

bool has_circles(const Lattice& lattice) {
  if (const auto* grid = dynamic_cast<const SrsLattice*>(&lattice))
    return grid->circles() != Lattice::Joints{};
  return dynamic_cast<const KnotGrid&>(lattice).circles() != Lattice::Joints{};
}

/// Expects the certificate that there is no path to pass its check.
void expect_certified(const PreparedRobot& robot, const PathProblem& problem,
                      const Planner& planner, const std::string& what, Counts& counts) {
  const InfeasibilityCertificate certificate = prove_infeasible(planner.view());
  const CertificateCheck check = verify_certificate(robot, problem, certificate);
  ASSERT_TRUE(check.passed) << what << ": " << check.failure;
  ++counts.certified;
}

/// Returns the warning that says how far a joint would turn; an empty one where there is none.
std::string turns_note_of(const std::vector<std::string>& warnings) {
  for (const std::string& line : warnings)
    if (line.find("but for its limits") != std::string::npos) return line;
  return {};
}

/// Returns the robot of a problem with the joints of `wide` continuous.
PathProblem without_wide_limits(const PathProblem& problem, const TestRobot& robot,
                                const Wide& wide) {
  PathProblem free = problem;
  static_cast<Robot&>(free) = problem_for(with_limits(robot, [&](int number, Joint& joint) {
    if (wide.joints[static_cast<std::size_t>(number)]) joint.type = Joint::Type::kContinuous;
  }));
  free.roll = problem.roll;
  return free;
}

/// Expects a path of `free`, the problem without limits of its wide joints, if an answer without a
/// path names the turn of one of them.
void check_note(const PlanResult& found, const PathProblem& free, const std::string& what,
                Counts& counts) {
  const std::string note = turns_note_of(found.warnings);
  if (note.empty()) return;
  ASSERT_EQ(found.status, PlanStatus::kInfeasible) << what;
  ASSERT_EQ(plan(free).status, PlanStatus::kSolved) << what << ": " << note;
  ++counts.noted;
}

/// Compares the answer with that of turns told apart: where a path did not fit, or `always`.
/// `free`: the problem without limits of its wide joints.
void check_windings(const PathProblem& problem, const PathProblem& free, PathShape shape,
                    bool exact, bool always, const std::string& what, Counts& counts) {
  const auto robot = std::make_shared<const PreparedRobot>(problem);
  const PlanOptions lazy = with_all_evidence(PlannerKind::kLazy);
  Planner planner(robot, problem);
  const PlanResult found = planner.plan(lazy);
  const std::vector<Lattice::Joints> told = planner.view().lattice.joints_with_windings();
  if (told.empty() && !always) return;  // circles that fit are many
  counts.wound += !told.empty();
  counts.several_wound += told.size() > 1;
  ASSERT_NO_FATAL_FAILURE(check_note(found, free, what, counts));
  PlanOptions apart;
  apart.planner = PlannerKind::kLazy;
  apart.hooks.check = std::make_shared<AllowsAll>();
  Planner truth_planner(robot, problem);
  const PlanResult truth = truth_planner.plan(apart);
  ASSERT_FALSE(has_circles(truth_planner.view().lattice)) << what;
  ASSERT_EQ(found.status, truth.status) << what;
  for (const PlannerKind kind : {PlannerKind::kEagerDp, PlannerKind::kParallel}) {
    PlanOptions options;
    options.planner = kind;
    options.threads = 3;
    const PlanResult other = plan(*robot, problem, options);
    ASSERT_EQ(other.status, found.status) << what << ' ' << other.planner;
    ASSERT_EQ(other.cost, found.cost) << what << ' ' << other.planner;
    ASSERT_EQ(other.trajectory.size(), found.trajectory.size()) << what;
    for (std::size_t i = 0; i < other.trajectory.size(); ++i)
      ASSERT_EQ(other.trajectory[i].q, found.trajectory[i].q) << what << " row " << i;
  }
  if (found.status == PlanStatus::kInfeasible) {
    ++counts.none;
    counts.none_wound += !told.empty();
    return expect_certified(*robot, problem, planner, what, counts);
  }
  ++counts.solved;
  counts.solved_wound += !told.empty();
  ++counts.solved_by_shape[static_cast<std::size_t>(shape)];
  // rounding of whole turns is all that may differ
  ASSERT_NEAR(found.lattice.cost, truth.lattice.cost, 1e-9) << what;
  if (exact) {
    ASSERT_NEAR(found.cost, truth.cost, 1e-9) << what;
  }
  const CheckResult check = check_trajectory(*robot, problem, found.trajectory);
  ASSERT_TRUE(check.passed) << what << ": " << (check.failures.empty() ? "" : check.failures[0]);
  if (problem.start) {
    ASSERT_EQ(found.trajectory.front().q, *problem.start) << what;
  }
  if (problem.end) {
    ASSERT_EQ(found.trajectory.back().q, *problem.end) << what;
  }
  const PlanResult again = planner.plan(lazy);
  ASSERT_EQ(again.cost, found.cost) << what;
  ASSERT_EQ(again.trajectory[0].q, found.trajectory[0].q) << what;
}

TEST(Windings, CirclesCostWhatTurnsToldApartCost) {
  const std::uint64_t base = seed("Windings");
  Random any(base);
  const std::array<TestRobot, 4> robots{data_robot("iiwa14"), data_robot("sda5f"),
                                        continuous_robot(),
                                        perturbed(data_robot("iiwa14"), 1, any)};
  Counts counts;
  const int count = trials(480);
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    const auto which = static_cast<std::size_t>(trial) % robots.size();
    const Wide wide = draw_wide(random);
    const bool rolls = random.coin(0.2);
    PathShape shape{};
    const PathProblem problem = wide_problem(robots[which], wide, rolls, random, counts, shape);
    counts.rolls += rolls;
    counts.inexact += which == 3;
    const std::string what = "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " +
                             std::to_string(trial) + " robot " + robots[which].name;
    ASSERT_NO_FATAL_FAILURE(check_windings(problem,
                                           without_wide_limits(problem, robots[which], wide), shape,
                                           which != 3, trial % 12 < 4, what, counts));
  }
  std::printf(
      "%d problems, %d with a start, %d with an end, %d with rolls, %d of an inexact arm; "
      "compared: "
      "%d solved (%d lines, %d rings, %d screws), %d without a path; turns told apart in %d, of "
      "several joints in %d; of these %d solved, %d without a path, %d with a turn named; %d "
      "certificates\n",
      count, counts.started, counts.ended, counts.rolls, counts.inexact, counts.solved,
      counts.solved_by_shape[0], counts.solved_by_shape[1], counts.solved_by_shape[2], counts.none,
      counts.wound, counts.several_wound, counts.solved_wound, counts.none_wound, counts.noted,
      counts.certified);
  for (const int solved : counts.solved_by_shape) EXPECT_GE(solved, at_least_among(6));
  EXPECT_GE(counts.started, at_least_among(15));
  EXPECT_GE(counts.ended, at_least_among(20));
  EXPECT_GE(counts.solved_wound, at_least_among(1));
  EXPECT_GE(counts.none_wound, at_least_among(10));
  EXPECT_GE(counts.noted, at_least_among(5));
  EXPECT_GE(counts.certified, at_least_among(40));
}

/// A ring of two and a half turns asks more of the last joint than +-2 pi allows: by as much as the
/// cheapest path of an arm without that limit turns it.
TEST(Windings, TellHowFarAJointWouldTurn) {
  Wide wide;
  wide.joints[6] = true;
  const TestRobot robot = widened(data_robot("iiwa14"), wide);
  PathProblem problem = problem_for(robot);
  Config q{0.1, 0.6, 0.2, -1.4, 0.1, 1.2, 0.3};
  const Pose tool = arm_of(robot).chain.tool(q);
  for (int k = 0; k <= 20; ++k) {
    Pose pose = tool;
    pose.linear() =
        tool.linear() * Eigen::AngleAxisd(kTwoPi * k / 8, Vector3d::UnitZ()).toRotationMatrix();
    pose.translation().x() -= 0.002 * k;
    problem.waypoints.push_back(waypoint_of(pose));
  }
  const PlanResult free = plan(without_wide_limits(problem, robot, wide));
  ASSERT_EQ(free.status, PlanStatus::kSolved);
  const auto last = [](const TrajectoryRow& row) { return row.q[6]; };
  const auto [least, most] = std::ranges::minmax(free.trajectory | std::views::transform(last));
  const PlanResult found = plan(problem);
  EXPECT_EQ(found.status, PlanStatus::kInfeasible);
  EXPECT_EQ(turns_note_of(found.warnings),
            formatted("but for its limits, %s would turn by %.0f deg along the cheapest path: its "
                      "range is 720 deg",
                      found.joint_names[6].c_str(), (most - least) * 180 / kPi));
  // in a job the stroke is named
  Problem job;
  static_cast<Robot&>(job.arm()) = problem;
  job.arm().transition_limits = problem.limits;
  static_cast<Task&>(job.arm().strokes.emplace_back()) = problem;
  job.arm().strokes[0].name = "screw";
  const Answer strokes = plan_job(job);
  EXPECT_EQ(strokes.status, PlanStatus::kInfeasible);
  EXPECT_EQ(turns_note_of(strokes.warnings),
            formatted("stroke 'screw': but for its limits, %s would turn by %.0f deg along the "
                      "cheapest job: its range is 720 deg",
                      found.joint_names[6].c_str(), (most - least) * 180 / kPi));
  // from a given start there is less room
  problem.start = free.trajectory.front().q;
  const double begin = (*problem.start)[6], end = most > begin ? most : least;
  EXPECT_EQ(turns_note_of(plan(problem).warnings),
            formatted("but for its limits, %s would turn from %.0f to %.0f deg along the cheapest "
                      "path: it may from -360 to 360 deg",
                      found.joint_names[6].c_str(), begin * 180 / kPi, end * 180 / kPi));
}

/// A joint that a step could move by half a turn keeps its turns apart: the short way round a
/// circle would then not be the way that it takes.
TEST(Windings, JointsAreCirclesOnlyWhereNoStepTurnsThemByHalfATurn) {
  Wide wide;
  wide.joints[0] = wide.joints[6] = true;
  PathProblem problem = problem_for(widened(data_robot("iiwa14"), wide));
  const Chain chain = arm_of(widened(data_robot("iiwa14"), wide)).chain;
  Config q{0.1, 0.6, 0.2, -1.4, 0.1, 1.2, 0.3};
  problem.waypoints = {waypoint_of(chain.tool(q)), waypoint_of(chain.tool(q))};
  problem.waypoints[1].position.x() -= 0.05;
  const auto circles = [](const PathProblem& of) {
    Planner planner(of);
    EXPECT_EQ(planner.plan().status, PlanStatus::kSolved);
    return dynamic_cast<const SrsLattice&>(planner.view().lattice).circles();
  };
  const Lattice::Joints both{true, false, false, false, false, false, true};
  EXPECT_EQ(circles(problem), both);
  PathProblem other = problem;
  other.limits.joint_step = 3.2;
  EXPECT_EQ(circles(other), Lattice::Joints{});
  other = problem;
  other.resolution.arcs = true;
  EXPECT_EQ(circles(other), Lattice::Joints{});
}

}  // namespace
}  // namespace swivel
