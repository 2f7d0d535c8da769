// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/workcell/prepared/prepared_workcell.hpp"

namespace swivel {

/// What is known of a problem of any kind before it is planned or checked: the robot of its arm, or
/// both arms with what they keep between each other. Immutable and safe to share between threads.
class PreparedProblem {
 public:
  /// Prepares the robots of a problem. Throws as PreparedRobot and PreparedWorkcell do.
  explicit PreparedProblem(const Problem& problem, const Budget& budget = {});
  /// Returns the number of arms.
  [[nodiscard]] std::size_t arms() const { return has_two_arms() ? 2 : 1; }
  [[nodiscard]] bool has_two_arms() const {
    return std::holds_alternative<PreparedWorkcell>(prepared_);
  }
  [[nodiscard]] const PreparedRobot& robot(std::size_t arm = 0) const {
    return has_two_arms() ? two_arms().robot(arm) : std::get<PreparedRobot>(prepared_);
  }
  /// Returns what is prepared of two arms. The problem must have two.
  [[nodiscard]] const PreparedWorkcell& two_arms() const {
    return std::get<PreparedWorkcell>(prepared_);
  }
  /// Returns the names of the joints of each arm.
  [[nodiscard]] std::vector<std::array<std::string, kDof>> joint_names() const;
  /// Returns the names of the joints of an arm.
  [[nodiscard]] const std::array<std::string, kDof>& joint_names(std::size_t arm) const;

 private:
  std::variant<PreparedRobot, PreparedWorkcell> prepared_;
};

}  // namespace swivel
