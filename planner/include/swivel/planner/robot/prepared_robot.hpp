// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

class World;
struct ArmClass;
struct ArmModel;
struct PlanningArm;
struct SrsArm;

/// Data that depend on the robot alone, not on path, scene poses, limits or start. They are built
/// once and shared by every plan of the robot. Immutable and safe to share between threads.
class PreparedRobot {
 public:
  /// Prepares the robot of a problem. Throws InputError for an unknown link, an arm of fewer than
  /// seven joints (six, if the tool may roll) and the like; InvalidArgument for what validate()
  /// refuses; Stopped, only with a budget.
  explicit PreparedRobot(const PathProblem& problem, const Budget& budget = {});
  /// Prepares the robot of a problem with an arm that is known, which must be planning_arm() of
  /// this problem. Throws InputError and Stopped.
  PreparedRobot(const PathProblem& problem, PlanningArm arm, const Budget& budget);
  /// Prepares the arm of `like` with the attached bodies of `problem`, and shares the trees of
  /// meshes. Throws InputError, InvalidArgument for what validate() refuses, and Stopped.
  PreparedRobot(const PreparedRobot& like, const PathProblem& problem, const Budget& budget = {});
  ~PreparedRobot();
  PreparedRobot(PreparedRobot&&) noexcept;
  PreparedRobot& operator=(PreparedRobot&&) noexcept;
  /// Throws InvalidArgument if the problem needs another PreparedRobot: its model, base_link,
  /// tip_link, tool, hold, roll or an attached body differs. Limits may differ.
  void require_prepared_for(const PathProblem& problem) const;
  /// Returns the name of what differs, such that another PreparedRobot is needed; null: nothing.
  [[nodiscard]] const char* difference_from(const Robot& robot) const;
  /// Returns the kinematic chain of the arm and which links move with it.
  [[nodiscard]] const ArmModel& arm() const;
  /// Returns the class of the arm, which says how its self-motion is computed.
  [[nodiscard]] const ArmClass& arm_class() const;
  /// Returns the S-R-S geometry of the arm. Throws InputError if the arm is not S-R-S; `what`
  /// names, in the message, the feature that needs one.
  [[nodiscard]] const SrsArm& srs(const char* what = "this") const;
  /// Returns by joint the greatest distance, m, at which a body that the joint moves can be from
  /// its axis (motion_radii()).
  [[nodiscard]] const std::array<double, kDof>& radii() const;
  /// Returns the world the robot was prepared with. The worlds of single plans are made from it and
  /// share its robot pairs and its meshes.
  [[nodiscard]] const World& world() const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace swivel
