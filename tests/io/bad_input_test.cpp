// SPDX-License-Identifier: BSD-3-Clause
// One row for every way to get a problem file wrong: InputError, one line, with file, key and what
// is allowed.
#include "problem_support.hpp"

namespace swivel::io::test {
namespace {

struct Case {
  const char* name;
  const char* section;
  std::string text;
  std::vector<std::string> needles;
};

void PrintTo(const Case& c, std::ostream* stream) {
  *stream << c.name;
}

class BadProblem : public testing::TestWithParam<Case> {};

TEST_P(BadProblem, IsOneLineThatSaysWhatIsAllowed) {
  const ProblemFolder folder;
  const fs::path file = folder.write({{GetParam().section, GetParam().text}});
  const std::string message = input_error([&] { (void)load_path_problem(file); });
  expect_message(message, GetParam().needles);
  expect_message(message, {file.string() + ":"});
  const std::string prefix = file.string() + ":";
  EXPECT_EQ(message.find(prefix, prefix.size()), std::string::npos) << "named twice: " << message;
}

std::string object(const std::string& text) {
  return "[{name: a, " + text + "}]";
}
std::string waypoints(const std::string& second) {
  return "{waypoints: [{xyz: [0, 0, 0]}, " + second + "]}";
}

const Case kCases[] = {
    {"RobotMissing", "robot", "", {": robot", "missing"}},
    {"RobotNotAMap", "robot", "arm.urdf", {"robot", "map"}},
    {"RobotUnknownKey", "robot", robot_with("tip_lnk: x"), {"robot.tip_lnk", "'tip_link'"}},
    {"UrdfMissing", "robot", "{base_link: base_link, tip_link: link_7}", {"robot.urdf", "missing"}},
    {"UrdfAbsent",
     "robot",
     "{urdf: none.urdf, base_link: base_link, tip_link: link_7}",
     {"robot.urdf", "none.urdf"}},
    {"BaseMissing",
     "robot",
     "{urdf: ../robots/arm.urdf, tip_link: link_7}",
     {"robot.base_link", "missing"}},
    {"TipMissing",
     "robot",
     "{urdf: ../robots/arm.urdf, base_link: base_link}",
     {"robot.tip_link", "missing"}},
    {"TipUnknown",
     "robot",
     "{urdf: ../robots/arm.urdf, base_link: base_link, tip_link: hand}",
     {"robot.tip_link", "'hand'", "arm.urdf"}},
    {"BaseUnknown",
     "robot",
     "{urdf: ../robots/arm.urdf, base_link: world, tip_link: link_7}",
     {"robot.base_link", "'world'"}},
    {"SrdfAbsent", "robot", robot_with("srdf: none.srdf"), {"robot.srdf", "none.srdf"}},
    {"PackageFolderAbsent",
     "robot",
     robot_with("packages: {p: nowhere}"),
     {"robot.packages.p", "nowhere"}},
    {"PackagesNotAMap", "robot", robot_with("packages: [p]"), {"robot.packages", "map"}},
    {"HoldUnknownJoint", "robot", robot_with("hold: {elbow: 0}"), {"robot.hold.elbow", "'elbow'"}},
    {"HoldNotANumber",
     "robot",
     robot_with("hold: {finger_joint: open}"),
     {"robot.hold.finger_joint", "'open'", "number"}},
    {"HoldOutside",
     "robot",
     robot_with("hold: {finger_joint: 1e-9, joint_1: 0,\n  joint_9: 0}"),
     {"problem.yaml:3: robot.hold.joint_9", "'joint_9'"}},
    {"HoldBeyondItsLimits",
     "robot",
     robot_with("hold: {\n  finger_joint: 0.0400001}"),
     {"problem.yaml:3: robot.hold.finger_joint",
      "at 0.0400001 is outside its limits: allowed is 0 to 0.04"}},
    {"HoldJustBelowZero",
     "robot",
     robot_with("hold: {finger_joint: -2.5e-9}"),
     {"robot.hold.finger_joint", "at -2.5e-09 is outside its limits"}},
    {"HoldOfTheArm",
     "robot",
     robot_with("hold: {joint_3: 0, joint_4: 0}"),
     {"problem.yaml:2: robot.tip_link", "only 5 movable joints", "at least six"}},
    {"WithoutUnknown",
     "robot",
     robot_with("without: [finger,\n  thumb]"),
     {"problem.yaml:3: robot.without[1]", "unknown link 'thumb'"}},
    {"WithoutTheRoot",
     "robot",
     robot_with("without:\n  [base_link]"),
     {"problem.yaml:3: robot.without[0]", "carries all others"}},
    {"TipTooNear",
     "robot",
     "{urdf: ../robots/arm.urdf, base_link: base_link,\n  tip_link: link_3}",
     {"problem.yaml:3: robot.tip_link", "only 3 movable joints", "at least six"}},
    {"ToolNaN", "robot", robot_with("tool: {xyz: [0, 0, .nan]}"), {"robot.tool.xyz[2]", ".nan"}},
    {"ToolTwoRotations",
     "robot",
     robot_with("tool: {rpy: [0, 0, 0], quat: [1, 0, 0, 0]}"),
     {"robot.tool.quat", "rpy"}},
    {"AttachedLikeALink",
     "robot",
     robot_with("attached: [{name: link_3, sphere: 1}]"),
     {"robot.attached[0].name", "'link_3'"}},
    {"AttachedTwice",
     "robot",
     robot_with("attached: [{name: t, sphere: 1}, {name: t, sphere: 1}]"),
     {"robot.attached[1].name", "'t'"}},
    {"AttachedUnknownLink",
     "robot",
     robot_with("attached: [{name: t, sphere: 1, link: hand}]"),
     {"robot.attached[0].link", "'hand'"}},
    {"AttachedNoName",
     "robot",
     robot_with("attached: [{sphere: 1}]"),
     {"robot.attached[0].name", "missing"}},
    {"AttachedNotAList", "robot", robot_with("attached: {name: t}"), {"robot.attached", "list"}},
    {"PathMissing", "path", "", {": path", "missing"}},
    {"PathEmpty", "path", "{}", {"path", "exactly one of waypoints, file"}},
    {"PathBoth",
     "path",
     "{file: weld.csv, waypoints: [{xyz: [0, 0, 0]}, {xyz: [1, 0, 0]}]}",
     {"path.file", "exactly one"}},
    {"PathFrameUnknown",
     "path",
     "{frame: door, file: weld.csv}",
     {"path.frame", "'door'", "base_link"}},
    {"PathFileNotAName", "path", "{file: [weld.csv]}", {"path.file", "a list is not a name"}},
    {"UrdfNotAName",
     "robot",
     "{urdf: {file: arm.urdf}, base_link: base_link, tip_link: link_7}",
     {"robot.urdf", "a map is not a name"}},
    {"SrdfNotAName",
     "robot",
     robot_with("srdf: [arm.srdf]"),
     {"robot.srdf", "a list is not a name"}},
    {"MeshNotAName",
     "scene",
     "[{name: a, mesh: [box.stl]}]",
     {"scene[0].mesh", "a list is not a name"}},
    {"PathFileAbsent", "path", "{file: none.csv}", {"path.file", "none.csv"}},
    {"OneWaypoint", "path", "{waypoints: [{xyz: [0, 0, 0]}]}", {"path.waypoints", "two"}},
    {"WaypointWithoutPosition",
     "path",
     waypoints("{rpy: [0, 0, 0]}"),
     {"path.waypoints[1].xyz", "missing"}},
    {"WaypointShort",
     "path",
     waypoints("{xyz: [0, 0]}"),
     {"path.waypoints[1].xyz", "2 entries", "3 numbers"}},
    {"WaypointZeroQuaternion",
     "path",
     waypoints("{xyz: [1, 0, 0], quat: [0, 0, 0, 0]}"),
     {"path.waypoints[1].quat"}},
    {"WaypointLongQuaternion",
     "path",
     waypoints("{xyz: [1, 0, 0], quat: [1.1, 0, 0, 0]}"),
     {"path.waypoints[1].quat", "1e-3"}},
    {"WaypointUnknownKey",
     "path",
     waypoints("{xyz: [1, 0, 0], pry: [0, 0, 0]}"),
     {"path.waypoints[1].pry", "'rpy'"}},
    {"SceneNotAList", "scene", "{name: a}", {"scene", "list"}},
    {"ObjectNoName", "scene", "[{sphere: 1}]", {"scene[0].name", "missing"}},
    {"ObjectNoShape", "scene", "[{name: a}]", {"scene[0]", "exactly one of box, cylinder"}},
    {"ObjectTwoShapes",
     "scene",
     object("sphere: 1, box: [1, 1, 1]"),
     {"scene[0].sphere", "both given"}},
    {"ObjectTwice",
     "scene",
     "[{name: a, sphere: 1}, {name: a, sphere: 1}]",
     {"scene[1].name", "'a'"}},
    {"ObjectNamedLikeBase",
     "scene",
     "[{name: base_link, sphere: 1}]",
     {"scene[0].name", "base link"}},
    {"ObjectUnknownKey", "scene", object("spere: 1"), {"scene[0].spere", "'sphere'"}},
    {"BoxZero", "scene", object("box: [1, 0, 1]"), {"scene[0].box[1]", "> 0"}},
    {"BoxNumber", "scene", object("box: 1"), {"scene[0].box", "list of 3"}},
    {"SphereNegative", "scene", object("sphere: -1"), {"scene[0].sphere", "> 0"}},
    {"SphereInfinite",
     "scene",
     object("sphere: {radius: .inf}"),
     {"scene[0].sphere.radius", ".inf"}},
    {"CylinderNoLength",
     "scene",
     object("cylinder: {radius: 1}"),
     {"scene[0].cylinder.length", "missing"}},
    {"CapsuleNumber", "scene", object("capsule: 1"), {"scene[0].capsule", "map"}},
    {"CapsuleUnknownKey",
     "scene",
     object("capsule: {radius: 1, lenght: 1}"),
     {"scene[0].capsule.lenght", "'length'"}},
    {"MeshAbsent", "scene", object("mesh: none.stl"), {"scene[0].mesh", "none.stl"}},
    {"MeshScaleZero", "scene", object("mesh: box.stl, scale: 0"), {"scene[0].scale", "zero"}},
    {"ScaleWithoutMesh", "scene", object("sphere: 1, scale: 2"), {"scene[0].scale", "mesh"}},
    {"ObjectQuaternionZero", "scene", object("sphere: 1, quat: [0, 0, 0, 0]"), {"scene[0].quat"}},
    {"ObjectQuaternionShort",
     "scene",
     object("sphere: 1, quat: [1, 0, 0]"),
     {"scene[0].quat", "4 numbers"}},
    {"AllowUnknown", "scene", object("sphere: 1, allow: [hand]"), {"scene[0].allow[0]", "'hand'"}},
    {"AllowUnknownDeep",
     "scene",
     object("sphere: 1, allow: {hand: 0.01}"),
     {"scene[0].allow.hand", "'hand'"}},
    {"AllowDepthZero",
     "scene",
     object("sphere: 1, allow: {link_7: 0}"),
     {"scene[0].allow.link_7", "> 0"}},
    {"AllowDepthText",
     "scene",
     object("sphere: 1, allow: {link_7: deep}"),
     {"scene[0].allow.link_7", "'deep'"}},
    {"AllowDepthTwice",
     "scene",
     object("sphere: 1, allow: {link_7: 0.01, link_7: 0.02}"),
     {"scene[0].allow", "link_7"}},
    {"AllowDeeperThanCanBe",
     "scene",
     object("sphere: 1, allow: {link_7: 3}"),
     {"scene[0].allow.link_7", "no depth exceeds"}},
    {"AllowNotAList", "scene", object("sphere: 1, allow: link_7"), {"scene[0].allow", "list"}},
    {"ResolutionZero", "resolution", "{ds: 0}", {"resolution.ds", "> 0"}},
    {"ResolutionArcsOfNumbers",
     "resolution",
     "{arcs: 0.2}",
     {"resolution.arcs", "one of false, true"}},
    {"ResolutionNegative", "resolution", "{dalpha: -0.1}", {"resolution.dalpha", "> 0"}},
    {"ResolutionNull", "resolution", "{ds: null}", {"resolution.ds", "null", "> 0"}},
    {"ResolutionOverATurn", "resolution", "{dphi: 6.3}", {"resolution.dphi", "2*pi"}},
    {"ResolutionWord", "resolution", "{dphi: fine}", {"resolution.dphi", "'fine'"}},
    {"LimitsUnknownKey", "limits", "{clearence: 0.1}", {"limits.clearence", "'clearance'"}},
    {"LimitsNegative", "limits", "{clearance: -0.001}", {"limits.clearance", ">= 0"}},
    {"ClearanceOfMillimetres",
     "limits",
     "{joint_step: 1,\n  clearance: 5}",
     {"problem.yaml:2: limits.clearance",
      "is 5 m, and the arm reaches 1.2 m: are these millimetres?", "at most 1.2"}},
    {"SelfClearanceOfMillimetres",
     "limits",
     "{self_clearance: 2}",
     {"limits.self_clearance", "millimetres"}},
    {"EdgeClearanceOfMillimetres",
     "limits",
     "{edge_clearance: 2}",
     {"limits.edge_clearance", "millimetres"}},
    {"EdgeToleranceOfMillimetres",
     "limits",
     "{edge_tolerance: 0.5}",
     {"limits.edge_tolerance", "millimetres"}},
    {"ToolPathErrorOfMillimetres",
     "limits",
     "{tool_path_error: 1}",
     {"limits.tool_path_error", "is 1 m, and the arm reaches 1.2 m: are these millimetres?",
      "at most 0.3"}},
    {"ToolSpeedOfMillimetres",
     "limits",
     "{tool_speed: 250}",
     {"limits.tool_speed", "is 250 m/s", "millimetres"}},
    {"JointSpeedOfDegrees",
     "limits",
     "{joint_step: 1,\n  joint_speed: 180}",
     {"problem.yaml:2: limits.joint_speed", "is 180 rad/s: are these degrees?", "at most 50"}},
    {"TurnSpeedOfDegrees",
     "limits",
     "{tool_turn_speed: 90}",
     {"limits.tool_turn_speed", "is 90 rad/s: are these degrees?"}},
    {"ToolAngleErrorOfDegrees",
     "limits",
     "{tool_angle_error: 5}",
     {"limits.tool_angle_error", "is 5 rad: are these degrees?", "at most 3.14"}},
    {"JointStepOfDegrees",
     "limits",
     "{joint_step: 30}",
     {"limits.joint_step", "is 30 rad: are these degrees?", "at most 6.28"}},
    {"OrientationOfDegrees",
     "path",
     "{waypoints: [{xyz: [0.5, 0, 0.5]}, {xyz: [0.6, 0, 0.5],\n  rpy: [0, -90, 0]}]}",
     {"problem.yaml:2: path.waypoints[1].rpy", "is -90 rad: are these degrees?", "a turn"}},
    {"RollOfDegrees",
     "path",
     "{roll: [-30, 30], waypoints: [{xyz: [0.5, 0, 0.5]}, {xyz: [0.6, 0, 0.5]}]}",
     {"path.roll", "is -30 rad: are these degrees?"}},
    {"SelfMotionOfAnArmAngle",
     "resolution",
     "{ds: 0.01,\n  arc: 0.1}",
     {"problem.yaml:3: resolution.arc", "S-R-S", "no such key"}},
    {"RollStepWithoutRoll", "resolution", "{droll: 0.1}", {"resolution.droll", "no roll", "free"}},
    {"RollSlopeWithoutRoll", "limits", "{roll_slope: 9}", {"limits.roll_slope", "no roll is free"}},
    {"NumberInQuotes", "resolution", "{ds: \"0.01\"}", {"resolution.ds", "'0.01', in quotes"}},
    {"NumbersInQuotes",
     "start",
     "{joints: [1, 2, 3, '4', 5, 6, 7]}",
     {"start.joints[3]", "'4', in quotes"}},
    {"WordInQuotes",
     "lift",
     "{allowed: 'true'}",
     {"lift.allowed", "'true', in quotes", "true or false"}},
    {"SmoothOfMillimetres",
     "path",
     "{file: weld.csv, smooth: {position: 1}}",
     {"problem.yaml:1: path.smooth.position", "is 1 m", "millimetres"}},
    {"LimitsNaN", "limits", "{manipulability: .nan}", {"limits.manipulability", "finite"}},
    {"LimitsNull", "limits", "{joint_margin: null}", {"limits.joint_margin", ">= 0"}},
    {"JointStepZero", "limits", "{joint_step: 0}", {"limits.joint_step", "> 0"}},
    {"RollSlopeZero", "limits", "{roll_slope: 0}", {"limits.roll_slope", "> 0"}},
    {"RollWord", "path", "{roll: some, waypoints: []}", {"path.roll", "'some'", "free"}},
    {"RollMap", "path", "{roll: {}, waypoints: []}", {"path.roll", "a map", "free"}},
    {"RollEmpty", "path", "{roll: [1, 1], waypoints: []}", {"path.roll", "lower < upper"}},
    {"RollShort", "path", "{roll: [1], waypoints: []}", {"path.roll", "2 numbers"}},
    {"RollCostNegative", "cost", "{roll: -1}", {"cost.roll", ">= 0"}},
    {"RollCostWithoutRoll",
     "cost",
     "{roll: 1}",
     {"problem.yaml:1: cost.roll", "no roll is free", "beside path.roll"}},
    {"ArmSlopeZero", "limits", "{arm_slope: 0}", {"limits.arm_slope", "> 0"}},
    {"EdgeToleranceZero", "limits", "{edge_tolerance: 0}", {"limits.edge_tolerance", "> 0"}},
    {"SelfClearanceNegative", "limits", "{self_clearance: -1}", {"limits.self_clearance", ">= 0"}},
    {"EdgeClearanceNegative", "limits", "{edge_clearance: -1}", {"limits.edge_clearance", ">= 0"}},
    {"StepErrorZero", "limits", "{step_error: 0}", {"limits.step_error", "> 0"}},
    {"ToolPathErrorZero", "limits", "{tool_path_error: 0}", {"limits.tool_path_error", "> 0"}},
    {"ToolSpeedNegative", "limits", "{tool_speed: -1}", {"limits.tool_speed", "> 0"}},
    {"EdgesUnknown",
     "limits",
     "{edges: corners}",
     {"limits.edges", "'corners'", "continuous, nodes"}},
    {"JointSpeedZero", "limits", "{joint_speed: 0}", {"limits.joint_speed", "> 0"}},
    {"JointAccelerationOfSix",
     "limits",
     "{joint_acceleration: [1, 1, 1, 1, 1, 1]}",
     {"limits.joint_acceleration", "7"}},
    {"JointJerkWord", "limits", "{joint_jerk: fast}", {"limits.joint_jerk"}},
    {"RefineUnknown", "refine", "{smoothness: 0.01}", {"refine.smoothness", "smoothing"}},
    {"RefineNegative", "refine", "{smoothing: -1}", {"refine.smoothing", ">= 0"}},
    {"LimitTwice", "limits", "{joint_step: 1, joint_step: 2}", {"limits.joint_step", "twice"}},
    {"StartShort", "start", "{joints: [1, 2, 3]}", {"start.joints", "3 entries", "7 numbers"}},
    {"StartWord", "start", "{joints: [1, 2, 3, x, 5, 6, 7]}", {"start.joints[3]", "'x'"}},
    {"StartEmpty", "start", "{}", {"start.joints", "missing"}},
    {"StartAtAlone", "start_at", "0.1", {"start_at", "without start"}},
    {"StartToleranceAlone", "start_tolerance", "0.01", {"start_tolerance", "without start"}},
    {"StartAtNegative",
     "start",
     "{joints: [1, 2, 3, 4, 5, 6, 7]}\nstart_at: -0.1",
     {"start_at", "-0.1", ">= 0"}},
    {"StartAtWord",
     "start",
     "{joints: [1, 2, 3, 4, 5, 6, 7]}\nstart_at: half",
     {"start_at", "'half'"}},
    {"StartToleranceZero",
     "start",
     "{joints: [1, 2, 3, 4, 5, 6, 7]}\nstart_tolerance: 0",
     {"start_tolerance", "> 0"}},
    {"StartToleranceLarge",
     "start",
     "{joints: [1, 2, 3, 4, 5, 6, 7]}\nstart_tolerance: 0.11",
     {"start_tolerance", "at most 0.1"}},
    {"MetricUnknown", "cost", "{metric: l3}", {"cost.metric", "'l3'", "l2, l1, max, time"}},
    {"WeightsShort", "cost", "{weights: [1]}", {"cost.weights", "7 numbers"}},
    {"WeightNegative", "cost", "{weights: [1, 1, 1, 1, 1, 1, -1]}", {"cost.weights[6]", ">= 0"}},
    {"WeightInfinite",
     "cost",
     "{weights: [1, 1, 1, 1, 1, 1, .inf]}",
     {"cost.weights[6]", "finite"}},
    {"WeightTooLarge",
     "cost",
     "{weights: [1, 1, 1e160, 1, 1, 1, 1]}",
     {"cost.weights[2]", "1e-6 to 1e6"}},
    {"WeightTooSmall",
     "cost",
     "{weights: [1e-170, 1, 1, 1, 1, 1, 1]}",
     {"cost.weights[0]", "1e-6 to 1e6"}},
    {"VaryUnknownObject", "vary", "[{object: door}]", {"vary[0].object", "'door'"}},
    {"VaryNoObject", "vary", "[{xyz: [1, 1, 1]}]", {"vary[0].object", "missing"}},
    {"TopLevelUnknownKey", "limit", "{}", {": limit", "'limits'"}},
    {"NotYaml", "scene", "[{", {}},
};

INSTANTIATE_TEST_SUITE_P(Io, BadProblem, testing::ValuesIn(kCases),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(BadProblemFile, HalfWidths) {
  const ProblemFolder folder;
  const auto refusal = [&](const std::string& vary) {
    const fs::path file = folder.write({{"scene", object("sphere: 1")}, {"vary", vary}});
    return input_error([&] { (void)load_path_problem(file); });
  };
  expect_message(refusal("[{object: a, rpy: [0, -1, 0]}]"), {"vary[0].rpy[1]", ">= 0"});
  expect_message(refusal("[{object: a, rpy: [0, 0, 15]}]"),
                 {"vary[0].rpy", "is 15 rad: are these degrees?"});
}

TEST(BadProblemFile, ObjectNamedLikeAnAttachedBody) {
  const ProblemFolder folder;
  const fs::path file = folder.write(
      {{"robot", robot_with("attached: [{name: a, sphere: 1}]")}, {"scene", object("sphere: 1")}});
  expect_message(input_error([&] { (void)load_path_problem(file); }),
                 {"scene[0].name", "'a'", "attached"});
}

TEST(BadProblemFile, LineNumbers) {
  const ProblemFolder folder;
  const std::string head =
      "robot:\n  urdf: ../robots/arm.urdf\n  base_link: base_link\n  tip_link: link_7\npath:\n  "
      "file: weld.csv\n";
  const auto message = [&](const std::string& text) {
    const fs::path file = folder.folder().write("problems/problem.yaml", head + text);
    return input_error([&] { (void)load_path_problem(file); });
  };
  expect_message(message("limits:\n  clearance: 0\n  joint_stp: 1\n"),
                 {"problem.yaml:9: limits.joint_stp"});
  expect_message(message("scene:\n  - name: a\n    sphere: 1\n  - name: b\n    box:\n      - 1\n   "
                         "   - x\n      - 1\n"),
                 {"problem.yaml:13: scene[1].box[1]"});
  expect_message(message("cost: {metric: l2,\n  weights: 3}\n"), {"problem.yaml:8: cost.weights"});
  expect_message(message("scene: [\n"), {"problem.yaml:8"});
}

TEST(BadProblemFile, RowOfThePathFile) {
  const ProblemFolder folder;
  folder.folder().write("problems/weld.csv", "x,y,z,qw,qx,qy,qz\n0,0,0,1,0,0,0\n1,0,0,2,0,0,0\n");
  const fs::path file = folder.write({});
  expect_message(input_error([&] { (void)load_path_problem(file); }),
                 {"problem.yaml:1: path.file", "weld.csv:3: data row 2"});
}

TEST(BadProblemFile, NotOneDocument) {
  const ProblemFolder folder;
  for (const char* text : {"", "# nothing\n", "a: 1\n---\nb: 2\n", "[1, 2]\n", "word\n",
                           "? [a, b]\n: c\n", "&a [*a]\n", "\x01\x02\n", "robot: !!binary x\n"}) {
    SCOPED_TRACE(text);
    const fs::path file = folder.folder().write("problems/problem.yaml", text);
    expect_message(input_error([&] { (void)load_path_problem(file); }), {file.string()});
  }
  expect_message(
      input_error([&] { (void)load_path_problem(folder.folder().path() / "none.yaml"); }),
      {"none.yaml"});
  expect_message(input_error([&] { (void)load_path_problem(folder.folder().path()); }),
                 {folder.folder().path().string(), "folder"});
}

TEST(BadProblemFile, DeeplyNested) {
  const ProblemFolder folder;
  const fs::path file =
      folder.folder().write("problems/problem.yaml", "robot: " + std::string(100000, '['));
  expect_message(input_error([&] { (void)load_path_problem(file); }), {file.string()});
}

}  // namespace
}  // namespace swivel::io::test
