// SPDX-License-Identifier: BSD-3-Clause
// compute_cartesian_path() against plan() and check_trajectory(), on random lines.
#include "swivel/planner/refine/cartesian_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "robots.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/planning_arm.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {

namespace {

Robot robot_of(const std::string& name) {
  const auto file = [&](const char* end) { return test::data_dir() / "robots" / (name + end); };
  Robot robot;
  robot.model = io::load_robot(file(".urdf"), file(".srdf"));
  robot.base_link = robot.model->links[static_cast<std::size_t>(robot.model->root_link)].name;
  robot.tip_link = name == "iiwa14" ? "tool0" : "flange";
  return robot;
}

Waypoint waypoint(const Pose& pose) {
  return {pose.translation(), Quaterniond(pose.linear()), {}};
}

/// A random start of an arm, within its limits, lines from there, and boxes in the way of some.
struct Query {
  Config start = Config::Zero();
  std::vector<Waypoint> waypoints;
  std::vector<SceneObject> scene;

  Query(const Chain& chain, test::Random& random) {
    for (Eigen::Index j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
      const double inside = 0.1 * (limit.upper - limit.lower);
      start[j] = random.uniform(limit.lower + inside, limit.upper - inside);
    }
    Pose pose = chain.tool(start);
    for (int k = random.below(2); k >= 0; --k) {
      const Vector3d way(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      const double length = random.uniform(0.02, 0.25);
      pose.translation() += length * way.normalized();
      if (random.coin())
        pose.rotate(Eigen::AngleAxisd(random.uniform(-0.8, 0.8), way.normalized()));
      waypoints.push_back(waypoint(pose));
    }
    if (random.coin(0.3)) {
      SceneObject& box = scene.emplace_back();
      box.name = "box";
      box.shape = Box{Vector3d::Constant(random.uniform(0.02, 0.1))};
      box.pose.translation() = waypoints.back().position;
    }
  }
};

/// The problem of a query, written by hand.
PathProblem problem_of(const Robot& robot, const Chain& chain, const Query& query) {
  PathProblem problem;
  static_cast<Robot&>(problem) = robot;
  problem.start = query.start;
  problem.waypoints = query.waypoints;
  problem.waypoints.insert(problem.waypoints.begin(), waypoint(chain.tool(query.start)));
  problem.scene = query.scene;
  problem.resolution.ds = 0.01;
  return problem;
}

TEST(CartesianPath, FractionIsOneWhereThereIsAPlanAndElseThePartIsValid) {
  test::Random random(test::seed("CartesianPath"));
  int whole = 0, part = 0, nothing = 0;
  for (const char* name : {"iiwa14", "panda_like"}) {
    const Robot robot = robot_of(name);
    const Chain chain = planning_arm(robot).model.chain;
    CartesianPathOptions options;
    options.max_step = 0.01;
    Planner planner(cartesian_robot(robot, options));
    for (int k = 0, most = test::trials(100); k < most; ++k) {
      const Query query(chain, random);
      const PlanResult plan = swivel::plan(problem_of(robot, chain, query));
      planner.set_scene(query.scene);
      const CartesianPath path =
          compute_cartesian_path(planner, query.waypoints, query.start, options);
      ASSERT_EQ(path.fraction == 1, plan.status == PlanStatus::kSolved) << name << ' ' << k;
      ASSERT_EQ(path.cause.empty(), path.fraction == 1) << path.cause;
      if (path.fraction == 1) {
        ++whole;
        ASSERT_EQ(path.rows.size(), plan.trajectory.size());
        for (std::size_t i = 0; i < path.rows.size(); ++i)
          ASSERT_EQ(path.rows[i].q, plan.trajectory[i].q) << name << ' ' << k << ' ' << i;
      } else {
        const std::size_t reached = std::max<std::size_t>(plan.partial.size(), 1) - 1;
        const int steps = problem_path(problem_of(robot, chain, query), chain).size() - 1;
        ASSERT_EQ(path.fraction, static_cast<double>(reached) / steps) << name << ' ' << k;
        ASSERT_EQ(path.rows.size(), plan.partial.size());
        ++(path.rows.size() < 2 ? nothing : part);
      }
      if (path.rows.size() < 2) continue;
      const CheckResult check = check_trajectory(path.problem, path.rows);
      ASSERT_TRUE(check.passed) << name << ' ' << k << ": " << check.failures.front();
    }
  }
  std::printf("%d whole, %d in part, %d not at all\n", whole, part, nothing);
  EXPECT_GE(whole, test::at_least(60));
  EXPECT_GE(part, test::at_least(15));
  EXPECT_GE(nothing, test::at_least(10));
}

TEST(CartesianPath, MotionsOfWholePathsAndPartsPassTheCheck) {
  test::Random random(test::seed("CartesianPath"));
  int whole = 0, part = 0;
  const Robot robot = robot_of("iiwa14");
  const Chain chain = planning_arm(robot).model.chain;
  for (int k = 0, most = test::trials(24); k < most; ++k) {
    const Query query(chain, random);
    CartesianPathOptions options;
    options.timed = true;
    if (random.coin()) options.speed_scale = 0.3, options.acceleration_scale = 0.5;
    if (random.coin()) options.tool_speed = 0.05;
    const CartesianPath path =
        compute_cartesian_path(robot, query.scene, query.waypoints, query.start, options);
    if (path.rows.size() < 2) continue;
    const CheckResult rows = check_trajectory(path.problem, path.rows);
    ASSERT_TRUE(rows.passed) << k << ": " << rows.failures.front();
    ASSERT_EQ(path.fraction == 1, path.cause.empty() || !path.motion) << k;
    if (!path.motion) {  // joints would have to jump
      ASSERT_NE(path.cause.find("jump"), std::string::npos) << k << ": " << path.cause;
      continue;
    }
    ++(path.fraction == 1 ? whole : part);
    EXPECT_LE((path.motion->rows.front().row.q - query.start).cwiseAbs().maxCoeff(), 1e-9);
    const PreparedRobot prepared(path.problem);
    const CheckResult check = check_motion(prepared, path.problem, path.motion->rows);
    ASSERT_TRUE(check.passed) << k << ": " << check.failures.front();
    for (const TimedRow& row : path.motion->rows)
      for (std::size_t j = 0; j < kDof; ++j)
        EXPECT_LE(std::abs(row.v[static_cast<Eigen::Index>(j)]),
                  options.speed_scale * chain.limit[j].velocity * 1.001);
    EXPECT_LE(check.motion->tool_speed, options.tool_speed.value_or(10) * 1.01);
  }
  std::printf("%d whole, %d in part\n", whole, part);
  EXPECT_GE(whole, test::at_least(8));
  EXPECT_GE(part, test::at_least(2));
}

/// A line across the front of an iiwa14.
struct Line {
  Robot robot = robot_of("iiwa14");
  std::vector<Waypoint> waypoints{{{0.5, -0.2, 0.4}, {0, 1, 0, 0}},
                                  {{0.5, 0.2, 0.4}, {0, 1, 0, 0}}};
};

TEST(CartesianPath, BodiesMayMeetWhereCollisionsAreNotAvoided) {
  const Line line;
  const std::vector<SceneObject> wall{
      {"wall", Box{{0.2, 0.02, 0.2}}, Pose(Eigen::Translation3d(0.5, 0, 0.4)), {}}};
  CartesianPathOptions options;
  const CartesianPath kept = compute_cartesian_path(line.robot, wall, line.waypoints, {}, options);
  EXPECT_LT(kept.fraction, 0.6);
  EXPECT_GT(kept.fraction, 0.1);
  EXPECT_NE(kept.cause.find("wall"), std::string::npos) << kept.cause;
  options.avoid_collisions = false;
  const CartesianPath through =
      compute_cartesian_path(line.robot, wall, line.waypoints, {}, options);
  EXPECT_EQ(through.fraction, 1);
  const CartesianPath no_wall = compute_cartesian_path(line.robot, {}, line.waypoints, {}, {});
  EXPECT_EQ(no_wall.fraction, 1);
}

TEST(CartesianPath, JointsStayInTheirBands) {
  const Line line;
  const CartesianPath free = compute_cartesian_path(line.robot, {}, line.waypoints, {});
  ASSERT_EQ(free.fraction, 1);
  const double before = free.rows.front().q[2];
  CartesianPathOptions options;
  options.bands["joint_a3"] = {before + 0.3, before + 0.5};
  options.timed = true;
  const CartesianPath path = compute_cartesian_path(line.robot, {}, line.waypoints, {}, options);
  ASSERT_EQ(path.fraction, 1);
  ASSERT_TRUE(path.motion) << path.cause;
  for (const TimedRow& row : path.motion->rows) {
    EXPECT_GE(row.row.q[2], before + 0.3 - 1e-9);
    EXPECT_LE(row.row.q[2], before + 0.5 + 1e-9);
  }
  options.bands["joint_a3"] = {10, 11};
  EXPECT_THROW(
      static_cast<void>(compute_cartesian_path(line.robot, {}, line.waypoints, {}, options)),
      InvalidArgument);
  options.bands = {{"elbow", {0, 1}}};
  EXPECT_THROW(
      static_cast<void>(compute_cartesian_path(line.robot, {}, line.waypoints, {}, options)),
      InvalidArgument);
}

TEST(CartesianPath, EndsInTime) {
  const Line line;
  CartesianPathOptions options;
  options.max_step = 0.0002;
  options.plan.timeout_s = 0.002;
  const CartesianPath path = compute_cartesian_path(line.robot, {}, line.waypoints, {}, options);
  EXPECT_EQ(path.plan.status, PlanStatus::kTimeout);
  EXPECT_LT(path.fraction, 1);
  EXPECT_NE(path.cause.find("timeout"), std::string::npos) << path.cause;
}

TEST(CartesianPath, RefusesWhatMakesNoSense) {
  const Line line;
  CartesianPathOptions options;
  options.speed_scale = 0;
  const auto compute = [&] {
    static_cast<void>(compute_cartesian_path(line.robot, {}, line.waypoints, {}, options));
  };
  EXPECT_THROW(compute(), InvalidArgument);
  options = {};
  options.acceleration_scale = 1.5;
  EXPECT_THROW(compute(), InvalidArgument);
  options = {};
  options.max_step = 0;
  EXPECT_THROW(compute(), InvalidArgument);
  EXPECT_THROW(static_cast<void>(compute_cartesian_path(line.robot, {}, {}, {})), InputError);
}

TEST(CartesianPath, WithoutSpeedLimitsThereIsAPathButNoMotion) {
  Line line;
  auto model = std::make_shared<RobotModel>(*line.robot.model);
  for (Joint& joint : model->joints) joint.velocity = 0;
  line.robot.model = model;
  CartesianPathOptions options;
  options.timed = true;
  const CartesianPath path = compute_cartesian_path(line.robot, {}, line.waypoints, {}, options);
  EXPECT_EQ(path.fraction, 1);
  EXPECT_FALSE(path.motion);
  EXPECT_NE(path.cause.find("no speed limit"), std::string::npos) << path.cause;
}

}  // namespace

}  // namespace swivel
