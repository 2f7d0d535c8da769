// SPDX-License-Identifier: BSD-3-Clause
// Limits and weights of joints by name, and MoveIt's joint_limits.yaml.
#include "problem_support.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel::io::test {
namespace {

/// Returns the arm's joint of a problem by number, from 1.
const Joint& joint_of(const PathProblem& problem, int number) {
  const int index = problem.model->find_joint("joint_" + std::to_string(number));
  return problem.model->joints.at(static_cast<std::size_t>(index));
}
PathProblem with_limits(const ProblemFolder& folder, const std::string& limits) {
  return folder.load({{"limits", limits}});
}
std::string refusal_of(const ProblemFolder& folder, const ProblemFolder::Sections& sections) {
  return input_error([&] { static_cast<void>(folder.load(sections)); });
}

TEST(JointLimits, AreNarrowedByName) {
  const ProblemFolder folder;
  const PathProblem problem =
      with_limits(folder, "{joints: {joint_5: [-1.5, 1.25], finger_joint: [0.01, 0.04]}}");
  EXPECT_EQ(-1.5, joint_of(problem, 5).lower);
  EXPECT_EQ(1.25, joint_of(problem, 5).upper);
  EXPECT_EQ(-2, joint_of(problem, 4).lower);
  EXPECT_EQ(2.5, joint_of(problem, 4).upper);
  const auto refused = [&](const std::string& limits, const std::vector<std::string>& words) {
    expect_message(refusal_of(folder, {{"limits", limits}}), words);
  };
  refused("{joints: {joint_5: [-2.1, 1]}}",
          {"problem.yaml", "joint_5", "reaches beyond the joint's limits", "[-2, 2.5]"});
  refused("{joints: {joint_5: [1, -1]}}", {"joint_5", "is empty", "lower < upper"});
  refused("{joints: {joint_8: [-1, 1]}}", {"unknown joint 'joint_8', nearest is 'joint_"});
  refused("{joints: {joint_5: [-1, 1, 2]}}", {"joint_5", "2"});
}

TEST(JointLimits, BoundAContinuousJoint) {
  const ProblemFolder folder;
  std::string urdf = arm_urdf();
  urdf.replace(urdf.find("revolute"), 8, "continuous");
  folder.folder().write("robots/arm.urdf", urdf);
  const PathProblem free = with_limits(folder, "{}"),
                    bounded = with_limits(folder, "{joints: {joint_1: [-7, 7]}}");
  EXPECT_EQ(Joint::Type::kContinuous, joint_of(free, 1).type);
  EXPECT_EQ(Joint::Type::kRevolute, joint_of(bounded, 1).type);
  EXPECT_EQ(-7, joint_of(bounded, 1).lower);
  EXPECT_EQ(7, joint_of(bounded, 1).upper);
}

TEST(JointLimits, MarginsMayBeByName) {
  const ProblemFolder folder;
  const PathProblem problem = with_limits(folder, "{joint_margin: {joint_2: 0.1, joint_3: 0.25}}");
  EXPECT_EQ(0, problem.limits.joint_margin);
  EXPECT_EQ(-1.9, joint_of(problem, 2).lower);
  EXPECT_EQ(2.25, joint_of(problem, 3).upper);
  EXPECT_EQ(0.3, with_limits(folder, "{joint_margin: 0.3}").limits.joint_margin);
  // Both keys together: the margin is kept from the narrower range.
  const PathProblem both =
      with_limits(folder, "{joints: {joint_2: [-1, 1]}, joint_margin: {joint_2: 0.5}}");
  EXPECT_EQ(-0.5, joint_of(both, 2).lower);
  expect_message(refusal_of(folder, {{"limits", "{joint_margin: {joint_2: 2.3}}"}}),
                 {"joint_2", "leaves no range", "less than 2.25"});
  expect_message(refusal_of(folder, {{"limits", "{joint_margin: {joint_2: -1}}"}}), {"joint_2"});
}

TEST(JointLimits, WeightsMayBeByName) {
  const ProblemFolder folder;
  const PathProblem problem = folder.load({{"cost", "{weights: {joint_1: 2, joint_7: 0.5}}"}});
  EXPECT_EQ((std::array<double, kDof>{2, 1, 1, 1, 1, 1, 0.5}), problem.cost.weights);
  expect_message(refusal_of(folder, {{"cost", "{weights: {finger_joint: 2}}"}}),
                 {"'finger_joint' is no joint of the arm", "nearest is"});
  expect_message(refusal_of(folder, {{"cost", "{weights: {joint_1: 1e9}}"}}),
                 {"joint_1", "1000000000"});
}

TEST(JointLimits, AreReadFromMoveItsFile) {
  const ProblemFolder folder;
  folder.folder().write("problems/joint_limits.yaml", R"(# of a robot
default_velocity_scaling_factor: 0.1
joint_limits:
  joint_1: {has_velocity_limits: true, max_velocity: 0.7, has_acceleration_limits: false,
            max_acceleration: 0}
  joint_2: {max_acceleration: 3, max_deceleration: 2, has_jerk_limits: true, max_jerk: 40}
  joint_3: {has_position_limits: true, min_position: -1.5, max_position: 1.5}
  joint_4: {min_position: -3, max_position: 2}
  joint_5: {has_velocity_limits: false, max_velocity: 9}
  joint_6: {has_effort_limits: true, max_effort: 30, max_speed: 3}
  other_joint: {max_velocity: 1}
  finger_joint: {max_velocity: 0.02}
)");
  const PathProblem problem = with_limits(folder, "{file: joint_limits.yaml}");
  EXPECT_EQ(0.7, joint_of(problem, 1).velocity);
  EXPECT_EQ(0, joint_of(problem, 1).acceleration);
  EXPECT_EQ(2, joint_of(problem, 2).acceleration);
  EXPECT_EQ(40, joint_of(problem, 2).jerk);
  EXPECT_EQ(-1.5, joint_of(problem, 3).lower);
  EXPECT_EQ(-2, joint_of(problem, 4).lower);
  EXPECT_EQ(2, joint_of(problem, 4).upper);
  EXPECT_EQ(1, joint_of(problem, 5).velocity);
  const auto warned = [&](const std::vector<std::string>& words) {
    for (const std::string& warning : problem.model->warnings)
      if (std::all_of(words.begin(), words.end(), [&](const std::string& word) {
            return warning.find(word) != std::string::npos;
          }))
        return true;
    return false;
  };
  EXPECT_TRUE(warned({"joint_limits.yaml:2", "default_velocity_scaling_factor", "not kept"}));
  EXPECT_TRUE(warned({"joint_4", "[-3, 2]", "reaches beyond [-2, 2.5] of the URDF"}));
  EXPECT_TRUE(warned({"has_velocity_limits is false of 'joint_5'"}));
  EXPECT_TRUE(warned({"max_speed", "joint_6", "not known"}));
  EXPECT_TRUE(warned({"unknown joint 'other_joint'", "not kept"}));
  EXPECT_EQ(5U, problem.model->warnings.size());
}

TEST(JointLimits, OfMoveItsFileAreRefusedByLine) {
  const ProblemFolder folder;
  const auto refused = [&](const std::string& text, const std::vector<std::string>& words) {
    folder.folder().write("problems/joint_limits.yaml", text);
    expect_message(refusal_of(folder, {{"limits", "{file: joint_limits.yaml}"}}), words);
  };
  refused("joint_limits:\n  joint_1: {max_velocity: fast}\n",
          {"problem.yaml", "limits.file", "joint_limits.yaml:2", "fast"});
  refused("joint_limits:\n  joint_1: {max_velocity: 0}\n", {"joint_limits.yaml:2", "a number > 0"});
  refused("joint_limits:\n  joint_1: {min_position: 1, max_position: 0}\n",
          {"joint_limits.yaml:2", "is empty"});
  refused("limits:\n  joint_1: {max_velocity: 1}\n", {"has no joint_limits"});
  refused("- 1\n", {"joint_limits.yaml"});
  expect_message(refusal_of(folder, {{"limits", "{file: missing.yaml}"}}), {"missing.yaml"});
}

TEST(JointLimits, AreOfTheRobotAndNotOfAStroke) {
  const ProblemFolder folder;
  const auto refused = [&](const std::string& file, const std::string& stroke,
                           const std::vector<std::string>& words) {
    const fs::path yaml =
        folder.write({{"path", ""},
                      {"limits", file},
                      {"strokes", "[{name: a, path: {file: weld.csv}, limits: " + stroke + "}]"}});
    expect_message(input_error([&] { static_cast<void>(load_job(yaml)); }), words);
  };
  refused("{}", "{joints: {joint_1: [-1, 1]}}", {"strokes[0].limits.joints", "is of the robot"});
  refused("{}", "{file: joint_limits.yaml}", {"strokes[0].limits.file", "is of the robot"});
  refused("{joint_margin: {joint_1: 0.1}}", "{joint_margin: 0.2}",
          {"strokes[0].limits.joint_margin", "one for each joint"});
}

TEST(JointLimits, AreOptionsOfALoadedRobot) {
  const TempFolder folder;
  const fs::path urdf = folder.write("arm.urdf", arm_urdf());
  const fs::path limits =
      folder.write("joint_limits.yaml", "joint_limits: {joint_1: {max_velocity: 0.25}}\n");
  RobotOptions options;
  options.joint_limits = limits;
  options.limits["joint_2"] = {-1, 1};
  const auto robot = load_robot(urdf, {}, {}, options);
  EXPECT_EQ(0.25, robot->joints[static_cast<std::size_t>(robot->find_joint("joint_1"))].velocity);
  EXPECT_EQ(1, robot->joints[static_cast<std::size_t>(robot->find_joint("joint_2"))].upper);
  options.limits["joint_2"] = {-9, 1};
  expect_message(input_error([&] { static_cast<void>(load_robot(urdf, {}, {}, options)); }),
                 {"joint_2", "reaches beyond"});
}

}  // namespace
}  // namespace swivel::io::test
