// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <optional>
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/motion.hpp"
#include "swivel/core/answer/stated.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// What a file, or a caller, states about one arm of an answer: its parts, or its motion in time.
/// Values of rows that are not stated are 0, and runs of strokes whose directions are not stated
/// count as forwards, until complete_answer() has found them.
struct GivenArm {
  /// Runs and transitions in their order. Empty where rows have times.
  std::vector<Part> parts;
  /// Whether each row is on its stroke, by part and row. Empty for parts that do not say it, and
  /// where the problem has one path for each arm.
  std::vector<std::vector<bool>> process;
  std::optional<ArmMotion> motion;  ///< set where rows have times
  std::vector<StrokeRun> order;     ///< runs of the motion, in their order
  Stated stated;
  bool states_directions = false;  ///< StrokeRun::reversed of each run is stated
};

/// An answer as a file or a caller states it, for check_answer() and time_answer().
struct GivenAnswer {
  /// The problem of which the rows are: where they have lift-offs, with_lift_offs().
  Problem problem;
  std::vector<GivenArm> arms;  ///< as many as the problem has

  /// Returns whether rows have times.
  [[nodiscard]] bool has_times() const { return arms.front().motion.has_value(); }
  /// Returns how many rows an arm has; those of two arms are as many.
  [[nodiscard]] std::size_t rows() const {
    if (has_times()) return arms.front().motion->rows.size();
    std::size_t count = 0;
    for (const Part& part : arms.front().parts) count += part.rows.size();
    return count;
  }
  /// Returns how many runs of strokes an arm has.
  [[nodiscard]] std::size_t runs() const {
    if (has_times()) return arms.front().order.size();
    const auto& parts = arms.front().parts;
    return static_cast<std::size_t>(std::count_if(
        parts.begin(), parts.end(), [](const Part& part) { return part.run.has_value(); }));
  }
};

}  // namespace swivel
