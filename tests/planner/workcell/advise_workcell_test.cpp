// SPDX-License-Identifier: BSD-3-Clause
// Workcells that have no plan, and advice that holds.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <string>

#include "plain_arm.hpp"
#include "robots.hpp"
#include "seed.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/study/advise.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "two_arms.hpp"

namespace swivel::test {
namespace {

using Change = Advice::Change;
using Outcome = Advice::Outcome;

PlanOptions long_enough(int threads) {
  PlanOptions options;
  options.threads = threads;
  options.timeout_s = 600;
  return options;
}

/// What makes a random workcell hard to plan.
enum class Hard { kClearance, kMargin, kPost, kGivenEnd, kRightFollows, kNear };

void add_post(Problem& cell, Random& random) {
  SceneObject post;
  post.name = "post";
  post.shape = Cylinder{0.03, 0.6};
  post.pose.translation() =
      Vector3d(random.uniform(0.3, 0.6), random.uniform(-0.5, 0.5), random.uniform(0.6, 1.3));
  if (random.coin())
    post.pose.linear() = Eigen::AngleAxisd(kPi / 2, Vector3d::UnitX()).toRotationMatrix();
  cell.scene.push_back(post);
}

/// Gives the left arm a random node of its lattice as its start or its end, if there is one.
void add_start_or_end(Problem& cell, Random& random) {
  const PreparedWorkcell prepared(cell);
  const PlainArm arm(prepared.problem(0), prepared.robot(0));
  const bool first = random.coin();
  const std::vector<Lattice::Node>& nodes = arm.nodes(first ? 0 : arm.layers() - 1);
  if (nodes.empty()) return;
  const Config q = nodes[static_cast<std::size_t>(random.below(static_cast<int>(nodes.size())))].q;
  (first ? cell.arms[0].path().start : cell.arms[0].path().end) = q;
}

/// Lets both hands point forward and carry a bar that turns, which the left one leads.
void carry_turning_bar(Problem& cell, Random& random) {
  const Quaterniond forward(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY()));
  const double width = random.uniform(0.15, 0.45);
  const Vector3d middle(random.uniform(0.6, 0.8), random.uniform(-0.1, 0.1),
                        random.uniform(0.9, 1.2));
  for (std::size_t k = 0; k < cell.arms[0].path().waypoints.size(); ++k) {
    Waypoint& waypoint = cell.arms[0].path().waypoints[k];
    const Vector3d moved(0, width / 2 + random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1));
    waypoint.position = middle + moved;
    waypoint.orientation =
        Quaterniond(Eigen::AngleAxisd(random.uniform(-0.6, 0.6), Vector3d::UnitX())) * forward;
    cell.arms[1].path().waypoints[k].position = Vector3d(0, -width, 0);
    cell.arms[1].path().waypoints[k].orientation = Quaterniond::Identity();
  }
  cell.arms[1].path().path_frame = "left";
}

/// Brings the right tool's path near to the left one's.
void bring_near(Problem& cell, Random& random) {
  const Vector3d apart =
      cell.arms[0].path().waypoints[0].position - cell.arms[1].path().waypoints[0].position;
  const double share = random.uniform(0.4, 1);
  for (Waypoint& waypoint : cell.arms[1].path().waypoints) waypoint.position += share * apart;
}

Problem hard_workcell(const TestRobot& robot, Hard hard, Random& random) {
  Problem cell = random_workcell(robot, random);
  if (hard == Hard::kRightFollows) carry_turning_bar(cell, random);
  if (hard == Hard::kNear) bring_near(cell, random);
  for (ArmTask& arm : cell.arms) {
    if (hard == Hard::kMargin) arm.path().limits.joint_margin = random.uniform(0.05, 0.6);
    if (hard == Hard::kClearance) arm.path().limits.clearance = random.uniform(0.01, 0.05);
  }
  if (hard == Hard::kPost || hard == Hard::kRightFollows || random.coin(0.3))
    add_post(cell, random);
  if (hard == Hard::kGivenEnd) add_start_or_end(cell, random);
  return cell;
}

Pose pose_of(const Waypoint& waypoint) {
  Pose pose = Pose::Identity();
  pose.translation() = waypoint.position;
  pose.linear() = waypoint.orientation.normalized().toRotationMatrix();
  return pose;
}

void set_pose(Waypoint& waypoint, const Pose& pose) {
  waypoint.position = pose.translation();
  waypoint.orientation = Quaterniond(pose.linear());
}

/// Makes `leads` lead, which follows the other arm so far.
void swap_leader(ArmTask& leads, ArmTask& follows) {
  for (std::size_t k = 0; k < leads.path().waypoints.size(); ++k) {
    const Pose tool = pose_of(follows.path().waypoints[k]),
               on_tool = pose_of(leads.path().waypoints[k]);
    set_pose(leads.path().waypoints[k], tool * on_tool);
    set_pose(follows.path().waypoints[k], on_tool.inverse());
  }
  leads.path().path_frame = "";
  follows.path().path_frame = leads.name;
}

/// Returns the workcell as somebody changes it who reads the advice. `stricter`: how far back a
/// limit is, of the way from `to` to `from`.
Problem as_advised(Problem cell, const Advice& advice, double stricter = 0) {
  const double to = advice.to ? *advice.to + stricter * (advice.from.value_or(0) - *advice.to) : 0;
  for (std::size_t k = 0; k < 2; ++k) {
    ArmTask& arm = cell.arms[k];
    if (!advice.arm.empty() && advice.arm != arm.name) continue;
    Limits& limits = arm.path().limits;
    switch (advice.change) {
      case Change::kFreeStart:
        arm.path().start.reset();
        break;
      case Change::kFreeEnd:
        arm.path().end.reset();
        break;
      case Change::kFiner:
        for (double* step : {&arm.path().resolution.ds, &arm.path().resolution.dphi,
                             &arm.path().resolution.dalpha})
          *step /= 2;
        arm.path().resolution.arc = kArcOfLayers / 2;
        arm.path().resolution.arcs = true;
        break;
      case Change::kClearance:
        limits.clearance = advice.arm.empty() ? std::min(limits.clearance, to) : to;
        break;
      case Change::kJointMargin:
        limits.joint_margin = advice.arm.empty() ? std::min(limits.joint_margin, to) : to;
        break;
      case Change::kArmSlope:
        limits.arm_slope = to;
        break;
      case Change::kJointStep:
        limits.joint_step = to;
        break;
      case Change::kPathError:
        limits.tool_path_error = to;
        break;
      case Change::kTurnedOver:
        arm.tool.linear() *= Eigen::AngleAxisd(kPi, Vector3d::UnitX()).toRotationMatrix();
        break;
      case Change::kLeads:
        swap_leader(arm, cell.arms[1 - k]);
        return cell;
      case Change::kMovePaths:
        if (cell.leader_of(k) < 0)
          for (Waypoint& waypoint : arm.path().waypoints) waypoint.position += advice.offset;
        break;
      default:
        break;
    }
  }
  for (SceneObject& object : cell.scene) {
    if (advice.change != Change::kMoveObject) break;
    if (object.name == advice.object) object.pose.translation() += advice.offset;
    if (object.name == advice.also) object.pose.translation() += advice.also_offset;
  }
  if (advice.change == Change::kWithoutObject)
    std::erase_if(cell.scene, [&](const auto& object) {
      return object.name == advice.object || object.name == advice.also;
    });
  return cell;
}

/// Returns what both paths cost; nothing where there is no plan, or no such workcell.
std::optional<double> cost_of(const Problem& cell) {
  try {
    PlanOptions options;
    options.planner = PlannerKind::kLazy;
    options.check = true;
    const Answer found = plan_workcell(cell, options);
    if (found.status == PlanStatus::kSolved) return found.cost;
    EXPECT_EQ(found.status, PlanStatus::kInfeasible);
  } catch (const InputError&) {
  }
  return std::nullopt;
}

bool is_limit(Change change) {
  return change >= Change::kClearance && change <= Change::kStepError;
}

/// Expects what the advice says of its change. Returns true if it helps.
bool holds(const Problem& cell, const Advice& advice) {
  SCOPED_TRACE(words(advice));
  EXPECT_NE(advice.outcome, Outcome::kUnknown);
  EXPECT_NE(advice.outcome, Outcome::kFurther);
  EXPECT_FALSE(advice.reached_s);
  const std::optional<double> cost = cost_of(as_advised(cell, advice));
  if (advice.outcome != Outcome::kSolved) {
    EXPECT_FALSE(cost);
    EXPECT_FALSE(advice.cost);
    return false;
  }
  EXPECT_TRUE(cost);
  // an arm that comes to lead has its waypoints by other roundings here
  const double rounding = advice.change == Change::kLeads ? 1e-6 : 0;
  if (cost) {
    EXPECT_NEAR(*cost, *advice.cost, rounding);
  }
  return true;
}

void expect_equal(const AdviceList& one, const AdviceList& other) {
  ASSERT_EQ(one.changes.size(), other.changes.size());
  ASSERT_EQ(one.alone.size(), other.alone.size());
  EXPECT_EQ(advice_text(one), advice_text(other));
  for (std::size_t k = 0; k < one.changes.size(); ++k) {
    EXPECT_EQ(one.changes[k].cost, other.changes[k].cost);
    EXPECT_EQ(one.changes[k].to, other.changes[k].to);
    EXPECT_EQ(one.changes[k].offset, other.changes[k].offset);
  }
}

TEST(AdviseWorkcell, IsWhatPlanningTheChangedWorkcellGives) {
  Random random(seed("AdviseWorkcell.IsWhatPlanningTheChangedWorkcellGives"));
  const std::array<TestRobot, 2> robots{data_robot("sda10f"), data_robot("sda5f")};
  std::map<std::string, int> helped;
  int infeasible = 0, with_help = 0, advised = 0, conflicts = 0, one_arm = 0, strictest = 0;
  const int count = trials(120);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    const Problem cell =
        hard_workcell(robots[random.coin() ? 0 : 1], static_cast<Hard>(trial % 6), random);
    Answer result;
    try {
      result = plan_workcell(cell, long_enough(2));
    } catch (const InputError&) {  // a path that makes no sense
      continue;
    }
    const AdviceList advice = advise_workcell(cell, result, long_enough(2));
    if (result.status == PlanStatus::kSolved) {
      EXPECT_TRUE(advice.changes.empty() && advice.alone.empty());
      continue;
    }
    ++infeasible;
    ASSERT_FALSE(advice.changes.empty());
    const auto lacking = static_cast<std::size_t>(
        std::count_if(result.arms.begin(), result.arms.end(),
                      [](const ArmAnswer& arm) { return !std::isfinite(arm.run().least_cost); }));
    EXPECT_EQ(advice.alone.size(), lacking);
    conflicts += lacking == 0;
    one_arm += lacking == 1;
    bool any = false;
    for (std::size_t k = 0; k < advice.changes.size(); ++k) {
      const Advice& one = advice.changes[k];
      if (k > 0) {
        EXPECT_LE(advice.changes[k - 1].outcome, one.outcome);
      }
      ++advised;
      if (!holds(cell, one)) continue;
      any = true;
      ++helped[to_string(one.change)];
      if (lacking == 1 || !is_limit(one.change) || one.from == one.to) continue;
      // a sixteenth of the way back is too strict
      const double share = *one.from / (*one.from - *one.to) / 16;  // both limits may be zero
      if (share >= 1) continue;
      EXPECT_FALSE(cost_of(as_advised(cell, one, share))) << words(one);
      ++strictest;
    }
    with_help += any;
    if (infeasible % 4 == 1) expect_equal(advice, advise_workcell(cell, result, long_enough(1)));
  }
  std::printf(
      "%d workcells: %d infeasible (%d by conflict, %d of one arm), %d of them helped; %d "
      "changes,",
      count, infeasible, conflicts, one_arm, with_help, advised);
  for (const auto& [change, times] : helped) std::printf(" %s %d", change.c_str(), times);
  std::printf("; %d limits strictest\n", strictest);
  EXPECT_GE(infeasible, at_least(count / 4));
  EXPECT_GE(with_help, at_least(count / 8));
  EXPECT_GE(conflicts, at_least(count / 30));
  EXPECT_GE(one_arm, at_least(count / 20));
}

/// The right tool is led in an arc about the left one, through a ball. Where the right arm leads,
/// it goes straight between the same two poses, and passes beside the ball.
TEST(AdviseWorkcell, LetsTheFollowerLead) {
  Random random(1);
  Problem cell = random_workcell(data_robot("sda10f"), random);
  const Quaterniond forward(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY()));
  const double turn = 0.7, width = 0.45;
  for (std::size_t k = 0; k < 2; ++k) {
    Waypoint& left = cell.arms[0].path().waypoints[k];
    left.position = Vector3d(0.68, 0.2, 1.05);
    left.orientation =
        Quaterniond(Eigen::AngleAxisd(k == 0 ? -turn : turn, Vector3d::UnitX())) * forward;
    cell.arms[1].path().waypoints[k].position = Vector3d(0, -width, 0);
    cell.arms[1].path().waypoints[k].orientation = Quaterniond::Identity();
  }
  cell.arms[1].path().path_frame = "left";
  ASSERT_TRUE(cost_of(cell));
  SceneObject ball;
  ball.name = "ball";
  ball.shape = Sphere{0.03};
  ball.pose.translation() = Vector3d(0.68, 0.2 - width, 1.05);
  cell.scene.push_back(ball);
  const Answer result = plan_workcell(cell, long_enough(2));
  ASSERT_EQ(result.status, PlanStatus::kInfeasible);
  int leads = 0;
  for (const Advice& one : advise_workcell(cell, result, long_enough(2)).changes) {
    const bool helps = holds(cell, one);
    if (one.change != Change::kLeads) continue;
    EXPECT_TRUE(helps);
    EXPECT_EQ(words(one), "'right' leads");
    ++leads;
  }
  EXPECT_EQ(leads, 1);
}

/// Beside a given motion only the other arm and the scene are changed, and no path is moved.
TEST(AdviseWorkcell, LeavesAGivenMotionAsItIs) {
  Random random(seed("AdviseWorkcell.LeavesAGivenMotionAsItIs"));
  const TestRobot robot = data_robot("sda10f");
  int infeasible = 0, helped = 0;
  const int count = trials(40);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE(trial);
    Problem cell = random_workcell(robot, random);
    const Answer both = plan_workcell(cell, long_enough(1));
    if (both.status != PlanStatus::kSolved) continue;
    ArmTask& left = cell.arms[0];
    for (const TrajectoryRow& row : both.arms[0].rows()) left.given.push_back(row.q);
    left.path().waypoints.clear();
    add_post(cell, random);
    cell.arms[1].path().limits.joint_margin = random.uniform(0, 0.5);
    Answer result;
    try {
      result = plan_workcell(cell, long_enough(1));
    } catch (const InputError&) {  // the post is in the way of the given motion
      continue;
    }
    if (result.status == PlanStatus::kSolved) continue;
    ++infeasible;
    bool any = false;
    for (const Advice& one : advise_workcell(cell, result, long_enough(2)).changes) {
      EXPECT_NE(one.arm, "left");
      EXPECT_NE(one.change, Change::kMovePaths);
      EXPECT_NE(one.change, Change::kFiner);
      any = holds(cell, one) || any;
    }
    helped += any;
  }
  std::printf("%d workcells: %d infeasible beside a given motion, %d of them helped\n", count,
              infeasible, helped);
  EXPECT_GE(infeasible, at_least(count / 20));
}

TEST(AdviseWorkcell, SaysNothingWithoutTimeAndWhereThereIsAPlan) {
  Random random(2);
  Problem cell = random_workcell(data_robot("sda10f"), random);
  cell.arms[0].path().limits.clearance = cell.arms[1].path().limits.clearance = 0.2;
  const Answer result = plan_workcell(cell, long_enough(1));
  ASSERT_EQ(result.status, PlanStatus::kInfeasible);
  PlanOptions none = long_enough(1);
  none.timeout_s = 1e-6;
  for (const Advice& one : advise_workcell(cell, result, none).changes)
    EXPECT_EQ(one.outcome, Outcome::kUnknown) << words(one);
  Answer solved = result;
  solved.status = PlanStatus::kSolved;
  EXPECT_TRUE(advise_workcell(cell, solved, none).changes.empty());
  none.hooks.check = std::make_shared<AllowsAll>();
  EXPECT_THROW(static_cast<void>(advise_workcell(cell, result, none)), InvalidArgument);
}

}  // namespace
}  // namespace swivel::test
