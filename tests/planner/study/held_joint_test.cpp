// SPDX-License-Identifier: BSD-3-Clause
// Placements over positions of joints that are held: every row against a plan of its own, whatever
// the threads.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>

#include "axes_robots.hpp"
#include "random_problem.hpp"
#include "swivel/collision/world/world.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/io/tables/placement.hpp"
#include "swivel/planner/job/plan_job.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/place.hpp"

namespace swivel {
namespace {

using namespace test;

/// A problem with a joint that is held between base and tip.
struct HeldProblem {
  PathProblem problem;
  std::string joint;
  double lower, upper;  ///< positions that are tried
};

/// Returns a problem of an arm without an arm angle: of six joints and one more.
PathProblem arc_problem(const TestRobot& robot, Random& random) {
  PathProblem problem = random_problem(robot, random);
  problem.limits.step_error.reset();
  problem.limits.arm_slope = Limits().arm_slope;
  problem.resolution.arc = random.uniform(0.3, 0.6);
  problem.waypoints.resize(2);
  return problem;
}

/// Returns an arm of seven joints on a torso or a slide, the left arm of a torso robot, or an arm
/// of six joints and a slide on a torso: by turns as trials go on.
HeldProblem held_problem(int trial, Random& random) {
  const MoreAxis torso{Joint::Type::kRevolute, Vector3d(0.2, 1, 0.1), -1.2, 1.0},
      slide{Joint::Type::kPrismatic, Vector3d(0, 1, 0.2), -0.6, 0.6};
  switch (trial % 5) {
    case 0:
      return {random_problem(data_robot("sda10f"), random), "torso_joint_b1", -0.3, 0.3};
    case 1:
      return {random_problem(with_axis(data_robot("iiwa14"), 0, torso), random), "torso", -0.3,
              0.3};
    case 2:
      return {random_problem(with_axis(continuous_robot(), 0, slide), random), "slide", -0.2, 0.2};
    case 3:
      return {arc_problem(with_axis(torso_robot(), 0, slide), random), "slide", -0.1, 0.1};
    default: {
      const TestRobot on_rail = slide_robots()[static_cast<std::size_t>(random.below(3))];
      PathProblem problem = arc_problem(on_rail, random);
      problem.model = with_axis(on_rail, 0, torso).model;
      problem.hold["torso"] = 0;
      return {problem, "torso", -0.1, 0.1};
    }
  }
}

/// Returns cells at three positions of the joint, of which some move the thing as well.
std::vector<PlacementCell> cells_of(const HeldProblem& held, bool moves, Random& random) {
  std::vector<PlacementCell> cells;
  for (int position = 0; position < 3; ++position) {
    const double at = random.uniform(held.lower, held.upper);
    for (int k = 0; k < 3; ++k) {
      PlacementCell& cell = cells.emplace_back(PlacementCell{cells.size()});
      cell.hold[held.joint] = at;
      if (moves)
        for (double& value : cell.offset)
          if (random.coin()) value = random.uniform(-0.05, 0.05);
    }
  }
  return cells;
}

/// Returns the problem of a cell, made by hand.
PathProblem problem_of(const HeldProblem& held, const Movable& thing, const PlacementCell& cell) {
  PathProblem problem = placed_problem(held.problem, thing, cell.offset);
  problem.hold[held.joint] = cell.hold.at(held.joint);
  return problem;
}

/// Returns the row of a cell whose problem was planned alone.
PlacementRow row_alone(const PlacementCell& cell, const PathProblem& problem,
                       const PlanOptions& options) {
  PlacementRow row;
  row.cell = cell.cell;
  row.offset = cell.offset;
  row.hold = cell.hold;
  const PlanResult result = plan(problem, options);
  row.status = result.status;
  if (row.status != PlanStatus::kSolved) {
    row.failed_s = result.diagnosis->reached_s;
    row.cause = to_string(result.diagnosis->cause.kind);
    row.by = subject_of(result.diagnosis->cause, problem.scene);
    row.reason = words(result.diagnosis->cause);
    return row;
  }
  row.cost = result.cost;
  row.checked = result.checked;
  if (result.min_margin) {
    row.clearance = result.min_margin->clearance;
    row.clearance_margin = result.min_margin->margin;
  }
  if (result.nearest_limit) row.joint_margin = result.nearest_limit->margin;
  if (result.nearest_slide_limit) row.slide_margin = result.nearest_slide_limit->margin;
  if (result.top_tool_speed) row.tool_speed = result.top_tool_speed->speed;
  return row;
}

/// Checks the cells of a problem at one and three threads; counts in `met` what they have.
void check_cells(const HeldProblem& held, const Movable& thing, Random& random,
                 std::map<std::string, int>& met) {
  const auto robot = std::make_shared<const PreparedRobot>(held.problem);
  const bool moves = thing.kind != Movable::Kind::kNothing;
  const std::vector<PlacementCell> cells = cells_of(held, moves, random);
  PlanOptions options;
  options.planner = random.coin() ? PlannerKind::kLazy : PlannerKind::kParallel;
  options.threads = 3;
  options.evidence.postures = true;
  std::vector<PlacementRow> alone;
  for (const PlacementCell& cell : cells)
    alone.push_back(row_alone(cell, problem_of(held, thing, cell), options));
  for (const int threads : {1, 3}) {
    options.threads = threads;
    PlacementPlanner planner(robot, held.problem, thing, options);
    const auto rows = planner.plan(cells);
    ASSERT_EQ(rows.size(), cells.size());
    // Numbers in a table are as many digits as they have.
    for (std::size_t k = 0; k < cells.size(); ++k)
      EXPECT_EQ(io::to_csv({rows[k]}), io::to_csv({alone[k]}));
    const auto plans = planner.trajectories(cells);
    for (const PlacedPlan& shown : plans)
      EXPECT_EQ(shown.robot->arm().held.empty(), robot->arm().held.empty());
  }
  for (const PlacementRow& row : alone) {
    ++met[row.status == PlanStatus::kSolved ? "solved" : "without a path"];
    ++met[moves ? "moved and held" : "held alone"];
    met["planned slide"] += row.slide_margin.has_value();
  }
  met["verdicts that differ"] +=
      std::any_of(alone.begin(), alone.end(),
                  [&](const PlacementRow& row) { return row.status != alone[0].status; });
}

TEST(HeldJoint, CellsAreSinglePlansAtAnyThreadCount) {
  const std::uint64_t base = seed("HeldJoint.Cells");
  std::map<std::string, int> met;
  const int count = trials(40);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE("SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial));
    Random random(base + static_cast<std::uint64_t>(trial));
    HeldProblem held = held_problem(trial, random);
    held.problem.start.reset();
    Movable thing{Movable::Kind::kNothing, ""};
    if (random.coin()) thing.kind = random.coin() ? Movable::Kind::kPath : Movable::Kind::kBase;
    if (thing.kind == Movable::Kind::kPath && !held.problem.scene.empty() && random.coin())
      thing = {Movable::Kind::kObject, held.problem.scene[0].name};
    check_cells(held, thing, random, met);
    if (HasFailure()) return;
  }
  for (const auto& [what, times] : met) std::printf("%s %d; ", what.c_str(), times);
  std::printf("\n");
  for (const char* const what :
       {"solved", "without a path", "moved and held", "held alone", "planned slide"})
    EXPECT_GE(met[what], at_least(30)) << what;
  EXPECT_GE(met["verdicts that differ"], at_least(3));
}

/// The joint moves what it carries: the arm, and a body that is attached before the arm. Scene and
/// path stay.
TEST(HeldJoint, MovesWhatItCarriesAndNothingElse) {
  const std::uint64_t base = seed("HeldJoint.Moves");
  const int count = trials(50);
  for (int trial = 0; trial < count; ++trial) {
    SCOPED_TRACE("SWIVEL_TEST_SEED " + std::to_string(base) + " trial " + std::to_string(trial));
    Random random(base + static_cast<std::uint64_t>(trial));
    const HeldProblem held = held_problem(1 + trial % 2, random);
    PathProblem problem = held.problem;
    problem.attached.push_back(
        {"lamp", Sphere{0.01}, Pose(Eigen::Translation3d(0, 3, 3)), held.joint + "_link"});
    PathProblem moved = problem;
    const double at = random.uniform(held.lower, held.upper);
    hold_joints(moved, {{held.joint, at}});
    EXPECT_EQ(moved.waypoints, problem.waypoints);
    for (std::size_t k = 0; k < problem.scene.size(); ++k)
      EXPECT_EQ(moved.scene[k].pose.matrix(), problem.scene[k].pose.matrix());

    const Joint& joint =
        problem.model->joints[static_cast<std::size_t>(problem.model->find_joint(held.joint))];
    Pose motion = Pose::Identity();
    if (joint.type == Joint::Type::kPrismatic)
      motion.translation() = at * joint.axis;
    else
      motion.linear() = Eigen::AngleAxisd(at, joint.axis).toRotationMatrix();
    const Pose by = joint.origin * motion * joint.origin.inverse();
    const PreparedRobot before(problem), after(moved);
    const Config q = random_config(before.arm().chain, random);
    EXPECT_TRUE(after.arm().chain.tool(q).isApprox(by * before.arm().chain.tool(q), 1e-9));
    const auto lamp = [](const PreparedRobot& robot) { return robot.world().bodies().back(); };
    ASSERT_EQ(lamp(before).name, "lamp");
    EXPECT_TRUE(lamp(after).pose.isApprox(by * lamp(before).pose, 1e-9));
  }
}

TEST(HeldJoint, RefusesByLine) {
  Random random(seed("HeldJoint.Refuses"));
  const HeldProblem held = held_problem(1, random);
  const auto refused = [&](const HeldPositions& positions, const char* words) {
    PathProblem problem = held.problem;
    try {
      hold_joints(problem, positions);
      ADD_FAILURE() << words;
    } catch (const InvalidArgument& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(words), std::string::npos) << message;
      EXPECT_NE(message.find("allowed "), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  };
  refused({{"torso", 1.5}}, "joint 'torso' at 1.5 rad is outside its limits: allowed is -1.2 to 1");
  refused({{"torsoo", 0}}, "unknown joint 'torsoo', nearest is 'torso'");
  const Chain chain =
      arm_of({"", held.problem.model, held.problem.base_link, held.problem.tip_link}).chain;
  refused({{chain.joint_names[2], 0}}, "is planned");
  for (const Joint& joint : held.problem.model->joints)
    if (!joint.movable()) {
      refused({{joint.name, 0}}, "is fixed");
      break;
    }
  const auto robot = std::make_shared<const PreparedRobot>(held.problem);
  for (const PlacementCell& cell :
       {PlacementCell{0, {}, {{"torso", -2}}}, PlacementCell{0, {0.1}, {{"torso", 0}}}}) {
    PlacementPlanner planner(robot, held.problem, {Movable::Kind::kNothing, ""}, {});
    EXPECT_THROW(static_cast<void>(planner.plan({cell})), InputError);
  }
}

/// A job with its torso held elsewhere, alone and with its door moved.
TEST(HeldJoint, RowsOfJobsAreSinglePlans) {
  Problem job = io::load_job(std::string(SWIVEL_DATA_DIR) + "/problems/door_job.yaml");
  job.arm().strokes.resize(2);
  job.arm().home.reset();
  for (Stroke& stroke : job.arm().strokes) stroke.resolution = {.ds = 0.02, .dphi = 0.1};
  const auto robot = std::make_shared<const PreparedRobot>(problem_of_run(job, {0, false}));
  std::vector<PlacementCell> cells;
  for (const double at : {-0.15, -0.05, 0.05})
    for (const double x : {0.0, 0.03})
      cells.push_back({cells.size(), {x}, {{"torso_joint_b1", at}}});
  const Movable door{Movable::Kind::kObject, "door"};
  std::map<PlanStatus, int> met;
  for (const int threads : {1, 3}) {
    PlanOptions options;
    options.threads = threads;
    PlacementPlanner planner(robot, job, door, options);
    const auto rows = planner.plan(cells);
    ASSERT_EQ(rows.size(), cells.size());
    for (std::size_t k = 0; k < cells.size(); ++k) {
      Problem placed = placed_problem(job, door, cells[k].offset);
      placed.arm().hold["torso_joint_b1"] = cells[k].hold.at("torso_joint_b1");
      const Answer alone = plan_job(PreparedRobot(problem_of_run(placed, {0, false})), placed, {});
      EXPECT_EQ(rows[k].status, alone.status) << k;
      EXPECT_EQ(rows[k].hold, cells[k].hold) << k;
      if (alone.status == PlanStatus::kSolved) {
        EXPECT_EQ(rows[k].cost, alone.cost) << k;
      }
      ++met[rows[k].status];
    }
  }
  EXPECT_GE(met[PlanStatus::kSolved], 6);
}

}  // namespace
}  // namespace swivel
