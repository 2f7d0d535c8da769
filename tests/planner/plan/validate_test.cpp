// SPDX-License-Identifier: BSD-3-Clause
// What a program may hand over wrongly: every member of a problem broken in every way, and a robot
// prepared for another problem.
#include "swivel/core/problem/validate.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "random_problem.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/study/campaign.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel {
namespace {

using namespace test;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(),
                 kInf = std::numeric_limits<double>::infinity();

/// A valid problem in which every member is set.
PathProblem full_problem() {
  PathProblem problem = problem_for(data_robot("iiwa14"));
  const Chain chain = arm_of(data_robot("iiwa14")).chain;
  Config q0, q1;
  q0 = {0.3, 0.5, 0.2, -1.2, 0.1, 0.6, 0.0};
  q1 = q0 + 0.05 * Config::Ones();
  problem.waypoints = {waypoint_of(chain.tool(q0)), waypoint_of(chain.tool(q1))};
  problem.resolution = {.ds = 0.02, .dphi = 0.3, .dalpha = 0.3};
  const Pose away(Eigen::Translation3d(0, 0, -3));
  problem.attached = {{"grip", Cylinder{0.01, 0.02}, Pose::Identity(), "tool0"}};
  problem.scene = {{"box", Box{Vector3d(0.1, 0.1, 0.1)}, away, {"link_7", "grip"}},
                   {"ball", Sphere{0.1}, away, {}},
                   {"can", Cylinder{0.1, 0.1}, away, {}},
                   {"pill", Capsule{0.1, 0.1}, away, {}},
                   {"mesh", box_mesh(Vector3d(0.1, 0.1, 0.1)), away, {}}};
  problem.vary = {{"box", Vector3d(0.01, 0.01, 0.01), Vector3d(0.1, 0.1, 0.1)}};
  Limits& limits = problem.limits;
  limits.step_error = limits.tool_path_error = limits.tool_angle_error = 1;
  limits.tool_speed = limits.tool_turn_speed = 0.01;
  limits.edge_clearance = limits.self_clearance = 0.001;
  limits.edges = EdgeMode::kNodes;
  return problem;
}

struct Case {
  std::string field;
  std::function<void(PathProblem&)> breaks;
};

/// A number that each of `values` breaks.
void add_number(std::vector<Case>& cases, const std::string& field,
                const std::function<double&(PathProblem&)>& member, std::vector<double> values) {
  values.insert(values.end(), {kNaN, kInf, -kInf});
  for (const double value : values)
    cases.push_back({field, [=](PathProblem& problem) { member(problem) = value; }});
}

/// Breaks numbers of the limits.
void add_limits(std::vector<Case>& cases) {
  const std::vector<double> not_positive{0, -1}, negative{-1};
  const auto limit = [&](const char* name, auto member, const std::vector<double>& values) {
    add_number(
        cases, std::string("limits.") + name,
        [=](PathProblem& p) -> double& { return p.limits.*member; }, values);
  };
  const auto optional_limit = [&](const char* name, auto member,
                                  const std::vector<double>& values) {
    add_number(
        cases, std::string("limits.") + name,
        [=](PathProblem& p) -> double& { return (p.limits.*member).emplace(); }, values);
  };
  limit("clearance", &Limits::clearance, negative);
  limit("manipulability", &Limits::manipulability, negative);
  limit("joint_margin", &Limits::joint_margin, negative);
  limit("joint_step", &Limits::joint_step, not_positive);
  limit("arm_slope", &Limits::arm_slope, not_positive);
  limit("edge_tolerance", &Limits::edge_tolerance, not_positive);
  optional_limit("step_error", &Limits::step_error, not_positive);
  optional_limit("tool_path_error", &Limits::tool_path_error, not_positive);
  optional_limit("tool_angle_error", &Limits::tool_angle_error, not_positive);
  optional_limit("tool_speed", &Limits::tool_speed, not_positive);
  optional_limit("tool_turn_speed", &Limits::tool_turn_speed, not_positive);
  optional_limit("self_clearance", &Limits::self_clearance, negative);
  optional_limit("edge_clearance", &Limits::edge_clearance, negative);
}

/// Breaks numbers of the resolution and of the cost.
void add_resolution_and_cost(std::vector<Case>& cases) {
  const std::vector<double> not_positive{0, -1};
  add_number(
      cases, "resolution.ds", [](PathProblem& p) -> double& { return p.resolution.ds; },
      not_positive);
  add_number(cases, "resolution.dphi", [](PathProblem& p) -> double& { return p.resolution.dphi; },
             {0, -1, 6.3});
  add_number(
      cases, "resolution.dalpha", [](PathProblem& p) -> double& { return p.resolution.dalpha; },
      not_positive);
  for (std::size_t k : {0u, 6u})
    add_number(cases, "cost.weights[" + std::to_string(k) + "]",
               [=](PathProblem& p) -> double& {
                 if (!p.cost.weights) p.cost.weights = {1, 1, 1, 1, 1, 1, 1};
                 return (*p.cost.weights)[k];
               },
               {-1, 1e-7, 1.1e6, 1e160, 1e-300});
  add_number(cases, "cost.roll",
             [](PathProblem& p) -> double& {
               p.roll = Roll{};
               return p.cost.roll;
             },
             {-1, 1e-7, 1.1e6});
  cases.push_back({"cost.roll", [](PathProblem& p) { p.cost.roll = 1; }});  // no roll is free
}

/// Breaks numbers of the start and of joints that are held.
void add_start_and_hold(std::vector<Case>& cases) {
  const std::vector<double> negative{-1}, none;
  for (std::size_t k : {0u, 6u})
    add_number(
        cases, "start[" + std::to_string(k) + "]",
        [=](PathProblem& p) -> double& {
          if (!p.start) p.start = Config::Zero();
          return (*p.start)[static_cast<Eigen::Index>(k)];
        },
        none);
  add_number(cases, "start_tolerance", [](PathProblem& p) -> double& { return p.start_tolerance; },
             {0, -1, 0.11});
  add_number(
      cases, "start_at",
      [](PathProblem& p) -> double& {
        p.start = Config::Zero();
        return p.start_at.emplace();
      },
      negative);
  cases.push_back({"start_at", [](PathProblem& p) { p.start_at = 0.1; }});
  add_number(
      cases, "hold.joint", [](PathProblem& p) -> double& { return p.hold["joint"]; }, none);
}

/// Breaks positions and orientations of waypoints, and how far objects vary.
void add_waypoints_and_variation(std::vector<Case>& cases) {
  const std::vector<double> negative{-1}, none;
  for (int k = 0; k < 3; ++k) {
    const std::string at = "[" + std::to_string(k) + "]";
    add_number(
        cases, "waypoints[1].position" + at,
        [=](PathProblem& p) -> double& { return p.waypoints[1].position[k]; }, none);
    add_number(
        cases, "vary[0].xyz" + at, [=](PathProblem& p) -> double& { return p.vary[0].xyz[k]; },
        negative);
    add_number(
        cases, "vary[0].rpy" + at, [=](PathProblem& p) -> double& { return p.vary[0].rpy[k]; },
        negative);
  }
  for (int k = 0; k < 4; ++k)
    add_number(cases, "waypoints[0].orientation",
               [=](PathProblem& p) -> double& { return p.waypoints[0].orientation.coeffs()[k]; },
               {3});
}

/// Breaks dimensions of boxes, spheres, cylinders and capsules.
void add_dimensions(std::vector<Case>& cases) {
  const std::vector<double> not_positive{0, -1};
  for (int k = 0; k < 3; ++k)
    add_number(
        cases, "scene[0].shape.size[" + std::to_string(k) + "]",
        [=](PathProblem& p) -> double& { return std::get<Box>(p.scene[0].shape).size[k]; },
        not_positive);
  add_number(
      cases, "scene[1].shape.radius",
      [](PathProblem& p) -> double& { return std::get<Sphere>(p.scene[1].shape).radius; },
      not_positive);
  add_number(
      cases, "scene[2].shape.radius",
      [](PathProblem& p) -> double& { return std::get<Cylinder>(p.scene[2].shape).radius; },
      not_positive);
  add_number(
      cases, "scene[2].shape.length",
      [](PathProblem& p) -> double& { return std::get<Cylinder>(p.scene[2].shape).length; },
      not_positive);
  add_number(
      cases, "scene[3].shape.radius",
      [](PathProblem& p) -> double& { return std::get<Capsule>(p.scene[3].shape).radius; },
      not_positive);
  add_number(
      cases, "scene[3].shape.length",
      [](PathProblem& p) -> double& { return std::get<Capsule>(p.scene[3].shape).length; },
      not_positive);
  add_number(
      cases, "attached[0].shape.radius",
      [](PathProblem& p) -> double& { return std::get<Cylinder>(p.attached[0].shape).radius; },
      not_positive);
}

/// Sets sizes, poses and names beyond their bounds.
void add_beyond_bounds(std::vector<Case>& cases) {
  // Beyond kMostMetres distances are not right, and names stand on terminals and in pictures
  // (bounds.hpp).
  cases.push_back(
      {"scene[1].shape.radius", [](PathProblem& p) { p.scene[1].shape = Sphere{1000.1}; }});
  cases.push_back({"scene[0].shape.size[2]",
                   [](PathProblem& p) { p.scene[0].shape = Box{Vector3d(1, 1, 1e9)}; }});
  cases.push_back({"scene[4].shape",
                   [](PathProblem& p) { p.scene[4].shape = box_mesh(Vector3d(1, 1, 2001)); }});
  cases.push_back(
      {"scene[3].pose", [](PathProblem& p) { p.scene[3].pose.translation().x() = 1e9; }});
  cases.push_back({"scene[2].name", [](PathProblem& p) { p.scene[2].name = "a\x1b[31m"; }});
  cases.push_back({"attached[0].name", [](PathProblem& p) { p.attached[0].name = "\xff"; }});
}

/// Breaks entries of the tool's pose and of poses of objects, in the scene and attached.
void add_poses(std::vector<Case>& cases) {
  const std::vector<double> none;
  const std::pair<const char*, std::function<Pose&(PathProblem&)>> poses[] = {
      {"tool", [](PathProblem& p) -> Pose& { return p.tool; }},
      {"scene[1].pose", [](PathProblem& p) -> Pose& { return p.scene[1].pose; }},
      {"attached[0].pose", [](PathProblem& p) -> Pose& { return p.attached[0].pose; }}};
  for (const auto& [field, member] : poses) {
    const auto pose = member;
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column)
        add_number(
            cases, field, [=](PathProblem& p) -> double& { return pose(p).matrix()(row, column); },
            row == 3 || column < 3 ? std::vector<double>{2, 1 - 1e-5 * (row == column)} : none);
    cases.push_back({field, [=](PathProblem& p) {
                       pose(p).matrix().topLeftCorner<3, 3>() *= -1;
                     }});  // a mirror
    cases.push_back({field, [=](PathProblem& p) { pose(p).matrix().setZero(); }});
  }
}

/// Breaks vertices of a mesh and corners of its triangles.
void add_mesh(std::vector<Case>& cases) {
  const std::vector<double> none;
  const auto mesh = [](PathProblem& p) {
    auto copy = std::make_shared<TriangleMesh>(*std::get<MeshPtr>(p.scene[4].shape));
    p.scene[4].shape = MeshPtr(copy);
    return copy;
  };
  for (int k = 0; k < 3; ++k)
    add_number(
        cases, "scene[4].shape", [=](PathProblem& p) -> double& { return mesh(p)->vertices[5][k]; },
        none);
  for (const int corner : {-1, 8, std::numeric_limits<int>::max()})
    cases.push_back({"scene[4].shape", [=](PathProblem& p) { mesh(p)->triangles[3][1] = corner; }});
}

/// Removes the model and a mesh, and sets names that are empty, taken or unknown.
void add_names(std::vector<Case>& cases) {
  cases.insert(cases.end(),
               {{"model", [](PathProblem& p) { p.model = nullptr; }},
                {"scene[4].shape", [](PathProblem& p) { p.scene[4].shape = MeshPtr(); }},
                {"scene[1].name", [](PathProblem& p) { p.scene[1].name = ""; }},
                {"scene[1].name", [](PathProblem& p) { p.scene[1].name = "box"; }},
                {"scene[1].name", [](PathProblem& p) { p.scene[1].name = "grip"; }},
                {"scene[1].name", [](PathProblem& p) { p.scene[1].name = "base_link"; }},
                {"scene[0].allow[1]", [](PathProblem& p) { p.scene[0].allow[1] = "hand"; }},
                {"scene[0].allow[0]", [](PathProblem& p) { p.scene[0].allow[0] = ""; }},
                {"attached[0].name", [](PathProblem& p) { p.attached[0].name = ""; }},
                {"attached[0].name", [](PathProblem& p) { p.attached[0].name = "link_3"; }},
                {"attached[1].name", [](PathProblem& p) { p.attached.push_back(p.attached[0]); }},
                {"attached[0].link", [](PathProblem& p) { p.attached[0].link = ""; }},
                {"attached[0].link", [](PathProblem& p) { p.attached[0].link = "hand"; }},
                {"path_frame", [](PathProblem& p) { p.path_frame = "door"; }},
                {"vary[0].object", [](PathProblem& p) { p.vary[0].object = "door"; }}});
}

/// Lists every way to break every member of full_problem().
std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const auto add :
       {add_limits, add_resolution_and_cost, add_start_and_hold, add_waypoints_and_variation,
        add_dimensions, add_beyond_bounds, add_poses, add_mesh, add_names})
    add(cases);
  return cases;
}

CampaignOptions one_episode() {
  CampaignOptions options;
  options.episodes = 1;
  return options;
}

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InvalidArgument& error) {
    return error.what();
  } catch (const std::exception& error) {
    return std::string("another exception: ") + error.what();
  }
  return "accepted";
}

void expect_message(const std::string& message, const std::string& field) {
  EXPECT_NE(message.find(": " + field + ": "), std::string::npos) << field << ": " << message;
  EXPECT_NE(message.find(": allowed is "), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST(Validate, EveryMemberBrokenInEveryWayIsNamed) {
  const PathProblem good = full_problem();
  ASSERT_EQ(message_of([&] { validate(good); }), "accepted");
  const PreparedRobot robot(good);
  ASSERT_NE(plan(robot, good).status, PlanStatus::kTimeout);
  int broken = 0;
  for (const Case& x : all_cases()) {
    PathProblem bad = good;
    x.breaks(bad);
    expect_message(message_of([&] { validate(bad); }), x.field);
    // The same wherever a problem is taken.
    for (const std::string& message :
         {message_of([&] { (void)plan(bad); }), message_of([&] { (void)plan(robot, bad); }),
          message_of([&] { PreparedRobot prepared(bad); }),
          message_of([&] { (void)check_trajectory(bad, {}); }),
          message_of([&] { run_campaign(robot, bad, one_episode(), [](const EpisodeRow&) {}); })})
      EXPECT_EQ(message, message_of([&] { validate(bad); }));
    ++broken;
  }
  std::printf("%d broken problems refused in 6 places\n", broken);
  EXPECT_GT(broken, 400);
}

TEST(Validate, EndsOfWhatIsAllowed) {
  PathProblem problem = full_problem();
  problem.cost.weights = {0, 1e-6, 1e6, 1, 0, 0, 0};
  problem.resolution.dphi = kTwoPi;
  problem.limits.clearance = problem.limits.manipulability = problem.limits.joint_margin = 0;
  problem.limits.edge_clearance = problem.limits.self_clearance = 0;
  problem.limits.tool_path_error = problem.limits.tool_speed = std::nullopt;
  problem.tool.linear() =
      Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()).toRotationMatrix() * (1 + 1e-8);
  EXPECT_EQ(message_of([&] { validate(problem); }), "accepted");
}

TEST(Validate, RobotModelsThatAreNone) {
  const RobotModel good = *data_robot("iiwa14").model;
  ASSERT_EQ(message_of([&] { validate(good); }), "accepted");
  const std::pair<const char*, std::function<void(RobotModel&)>> cases[] = {
      {"joints[1].axis", [](RobotModel& r) { r.joints[1].axis.setZero(); }},
      {"joints[1].axis", [](RobotModel& r) { r.joints[1].axis[0] = kNaN; }},
      {"joints[1].lower", [](RobotModel& r) { r.joints[1].lower = kNaN; }},
      {"joints[1].lower", [](RobotModel& r) { r.joints[1].upper = -9; }},
      {"joints[1].velocity", [](RobotModel& r) { r.joints[1].velocity = -1; }},
      {"joints[1].velocity", [](RobotModel& r) { r.joints[1].velocity = kNaN; }},
      {"joints[1].origin", [](RobotModel& r) { r.joints[1].origin.translation()[2] = kNaN; }},
      {"joints[1].parent_link", [](RobotModel& r) { r.joints[1].parent_link = 99; }},
      {"joints[1].child_link", [](RobotModel& r) { r.joints[1].child_link = -1; }},
      {"joints[1].mimic.joint",
       [](RobotModel& r) {
         r.joints[1].mimic = Joint::Mimic{99, 1, 0};
       }},
      {"joints[1].mimic.multiplier",
       [](RobotModel& r) {
         r.joints[1].mimic = Joint::Mimic{0, kNaN, 0};
       }},
      {"joints[1].mimic.offset",
       [](RobotModel& r) {
         r.joints[1].mimic = Joint::Mimic{0, 1, kInf};
       }},
      {"joints[1].name", [](RobotModel& r) { r.joints[1].name = r.joints[0].name; }},
      {"links[2].name", [](RobotModel& r) { r.links[2].name = ""; }},
      {"links[2].parent_joint", [](RobotModel& r) { r.links[2].parent_joint = 99; }},
      {"links[2].parent_joint", [](RobotModel& r) { r.links[2].parent_joint = 0; }},
      {"links[0].parent_joint",
       [](RobotModel& r) {
         r.joints[0].parent_link =
             static_cast<int>(r.links.size()) - 1;  // the tip carries the base
         Joint joint;
         joint.name = "loop";
         joint.parent_link = static_cast<int>(r.links.size()) - 1;
         r.links[0].parent_joint = static_cast<int>(r.joints.size());
         joint.child_link = 0;
         r.joints.push_back(joint);
       }},
      {"root_link", [](RobotModel& r) { r.root_link = 99; }},
      {"links[1].collision[0].shape",
       [](RobotModel& r) { r.links[1].collision[0].shape = MeshPtr(); }},
      {"links[1].collision[0].shape.radius",
       [](RobotModel& r) { r.links[1].collision[0].shape = Sphere{kNaN}; }},
      {"links[1].collision[0].pose",
       [](RobotModel& r) { r.links[1].collision[0].pose.matrix()(0, 0) = kNaN; }},
  };
  for (const auto& [field, breaks] : cases) {
    auto bad = std::make_shared<RobotModel>(good);
    breaks(*bad);
    PathProblem problem = full_problem();
    problem.model = bad;
    expect_message(message_of([&] { PreparedRobot robot(problem); }), field);
  }
}

/// Every difference in what a robot was prepared for is refused by name; what is not baked in may
/// differ.
TEST(PreparedRobot, IsTiedToWhatItWasMadeOf) {
  const PathProblem good = full_problem();
  const PreparedRobot robot(good);
  const std::pair<const char*, std::function<void(PathProblem&)>> others[] = {
      {"model", [](PathProblem& p) { p.model = std::make_shared<RobotModel>(*p.model); }},
      {"base_link", [](PathProblem& p) { p.base_link = p.path_frame = "link_1"; }},
      {"tip_link", [](PathProblem& p) { p.tip_link = "link_7"; }},
      {"tool", [](PathProblem& p) { p.tool.translation().z() += 1e-9; }},
      {"hold", [](PathProblem& p) { p.hold["joint"] = 0; }},
      {"attached",
       [](PathProblem& p) {
         p.attached[0].shape = Cylinder{0.01, 0.3};
       }},
      {"attached", [](PathProblem& p) { p.attached[0].pose.translation().x() += 0.1; }},
      {"attached", [](PathProblem& p) { p.attached[0].link = "link_7"; }},
      {"attached", [](PathProblem& p) { p.attached[0].name = "hand", p.scene[0].allow = {}; }},
      {"attached",
       [](PathProblem& p) {
         p.attached.push_back({"more", Sphere{0.01}, Pose::Identity(), "tool0"});
       }},
      {"attached", [](PathProblem& p) { p.attached.clear(), p.scene[0].allow = {}; }},
  };
  for (const auto& [what, changes] : others) {
    PathProblem other = good;
    changes(other);
    for (const std::string& message :
         {message_of([&] { (void)plan(robot, other); }), message_of([&] {
            run_campaign(robot, other, one_episode(), [](const EpisodeRow&) {});
          })}) {
      EXPECT_NE(message.find(std::string(": ") + what), std::string::npos)
          << what << ": " << message;
      EXPECT_NE(message.find("prepared for"), std::string::npos) << message;
    }
  }
  PathProblem moved = good;
  moved.scene.pop_back();
  moved.scene[0].pose.translation().x() += 1;
  moved.resolution.ds = 0.03;
  moved.waypoints[0].position.z() += 0.01;
  moved.limits.joint_step = 1;
  moved.limits.clearance = 0.02;
  moved.limits.self_clearance = 0.01;
  moved.limits.edge_clearance = 0.03;
  moved.limits.edge_tolerance = 0.05;
  moved.cost.metric = CostMetric::kMax;
  EXPECT_EQ(message_of([&] { (void)plan(robot, moved); }), "accepted");
}

/// Problems that a program makes have no file to name: a message begins with the key then, and not
/// with a colon.
TEST(Validate, MessagesWithoutAFileBeginWithTheKey) {
  const std::vector<std::pair<const char*, std::function<void(PathProblem&)>>> breaks = {
      {"path: 1 waypoint", [](PathProblem& p) { p.waypoints.resize(1); }},
      {"path: all waypoints are one pose",
       [](PathProblem& p) { p.waypoints.assign(3, p.waypoints[0]); }},
      {"path: waypoint 1: turns by 180 deg",
       [](PathProblem& p) {
         p.waypoints[1].orientation = p.waypoints[0].orientation * Quaterniond(0, 1, 0, 0);
       }},
      {"problem: path_frame: unknown frame", [](PathProblem& p) { p.path_frame = "nowhere"; }},
      {"start.joints: joint", [](PathProblem& p) { p.start = Config::Constant(9); }},
      {"start.joints: the tool", [](PathProblem& p) { p.start = Config::Zero(); }},
      {"start_at: is", [](PathProblem& p) { p.start = Config::Zero(), p.start_at = 50; }},
      {"limits.joint_margin: leaves no range", [](PathProblem& p) { p.limits.joint_margin = 3; }},
      {"resolution", [](PathProblem& p) { p.resolution.ds = p.resolution.dphi = 1e-7; }},
      {"problem: attached[0].name: 'link_3' is a link",
       [](PathProblem& p) {
         p.attached = {{"link_3", Sphere{0.1}, Pose::Identity(), "tool0"}};
       }},
      {"problem: attached[0].link: unknown link",
       [](PathProblem& p) { p.attached[0].link = "nothing"; }},
      {"robot.tip_link: ", [](PathProblem& p) { p.tip_link = "nothing"; }},
      {"robot.tip_link: only", [](PathProblem& p) { p.tip_link = "link_3"; }},
  };
  const PathProblem good = [] {
    PathProblem problem = full_problem();
    problem.source.clear();
    auto model = std::make_shared<RobotModel>(*problem.model);
    model->source.clear();
    problem.model = model;
    problem.limits = {};
    problem.path_frame = problem.base_link;
    return problem;
  }();
  for (const auto& [words, change] : breaks) {
    PathProblem problem = good;
    change(problem);
    try {
      (void)Planner(problem).plan({});
      ADD_FAILURE() << words << ": nothing is wrong";
    } catch (const std::exception& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(words)) << words << ": " << error.what();
    }
  }
}

}  // namespace
}  // namespace swivel
