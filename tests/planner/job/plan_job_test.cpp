// SPDX-License-Identifier: BSD-3-Clause
// Jobs on real robots: answers against a plain program and their own check, whatever the threads;
// motions by differences from outside; mutated answers are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "random_jobs.hpp"
#include "robots.hpp"
#include "seed.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/study/campaign.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/graph/verdicts/verdicts.hpp"
#include "swivel/io/io.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/planner/job/check_job.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/job/time_job.hpp"
#include "swivel/planner/plan/problem_view.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {
namespace {

using namespace test;

TEST(PlanJob, PassesItsCheckAndIsTheSameAtAnyThreadCount) {
  Random random(seed("PlanJob"));
  const JobCase door("door_job.yaml");
  int solved = 0, detours = 0, best = 0;
  const int count = trials(60);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what = "trial " + std::to_string(trial);
    const Problem job = random_job(door, random);
    PlanOptions options;
    options.threads = 1;
    const Answer found = plan_job(door.robot, job, options);
    for (const int threads : {2, 4}) {
      if (trial % 4 != 0) continue;
      options.threads = threads;
      expect_same(found, plan_job(door.robot, job, options), what);
      if (HasFatalFailure()) return;
    }
    if (found.status != PlanStatus::kSolved) continue;
    ++solved;
    best += job.arm().order == StrokeOrder::kBest;
    ASSERT_LE(found.bound, found.cost) << what;
    ASSERT_LE(found.bound_any, found.bound) << what;
    const AnswerCheck check = check_job(door.robot, job, found.arm().parts);
    ASSERT_TRUE(check.passed) << what << ": " << check.failures.front();
    ASSERT_NEAR(check.cost, found.cost, 1e-6) << what;
    for (const Part& part : found.arm().parts) detours += !part.run && part.rows.size() > 2;
  }
  std::printf("%d jobs, %d solved, %d in the best order, %d transitions around obstacles\n", count,
              solved, best, detours);
  EXPECT_GE(solved, at_least(20));
  EXPECT_GE(best, at_least(3));
  EXPECT_GE(detours, at_least(3));
}

/// The eager planners ask about all nodes and edges first, and find the same jobs.
TEST(PlanJob, EagerPlannersFindTheSameJobs) {
  Random random(seed("PlanJob.Eager"));
  const JobCase door("door_job.yaml");
  int solved = 0;
  const int count = trials(12);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what = "trial " + std::to_string(trial);
    Problem job = random_job(door, random);
    while (job.arm().strokes.size() > 2) job.arm().strokes.pop_back();
    for (Stroke& stroke : job.arm().strokes) {
      stroke.resolution.ds = 0.05;
      stroke.resolution.dphi = 0.3;
      stroke.limits.joint_step = 1;
      stroke.limits.tool_path_error = 0.05;
    }
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    const Answer lazy = plan_job(door.robot, job, options);
    for (const PlannerKind kind : {PlannerKind::kEager, PlannerKind::kEagerDp}) {
      options.planner = kind;
      const Answer eager = plan_job(door.robot, job, options);
      ASSERT_EQ(eager.status, lazy.status) << what;
      ASSERT_EQ(eager.planner, to_string(kind)) << what;
      ASSERT_EQ(eager.cost, lazy.cost) << what;
      ASSERT_EQ(eager.bound_any, lazy.bound_any) << what;
      ASSERT_GE(eager.arm().counters.nodes_checked, lazy.arm().counters.nodes_checked) << what;
      ASSERT_EQ(eager.arm().parts.size(), lazy.arm().parts.size()) << what;
      for (std::size_t k = 0; k < lazy.arm().parts.size(); ++k)
        for (std::size_t i = 0; i < lazy.arm().parts[k].rows.size(); ++i)
          ASSERT_EQ(eager.arm().parts[k].rows[i].q, lazy.arm().parts[k].rows[i].q) << what;
    }
    solved += lazy.has_rows();
  }
  std::printf("%d jobs, %d solved\n", count, solved);
  EXPECT_GE(solved, at_least(4));
}

/// Joints 1 and 7 of two turns are circles, unless a step may move them by half a turn; no step of
/// these jobs does, so that the cost is the same.
TEST(PlanJob, WideJointsCostWhatTheirTurnsToldApartCost) {
  const Problem door = load("door_job.yaml");
  const PathProblem first = problem_of_run(door, {0, false});
  const TestRobot wide = with_limits({"door", door.arm().model, first.base_link, first.tip_link},
                                     [](int number, Joint& j) {
                                       if (number == 0 || number == 6)
                                         j.lower = -kTwoPi, j.upper = kTwoPi;
                                     });
  Random random(seed("PlanJob.Wide"));
  int solved = 0, told_apart = 0;
  const int count = trials(24);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what = "trial " + std::to_string(trial);
    Problem job = door;
    job.arm().model = wide.model;
    job.scene = episode_problem(first, 1, static_cast<std::uint64_t>(trial)).scene;
    while (job.arm().strokes.size() > 2 && random.coin()) job.arm().strokes.pop_back();
    if (random.coin()) job.arm().home.reset();
    for (Stroke& stroke : job.arm().strokes) {
      stroke.resolution.ds = 0.03;
      stroke.resolution.dphi = 0.25;
      stroke.resolution.knot = 0;
      stroke.limits.tool_path_error = 0.02;
      const double turn = random.uniform(-4, 4);  // of the tool, about its axis
      const std::size_t parts = stroke.waypoints.size();
      for (std::size_t k = 0; k < parts; ++k)
        stroke.waypoints[k].orientation =
            stroke.waypoints[k].orientation *
            Quaterniond(Eigen::AngleAxisd(
                turn * static_cast<double>(k) / static_cast<double>(parts), Vector3d::UnitZ()));
    }
    std::array<Answer, 2> found;
    std::array<int, 2> windings{};
    for (std::size_t apart = 0; apart < 2; ++apart) {
      // one stroke that moves joints by half a turn tells them apart in all
      for (Stroke& stroke : job.arm().strokes) stroke.limits.joint_step = 3.0;
      if (apart == 1) job.arm().strokes.back().limits.joint_step = 3.2;
      found[apart] = plan_job(job, {});
      ASSERT_FALSE(found[apart].arm().runs.empty()) << what;
      windings[apart] = found[apart].arm().runs[0].lattice.grid->windings;
    }
    ASSERT_EQ(windings[1], 4) << what;
    ASSERT_EQ(found[0].status, found[1].status) << what;
    ASSERT_NEAR(found[0].cost, found[1].cost, 1e-6) << what;
    solved += found[0].status == PlanStatus::kSolved;
    told_apart += windings[0] > 1;
  }
  std::printf("%d jobs, %d solved, %d with turns told apart\n", count, solved, told_apart);
  EXPECT_GE(solved, at_least_among(count / 3));
  EXPECT_GE(told_apart, at_least(1));
  EXPECT_LT(told_apart, count);
}

/// Expects that a run's view has the rows of its part, but for whole turns, and knows their nodes.
void expect_shows(const PlanView& view, const Part& part, const std::string& what) {
  const std::vector<TrajectoryRow> rows = view.lattice.path_rows(view.path);
  ASSERT_EQ(rows.size(), part.rows.size()) << what;
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (int j = 0; j < kDof; ++j)
      ASSERT_NEAR(wrap_angle(rows[i].q[j] - part.rows[i].q[j]), 0, 1e-9) << what << ", row " << i;
  for (std::size_t i = 0; i < view.path.size(); ++i)
    ASSERT_EQ(view.verdicts->node(static_cast<int>(i), view.path[i]), Verdict::kValid) << what;
}

TEST(PlanJob, ShowsWhatItFoundOutAboutRuns) {
  Random random(seed("ProblemView"));
  const JobCase door("door_job.yaml");
  int solved = 0, without = 0;
  const int count = trials(20);
  for (int trial = 0; trial < count; ++trial) {
    const std::string what = "trial " + std::to_string(trial);
    const Problem job = random_job(door, random);
    ProblemView view;
    const Answer found = plan_job(door.robot, job, {}, &view);
    expect_same(found, plan_job(door.robot, job), what);
    if (HasFatalFailure()) return;
    if (view.runs.empty()) {
      ASSERT_TRUE(found.arm().no_transition) << what;
      ASSERT_EQ(found.arm().no_transition->where, NoTransition::Where::kHome) << what;
      continue;
    }
    ASSERT_EQ(view.runs.size(), found.arm().runs.size()) << what;
    std::size_t run = 0;
    for (const Part& part : found.arm().parts)
      if (part.run) expect_shows(view.runs[run++], part, what);
    if (HasFatalFailure()) return;
    solved += run > 0;
    for (; run < view.runs.size(); ++run) {
      const auto layers = static_cast<std::size_t>(view.runs[run].lattice.layers());
      ASSERT_LT(view.runs[run].path.size(), layers) << what;
      without += !view.runs[run].path.empty();
    }
  }
  std::printf("%d jobs, %d solved, %d runs with a part of a path\n", count, solved, without);
  EXPECT_GE(solved, at_least(8));
  EXPECT_GE(without, at_least(2));
}

TEST(PlanJob, JobsOfTheDataFolderBecomeMotions) {
  for (const char* const name : {"door_job.yaml", "iiwa14_bench_job.yaml", "kr6_weld_pipe_job.yaml",
                                 "ur5e_deburr_plate_job.yaml"}) {
    SCOPED_TRACE(name);
    const Problem job = with_motion_defaults(load(name));
    const PreparedRobot robot(problem_of_run(job, {0, false}));
    const Answer plan = plan_job_motion(robot, job, {}, false, TimingOptions{.rate = 50});
    ASSERT_TRUE(plan.timed());
    EXPECT_EQ(plan.timed()->arms.front().events.size(), 2 * job.arm().strokes.size());
    std::vector<StrokeRun> order;
    for (const RunAnswer& run : plan.arm().runs) order.push_back(run.run);
    const AnswerCheck check =
        check_job_motion(robot, job, order, plan.timed()->arms.front(), {.margins = false});
    EXPECT_TRUE(check.passed) << check.failures.front();
    EXPECT_LE(plan.cost, 1.05 * plan.bound_any);
  }
}

TEST(PlanJob, TheBestOrderIsNoDearerThanTheGivenOne) {
  const JobCase door("door_job.yaml");
  int solved = 0;
  double most = 0, sum = 0;
  const int count = trials(12);
  for (int k = 0; k < count; ++k) {
    Problem job = door.episode(static_cast<std::uint64_t>(k));
    for (Stroke& stroke : job.arm().strokes) {
      stroke.reversible = true;
      stroke.resolution.ds = 0.02;
      stroke.resolution.dphi = 0.1;
    }
    std::swap(job.arm().strokes[1], job.arm().strokes[4]);
    const Answer given = plan_job(door.robot, job, {});
    job.arm().order = StrokeOrder::kBest;
    const Answer best = plan_job(door.robot, job, {});
    if (given.status != PlanStatus::kSolved) continue;
    ASSERT_EQ(best.status, PlanStatus::kSolved);
    ++solved;
    EXPECT_LE(best.cost, given.cost * (1 + 1e-12)) << "episode " << k;
    most = std::max(most, best.cost / given.cost);
    sum += best.cost / given.cost;
  }
  std::printf("%d jobs: best over given %.3f in the mean, %.3f at most\n", solved, sum / solved,
              most);
  EXPECT_GE(solved, at_least(6));
}

TEST(PlanJob, TriesOrdersWhereTheRollCosts) {
  Problem job = load("ur5e_deburr_plate_job.yaml");
  for (Stroke& stroke : job.arm().strokes) {
    stroke.cost.roll = 2;
    stroke.resolution.ds = 0.03;
    stroke.resolution.arc = 0.35;
    stroke.limits.tool_path_error = 0.02;
  }
  job.arm().order = StrokeOrder::kGiven;
  const Answer given = plan_job(job);
  job.arm().order = StrokeOrder::kBest;
  const Answer best = plan_job(job);
  ASSERT_EQ(given.status, PlanStatus::kSolved);
  ASSERT_EQ(best.status, PlanStatus::kSolved);
  EXPECT_LE(best.cost, given.cost * (1 + 1e-12));
  const PreparedRobot robot(problem_of_run(job, {0, false}));
  const AnswerCheck check = check_job(robot, job, best.arm().parts);
  ASSERT_TRUE(check.passed) << check.failures.front();
  EXPECT_NEAR(check.cost, best.cost, 1e-9);
}

/// Returns a problem's path cut in two strokes at its middle waypoint, without a start.
Problem halves(const char* name) {
  PathProblem whole = io::load_path_problem(std::string(SWIVEL_DATA_DIR) + "/problems/" + name);
  whole.start.reset();
  if (whole.waypoints.size() == 2) {
    Waypoint middle = whole.waypoints[0];
    middle.position = (middle.position + whole.waypoints[1].position) / 2;
    middle.orientation = middle.orientation.slerp(0.5, whole.waypoints[1].orientation);
    whole.waypoints.insert(whole.waypoints.begin() + 1, middle);
  }
  Problem job;
  static_cast<Robot&>(job.arm()) = whole;
  job.source = name;
  job.scene = whole.scene;
  job.arm().transition_limits = whole.limits;
  const auto middle =
      whole.waypoints.begin() + static_cast<std::ptrdiff_t>(whole.waypoints.size() / 2);
  for (const bool second : {false, true}) {
    Stroke& stroke = job.arm().strokes.emplace_back();
    static_cast<Task&>(stroke) = whole;
    stroke.name = second ? "second" : "first";
    stroke.waypoints = second ? std::vector<Waypoint>(middle, whole.waypoints.end())
                              : std::vector<Waypoint>(whole.waypoints.begin(), middle + 1);
  }
  job.arm().process_speed = 0.05;
  return job;
}

/// Draws a home within the joints' limits at which nothing is near.
std::optional<Config> random_home(const PreparedRobot& robot, const Problem& job, Random& random) {
  const Chain& chain = robot.arm().chain;
  const World world(robot.world(), problem_of_run(job, {0, false}));
  World::Query query(world);
  for (int tries = 0; tries < 100; ++tries) {
    Config q = Config::Zero();
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain.limit[j];
      if (chain.roll && j + 1 == kDof) continue;
      q[static_cast<Eigen::Index>(j)] =
          limit.continuous ? random.uniform(-4, 4) : random.uniform(limit.lower, limit.upper);
    }
    const auto clearance = query.clearance(q);
    if (!clearance || clearance->margin() > 0.02) return q;
  }
  return std::nullopt;
}

TEST(PlanJob, TakesEveryClassOfArm) {
  Random random(seed("PlanJob arms"));
  int solved = 0, timed = 0;
  for (const char* name :
       {"experiment_a.yaml", "iiwa14_bench.yaml", "kr6_weld_pipe.yaml", "panda_weld_seam.yaml",
        "ur5e_deburr_edge.yaml", "gen3_glue_bead.yaml"}) {
    Problem job = halves(name);
    const PreparedRobot robot(problem_of_run(job, {0, false}));
    for (int trial = 0; trial < trials(3); ++trial) {
      if (trial > 0) job.arm().home = random_home(robot, job, random);
      const Answer plan = plan_job_motion(robot, job, {}, false, TimingOptions{});
      if (plan.status != PlanStatus::kSolved) continue;
      ++solved;
      const Problem completed = with_motion_defaults(job);
      const AnswerCheck check = check_job(robot, completed, plan.arm().parts, {.margins = false});
      ASSERT_TRUE(check.passed) << name << " trial " << trial << ": " << check.failures.front();
      ASSERT_TRUE(plan.motion) << name;
      if (!plan.timed()) continue;
      ++timed;
      std::vector<StrokeRun> order;
      for (const RunAnswer& run : plan.arm().runs) order.push_back(run.run);
      const AnswerCheck moved =
          check_job_motion(robot, job, order, plan.timed()->arms.front(), {.margins = false});
      ASSERT_TRUE(moved.passed) << name << " trial " << trial << ": " << moved.failures.front();
    }
  }
  std::printf("%d jobs solved, %d timed\n", solved, timed);
  EXPECT_GE(solved, at_least(12));
  EXPECT_GE(timed, at_least(8));
}

TEST(PlanJob, ADeadlineEndsItWithWhatIsKnown) {
  const JobCase door("door_job.yaml");
  for (const double timeout : {1e-4, 2e-3, 2e-2, 5e-2}) {
    PlanOptions options;
    options.timeout_s = timeout;
    const Answer found = plan_job(door.robot, door.job, options);
    if (found.status != PlanStatus::kSolved) {
      EXPECT_EQ(found.status, PlanStatus::kTimeout);
    }
    if (found.arm().parts.empty()) continue;
    EXPECT_LE(found.bound, found.cost);
    EXPECT_TRUE(check_job(door.robot, door.job, found.arm().parts).passed);
  }
}

TEST(PlanJob, TellsWhichStrokeHasNoPath) {
  const JobCase door("door_job.yaml");
  Problem job = door.job;
  for (Waypoint& waypoint : job.arm().strokes[3].waypoints)
    waypoint.position.y() += 2;  // out of reach
  const Answer found = plan_job(door.robot, job, {});
  ASSERT_EQ(found.status, PlanStatus::kInfeasible);
  ASSERT_EQ(found.arm().runs.size(), job.arm().strokes.size());
  for (std::size_t k = 0; k < found.arm().runs.size(); ++k) {
    EXPECT_EQ(found.arm().runs[k].status, k == 3 ? PlanStatus::kInfeasible : PlanStatus::kSolved);
    EXPECT_EQ(found.arm().runs[k].diagnosis.has_value(), k == 3);
  }
}

/// Returns the greatest differences of samples as parts of the joints' rates: speed, acceleration,
/// jerk.
std::array<double, 3> greatest_shares(const std::vector<TimedRow>& rows, const JointRates& rates,
                                      double rate) {
  std::array<double, 3> most{};
  std::vector<Config> values(3, rows.front().row.q);
  for (const TimedRow& row : rows) values.push_back(row.row.q);
  values.insert(values.end(), 3, rows.back().row.q);
  const Config* const limits[] = {&rates.speed, &rates.acceleration, &rates.jerk};
  for (std::size_t order = 0; order < 3; ++order) {
    for (std::size_t k = 0; k + 1 < values.size(); ++k)
      values[k] = (values[k + 1] - values[k]) * rate;
    values.pop_back();
    for (const Config& value : values)
      most[order] = std::max(
          most[order], value.cwiseAbs().cwiseQuotient(*limits[order]).head<kDof>().maxCoeff());
  }
  return most;
}

/// Expects a job's motion to keep rates, clearances and its strokes, judged from outside.
void expect_executable(const JobCase& of, const Problem& job, const Answer& plan,
                       const std::string& what) {
  const ArmMotion& motion = plan.timed()->arms.front();
  const Chain& chain = of.robot.arm().chain;
  const auto shares = greatest_shares(
      motion.rows, joint_rates(chain, job.arm().transition_limits, ""), motion.rate);
  for (const double share : shares) ASSERT_LE(share, 1 + 1e-6) << what;
  PathProblem problem = problem_of_run(with_motion_defaults(job), {0, false});
  const World world(of.robot.world(), problem);
  World::Query query(world);
  for (std::size_t k = 1; k < motion.rows.size(); k += 97)
    for (int i = 0; i < 10; ++i) {
      const Config q =
          motion.rows[k - 1].row.q + 0.1 * i * (motion.rows[k].row.q - motion.rows[k - 1].row.q);
      const auto clearance = query.clearance(q);
      ASSERT_TRUE(clearance && clearance->margin() >= -6e-5) << what << " row " << k;
    }
  ASSERT_EQ(motion.events.size(), 2 * job.arm().strokes.size()) << what;
  for (std::size_t k = 0; k < motion.events.size(); ++k) {
    const ProcessEvent& event = motion.events[k];
    ASSERT_EQ(event.on, k % 2 == 0) << what;
    const StrokeRun run = plan.arm().runs[k / 2].run;
    ASSERT_EQ(event.stroke, run.stroke) << what;
    // the tool is at the stroke's end within one sample
    const auto row = static_cast<std::size_t>(std::llround(event.t * motion.rate));
    const PathProblem path = problem_of_run(job, run);
    const ProcessWaypoints process = process_waypoints(job.arm().strokes[run.stroke]);
    const Vector3d end = waypoints_in_base(path)[event.on ? process.first : process.last].position;
    const Vector3d at = chain.tool(motion.rows[row].row.q).translation();
    const Vector3d before = chain.tool(motion.rows[row > 0 ? row - 1 : 0].row.q).translation();
    ASSERT_LE((at - end).norm(), (at - before).norm() + 2e-4) << what << " event " << k;
  }
}

TEST(JobMotion, KeepsRatesClearancesAndEvents) {
  const JobCase door("door_job.yaml"), bench("iiwa14_bench_job.yaml");
  int timed = 0;
  for (const JobCase* of : {&door, &bench})
    for (int k = 0; k < trials(8); ++k) {
      Problem job = of->episode(static_cast<std::uint64_t>(k));
      for (Stroke& stroke : job.arm().strokes)
        stroke.retract = stroke.approach = Vector3d(0, 0, -0.02);
      job.arm().approach_speed = 0.1;
      job.arm().rapid = 0.5;
      const std::string what = job.source + " episode " + std::to_string(k);
      PlanOptions options;
      const Answer plan = plan_job_motion(of->robot, job, options, false, TimingOptions{});
      if (plan.status != PlanStatus::kSolved) continue;
      ASSERT_TRUE(plan.motion) << what;
      if (!plan.timed()) continue;
      ++timed;
      expect_executable(*of, job, plan, what);
      if (HasFatalFailure()) return;
      std::vector<StrokeRun> order;
      for (const RunAnswer& run : plan.arm().runs) order.push_back(run.run);
      const AnswerCheck check = check_job_motion(of->robot, job, order, plan.timed()->arms.front());
      ASSERT_TRUE(check.passed) << what << ": " << check.failures.front();
    }
  std::printf("%d motions\n", timed);
  EXPECT_GE(timed, at_least(8));
}

/// A stroke that begins at the joints at which the one before ends needs no way between them; the
/// motion has a row of the transition nevertheless.
TEST(JobMotion, StrokesThatMeetAreTimed) {
  const JobCase door("door_job.yaml");
  Problem job = door.job;
  job.arm().home.reset();
  job.arm().strokes.resize(1);
  Answer there = plan_job(door.robot, with_motion_defaults(job));
  ASSERT_EQ(there.arm().parts.size(), 1u);
  job.arm().strokes.push_back(job.arm().strokes.front());
  std::vector<Waypoint>& waypoints = job.arm().strokes[1].waypoints;
  std::reverse(waypoints.begin(), waypoints.end());
  job.arm().strokes[1].name = "back";
  Part back = there.arm().parts[0], rest;
  back.run = StrokeRun{1, false};
  std::reverse(back.rows.begin(), back.rows.end());
  for (TrajectoryRow& row : back.rows) row.s = there.arm().parts[0].rows.back().s - row.s;
  rest.rows = {back.rows.front(), back.rows.front()};
  const std::vector<Part> parts{there.arm().parts[0], rest, back};
  const MotionTiming timed = time_job(door.robot, job, parts, {});
  ASSERT_TRUE(timed.motion);
  const ArmMotion& motion = timed.motion->arms.front();
  EXPECT_EQ(std::count(motion.part.begin(), motion.part.end(), 1), 1);
  const AnswerCheck check = check_job_motion(door.robot, job, {{0, false}, {1, false}}, motion);
  EXPECT_TRUE(check.passed) << check.failures.front();
}

TEST(JobMotion, SpeedsAreStatedBeforePlanning) {
  const JobCase door("door_job.yaml");
  Problem job = door.job;
  job.arm().strokes.resize(1);
  job.arm().process_speed.reset();
  PlanOptions none;
  none.timeout_s = 1e-9;
  EXPECT_THROW(static_cast<void>(plan_job_motion(door.robot, job, none, false, TimingOptions{})),
               InputError);
  job.arm().strokes[0].feed.assign(job.arm().strokes[0].waypoints.size(), 0.04);
  EXPECT_EQ(plan_job_motion(door.robot, job, none, false, TimingOptions{}).status,
            PlanStatus::kTimeout);
  const Answer plan = plan_job_motion(door.robot, job, {}, false, TimingOptions{});
  ASSERT_TRUE(plan.timed());
  EXPECT_NEAR(plan.timed()->arms.front().runs.front().speed, 0.04, 1e-12);
}

/// A way to spoil a job's answer, by a random amount.
using Spoil = std::function<void(std::vector<Part>&, Random&)>;
using Ways = std::vector<std::pair<const char*, Spoil>>;

/// Returns a random part: a run or a transition.
Part& random_part(std::vector<Part>& parts, bool run, Random& random) {
  for (;;)
    if (Part& part = parts[static_cast<std::size_t>(random.below(static_cast<int>(parts.size())))];
        part.run.has_value() == run)
      return part;
}

/// Returns ways to spoil the rows of a part.
Ways ways_to_spoil_rows() {
  return {{"the retract is missing",
           [](auto& parts, Random& random) {
             Part& part = random_part(parts, true, random);
             part.rows.resize(part.rows.size() - 1 - static_cast<std::size_t>(random.below(3)));
           }},
          {"the approach is missing",
           [](auto& parts, Random& random) {
             Part& part = random_part(parts, true, random);
             part.rows.erase(part.rows.begin(), part.rows.begin() + 1 + random.below(3));
           }},
          {"a transition ends elsewhere",
           [](auto& parts, Random& random) {
             TrajectoryRow& row = random_part(parts, false, random).rows.back();
             row.q[random.below(6)] += random.coin() ? 1e-6 : 0.3;
           }},
          {"a transition begins elsewhere",
           [](auto& parts, Random& random) {
             TrajectoryRow& row = random_part(parts, false, random).rows.front();
             row.q[random.below(6)] -= random.coin() ? 1e-6 : 0.3;
           }},
          {"a transition leads out of the joints' limits",
           [](auto& parts, Random& random) {
             Part& part = random_part(parts, false, random);
             TrajectoryRow row = part.rows.front();
             row.q[random.below(6)] += random.coin() ? 7 : -7;
             part.rows.insert(part.rows.begin() + 1, row);
           }},
          {"a stroke jumps", [](auto& parts, Random& random) {
             Part& part = random_part(parts, true, random);
             const auto row =
                 static_cast<std::size_t>(random.below(static_cast<int>(part.rows.size())));
             part.rows[row].q[random.below(6)] += 0.01;
           }}};
}

/// Returns ways to spoil which parts there are.
Ways ways_to_spoil_parts() {
  return {{"two strokes are swapped",
           [](auto& parts, Random& random) {
             const auto a = 1 + 2 * static_cast<std::size_t>(random.below(2));
             std::swap(parts[a], parts[a + 2]);
           }},
          {"a stroke is left out",
           [](auto& parts, Random& random) {
             const auto a = parts.begin() + 1 + 2 * random.below(2);
             parts.erase(a, a + 2);
           }},
          {"a stroke is said to be another",
           [](auto& parts, Random& random) {
             Part& part = random_part(parts, true, random);
             part.run->stroke = (part.run->stroke + 1) % 3;
           }},
          {"a stroke runs backwards",
           [](auto& parts, Random& random) {
             Part& part = random_part(parts, true, random);
             part.run->reversed = true;
             std::reverse(part.rows.begin(), part.rows.end());
           }},
          {"a transition is left out", [](auto& parts, Random& random) {
             parts.erase(parts.begin() + 2 * random.below(static_cast<int>(parts.size() / 2)));
           }}};
}

TEST(CheckJob, RefusesSpoiltAnswers) {
  Random random(seed("CheckJob"));
  const JobCase door("door_job.yaml");
  Problem job = door.job;
  job.arm().strokes.resize(3);
  for (Stroke& stroke : job.arm().strokes) {
    stroke.approach = stroke.retract = Vector3d(0, 0, -0.02);
    stroke.resolution.ds = 0.02;
    stroke.resolution.dphi = 0.1;
  }
  const Answer found = plan_job(door.robot, job, {});
  ASSERT_EQ(found.status, PlanStatus::kSolved);
  ASSERT_TRUE(check_job(door.robot, job, found.arm().parts).passed);
  int refused = 0;
  Ways ways = ways_to_spoil_rows();
  for (const auto& way : ways_to_spoil_parts()) ways.push_back(way);
  const int count = trials(330);
  for (int trial = 0; trial < count; ++trial) {
    const auto& [name, spoil] = ways[static_cast<std::size_t>(trial) % ways.size()];
    std::vector<Part> parts = found.arm().parts;
    spoil(parts, random);
    const AnswerCheck check = check_job(door.robot, job, parts, {.margins = false});
    EXPECT_FALSE(check.passed) << "trial " << trial << ": " << name;
    refused += !check.passed;
  }
  std::printf("%d answers spoilt in %zu ways, %d refused\n", count, ways.size(), refused);
}

TEST(CheckJob, RefusesEventsThatLie) {
  Random random(seed("CheckJob events"));
  const JobCase door("door_job.yaml");
  Problem job = door.job;
  job.arm().strokes.resize(2);
  for (Stroke& stroke : job.arm().strokes) stroke.approach = Vector3d(0, 0, -0.02);
  const Answer plan = plan_job_motion(door.robot, job, {}, false, TimingOptions{});
  ASSERT_TRUE(plan.timed());
  std::vector<StrokeRun> order;
  for (const RunAnswer& run : plan.arm().runs) order.push_back(run.run);
  const auto passes = [&](const ArmMotion& motion) {
    return check_job_motion(door.robot, job, order, motion, {.margins = false}).passed;
  };
  ASSERT_TRUE(passes(plan.timed()->arms.front()));
  for (int trial = 0; trial < trials(30); ++trial) {
    ArmMotion motion = plan.timed()->arms.front();
    ProcessEvent& event =
        motion
            .events[static_cast<std::size_t>(random.below(static_cast<int>(motion.events.size())))];
    switch (random.below(4)) {
      case 0:
        event.on = !event.on;
        break;
      case 1:
        event.t += (random.coin() ? 1 : -1) / motion.rate;
        break;
      case 2:
        event.stroke = 1 - event.stroke;
        break;
      default:
        motion.events.pop_back();
    }
    EXPECT_FALSE(passes(motion)) << "trial " << trial;
  }
}

TEST(CheckJob, HoldsTheProcessAgainstTheStroke) {
  Random random(seed("CheckJob process"));
  const JobCase door("door_job.yaml");
  Problem job = door.job;
  job.arm().strokes.resize(3);
  for (Stroke& stroke : job.arm().strokes) {
    stroke.approach = stroke.retract = Vector3d(0, 0, -0.02);
    stroke.resolution.ds = 0.02;
    stroke.resolution.dphi = 0.1;
  }
  const std::vector<Part> parts = plan_job(door.robot, job, {}).arm().parts;
  ASSERT_EQ(parts.size(), 7u);
  std::vector<std::vector<bool>> process;
  for (const Part& part : parts) process.push_back(process_of_rows(part, job));
  const auto failures = [&](const std::vector<std::vector<bool>>& said) {
    AnswerCheck result;
    result.passed = true;
    check_process(job, parts, said, result);
    EXPECT_EQ(result.passed, result.failures.empty());
    EXPECT_EQ(result.failure_count, static_cast<std::int64_t>(result.failures.size()));
    return result.failures;
  };
  EXPECT_TRUE(failures(process).empty());
  EXPECT_TRUE(failures(std::vector<std::vector<bool>>(parts.size())).empty());
  int refused = 0;
  for (int trial = 0; trial < trials(60); ++trial) {
    auto spoilt = process;
    const auto k = static_cast<std::size_t>(random.below(static_cast<int>(parts.size())));
    const auto row = static_cast<std::size_t>(random.below(static_cast<int>(spoilt[k].size())));
    spoilt[k][row] = !spoilt[k][row];
    const std::vector<std::string> said = failures(spoilt);
    if (!parts[k].run) {
      EXPECT_TRUE(said.empty()) << said.front();
      continue;
    }
    ASSERT_EQ(said.size(), 1u);
    const int is = spoilt[k][row];
    EXPECT_EQ(said.front(), "stroke '" + job.arm().strokes[parts[k].run->stroke].name + "': row " +
                                std::to_string(row) + ": process is " + std::to_string(is) +
                                ": allowed is " + std::to_string(1 - is));
    ++refused;
  }
  EXPECT_GE(refused, at_least(10));
  auto short_of_a_row = process;
  short_of_a_row[1].pop_back();
  EXPECT_THROW(failures(short_of_a_row), InvalidArgument);
  process.pop_back();
  EXPECT_THROW(failures(process), InvalidArgument);
}

TEST(CheckJob, FindsTheDirectionsOfRunsInMotions) {
  const JobCase door("door_job.yaml");
  int backwards = 0;
  for (const bool home : {true, false}) {
    Problem job = door.job;
    if (!home) job.arm().home.reset();
    job.arm().strokes.resize(4);
    job.arm().order = StrokeOrder::kBest;
    for (Stroke& stroke : job.arm().strokes) {
      stroke.reversible = &stroke != &job.arm().strokes.front();  // so that one runs forwards
      stroke.approach = Vector3d(0, 0, -0.02);
      stroke.resolution.knot = 0;
    }
    const Answer plan = plan_job_motion(door.robot, job, {}, false, TimingOptions{});
    ASSERT_TRUE(plan.timed());
    std::vector<StrokeRun> order;
    std::vector<std::size_t> strokes;
    for (const RunAnswer& run : plan.arm().runs) {
      order.push_back(run.run);
      strokes.push_back(run.run.stroke);
      backwards += run.run.reversed;
    }
    EXPECT_EQ(runs_of_motion(door.robot, job, strokes, plan.timed()->arms.front()), order);
  }
  EXPECT_GT(backwards, 0);
  EXPECT_LT(backwards, 8);
}

}  // namespace
}  // namespace swivel
