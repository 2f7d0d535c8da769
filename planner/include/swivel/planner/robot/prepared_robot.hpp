// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

class World;
struct ArmClass;
struct ArmModel;
struct PlanningArm;
struct SrsArm;

/// What depends on the robot alone, not on path, scene poses, limits or start: built once, shared by every plan of the robot.
/// Immutable and safe to share between threads.
class PreparedRobot {
 public:
  /// Throws InputError: unknown links, an arm of fewer than seven joints (six, where the tool may roll), ...; InvalidArgument: see
  /// validate(); Stopped, only with a budget.
  explicit PreparedRobot(const Problem& problem, const Budget& budget = {});
  /// The same of an arm that is known: that of this problem.
  PreparedRobot(const Problem& problem, PlanningArm arm, const Budget& budget);
  /// The same arm with other attached bodies, which shares the trees of meshes. Throws as the one before.
  PreparedRobot(const PreparedRobot& like, const Problem& problem, const Budget& budget = {});
  ~PreparedRobot();
  PreparedRobot(PreparedRobot&&) noexcept;
  PreparedRobot& operator=(PreparedRobot&&) noexcept;
  /// Throws InvalidArgument for a problem that another robot would have to be prepared for: another model, base_link, tip_link,
  /// tool, hold, roll or attached body. Limits may differ.
  void require_prepared_for(const Problem& problem) const;
  [[nodiscard]] const ArmModel& arm() const;
  [[nodiscard]] const ArmClass& arm_class() const;
  /// Throws InputError where the arm is not S-R-S, for `what` asks for one.
  [[nodiscard]] const SrsArm& srs(const char* what = "this") const;
  [[nodiscard]] const std::array<double, kDof>& radii() const;
  /// Robot pairs and the meshes of the robot and the scene it was prepared with; the worlds of single plans are made from it.
  [[nodiscard]] const World& world() const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace swivel
