// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/study/advise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "random_problem.hpp"

namespace swivel {
namespace {

using namespace test;
using Change = Advice::Change;
using Outcome = Advice::Outcome;

/// Halves the steps of the lattice and adds arcs to it.
void make_finer(Resolution& resolution) {
  for (double* step : {&resolution.ds, &resolution.dphi, &resolution.dalpha}) *step *= 0.5;
  resolution.arc = resolution.arc_of_nodes() / 2;
  resolution.arcs = true;
}

/// Sets limits.clearance, in metres, and scales self_clearance and edge_clearance alike.
void set_clearance(Limits& limits, double clearance) {
  if (limits.self_clearance)
    limits.self_clearance = *limits.self_clearance * (clearance / limits.clearance);
  if (limits.edge_clearance)
    limits.edge_clearance = *limits.edge_clearance * (clearance / limits.clearance);
  limits.clearance = clearance;
}

void move_objects(PathProblem& problem, const Advice& advice) {
  for (SceneObject& object : problem.scene) {
    if (object.name == advice.object) object.pose.translation() += advice.offset;
    if (object.name == advice.also) object.pose.translation() += advice.also_offset;
  }
}

void remove_objects(PathProblem& problem, const Advice& advice) {
  std::erase_if(problem.scene, [&](const SceneObject& object) {
    return object.name == advice.object || object.name == advice.also;
  });
}

/// The problem as a reader of the advice would change it by hand.
PathProblem followed(PathProblem problem, const Advice& advice) {
  const double share = advice.to.value_or(0);
  Limits& limits = problem.limits;
  switch (advice.change) {
    case Change::kFreeStart:
      problem.start = std::nullopt;
      break;
    case Change::kFreeRoll:
      problem.roll = Roll{};
      break;
    case Change::kFiner:
      make_finer(problem.resolution);
      break;
    case Change::kClearance:
      set_clearance(limits, share);
      break;
    case Change::kJointMargin:
      limits.joint_margin = share;
      break;
    case Change::kManipulability:
      limits.manipulability = share;
      break;
    case Change::kArmSlope:
      limits.arm_slope = share;
      break;
    case Change::kRollSlope:
      limits.roll_slope = share;
      break;
    case Change::kJointStep:
      limits.joint_step = share;
      break;
    case Change::kToolSpeed:
      limits.tool_speed = share;
      break;
    case Change::kToolTurnSpeed:
      limits.tool_turn_speed = share;
      break;
    case Change::kPathError:
      limits.tool_path_error = share;
      break;
    case Change::kAngleError:
      limits.tool_angle_error = share;
      break;
    case Change::kStepError:
      limits.step_error = share;
      break;
    case Change::kHold:
      problem.hold[advice.object] = share;
      break;
    case Change::kMoveObject:
      move_objects(problem, advice);
      break;
    case Change::kWithoutObject:
      remove_objects(problem, advice);
      break;
    case Change::kTurnedOver:
      problem.tool.linear() *= Eigen::AngleAxisd(kPi, Vector3d::UnitX()).toRotationMatrix();
  }
  return problem;
}

/// Counts the infeasible problems and the changes that are advised for them.
struct AdviceCounts {
  int infeasible = 0, helped = 0, unknown = 0;
  std::map<std::pair<Change, Outcome>, int> seen;
};

/// Draws a problem, at times with a bound on the joints' steps (rad) or with a clearance (m).
PathProblem random_advised(const TestRobot& robot, Random& random) {
  PathProblem problem = random_problem(robot, random);
  if (random.coin()) problem.limits.joint_step = random.uniform(0.1, 0.3);
  if (random.coin(0.3)) problem.limits.clearance = random.uniform(0.02, 0.08);
  return problem;
}

/// Where a limit is relaxed, it is relaxed no further than a sixteenth of the way beyond what is
/// needed.
void expect_stricter_unsolved(const PathProblem& problem, const Advice& one,
                              const PlanOptions& options, const std::string& what) {
  if (one.outcome != Outcome::kSolved || !one.to || !one.from || one.change == Change::kHold)
    return;
  const bool down = *one.to < *one.from;
  const double furthest = !down ? 8 * *one.from
                          : one.change == Change::kToolSpeed || one.change == Change::kToolTurnSpeed
                              ? *one.from / 8
                              : 0;
  Advice stricter = one;
  stricter.to = *one.to + (*one.from - furthest) / 16;
  if (down ? *stricter.to < *one.from : *stricter.to > *one.from) {
    const PlanResult strict = plan(followed(problem, stricter), options);
    EXPECT_NE(strict.status, PlanStatus::kSolved) << what << ": " << words(stricter);
  }
}

/// Plans the problem that follows one advice and compares the result with the advice's outcome.
void expect_outcome(const PathProblem& problem, const Advice& one, const PlanOptions& options,
                    const std::string& what, AdviceCounts& counts) {
  ++counts.seen[{one.change, one.outcome}];
  EXPECT_FALSE(words(one).empty()) << what;
  if (one.outcome == Outcome::kUnknown) {
    ++counts.unknown;
    return;
  }
  if (one.change == Change::kMoveObject && one.offset.isZero()) return;  // none of the ways helps
  if (one.change == Change::kHold && !one.to) return;                    // likewise
  Advice given = one;
  if (!given.to) given.to = 0;
  const PlanResult there = plan(followed(problem, given), options);
  ASSERT_EQ(there.status == PlanStatus::kSolved, one.outcome == Outcome::kSolved)
      << what << ": " << words(one);
  if (one.outcome == Outcome::kSolved) {
    ASSERT_EQ(there.cost, *one.cost) << what << ": " << words(one);
  }
  if (one.outcome != Outcome::kSolved) {
    ASSERT_EQ(there.diagnosis->reached_s, one.reached_s) << what << ": " << words(one);
  }
  expect_stricter_unsolved(problem, one, options, what);
}

/// Asks for advice about one problem and checks the order and the outcome of every change.
void check_advice(const PathProblem& problem, const std::string& what, AdviceCounts& counts) {
  PlanOptions options;
  options.planner = PlannerKind::kLazy;
  Planner planner(problem);
  const PlanResult result = planner.plan(options);
  options.timeout_s = 5;
  const std::vector<Advice> advice = advise(planner, result, options);
  if (result.status == PlanStatus::kSolved) {
    EXPECT_TRUE(advice.empty()) << what;
    return;
  }
  ++counts.infeasible;
  ASSERT_FALSE(advice.empty()) << what;
  counts.helped += advice[0].outcome == Outcome::kSolved;
  for (std::size_t k = 0; k < advice.size(); ++k) {
    if (k > 0) {
      EXPECT_LE(advice[k - 1].outcome, advice[k].outcome) << what;
    }
    expect_outcome(problem, advice[k], options, what, counts);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

/// Whatever is said of a change is what planning the changed problem, on a robot of its own, gives.
TEST(Advise, EveryOutcomeIsWhatFollowingTheAdviceGives) {
  const std::uint64_t base = seed("Advise");
  const auto robots = all_robots();
  AdviceCounts counts;
  for (int trial = 0; trial < trials(60); ++trial) {
    const std::string what =
        "SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial);
    Random random(base + static_cast<std::uint64_t>(trial));
    check_advice(random_advised(robots[static_cast<std::size_t>(trial) % robots.size()], random),
                 what, counts);
    if (HasFatalFailure()) return;
  }
  std::printf("%d infeasible, %d helped by one change, %d changes not decided;", counts.infeasible,
              counts.helped, counts.unknown);
  for (const auto& [key, count] : counts.seen)
    std::printf(" %s %s %d,", to_string(key.first), to_string(key.second), count);
  std::printf("\n");
  EXPECT_GE(counts.infeasible, at_least(15));
  EXPECT_GE(counts.helped, at_least(5));
}

PlanOptions for_seconds(double seconds) {
  PlanOptions options;
  options.timeout_s = seconds;
  return options;
}

/// Paths that an arm reaches with its torso turned, asked for with the torso at 0: where holding it
/// elsewhere helps, no position that was tried nearer to 0 does.
TEST(Advise, ATorsoHeldElsewhereHelps) {
  const std::uint64_t base = seed("Advise.Torso");
  const TestRobot robot = data_robot("sda10f");
  const int count = trials(40);
  int infeasible = 0, helped = 0, nearer = 0;
  for (int trial = 0; trial < count; ++trial) {
    Random random(base + static_cast<std::uint64_t>(trial));
    SCOPED_TRACE("SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial));
    PathProblem problem = problem_for(robot);
    const double turned = random.uniform(-1.5, 1.5);
    const Chain chain = build_arm(*robot.model, robot.base_link, robot.tip_link,
                                  {{"torso_joint_b1", turned}}, Pose::Identity())
                            .chain;
    problem_parts::draw_waypoints(problem, chain, random_config(chain, random), 2, random);
    problem.resolution = {.ds = 0.02, .dphi = 0.3, .dalpha = 0.5};
    problem.limits.clearance = 0;
    problem.limits.tool_path_error.reset();
    Planner planner(problem);
    const PlanResult result = planner.plan();
    if (result.status == PlanStatus::kSolved) continue;
    ++infeasible;
    const std::vector<Advice> advice = advise(planner, result, for_seconds(60));
    const auto held = std::find_if(advice.begin(), advice.end(),
                                   [](const Advice& a) { return a.change == Change::kHold; });
    ASSERT_NE(held, advice.end());
    ASSERT_EQ(held->object, "torso_joint_b1");
    ASSERT_EQ(*held->from, 0);
    if (held->outcome != Outcome::kSolved) continue;
    ++helped;
    const PlanResult there = plan(followed(problem, *held));
    ASSERT_EQ(there.status, PlanStatus::kSolved);
    ASSERT_EQ(there.cost, *held->cost);
    EXPECT_NE(words(*held).find("'torso_joint_b1' held at "), std::string::npos) << words(*held);
    const Joint& joint =
        robot.model->joints[static_cast<std::size_t>(robot.model->find_joint(held->object))];
    const double range = joint.upper - joint.lower;
    for (double share = 1.0 / 16; share * range < std::abs(*held->to) - 1e-3; share *= 2)
      for (const double way : {-share, share}) {
        Advice less = *held;
        less.to = std::round(1e3 * way * range) / 1e3;
        if (*less.to < joint.lower || *less.to > joint.upper) continue;
        ++nearer;
        EXPECT_NE(plan(followed(problem, less)).status, PlanStatus::kSolved) << *less.to;
      }
  }
  std::printf(
      "%d paths, %d out of reach with the torso at 0, of which %d helped by holding it "
      "elsewhere; %d nearer positions do not\n",
      count, infeasible, helped, nearer);
  EXPECT_GE(infeasible, at_least_among(count / 4));
  EXPECT_GE(helped, at_least_among(count / 5));
  EXPECT_GE(nearer, at_least_among(count / 8));
}

/// Joint 5 stands at its limit at the given start: without the start there is a path.
TEST(Advise, ExperimentAFromItsStartNeedsAnother) {
  Planner planner(io::load_path_problem(data_dir() / "problems" / "experiment_a_start.yaml"));
  const PlanResult result = planner.plan();
  if (result.status == PlanStatus::kSolved) GTEST_SKIP() << "the start is a good one";
  const std::vector<Advice> advice = advise(planner, result, for_seconds(20));
  ASSERT_FALSE(advice.empty());
  EXPECT_EQ(advice[0].change, Change::kFreeStart);
  EXPECT_EQ(advice[0].outcome, Outcome::kSolved);
}

/// The torch stands turned so that the arm cannot follow; turned as it likes it can.
TEST(Advise, ATorchMayTurnAboutItsAxis) {
  for (const Roll& roll : {Roll{-0.3, -0.2}, Roll{0.4, 0.5}}) {
    PathProblem problem = io::load_path_problem(data_dir() / "problems" / "kr6_weld_pipe.yaml");
    problem.roll = roll;
    Planner planner(problem);
    const PlanResult result = planner.plan();
    ASSERT_EQ(result.status, PlanStatus::kInfeasible);
    const std::vector<Advice> advice = advise(planner, result, for_seconds(60));
    const auto free = std::find_if(advice.begin(), advice.end(),
                                   [](const Advice& a) { return a.change == Change::kFreeRoll; });
    ASSERT_NE(free, advice.end());
    EXPECT_EQ(free->outcome, Outcome::kSolved);
    const PlanResult follow = plan(followed(problem, *free));
    EXPECT_EQ(follow.status, PlanStatus::kSolved);
    EXPECT_EQ(follow.cost, free->cost);
  }
  Planner planner(io::load_path_problem(data_dir() / "problems" / "kr6_weld_pipe.yaml"));
  EXPECT_EQ(planner.plan().status, PlanStatus::kSolved);  // whose roll is free
}

/// A wall across the path, which nothing but its removal helps against.
TEST(Advise, AWallMustGo) {
  PathProblem problem = io::load_path_problem(data_dir() / "problems" / "experiment_a.yaml");
  SceneObject& wall = problem.scene.emplace_back();
  wall.name = "wall";
  wall.shape = Box{{0.3, 0.02, 0.3}};
  wall.pose.translation() = problem.waypoints.front().position + Vector3d(0, 0.3, 0);
  Planner planner(problem);
  const std::vector<Advice> advice = advise(planner, planner.plan(), for_seconds(20));
  ASSERT_FALSE(advice.empty());
  EXPECT_EQ(advice[0].change, Change::kWithoutObject);
  EXPECT_EQ(advice[0].object, "wall");
  EXPECT_EQ(words(advice[0]), "no 'wall'");
  for (std::size_t k = 1; k < advice.size(); ++k)
    EXPECT_NE(advice[k].outcome, Outcome::kSolved) << words(advice[k]);
  Planner solved(io::load_path_problem(data_dir() / "problems" / "experiment_a.yaml"));
  EXPECT_TRUE(advise(solved, solved.plan(), for_seconds(1)).empty());
}

/// Returns a line of an iiwa 14 that works downwards on a part, with a sander as its tool.
PathProblem sanded_line() {
  PathProblem problem = problem_for(data_robot("iiwa14"));
  problem.tip_link = "tool0";
  problem.tool.translation() = Vector3d(0, 0, 0.15);
  AttachedBody sander;
  sander.name = "sander";
  sander.link = problem.tip_link;
  sander.shape = Cylinder{0.03, 0.1};
  sander.pose.translation() = Vector3d(0, 0, 0.06);
  problem.attached.push_back(sander);
  for (const double y : {-0.15, 0.15}) {
    Waypoint& waypoint = problem.waypoints.emplace_back();
    waypoint.position = Vector3d(0.55, y, 0.41);
    waypoint.orientation = Quaterniond(0, 1, 0, 0);  // down
  }
  problem.resolution = {.ds = 0.02, .dphi = 0.1};
  SceneObject part;
  part.name = "part";
  part.shape = Box{{0.3, 0.4, 0.1}};
  part.pose.translation() = Vector3d(0.55, 0, 0.3);
  problem.scene.push_back(part);
  return problem;
}

SceneObject wall(const std::string& name, double y) {
  SceneObject object;
  object.name = name;
  object.shape = Box{{0.4, 0.04, 0.12}};
  object.pose.translation() = Vector3d(0.55, y, 0.43);
  return object;
}

TEST(Advise, AToolThatPointsIntoItsFlangeIsTurnedOver) {
  PathProblem problem = sanded_line();
  EXPECT_EQ(plan(problem).status, PlanStatus::kSolved);
  problem.tool.linear() = Eigen::AngleAxisd(kPi, Vector3d::UnitX()).toRotationMatrix();
  Planner planner(problem);
  const std::vector<Advice> advice = advise(planner, planner.plan(), for_seconds(60));
  ASSERT_FALSE(advice.empty());
  const auto over = std::find_if(advice.begin(), advice.end(),
                                 [](const Advice& a) { return a.change == Change::kTurnedOver; });
  ASSERT_NE(over, advice.end());
  EXPECT_EQ(over->outcome, Outcome::kSolved) << words(*over);
  EXPECT_EQ(plan(followed(problem, *over)).cost, over->cost);
}

/// A wall over the end of the line must be moved away from it, by 45 mm.
TEST(Advise, AWallIsMovedAsFarAsItMust) {
  PathProblem problem = sanded_line();
  problem.scene.push_back(wall("wall", 0.16));
  Planner planner(problem);
  const std::vector<Advice> advice = advise(planner, planner.plan(), for_seconds(120));
  const auto moved = std::find_if(advice.begin(), advice.end(), [](const Advice& a) {
    return a.change == Change::kMoveObject && a.object == "wall";
  });
  ASSERT_NE(moved, advice.end());
  ASSERT_EQ(moved->outcome, Outcome::kSolved) << words(*moved);
  EXPECT_NEAR(moved->offset.norm(), 0.05, 1e-9);
  EXPECT_EQ(plan(followed(problem, *moved)).cost, moved->cost);
  Advice less = *moved;
  less.offset *= 0.8;
  EXPECT_NE(plan(followed(problem, less)).status, PlanStatus::kSolved);
}

/// Two walls, one over either end: neither alone helps.
TEST(Advise, TwoWallsAreMovedTogether) {
  PathProblem problem = sanded_line();
  problem.scene.push_back(wall("left", 0.16));
  problem.scene.push_back(wall("right", -0.16));
  Planner planner(problem);
  const std::vector<Advice> advice = advise(planner, planner.plan(), for_seconds(240));
  int both = 0;
  for (const Advice& one : advice) {
    if (one.change != Change::kMoveObject && one.change != Change::kWithoutObject) continue;
    if (one.also.empty()) {
      EXPECT_NE(one.outcome, Outcome::kSolved) << words(one);
      continue;
    }
    ++both;
    ASSERT_EQ(one.outcome, Outcome::kSolved) << words(one);
    EXPECT_EQ(plan(followed(problem, one)).cost, one.cost) << words(one);
    EXPECT_NE(words(one).find(" and "), std::string::npos);
  }
  EXPECT_EQ(both, 2);
}

}  // namespace
}  // namespace swivel
