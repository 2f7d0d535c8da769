// SPDX-License-Identifier: BSD-3-Clause
#include "problem_support.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel::io::test {
namespace {

TEST(ProblemFile, Defaults) {
  const ProblemFolder folder;
  const fs::path file = folder.write({});
  const PathProblem problem = load_path_problem(file);
  const PathProblem fresh;
  EXPECT_EQ(problem.source, file.string());
  EXPECT_EQ(problem.model->links.size(), 9u);
  EXPECT_EQ(problem.base_link, "base_link");
  EXPECT_EQ(problem.tip_link, "link_7");
  EXPECT_TRUE(problem.tool.isApprox(Pose::Identity()));
  EXPECT_EQ(problem.path_frame, "base_link");
  EXPECT_EQ(problem.waypoints.size(), 2u);
  EXPECT_EQ(problem.resolution.ds, fresh.resolution.ds);
  EXPECT_EQ(problem.limits.tool_path_error, 0.001);
  EXPECT_EQ(problem.limits.edges, EdgeMode::kContinuous);
  EXPECT_FALSE(problem.limits.edge_clearance);
  EXPECT_FALSE(problem.limits.self_clearance);
  EXPECT_FALSE(problem.start);
  EXPECT_FALSE(problem.start_at);
  EXPECT_FALSE(problem.end);
  EXPECT_EQ(problem.start_tolerance, 1e-6);
  EXPECT_EQ(problem.cost.metric, CostMetric::kL2);
  EXPECT_TRUE(problem.scene.empty() && problem.vary.empty() && problem.hold.empty() &&
              problem.attached.empty());
}

TEST(ProblemFile, WhatMotionsKeep) {
  const ProblemFolder folder;
  const std::string waypoints = "waypoints: [{xyz: [0.6, -0.1, 0.9]}, {xyz: [0.6, 0.1, 0.9]}]";
  EXPECT_FALSE(folder.load({}).smooth);
  EXPECT_FALSE(folder.load({}).limits.joint_jerk);
  const PathProblem problem = folder.load(
      {{"path", "{smooth: {position: 0.0002}, " + waypoints + "}"},
       {"limits", "{joint_speed: 2, joint_acceleration: [1, 2, 3, 4, 5, 6, 7], joint_jerk: null}"},
       {"refine", "{smoothing: 0.02, joint_margin: 0.03, singular_margin: 0.04}"}});
  ASSERT_TRUE(problem.smooth && problem.limits.joint_speed && problem.limits.joint_acceleration);
  EXPECT_EQ(problem.smooth->position, 0.0002);
  EXPECT_EQ(problem.smooth->angle, PathSmoothing{}.angle);
  EXPECT_EQ((*problem.limits.joint_speed)[6], 2);
  EXPECT_EQ((*problem.limits.joint_acceleration)[6], 7);
  EXPECT_FALSE(problem.limits.joint_jerk);
  EXPECT_EQ(problem.refinement.smoothing, 0.02);
  EXPECT_EQ(problem.refinement.joint_margin, 0.03);
  EXPECT_EQ(problem.refinement.singular_margin, 0.04);
  const PathProblem sharp = folder.load({{"path", "{smooth: null, " + waypoints + "}"}});
  ASSERT_TRUE(sharp.smooth);
  EXPECT_EQ(sharp.smooth->position, 0);
  EXPECT_EQ(sharp.smooth->angle, 0);
}

TEST(ProblemFile, RollOfTheTool) {
  const ProblemFolder folder;
  const std::string waypoints = "waypoints: [{xyz: [0.6, -0.1, 0.9]}, {xyz: [0.6, 0.1, 0.9]}]";
  EXPECT_FALSE(folder.load({}).roll);
  EXPECT_FALSE(folder.load({}).cost.weights);
  const PathProblem free = folder.load({{"path", "{roll: free, " + waypoints + "}"}});
  ASSERT_TRUE(free.roll);
  EXPECT_EQ(*free.roll, Roll{});
  EXPECT_FALSE(free.cost.weights);
  EXPECT_EQ(free.limits.roll_slope, 20);
  const PathProblem some = folder.load({{"path", "{roll: [-0.5, 1], " + waypoints + "}"},
                                        {"limits", "{roll_slope: 7}"},
                                        {"cost", "{weights: [1, 1, 1, 1, 1, 1, 0.3]}"}});
  ASSERT_TRUE(some.roll);
  EXPECT_EQ(some.roll->lower, -0.5);
  EXPECT_EQ(some.roll->upper, 1);
  EXPECT_EQ(some.limits.roll_slope, 7);
  EXPECT_EQ(some.cost.weights->back(), 0.3);
}

/// A problem of two waypoints with windows of the roll.
struct RollWindows {
  /// Loads the problem; the texts are path.roll with its comma and what follows xyz of the
  /// waypoints.
  [[nodiscard]] PathProblem load(const char* roll, const char* first, const char* second) const {
    return folder.load({{"path", std::string("{") + roll + "waypoints: [{xyz: [0.6, -0.1, 0.9]" +
                                     first + "}, {xyz: [0.6, 0.1, 0.9]" + second + "}]}"}});
  }

  ProblemFolder folder;
};

TEST(ProblemFile, WindowsOfTheRoll) {
  const RollWindows windows;
  // Windows of waypoints are cut to path.roll, which is cut to what they leave of it.
  const PathProblem cut =
      windows.load("roll: [-0.5, 1], ", ", roll: [-2, 0.1]", ", roll: [0.2, 0.2]");
  EXPECT_EQ(cut.waypoints[0].roll, Roll(-0.5, 0.1));
  EXPECT_EQ(cut.waypoints[1].roll, Roll(0.2, 0.2));
  EXPECT_EQ(*cut.roll, Roll(-0.5, 0.2));
  EXPECT_EQ(*windows.load("roll: free, ", ", roll: [-2, 0.1]", ", roll: [0.2, 3]").roll,
            Roll(-2, 3));
  // What allows a whole turn at one waypoint allows no circle.
  const PathProblem whole = windows.load("roll: free, ", ", roll: [-4, 4]", ", roll: [0.2, 0.2]");
  EXPECT_FALSE(whole.roll->circle());
  EXPECT_NEAR(whole.roll->upper, kPi, 1e-5);
  EXPECT_FALSE(windows.load("roll: free, ", "", "").waypoints[0].roll);
}

TEST(ProblemFile, BadWindowsOfTheRollAreRefused) {
  const RollWindows windows;
  const auto refused = [&](const char* roll, const char* first, const char* second,
                           const std::vector<std::string>& words) {
    expect_message(input_error([&] { return windows.load(roll, first, second); }), words);
  };
  refused("", ", roll: [-2, 0.1]", ", roll: [0, 1]",
          {"path.waypoints", "the roll is not free", "path.roll"});
  refused("roll: free, ", ", roll: [-2, 0.1]", "", {"path.waypoints[1]", "some waypoints alone"});
  refused("roll: free, ", ", roll: [0.2, 0.1]", ", roll: [0, 1]",
          {"path.waypoints[0].roll", "lower <= upper"});
  refused("roll: free, ", ", roll: [0.2]", ", roll: [0, 1]",
          {"path.waypoints[0].roll", "2 numbers"});
  refused("roll: [0, 1], ", ", roll: [0.2, 0.5]", ", roll: [1.2, 1.5]",
          {"path.waypoints", "waypoint 1 (from 0)", "path.roll"});
  refused("roll: free, ", ", roll: [-2, -1]", ", roll: [4, 5]",
          {"path.waypoints", "-2 to 5", "less than a turn"});
  refused("roll: free, ", ", roll: [1, 1]", ", roll: [1, 1]", {"path.waypoints", "more than one"});
}

TEST(ProblemFile, WindowsOfTheRollInATable) {
  const RollWindows windows;
  const ProblemFolder& folder = windows.folder;
  const PathProblem cut =
      windows.load("roll: [-0.5, 1], ", ", roll: [-2, 0.1]", ", roll: [0.2, 0.2]");
  folder.folder().write("problems/turns.csv",
                        "x,y,z,qw,qx,qy,qz,roll_min,roll_max\n0.6,-0.1,0.9,1,0,0,0,-2,0.1\n0.6,0.1,"
                        "0.9,1,0,0,0,0.2,0.2\n");
  const PathProblem file = folder.load({{"path", "{roll: [-0.5, 1], file: turns.csv}"}});
  EXPECT_EQ(file.waypoints, cut.waypoints);
  EXPECT_EQ(*file.roll, *cut.roll);
  expect_message(input_error([&] {
                   return folder.load({{"path", "{file: turns.csv}"}});
                 }),
                 {"path.file", "the roll is not free"});
  folder.folder().write(
      "problems/turns.csv",
      "x,y,z,qw,qx,qy,qz,roll_min,roll_max\n0,0,0,1,0,0,0,0,1\n1,0,0,1,0,0,0,1,0\n");
  expect_message(
      input_error([&] {
        return folder.load({{"path", "{roll: free, file: turns.csv}"}});
      }),
      {"turns.csv:3: data row 2", "roll_min,roll_max: is empty", "roll_min <= roll_max"});
  folder.folder().write("problems/turns.csv",
                        "x,y,z,qw,qx,qy,qz,roll_min\n0,0,0,1,0,0,0,0\n1,0,0,1,0,0,0,1\n");
  expect_message(input_error([&] {
                   return folder.load({{"path", "{roll: free, file: turns.csv}"}});
                 }),
                 {"turns.csv:1", "roll_max"});
}

TEST(ProblemFile, RollCost) {
  const ProblemFolder folder;
  const std::string waypoints = "waypoints: [{xyz: [0.6, -0.1, 0.9]}, {xyz: [0.6, 0.1, 0.9]}]";
  EXPECT_EQ(folder.load({}).cost.roll, 0);
  EXPECT_EQ(folder.load({{"cost", "{roll: 0}"}}).cost.roll, 0);
  EXPECT_EQ(
      folder.load({{"path", "{roll: free, " + waypoints + "}"}, {"cost", "{roll: 2.5}"}}).cost.roll,
      2.5);
  expect_message(
      input_error([&] {
        return folder.load({{"path", "{roll: free, " + waypoints + "}"}, {"cost", "{roll: 1e-7}"}});
      }),
      {"cost.roll", "1e-6"});
}

TEST(ProblemFile, ArmSlopeIsForArmsWithAnArmAngle) {
  const ProblemFolder folder;
  EXPECT_EQ(folder.load({{"limits", "{arm_slope: 20}"}}).limits.arm_slope, 20);
  std::string bent = arm_urdf();
  const std::size_t at = bent.rfind("0 0 0.2");
  bent.replace(at, 7, "0.1 0 0");
  folder.folder().write("robots/bent.urdf", bent);
  const std::string robot = "{urdf: ../robots/bent.urdf, base_link: base_link, tip_link: link_7}";
  EXPECT_EQ(folder.load({{"robot", robot}}).limits.arm_slope, 20);
  // Its default as well: what is given does nothing.
  for (const char* const slope : {"20", "7"})
    expect_message(input_error([&] {
                     return folder.load(
                         {{"robot", robot}, {"limits", std::string("{arm_slope: ") + slope + "}"}});
                   }),
                   {"problem.yaml:1: limits.arm_slope", "no arm angle", "allowed is no such key"});
}

/// As for arm_slope: a key that no lattice of the arm reads is given in vain.
TEST(ProblemFile, KeysOfAnArmAngleAreForArmsThatHaveOne) {
  const ProblemFolder folder;
  EXPECT_EQ(folder.load({{"resolution", "{dphi: 0.1, arcs: true}"}}).resolution.dphi, 0.1);
  std::string bent = arm_urdf();
  bent.replace(bent.rfind("0 0 0.2"), 7, "0.1 0 0");
  folder.folder().write("robots/bent.urdf", bent);
  const std::string robot = "{urdf: ../robots/bent.urdf, base_link: base_link, tip_link: link_7}";
  const auto load = [&](const std::string& section, const std::string& text) {
    return folder.load({{"robot", robot}, {section, text}});
  };
  EXPECT_EQ(load("resolution", "{arc: 0.1}").resolution.arc, 0.1);
  for (const char* const key : {"dphi: 0.05", "arcs: true", "arcs: false"})
    expect_message(
        input_error([&] { return load("resolution", std::string("{ds: 0.1,\n ") + key + "}"); }),
        {std::string("problem.yaml:3: resolution.") + std::string(key, 4), "no arm angle",
         "allowed is no such key"});
  expect_message(input_error([&] { return load("limits", "{step_error: 0.1}"); }),
                 {"problem.yaml:1: limits.step_error", "no arm angle"});
}

/// Loads a problem file with every key.
PathProblem load_every_key(const ProblemFolder& folder) {
  return folder.load({
      {"robot", R"(
  urdf: ../robots/arm.urdf
  srdf: ../robots/arm.srdf
  packages: {some_package: ..}
  base_link: base_link
  tip_link: link_7
  tool: {xyz: [0, 0, 0.1], rpy: [0.1, 0.2, 0.3]}
  hold: {finger_joint: 0.01}
  attached:
    - {name: grinder, mesh: box.stl, scale: 0.001, xyz: [0, 0, 1], link: finger}
    - {name: grip, sphere: 0.05})"},
      {"scene", R"(
  - {name: table, box: [1, 1, 0.05], xyz: [0.6, 0, 0.4], rpy: [0, 0, 0]}
  - {name: post, cylinder: {radius: 0.05, length: 0.8}}
  - {name: ball, sphere: {radius: 0.2}, allow: {grip: 0.02}}
  - {name: rod, capsule: {radius: 0.05, length: 0.8}}
  - {name: door, mesh: box.stl, scale: [1, -1, 1], quat: [2, 0, 0, 0], allow: [grinder, link_7]})"},
      {"path",
       "{frame: door, waypoints: [{xyz: [0.6, -0.1, 0.9], rpy: [0, -1.5707963, 0]}, {xyz: [0, 0, "
       "1], quat: [0.9995, 0, 0, 0]}], end: {joints: [7, 6, 5, 4, 3, 2, 1]}}"},
      {"resolution", "{ds: 0.01, dphi: 0.2, dalpha: 0.3, arcs: true}"},
      {"limits",
       "{clearance: 0.01, self_clearance: 0.002, manipulability: 0.02, joint_margin: 0.03, "
       "joint_step: 0.4, arm_slope: 5, "
       "step_error: 0.6, "
       "tool_path_error: null, "
       "tool_angle_error: 0.8, tool_speed: 0.9, tool_turn_speed: 1, edges: nodes, edge_clearance: "
       "0, edge_tolerance: 0.001}"},
      {"start", "{joints: [1, 2, 3, 4, 5, 6, 7]}"},
      {"start_at", "0.25"},
      {"start_tolerance", "0.002"},
      {"cost", "{metric: time, weights: [1, 2, 3, 4, 5, 6, 0]}"},
      {"vary", "[{object: door, xyz: [0.1, 0.2, 0.3]}, {object: ball, rpy: [0, 0, 1]}]"},
  });
}

TEST(ProblemFile, EveryKey) {
  const ProblemFolder folder;
  const PathProblem problem = load_every_key(folder);
  EXPECT_TRUE(problem.model->has_srdf);
  EXPECT_EQ(problem.tool.translation(), Vector3d(0, 0, 0.1));
  const Matrix3d tool =
      (Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) * Eigen::AngleAxisd(0.2, Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.1, Vector3d::UnitX()))
          .toRotationMatrix();
  EXPECT_TRUE(problem.tool.linear().isApprox(tool, 1e-14));
  EXPECT_EQ(problem.hold.at("finger_joint"), 0.01);
  ASSERT_EQ(problem.attached.size(), 2u);
  EXPECT_EQ(problem.attached[0].link, "finger");
  EXPECT_NEAR(volume(*std::get<MeshPtr>(problem.attached[0].shape)), 6e-9, 1e-20);
  EXPECT_EQ(problem.attached[1].link, "link_7");
  EXPECT_EQ(std::get<Sphere>(problem.attached[1].shape).radius, 0.05);
  ASSERT_EQ(problem.scene.size(), 5u);
  EXPECT_EQ(std::get<Box>(problem.scene[0].shape).size, Vector3d(1, 1, 0.05));
  EXPECT_EQ(problem.scene[0].pose.translation(), Vector3d(0.6, 0, 0.4));
  EXPECT_EQ(std::get<Cylinder>(problem.scene[1].shape).length, 0.8);
  EXPECT_EQ(std::get<Sphere>(problem.scene[2].shape).radius, 0.2);
  EXPECT_EQ(std::get<Capsule>(problem.scene[3].shape).radius, 0.05);
  EXPECT_DOUBLE_EQ(volume(*std::get<MeshPtr>(problem.scene[4].shape)), 6);
  EXPECT_TRUE(problem.scene[4].pose.isApprox(Pose::Identity()));
  EXPECT_EQ(problem.scene[4].allow, (std::vector<Allowed>{{"grinder"}, {"link_7"}}));
  EXPECT_EQ(problem.scene[2].allow, (std::vector<Allowed>{{"grip", 0.02}}));
  EXPECT_EQ(problem.path_frame, "door");
  EXPECT_EQ(problem.waypoints[1].orientation.w(), 0.9995);
  EXPECT_EQ(problem.resolution.dalpha, 0.3);
  EXPECT_TRUE(problem.resolution.arcs);
  const Limits& limits = problem.limits;
  EXPECT_EQ(limits.clearance, 0.01);
  EXPECT_EQ(limits.joint_step, 0.4);
  EXPECT_EQ(limits.arm_slope, 5);
  EXPECT_EQ(limits.step_error, 0.6);
  EXPECT_FALSE(limits.tool_path_error);
  EXPECT_EQ(limits.tool_angle_error, 0.8);
  EXPECT_EQ(limits.tool_turn_speed, 1);
  EXPECT_EQ(limits.edges, EdgeMode::kNodes);
  EXPECT_EQ(limits.edge_clearance, 0);
  EXPECT_EQ(limits.self_clearance, 0.002);
  EXPECT_EQ(limits.edge_tolerance, 0.001);
  ASSERT_TRUE(problem.start);
  EXPECT_EQ((*problem.start)[6], 7);
  EXPECT_EQ(problem.start_at, 0.25);
  EXPECT_EQ(problem.start_tolerance, 0.002);
  ASSERT_TRUE(problem.end);
  EXPECT_EQ((*problem.end)[0], 7);
  EXPECT_EQ(problem.cost.metric, CostMetric::kTime);
  EXPECT_EQ((*problem.cost.weights)[5], 6);
  ASSERT_EQ(problem.vary.size(), 2u);
  EXPECT_EQ(problem.vary[0].xyz, Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(problem.vary[1].rpy, Vector3d(0, 0, 1));
}

/// Returns the problem of data/problems/kr6_weld_pipe.yaml, an arm of six joints, with an end.
PathProblem kr6_problem(const fs::path& folder, const std::string& joints) {
  const std::string data = SWIVEL_DATA_DIR;
  std::ostringstream read;
  read << std::ifstream(fs::path(data) / "problems" / "kr6_weld_pipe.yaml").rdbuf();
  std::string text = read.str();
  for (std::size_t at = 0; (at = text.find("../", at)) != std::string::npos;)
    text.replace(at, 2, data);
  const std::string roll = "roll: free";
  const std::size_t at = text.find(roll);
  text.insert(at + roll.size(), "\n  end: {joints: [" + joints + "]}");
  const fs::path file = folder / "kr6.yaml";
  write_file(file, text);
  return load_path_problem(file);
}

/// Of an arm of six joints the roll may be left out of an end: it is that of the last waypoint.
TEST(ProblemFile, EndOfSixJoints) {
  const ProblemFolder folder;
  const fs::path place = folder.write({}).parent_path();
  for (const char* six : {"0, -1.4, 1.5, 0, 0.6, 0", "0.4, -1.2, 1.3, 0.7, -0.9, 2"}) {
    const PathProblem problem = kr6_problem(place, six);
    ASSERT_TRUE(problem.end);
    const Chain chain = build_arm(*problem.model, problem.base_link, problem.tip_link, {},
                                  problem.tool, problem.roll)
                            .chain;
    Pose wanted = Pose::Identity();
    wanted.linear() = given_waypoints_in_base(problem).back().orientation.toRotationMatrix();
    EXPECT_NEAR(roll_between(wanted, chain.tool(*problem.end)), 0, 1e-9) << six;
    const std::string seven = std::string(six) + ", 0.25";
    EXPECT_EQ((*kr6_problem(place, seven).end)[6], 0.25);
  }
  const std::string message = input_error([&] { (void)kr6_problem(place, "0, -1.4, 1.5"); });
  EXPECT_NE(message.find("path.end.joints: has 3 entries"), std::string::npos) << message;
}

/// Returns a path with three waypoints, of which the last is to be the first, and more keys.
ProblemFolder::Sections closed_path(const std::string& last, const std::string& more = "") {
  return {{"path", "{closed: true, waypoints: [{xyz: [0.6, 0, 0.9]}, {xyz: [0.6, 0.1, 0.9]}, " +
                       last + "]" + more + "}"}};
}

TEST(ProblemFile, ClosedPaths) {
  const ProblemFolder folder;
  const std::string first = "{xyz: [0.6, 0, 0.9]}", seven = "{joints: [0, 0, 0, 0, 0, 0, 1]}";
  EXPECT_FALSE(folder.load({}).closed);
  EXPECT_TRUE(folder.load(closed_path(first)).closed);
  EXPECT_TRUE(folder.load(closed_path("{xyz: [0.6, 5e-7, 0.9], quat: [-1, 0, 0, 0]}")).closed);
  ProblemFolder::Sections pinned = closed_path(first, ", end: " + seven);
  pinned["start"] = seven;
  EXPECT_TRUE(folder.load(pinned).closed);
  struct Case {
    ProblemFolder::Sections sections;
    std::vector<std::string> needles;
  };
  std::vector<Case> cases{
      {closed_path("{xyz: [0.6, 2e-6, 0.9]}"),
       {"path.closed: is true, but the last waypoint is 2e-06 m and 0 rad from the first",
        "at most 1e-6 m and 1e-6 rad"}},
      {closed_path("{xyz: [0.6, 0, 0.9], rpy: [0, 0, 0.5]}"), {"path.closed", "0.5 rad"}},
      {closed_path(first, ", end: " + seven), {"path.closed: is given beside `start` or `end`"}},
      {closed_path(first), {"path.closed: is given beside `start` or `end`", "neither, or both"}},
      {pinned, {"path.closed: is given beside `start_at`", "one of the two"}},
  };
  cases[3].sections["start"] = seven;
  cases[4].sections["start_at"] = "0.05";
  for (const Case& one : cases)
    expect_message(input_error([&] { (void)folder.load(one.sections); }), one.needles);
  const std::string data = SWIVEL_DATA_DIR;
  const std::string windows =
      "robot: {urdf: " + data +
      "/robots/kr6_like.urdf, base_link: base_link, tip_link: flange}\n"
      "path: {closed: true, roll: free, waypoints: [{xyz: [0.6, 0, 0.9], roll: [0, 1]}, "
      "{xyz: [0.6, 0.1, 0.9], roll: [0, 1]}, {xyz: [0.6, 0, 0.9], roll: [0, 2]}]}\n";
  expect_message(input_error([&] {
                   (void)load_path_problem(folder.folder().write("problems/w.yaml", windows));
                 }),
                 {"w.yaml:2: path.closed", "the last waypoint allows other rolls than the first"});
}

TEST(ProblemFile, SectionsWithEverythingCommentedOut) {
  const ProblemFolder folder;
  const PathProblem problem = folder.load({{"limits", "# {}"},
                                           {"scene", "null"},
                                           {"resolution", "~"},
                                           {"start", "null"},
                                           {"vary", "[]"},
                                           {"cost", "{}"}});
  EXPECT_EQ(problem.limits.joint_step, 0.5);
  EXPECT_FALSE(problem.start);
}

TEST(ProblemFile, NamesAreRelativeToTheFileWhereverItIsReadFrom) {
  const ProblemFolder folder;
  (void)folder.write({});
  const fs::path before = fs::current_path();
  fs::current_path(folder.folder().path() / "problems");
  EXPECT_NO_THROW((void)load_path_problem("problem.yaml"));
  fs::current_path(before);
}

TEST(ProblemFile, OneMeshForManyObjects) {
  const ProblemFolder folder;
  const PathProblem problem =
      folder.load({{"scene", "[{name: a, mesh: box.stl}, {name: b, mesh: ./box.stl, scale: 1}]"}});
  EXPECT_EQ(std::get<MeshPtr>(problem.scene[0].shape), std::get<MeshPtr>(problem.scene[1].shape));
}

/// Six numbers for six joints: the seventh is the roll.
TEST(ProblemFile, ListsOfASixJointArmSayThatTheSeventhIsTheRoll) {
  const ProblemFolder folder;
  const ProblemFolder::Sections six = {
      {"robot", "{urdf: ../robots/arm.urdf, base_link: base_link, tip_link: link_6}"},
      {"path", "{file: weld.csv, roll: free}"}};
  EXPECT_TRUE(folder.load(six).roll);
  for (const auto& [section, text, key] :
       {std::tuple("start", "{joints: [0, 0, 0, 0, 0, 0]}", "start.joints"),
        std::tuple("cost", "{weights: [1, 1, 1, 1, 1, 1]}", "cost.weights"),
        std::tuple("limits", "{joint_speed: [1, 1, 1, 1, 1, 1]}", "limits.joint_speed"),
        std::tuple("limits", "{joint_jerk: [1, 1, 1, 1, 1, 1]}", "limits.joint_jerk")}) {
    ProblemFolder::Sections changes = six;
    changes[section] = text;
    const std::string message = input_error([&] { (void)folder.load(changes); });
    expect_message(message, {key, "6 entries", "seventh for the roll of the tool"});
  }
  ProblemFolder::Sections seven = ProblemFolder::good();
  seven["start"] = "{joints: [0, 0, 0, 0, 0, 0]}";
  EXPECT_EQ(input_error([&] { (void)folder.load(seven); }).find("roll"), std::string::npos);
}

}  // namespace
}  // namespace swivel::io::test
