// SPDX-License-Identifier: BSD-3-Clause
// Motions of two arms by one clock, measured from outside: rates by differences between samples,
// places of the tools by the chains alone, clearances between samples by FCL alone.
#include "swivel/planner/workcell/time_workcell.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "inner_posture.hpp"
#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/planner/plan/problem_view.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "swivel/planner/workcell/refine_workcell.hpp"
#include "two_arms.hpp"
#include "worst_rates.hpp"

namespace swivel::test {

namespace {

enum class Kind { kTwoLines, kTwoPolylines, kFollower, kBar };

/// Gives both arms of a random workcell one to three further waypoints, at other shares of their
/// ways, so that the ratio of the tools' speeds changes there; some bend the paths as well.
void add_waypoints(Problem& cell, Random& random) {
  const int more = 1 + random.below(3);
  const bool bends = random.coin();
  for (ArmTask& arm : cell.arms) {
    const Waypoint from = arm.path().waypoints.front(), to = arm.path().waypoints.back();
    arm.path().waypoints.pop_back();
    double share = 0;
    for (int k = 0; k < more; ++k) {
      share += random.uniform(0.1, 1.4) * (1 - share) / (more - k + 1);
      share = std::min(share, 0.95);
      Waypoint between = from;
      between.position += share * (to.position - from.position);
      if (bends) between.position += random_vector(random, random.uniform(0, 0.03));
      arm.path().waypoints.push_back(between);
    }
    arm.path().waypoints.push_back(to);
  }
}

/// Lets the right tool stand against a place beside the left one's and move a little about it.
void follow(Problem& cell, Random& random) {
  ArmTask& right = cell.arms[1];
  right.path().path_frame = "left";
  for (std::size_t k = 0; k < right.path().waypoints.size(); ++k) {
    right.path().waypoints[k].position =
        Vector3d(random.uniform(-0.05, 0.05), random.uniform(0.17, 0.2), random.uniform(0, 0.04));
    right.path().waypoints[k].orientation =
        Quaterniond(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitX()) *
                    Eigen::AngleAxisd(random.uniform(-0.2, 0.2), Vector3d::UnitZ()));
  }
}

/// Lets both hands point forward and keep their pose to each other along a random polyline.
void carry_bar(Problem& cell, Random& random) {
  const Quaterniond forward(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY()));
  const double width = random.uniform(0.2, 0.5);
  const Vector3d middle(random.uniform(0.66, 0.78), random.uniform(-0.1, 0.1),
                        random.uniform(0.9, 1.2));
  for (std::size_t k = 0; k < cell.arms[0].path().waypoints.size(); ++k) {
    Waypoint& waypoint = cell.arms[0].path().waypoints[k];
    waypoint.position = middle + Vector3d(0, width / 2, 0) + random_vector(random, 0.12);
    waypoint.orientation =
        Quaterniond(Eigen::AngleAxisd(random.uniform(-0.2, 0.2), Vector3d::UnitX())) * forward;
    cell.arms[1].path().waypoints[k].position = Vector3d(0, -width, 0);
    cell.arms[1].path().waypoints[k].orientation = Quaterniond::Identity();
  }
  cell.arms[1].path().path_frame = "left";
}

/// Returns a random workcell to be timed.
Problem workcell_to_time(const TestRobot& robot, Kind kind, Random& random) {
  Problem cell = random_workcell(robot, random);
  if (kind != Kind::kTwoLines) add_waypoints(cell, random);
  if (kind == Kind::kFollower) follow(cell, random);
  if (kind == Kind::kBar) carry_bar(cell, random);
  for (ArmTask& arm : cell.arms) {
    arm.path().resolution.ds = kind == Kind::kBar ? 0.01 : 0.02;
    arm.path().resolution.dphi = 0.1;
    arm.path().limits.tool_path_error = kind == Kind::kBar ? 0.001 : 0.005;
    std::array<double, kDof> acceleration, jerk;
    acceleration.fill(random.uniform(3, 15));
    jerk.fill(random.uniform(50, 300));
    arm.path().limits.joint_acceleration = acceleration;
    arm.path().limits.joint_jerk = jerk;
    if (random.coin(0.3)) arm.path().limits.tool_speed = random.uniform(0.05, 0.5);
    // No corner is rounded, so both arms stop at each.
    if (random.coin(0.15) && !(arm.path().path_frame == "left"))
      arm.path().smooth = PathSmoothing{0, 0};
  }
  return with_motion_defaults(std::move(cell));
}

/// Returns how far a place is from the polyline through waypoints, m.
double off_polyline(const Vector3d& place, const std::vector<Waypoint>& waypoints) {
  double least = 1e9;
  for (std::size_t k = 0; k + 1 < waypoints.size(); ++k) {
    const Vector3d from = waypoints[k].position, way = waypoints[k + 1].position - from;
    const double length = way.squaredNorm();
    const double t = length > 0 ? std::clamp((place - from).dot(way) / length, 0.0, 1.0) : 0;
    least = std::min(least, (place - from - t * way).norm());
  }
  return least;
}

/// The worst that was measured of motions.
struct Worst {
  double rates[3] = {0, 0, 0};          // of what joints can do
  double off_path = 0, off_leader = 0;  // m
  double speed = 0;                     // of what was asked for
  double too_near = -1;                 // m: required less seen, between the arms
  double at_waypoints = 0;              // m
  int differences = 0, clearances = 0;
};

/// Measures the motion of a workcell: what its rows are, nothing of how they were found.
class Measurement {
 public:
  Measurement(const Problem& cell, const PreparedWorkcell& prepared, const Motion& motion,
              double speed, Worst& worst)
      : cell_(cell), prepared_(prepared), motion_(motion), speed_(speed), worst_(worst) {}

  void run() {
    const ArmMotion &left = motion_.arms[0], &right = motion_.arms[1];
    ASSERT_EQ(left.rows.size(), right.rows.size());
    for (std::size_t row = 0; row < left.rows.size(); ++row) {
      ASSERT_EQ(left.rows[row].t, right.rows[row].t);
      ASSERT_EQ(left.rows[row].t, static_cast<double>(row) * (1 / motion_.rate));
    }
    for (std::size_t k = 0; k < 2; ++k) {
      const PathProblem& problem = prepared_.problem(k);
      const JointRates rates =
          joint_rates(prepared_.robot(k).arm().chain, problem.limits, problem.source);
      worst_.differences +=
          keep_worst_rates(motion_.arms[k].rows, 1 / motion_.rate, rates, worst_.rates);
      measure_tool(k);
    }
    measure_clearance();
  }

 private:
  [[nodiscard]] const Config& q(std::size_t arm, std::size_t row) const {
    return motion_.arms[arm].rows[row].row.q;
  }
  /// Returns the tool of an arm in the frame that its path is in.
  [[nodiscard]] Pose tool(std::size_t arm, std::size_t row) const {
    const Pose own = prepared_.robot(arm).arm().chain.tool(q(arm, row));
    return cell_.leader_of(arm) < 0
               ? own
               : prepared_.robot(1 - arm).arm().chain.tool(q(1 - arm, row)).inverse() * own;
  }
  void measure_tool(std::size_t k) {
    const std::size_t rows = motion_.arms[k].rows.size();
    const Limits& limits = prepared_.problem(k).limits;
    const Chain& chain = prepared_.robot(k).arm().chain;
    double& off = cell_.leader_of(k) < 0 ? worst_.off_path : worst_.off_leader;
    for (std::size_t row = 0; row < rows; ++row) {
      const Pose now = tool(k, row);
      off = std::max(off, off_polyline(now.translation(), cell_.arms[k].path().waypoints));
      if (row == 0) continue;
      const Pose before = tool(k, row - 1);
      const double speed = (now.translation() - before.translation()).norm() * motion_.rate;
      worst_.speed = std::max(worst_.speed, speed / speed_);
      if (!limits.tool_speed) continue;
      const Vector3d moved =
          chain.tool(q(k, row)).translation() - chain.tool(q(k, row - 1)).translation();
      worst_.speed = std::max(worst_.speed, moved.norm() * motion_.rate / *limits.tool_speed);
    }
    EXPECT_NEAR((tool(k, 0).translation() - cell_.arms[k].path().waypoints.front().position).norm(),
                0, 2e-4);
    EXPECT_NEAR(
        (tool(k, rows - 1).translation() - cell_.arms[k].path().waypoints.back().position).norm(),
        0, 2e-4);
    measure_waypoints(k);
  }
  /// Measures how far the other tool is from its waypoint when that of arm k is nearest to its own.
  void measure_waypoints(std::size_t k) {
    if (cell_.leader_of(0) >= 0 || cell_.leader_of(1) >= 0) return;
    const std::size_t rows = motion_.arms[k].rows.size();
    for (std::size_t w = 1; w + 1 < cell_.arms[k].path().waypoints.size(); ++w) {
      std::size_t nearest = 0;
      double least = 1e9;
      for (std::size_t row = 0; row < rows; ++row) {
        const double off =
            (tool(k, row).translation() - cell_.arms[k].path().waypoints[w].position).norm();
        if (off < least) least = off, nearest = row;
      }
      const double other =
          (tool(1 - k, nearest).translation() - cell_.arms[1 - k].path().waypoints[w].position)
              .norm();
      // Either is within half a sample of its waypoint, and the corner is rounded.
      worst_.at_waypoints = std::max(worst_.at_waypoints, other - speed_ / motion_.rate - 1.5e-4);
    }
  }
  /// Measures clearances between the arms at samples and three times between each two.
  void measure_clearance() {
    InterArmWorld::Query query(prepared_.between(), DistanceProofs::kOff);
    const std::size_t rows = motion_.arms[0].rows.size();
    const std::size_t every = std::max<std::size_t>(1, rows / 150);
    for (std::size_t row = 0; row + 1 < rows; row += every)
      for (const double t : {0.0, 0.25, 0.5, 0.75}) {
        std::array<Config, 2> both;
        for (std::size_t k = 0; k < 2; ++k) both[k] = q(k, row) + t * (q(k, row + 1) - q(k, row));
        const auto found = query.clearance(both);
        if (!found) continue;
        ++worst_.clearances;
        worst_.too_near = std::max(worst_.too_near, -found->margin());
      }
  }

  const Problem& cell_;
  const PreparedWorkcell& prepared_;
  const Motion& motion_;
  double speed_;
  Worst& worst_;
};

PlanOptions lazily() {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  options.check = true;
  return options;
}

std::array<std::vector<TimedRow>, 2> rows_of(const Motion& motion) {
  return {motion.arms[0].rows, motion.arms[1].rows};
}

/// A workcell that was planned and timed.
struct Timed {
  Problem cell;
  std::optional<PreparedWorkcell> prepared;
  bool solved = false;
  double speed = 0;
  MotionTiming timing;
};

/// Plans and times a random workcell.
Timed timed_workcell(const TestRobot& robot, Kind kind, Random& random) {
  Timed timed{workcell_to_time(robot, kind, random)};
  timed.speed = std::exp(random.uniform(std::log(0.03), std::log(0.5)));
  const double rate = std::array{125.0, 250.0, 500.0}[static_cast<std::size_t>(random.below(3))];
  try {
    timed.prepared.emplace(timed.cell);
  } catch (const InputError&) {
    return timed;  // a follower whose tool stands still
  }
  const Answer found = plan_workcell(*timed.prepared, lazily());
  timed.solved = found.status == PlanStatus::kSolved;
  if (timed.solved)
    timed.timing =
        time_workcell(*timed.prepared, rows_of_arms(found), {.speed = timed.speed, .rate = rate});
  return timed;
}

TEST(Motion, KeepsEveryLimitOfBothArms) {
  Random random(seed("Motion.KeepsEveryLimitOfBothArms"));
  const std::array<TestRobot, 2> robots{data_robot("sda10f"), data_robot("sda5f")};
  const int count = trials(240);
  std::array<int, 4> solved{}, moves{};
  int blended = 0, stops = 0;
  Worst worst;
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const auto kind = static_cast<Kind>(trial % 4);
    const TestRobot& robot = robots[kind == Kind::kBar || random.coin() ? 0 : 1];
    const Timed timed = timed_workcell(robot, kind, random);
    if (!timed.solved) continue;
    ++solved[static_cast<std::size_t>(trial % 4)];
    if (!timed.timing.motion) {
      std::printf("trial %d: s = %.4f m: %s\n", trial, timed.timing.failure->s,
                  timed.timing.failure->reason.c_str());
      continue;
    }
    ++moves[static_cast<std::size_t>(trial % 4)];
    const Motion& motion = *timed.timing.motion;
    blended += motion.blended;
    stops += static_cast<int>(motion.arms[0].stops.size());
    EXPECT_GE(motion.duration, motion.ideal * (1 - 1e-6));
    Measurement(timed.cell, *timed.prepared, motion, timed.speed, worst).run();
    const AnswerCheck check =
        check_workcell_motion(*timed.prepared, rows_of(motion), {.margins = false});
    EXPECT_TRUE(check.passed) << (check.failures.empty() ? "" : check.failures.front());
    for (const CheckResult& arm : check.runs)
      EXPECT_TRUE(arm.passed) << (arm.failures.empty() ? "" : arm.failures.front());
  }
  int all = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    std::printf("%s %d of %d, ", std::array{"lines", "polylines", "followers", "bars"}[k], moves[k],
                solved[k]);
    EXPECT_GE(moves[k], 0.9 * solved[k]);
    all += moves[k];
  }
  std::printf(
      "%d waypoints blended, %d stops; %d differences: rates %.4f %.4f %.4f of the limits; tools "
      "within %.3g mm of their paths, %.3g mm on a leader's tool, %.3g mm of waypoints, speed "
      "%.7f of what is asked for; %d clearances: %.3g mm too near\n",
      blended, stops, worst.differences, worst.rates[0], worst.rates[1], worst.rates[2],
      1e3 * worst.off_path, 1e3 * worst.off_leader, 1e3 * worst.at_waypoints, worst.speed,
      worst.clearances, 1e3 * worst.too_near);
  for (const double ratio : worst.rates) EXPECT_LE(ratio, 1 + 1e-9);
  EXPECT_LE(worst.off_path, 0.1e-3 + 1e-9);
  EXPECT_LE(worst.off_leader, 1e-3);
  EXPECT_LE(worst.speed, 1 + 1e-6);
  EXPECT_LE(worst.too_near, 0.05e-3 + 1e-9);
  EXPECT_LE(worst.at_waypoints, 0.05e-3);
  EXPECT_GE(all, at_least(80));
  EXPECT_GE(blended, at_least(60));
  EXPECT_GE(stops, at_least(10));
  EXPECT_GE(worst.differences, at_least(100000));
}

/// Spoils the motion of a workcell in one of several ways. Returns how.
const char* spoil(std::array<std::vector<TimedRow>, 2>& rows, Random& random) {
  const std::size_t n = rows[0].size(), arm = random.coin() ? 0 : 1;
  switch (random.below(5)) {
    case 0:
      rows[arm][n / 2].row.q[random.below(kDof)] += 1e-3;
      return "a joint out of place";
    case 1:
      for (auto& one : rows)
        for (TimedRow& row : one) row.t *= 0.5, row.v *= 2, row.a *= 4;
      return "twice as fast";
    case 2:
      rows[arm][n / 2].t += 1e-4;
      return "a time that differs";
    case 3:
      rows[arm].pop_back();
      return "a row that is missing";
    default:
      // One arm rests for 0.5 s at the beginning, and the other one at the end.
      const auto late = static_cast<std::size_t>(std::ceil(0.5 / rows[0][1].t));
      const double dt = rows[0][1].t;
      rows[arm].insert(rows[arm].begin(), late, rows[arm].front());
      rows[1 - arm].insert(rows[1 - arm].end(), late, rows[1 - arm].back());
      for (auto& one : rows)
        for (std::size_t k = 0; k < one.size(); ++k) one[k].t = static_cast<double>(k) * dt;
      return "an arm that is late";
  }
}

TEST(Motion, CheckRefusesSpoiltMotions) {
  Random random(seed("Motion.CheckRefusesSpoiltMotions"));
  const TestRobot robot = data_robot("sda10f");
  int spoilt = 0;
  const int count = trials(80);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const Kind kind = trial % 2 == 0 ? Kind::kTwoPolylines : Kind::kBar;
    const Timed timed = timed_workcell(robot, kind, random);
    if (!timed.timing.motion) continue;
    auto rows = rows_of(*timed.timing.motion);
    const char* how = spoil(rows, random);
    EXPECT_FALSE(check_workcell_motion(*timed.prepared, rows, {.margins = false}).passed) << how;
    ++spoilt;
  }
  std::printf("%d motions spoilt\n", spoilt);
  EXPECT_GE(spoilt, at_least(count / 4));
}

/// Returns a workcell whose left tool runs after the right one to the right, side by side with it
/// and as fast, and slows down at the waypoint in the middle.
Problem chase(double self_clearance) {
  Random random(1);
  Problem cell = random_workcell(data_robot("sda10f"), random);
  const Quaterniond forward(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY()));
  const std::array<std::array<double, 3>, 2> y{{{0.185, 0.065, 0.035}, {0.06, -0.06, -0.18}}};
  for (std::size_t k = 0; k < 2; ++k) {
    ArmTask& arm = cell.arms[k];
    arm.path().waypoints.resize(3);
    for (std::size_t w = 0; w < 3; ++w) {
      arm.path().waypoints[w].position = Vector3d(0.65, y[k][w], 1.05);
      arm.path().waypoints[w].orientation = forward;
    }
    arm.path().resolution = {.ds = 0.01, .dphi = 0.1};
    arm.path().limits.clearance = 0.001;
    arm.path().limits.self_clearance = self_clearance;
    arm.path().limits.edge_clearance = self_clearance;
  }
  return with_motion_defaults(std::move(cell));
}

TEST(Motion, StopsWhereABlendWouldBringTheArmsTogether) {
  const PreparedWorkcell loose(chase(0.001));
  PlanOptions options = lazily();
  options.evidence = Evidence::all();
  const Answer found = plan_workcell(loose, options);
  ASSERT_EQ(found.status, PlanStatus::kSolved);
  const std::array<std::vector<TrajectoryRow>, 2> rows = rows_of_arms(found);
  const MotionTiming passing = time_workcell(loose, rows, {.speed = 0.1});
  ASSERT_TRUE(passing.motion);
  EXPECT_EQ(passing.motion->blended, 1);
  EXPECT_TRUE(passing.motion->arms[0].stops.empty());
  ASSERT_TRUE(found.pair.nearest);
  const double nearest = found.pair.nearest->clearance;
  std::printf("nearest to each other %.2f mm at rows: %s and %s\n", 1e3 * nearest,
              found.pair.nearest->bodies[0].c_str(), found.pair.nearest->bodies[1].c_str());
  // At rows the arms keep what they must, but not while one tool comes early.
  const PreparedWorkcell tight(chase(nearest - 0.5e-3));
  const MotionTiming stopping = time_workcell(tight, rows, {.speed = 0.1});
  ASSERT_TRUE(stopping.motion) << stopping.failure->reason;
  EXPECT_EQ(stopping.motion->blended, 0);
  ASSERT_EQ(stopping.motion->arms[0].stops.size(), 1u);
  EXPECT_EQ(stopping.motion->arms[1].stops.front().waypoint, 1);
  EXPECT_GT(stopping.motion->duration, passing.motion->duration);
  EXPECT_FALSE(check_workcell_motion(tight, rows_of(*passing.motion)).passed);
  EXPECT_TRUE(check_workcell_motion(tight, rows_of(*stopping.motion)).passed);
  // Where they do not even at rows, there is no motion.
  const PreparedWorkcell narrow(chase(nearest + 1e-3));
  const MotionTiming none = time_workcell(narrow, rows, {.speed = 0.1});
  ASSERT_TRUE(none.failure);
  EXPECT_NE(none.failure->reason.find("come too near"), std::string::npos);
}

TEST(RefineWorkcell, IsCheaperAndValid) {
  Random random(seed("RefineWorkcell.IsCheaperAndValid"));
  const std::array<TestRobot, 2> robots{data_robot("sda10f"), data_robot("sda5f")};
  const int count = trials(160);
  int solved = 0, cheaper = 0, in_conflict = 0, timed = 0, faster = 0;
  double saved = 0;
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const auto kind = static_cast<Kind>(trial % 4);
    const TestRobot& robot = robots[kind == Kind::kBar || random.coin() ? 0 : 1];
    const Problem cell = workcell_to_time(robot, kind, random);
    std::optional<PreparedWorkcell> prepared;
    try {
      prepared.emplace(cell);
    } catch (const InputError&) {
      continue;  // a follower whose tool stands still
    }
    const Answer found = plan_workcell(*prepared, lazily());
    if (found.status != PlanStatus::kSolved) continue;
    ++solved;
    in_conflict += found.pair.decided_by != PairSearch::kArmsAlone;
    const std::array<std::vector<TrajectoryRow>, 2> rows = rows_of_arms(found);
    const RefinedRuns refined = refine_workcell(*prepared, rows);
    EXPECT_NEAR(refined.cost_before, found.cost, 1e-9 * found.cost);
    EXPECT_LE(refined.cost, refined.cost_before);
    EXPECT_LE(refined.turns, 4);
    const AnswerCheck check =
        check_workcell(*prepared, {refined.runs[0].rows, refined.runs[1].rows}, {.margins = false});
    EXPECT_TRUE(check.passed) << (check.failures.empty() ? "" : check.failures.front());
    double cost = 0;
    for (const CheckResult& arm : check.runs) {
      EXPECT_TRUE(arm.passed) << (arm.failures.empty() ? "" : arm.failures.front());
      cost += arm.cost;
    }
    EXPECT_NEAR(cost, refined.cost, 1e-6 * refined.cost);
    cheaper += refined.cost < refined.cost_before * (1 - 1e-3);
    saved += 1 - refined.cost / refined.cost_before;
    const TimingOptions options{.speed = 0.25};
    const MotionTiming before = time_workcell(*prepared, rows, options),
                       after = time_workcell(*prepared,
                                             {refined.runs[0].rows, refined.runs[1].rows}, options);
    if (!before.motion || !after.motion) continue;
    ++timed;
    faster += after.motion->duration < before.motion->duration;
    EXPECT_TRUE(
        check_workcell_motion(*prepared, rows_of(*after.motion), {.margins = false}).passed);
  }
  std::printf(
      "%d workcells, %d in conflict: %d cheaper by more than a thousandth, %.2f %% on average; %d "
      "timed before and after, %d of them faster then\n",
      solved, in_conflict, cheaper, 100 * saved / std::max(1, solved), timed, faster);
  EXPECT_GE(solved, at_least(count / 4));
  EXPECT_GE(cheaper, at_least(count / 8));
  EXPECT_GE(timed, at_least(count / 5));
}

TEST(RefineWorkcell, IsPlannedTimedAndProvedInOneCall) {
  Random random(seed("RefineWorkcell.IsPlannedTimedAndProvedInOneCall"));
  const TestRobot robot = data_robot("sda10f");
  const int count = trials(48);
  int solved = 0, timed = 0, cheaper = 0;
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const Problem cell = workcell_to_time(robot, static_cast<Kind>(trial % 4), random);
    std::optional<PreparedWorkcell> prepared;
    try {
      prepared.emplace(cell);
    } catch (const InputError&) {
      continue;  // a follower whose tool stands still
    }
    PlanOptions options = lazily();
    options.check = true;
    options.evidence = Evidence::all();
    const Answer plain = plan_workcell(*prepared, options);
    ProblemView view;
    const TimingOptions timing{.speed = 0.25};
    const Answer plan = plan_workcell_motion(*prepared, options, true, timing, &view);
    ASSERT_EQ(plan.status, plain.status);
    EXPECT_EQ(plan.refinement.has_value(), plain.status == PlanStatus::kSolved);
    if (plain.status != PlanStatus::kSolved) continue;
    ++solved;
    EXPECT_FALSE(plan.stopped);
    EXPECT_LE(plan.cost, plain.cost * (1 + 1e-12));
    EXPECT_EQ(plan.refinement->cost_before, plain.cost);
    cheaper += plan.cost < plain.cost;
    for (std::size_t k = 0; k < 2; ++k) {
      const ArmAnswer& arm = plan.arms[k];
      EXPECT_EQ(arm.run().lattice.cost, plain.arms[k].cost());
      EXPECT_EQ(arm.run().evidence.postures, plain.arms[k].run().evidence.postures);
      const std::vector<TrajectoryRow>& rows = plan.refinement->runs[k].rows;
      ASSERT_EQ(arm.rows().size(), rows.size());
      for (std::size_t row = 0; row < rows.size(); ++row) EXPECT_EQ(arm.rows()[row].q, rows[row].q);
    }
    const AnswerCheck check = check_workcell(*prepared, rows_of_arms(plan));
    EXPECT_TRUE(check.passed);
    ASSERT_EQ(plan.pair.nearest.has_value(), check.between.has_value());
    if (check.between) {
      EXPECT_NEAR(plan.pair.nearest->margin, check.between->margin, 1e-9);
    }
    ASSERT_TRUE(plan.motion);
    if (!plan.timed()) continue;
    ++timed;
    EXPECT_TRUE(
        check_workcell_motion(*prepared, rows_of(*plan.timed()), {.margins = false}).passed);
  }
  std::printf("%d solved, %d cheaper, %d timed\n", solved, cheaper, timed);
  EXPECT_GE(solved, at_least(count / 4));
  EXPECT_GE(cheaper, at_least(count / 6));
  EXPECT_GE(timed, at_least(count / 6));
}

/// Rows of plans whose corners are sharp are laid on the rounded ones, refined and timed.
TEST(RefineWorkcell, RefinesAndTimesRowsOfOtherPlans) {
  Random random(seed("RefineWorkcell.RefinesAndTimesRowsOfOtherPlans"));
  const TestRobot robot = data_robot("sda10f");
  const int count = trials(48);
  int solved = 0, timed = 0, cheaper = 0, too_near = 0;
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    Problem sharp = workcell_to_time(robot, static_cast<Kind>(trial % 4), random);
    for (ArmTask& arm : sharp.arms) arm.path().smooth.reset();
    std::optional<PreparedWorkcell> planned, prepared;
    try {
      planned.emplace(sharp);
      prepared.emplace(with_motion_defaults(sharp));
    } catch (const InputError&) {
      continue;  // a follower whose tool stands still
    }
    const Answer plain = plan_workcell(*planned, lazily());
    if (plain.status != PlanStatus::kSolved) continue;
    ++solved;
    const std::array<std::vector<TrajectoryRow>, 2> rows = rows_of_arms(plain);
    std::optional<RefinedWorkcellMotion> found;
    try {
      found = refine_and_time_workcell(*prepared, rows, {.speed = 0.25});
    } catch (const InputError&) {
      continue;  // a follower has other layers where its leader rounds corners
    }
    const RefinedRuns& refined = found->refinement;
    EXPECT_LE(refined.cost, refined.cost_before);
    EXPECT_NEAR(refined.cost_before, plain.cost, 0.05 * plain.cost);
    cheaper += refined.cost < refined.cost_before;
    too_near += found->timing.failure && found->timing.failure->too_near;
    if (!found->timing.motion) continue;
    ++timed;
    const AnswerCheck check =
        check_workcell_motion(*prepared, rows_of(*found->timing.motion), {.margins = false});
    EXPECT_TRUE(check.passed) << (check.failures.empty() ? "" : check.failures.front());
  }
  std::printf("%d plans, %d refined, %d timed, %d too near between samples\n", solved, cheaper,
              timed, too_near);
  EXPECT_GE(solved, at_least(count / 3));
  EXPECT_GE(cheaper, at_least(count / 4));
  EXPECT_GE(timed, at_least(count / 4));
}

TEST(RefineWorkcell, LeavesUnrefinedPlansAsTheyAre) {
  Random random(seed("RefineWorkcell.LeavesUnrefinedPlansAsTheyAre"));
  const TestRobot robot = data_robot("sda10f");
  for (int trial = 0; trial < trials(12); ++trial) {
    const Problem cell = random_workcell(robot, random);
    const PreparedWorkcell prepared(cell);
    const Answer plain = plan_workcell(prepared, lazily());
    const Answer plan = plan_workcell_motion(prepared, lazily(), false, std::nullopt);
    EXPECT_FALSE(plan.refinement || plan.motion || plan.stopped);
    EXPECT_EQ(plan.cost, plain.cost);
    for (std::size_t k = 0; k < 2; ++k) {
      ASSERT_EQ(plan.arms[k].rows().size(), plain.arms[k].rows().size());
      for (std::size_t row = 0; row < plain.arms[k].rows().size(); ++row)
        EXPECT_EQ(plan.arms[k].rows()[row].q, plain.arms[k].rows()[row].q);
    }
  }
}

TEST(Motion, RefusesWhatIsNoTiming) {
  Random random(seed("Motion.RefusesWhatIsNoTiming"));
  const Problem cell = random_workcell(data_robot("sda10f"), random);
  const std::array<std::vector<TrajectoryRow>, 2> none;
  const PreparedWorkcell completed(with_motion_defaults(cell));
  EXPECT_FALSE(check_workcell_motion(completed, {}).passed);
  EXPECT_THROW(static_cast<void>(time_workcell(PreparedWorkcell(cell), none, {.speed = 0.1})),
               InvalidArgument);
  EXPECT_THROW(static_cast<void>(time_workcell(completed, none, {.speed = 0})), InvalidArgument);
  EXPECT_THROW(static_cast<void>(time_workcell(completed, none, {.speed = 0.1, .rate = -1})),
               InvalidArgument);
  EXPECT_THROW(static_cast<void>(time_workcell(
                   completed, none, {.speed = 0.1, .speeds = {{.s = 0.1, .speed = 0.2}}})),
               InvalidArgument);
  EXPECT_THROW(static_cast<void>(time_workcell(completed, none, {.speed = 0.1})), InputError);
}

}  // namespace

}  // namespace swivel::test
