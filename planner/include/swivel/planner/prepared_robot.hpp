// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "swivel/collision/world.hpp"
#include "swivel/core/arm.hpp"
#include "swivel/core/budget.hpp"
#include "swivel/core/problem.hpp"
#include "swivel/core/srs.hpp"

namespace swivel {

/// What depends on the robot alone, not on path, scene poses, limits or start: built once, shared by every plan of the robot.
/// Immutable and safe to share between threads.
class PreparedRobot {
 public:
  /// Throws InputError: unknown links, fewer than seven joints, an arm that is not S-R-S, ...; InvalidArgument: see validate();
  /// Stopped, only with a budget.
  explicit PreparedRobot(const Problem& problem, const Budget& budget = {});
  /// The same arm with other attached bodies, which shares the trees of meshes. Throws as the one before.
  PreparedRobot(const PreparedRobot& like, const Problem& problem, const Budget& budget = {});
  /// Throws InvalidArgument for a problem that another robot would have to be prepared for: another model, base_link, tip_link,
  /// tool, hold or attached body. Limits may differ.
  void require_prepared_for(const Problem& problem) const;
  [[nodiscard]] const ArmModel& arm() const { return arm_; }
  [[nodiscard]] const SrsArm& srs() const { return srs_; }
  [[nodiscard]] const std::array<double, kDof>& radii() const { return radii_; }
  /// Robot pairs and the trees of all meshes of the robot and the scene it was prepared with; the worlds of single plans are made
  /// from it.
  [[nodiscard]] const World& world() const { return world_; }

 private:
  Robot basis_;  // holds the model, so that no other takes its address
  ArmModel arm_;
  SrsArm srs_;
  World world_;
  std::array<double, kDof> radii_;
};

}  // namespace swivel
