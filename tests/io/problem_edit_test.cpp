// SPDX-License-Identifier: BSD-3-Clause
// A placement as a problem file: only the pose is changed, and it reads back as it was planned.
#include <yaml-cpp/yaml.h>

#include <map>

#include "problem_support.hpp"
#include "swivel/core/base/rpy.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/study/placement.hpp"
#include "swivel/io/problems/problem.hpp"
#include "swivel/io/tables/placement.hpp"

namespace swivel::io::test {
namespace {

const Offset kMoved{0.05, 0, -0.1, 0, 0, 0}, kTurned{0.05, 0.2, 0, 0.1, 0.2, 0.3};

struct Edited {
  std::string before, after;
  PathProblem wanted, read;
};

Edited edited(const ProblemFolder& folder, const std::string& scene, const Offset& offset,
              const Movable& thing = {Movable::Kind::kObject, "part"},
              const std::string& path = "{file: weld.csv}") {
  const fs::path file = folder.write({{"scene", scene}, {"path", path}});
  const PathProblem problem = load_path_problem(file);
  Edited result{TempFolder::read(file), "", placed_problem(problem, thing, offset), {}};
  result.after = with_poses(result.before, problem, result.wanted);
  result.read = load_path_problem(folder.folder().write("problems/placed.yaml", result.after));
  return result;
}

TEST(WithPoses, ReadsBackBitForBitAndKeepsTheRest) {
  const ProblemFolder folder;
  const std::vector<std::string> scenes{
      "\n  # ünïcode: xyz: [1, 2, 3]\n  - {name: post, sphere: 0.1, xyz: [0.1, 0.2, 0.3]}\n  - "
      "{name: part, sphere: 0.1, xyz: "
      "[0.76, 0.27, 0.90], rpy: [0, 0, "
      "-1.5707963267948966]}  # the part",
      "\n  - name: part   # stands on the table\n    sphere: 0.1\n    xyz:\n      - 0.76  # "
      "across\n      - 0.27\n      - 0.9\n    "
      "rpy: [0.1, 0.2,\n          0.3]",
      "\n  - name: part\n    box: [0.1, 0.1, 0.2]",
      "[{name: part, sphere: 0.1}, {name: post, sphere: 0.1}]",
      "[{name: part, sphere: 0.1, xyz: [1, 2, 3]}]",
      "[{name: part, sphere: 0.1, xyz: }]",
      "[{name: shelf, sphere: 0.1, frame: link_2}, {name: part, sphere: 0.1}]",
      "\n  - name: part\n    sphere: 0.1\n    quat:\n      - 0.5\n      - 0.5\n      - 0.5\n      "
      "- 0.5",
      "\n  - {quat: [0.5, 0.5, 0.5, 0.5], name: part, sphere: 0.1}",
      "\n  - {sphere: 0.1, name: 'part', xyz: [1e-3, +.2, 3]}",
  };
  int turned = 0;
  for (const std::string& scene : scenes)
    for (const Offset& offset : {kMoved, kTurned, Offset{}, Offset{0, 0, 0, 0, 0.3, 0}}) {
      const Edited e = edited(folder, scene, offset);
      ASSERT_EQ(e.read.scene.size(), e.wanted.scene.size());
      for (std::size_t k = 0; k < e.read.scene.size(); ++k)
        EXPECT_EQ(e.read.scene[k].pose.matrix(), e.wanted.scene[k].pose.matrix()) << e.after;
      EXPECT_EQ(e.after == e.before, offset == Offset{}) << e.after;
      // Every comment is still there.
      for (const char* const comment :
           {"# ünïcode: xyz: [1, 2, 3]", "# the part", "# stands on the table", "# across"})
        EXPECT_EQ(e.before.find(comment) == std::string::npos,
                  e.after.find(comment) == std::string::npos)
            << e.after;
      turned += offset[4] != 0;
    }
  EXPECT_EQ(turned, 20);
  const Edited e = edited(folder, scenes[0], kMoved);
  EXPECT_NE(e.after.find("{name: part, sphere: 0.1, xyz: [0.81, 0.27, 0.8], rpy: [0, 0, "
                         "-1.5707963267948966]}  # the part"),
            std::string::npos)
      << e.after;
}

TEST(WithPoses, LineEndsAndByteOrderMarksStay) {
  const ProblemFolder folder;
  for (const std::string& head :
       {std::string("# häder\r\n"), std::string("\xef\xbb\xbf# häder\n")}) {
    const fs::path file = folder.folder().write(
        "problems/p.yaml",
        head +
            "robot: {urdf: ../robots/arm.urdf, base_link: base_link, tip_link: link_7}\r\npath: "
            "{file: "
            "weld.csv}\r\nscene:\r\n  - {name: part, sphere: 0.1, xyz: [1, 2, 3]}  # ö\r\n");
    const PathProblem problem = load_path_problem(file),
                      wanted = placed_problem(problem, {Movable::Kind::kObject, "part"}, kMoved);
    std::string expected = TempFolder::read(file);
    expected.replace(expected.find("[1, 2, 3]"), 9, "[1.05, 2, 2.9]");
    EXPECT_EQ(with_poses(TempFolder::read(file), problem, wanted), expected);
  }
}

TEST(WithPoses, TheBaseMovesAllObjects) {
  const ProblemFolder folder;
  const std::string scene =
      "\n  - {name: part, sphere: 0.1, xyz: [1, 2, 3]}\n  - {name: post, sphere: 0.1, rpy: [0, 0, "
      "1]} # post";
  const Edited e =
      edited(folder, scene, kTurned, {Movable::Kind::kBase, ""}, "{frame: part, file: weld.csv}");
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_EQ(e.read.scene[k].pose.matrix(), e.wanted.scene[k].pose.matrix()) << e.after;
  EXPECT_EQ(e.read.waypoints, e.wanted.waypoints);
  EXPECT_NE(e.after.find(" # post"), std::string::npos);
}

TEST(WithPoses, RefusesWhatItCannotChangeInPlace) {
  const ProblemFolder folder;
  const auto refused = [&](const std::string& scene, const Offset& offset,
                           const Movable& thing = {Movable::Kind::kObject, "part"}) {
    const std::string message =
        input_error([&] { static_cast<void>(edited(folder, scene, offset, thing)); });
    EXPECT_NE(message.find("problem.yaml"), std::string::npos) << message;
    EXPECT_NE(message.find("allowed is"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  };
  refused("[{name: post, sphere: 0.1, xyz: &p [1, 2, 3]}, {name: part, sphere: 0.1, xyz: *p}]",
          kMoved);
  refused("[{name: part, sphere: 0.1}]", kMoved, {Movable::Kind::kPath, ""});
  refused("[{name: part, sphere: 0.1}]", kMoved, {Movable::Kind::kBase, ""});
}

/// Positions of joints are changed in place, or put in, and nothing else is.
TEST(WithPoses, HoldsJoints) {
  const ProblemFolder folder;
  const std::string head =
      "robot: {urdf: ../robots/arm.urdf, base_link: base_link, tip_link: link_7";
  const std::map<std::string, double> wanted{{"a", 0.30000000000000004}, {"b: c", -2e-3}};
  const auto written = [&](const std::string& robot) {
    const std::string text = "# head\n" + robot + "\npath: {file: weld.csv}  # path\n";
    PathProblem problem;
    problem.source = "problem.yaml";
    const YAML::Node held = YAML::Load(text)["robot"]["hold"];
    for (const auto& entry : held) problem.hold[entry.first.Scalar()] = entry.second.as<double>();
    PathProblem placed = problem;
    for (const auto& [joint, position] : wanted) placed.hold[joint] = position;
    const std::string after = with_poses(text, problem, placed);
    std::map<std::string, double> said;
    for (const auto& entry : YAML::Load(after)["robot"]["hold"])
      said[entry.first.Scalar()] = entry.second.as<double>();
    EXPECT_EQ(said, placed.hold) << after;
    EXPECT_EQ(after.find("# head\n"), 0u) << after;
    EXPECT_NE(after.find("\npath: {file: weld.csv}  # path\n"), std::string::npos) << after;
    return after;
  };
  written(head + "}");
  written(head + ", hold: {a: 1, other: 2}}");
  written(head + ", hold: {'b: c': 1, a: 0.0}}");
  EXPECT_NE(written("robot:\n  urdf: u  # u\n  hold:  # held\n    a: 1  # one\n    z: 3")
                .find("    a: 0.30000000000000004  # one\n    z: 3"),
            std::string::npos);
  written("robot:\n  urdf: u\n  tool: {xyz: [0, 0, 1]}");
  written("robot: {urdf: u, hold: {a: \"1\", 'b: c': 1}}");
  written("robot: {urdf: u, hold: }");
}

TEST(Placements, Csv) {
  PlacementRow solved, blocked;
  solved.cell = 3;
  solved.offset = {0.1, -0.2, 0, 0, 0, 1e-3};
  solved.status = PlanStatus::kSolved;
  solved.cost = 2.5;
  solved.checked = true;
  solved.clearance = 0.01;
  solved.clearance_margin = 0.005;
  solved.tool_speed = 1;
  blocked.failed_s = 0.25;
  blocked.cause = "pair";
  blocked.by = "a, \"b\"";
  blocked.reason = "two\nlines";
  EXPECT_EQ(to_csv({solved, blocked}),
            "cell,x,y,z,roll,pitch,yaw,status,cost,clearance,clearance_margin,joint_margin,"
            "slide_margin,tool_speed,failed_s,cause,by,reason,checked\n"
            "3,0.1,-0.2,0,0,0,0.001,solved,2.5,0.01,0.005,,,1,,,,,true\n"
            "0,0,0,0,0,0,0,infeasible,,,,,,,0.25,pair,\"a, \"\"b\"\"\",two lines,\n");
  PlacementRow held = solved;
  held.hold = {{"torso", 0.3}, {"a, rail", -1}};
  held.slide_margin = 0.125;
  EXPECT_EQ(
      to_csv({held}),
      "cell,x,y,z,roll,pitch,yaw,\"hold.a, rail\",hold.torso,status,cost,clearance,"
      "clearance_margin,joint_margin,slide_margin,tool_speed,failed_s,cause,by,reason,checked\n"
      "3,0.1,-0.2,0,0,0,0.001,-1,0.3,solved,2.5,0.01,0.005,,0.125,1,,,,,true\n");
}

}  // namespace
}  // namespace swivel::io::test
