// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

class InterArmWorld;
class PreparedRobot;

/// What is known of a workcell before it is planned: the problem that each arm poses by itself and
/// its prepared robot, and the bodies of both arms that must keep clear of each other. Immutable
/// and safe to share between threads.
class PreparedWorkcell {
 public:
  /// Prepares both arms. Throws InvalidArgument for what validate(Problem) refuses, InputError for
  /// what PreparedRobot refuses of either arm, arms that share a joint or a link, a follower whose
  /// tool stands still in the base frame on a step, a given motion whose tool stands still on one,
  /// and a roll that is chosen besides the arm angle; Stopped.
  explicit PreparedWorkcell(const Problem& cell, const Budget& budget = {});
  /// Prepares both arms, with the robots of another workcell where these are the same. Throws as
  /// the constructor above.
  PreparedWorkcell(const PreparedWorkcell& like, const Problem& cell, const Budget& budget = {});
  ~PreparedWorkcell();
  PreparedWorkcell(PreparedWorkcell&&) noexcept;
  PreparedWorkcell& operator=(PreparedWorkcell&&) noexcept;
  /// Returns the name of an arm.
  [[nodiscard]] const std::string& name(std::size_t arm) const;
  /// Returns the problem of an arm by itself: its path in the base frame, cut into as many steps as
  /// the other's (for a given motion, the path that its rows lead the tool along), and a robot
  /// model without the collision shapes of the links that the other arm moves.
  [[nodiscard]] const PathProblem& problem(std::size_t arm) const;
  [[nodiscard]] const PreparedRobot& robot(std::size_t arm) const;
  [[nodiscard]] const InterArmWorld& between() const;
  /// Returns the number of the arm whose motion is given, if one is.
  [[nodiscard]] std::optional<std::size_t> given_arm() const;
  /// Returns the rows of the given motion: the joints of Problem::given, bit for bit, with the
  /// path length, arm angle and branch that follow from them. Empty where no motion is given.
  [[nodiscard]] const std::vector<TrajectoryRow>& given_rows() const;
  /// Returns the bodies of both arms with what they keep at and between the samples of timed
  /// motions (time_workcell()).
  [[nodiscard]] InterArmWorld between_samples(const Budget& budget = {}) const;
  /// Returns the number of the arm whose path the other one's tool carries; -1: there is none.
  [[nodiscard]] int follower() const;
  /// Returns the pose of the follower's tool in the frame of the leader's tool at a layer; between
  /// two layers at a fraction. Only where there is a follower.
  [[nodiscard]] Pose on_leader(double layer) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace swivel
