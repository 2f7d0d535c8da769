// SPDX-License-Identifier: BSD-3-Clause
// Rows of an answer that a file states, in the shapes that checks and timing take.
#pragma once
#include <array>
#include <vector>

#include "swivel/core/answer/given_answer.hpp"

namespace swivel {

/// Returns the problem of one path of which the rows of one arm with one stroke are.
inline PathProblem path_of(const GivenAnswer& given) {
  return problem_of_run(given.problem, {0, false});
}

inline std::vector<TrajectoryRow> rows_of(const ArmMotion& motion) {
  std::vector<TrajectoryRow> rows;
  for (const TimedRow& row : motion.rows) rows.push_back(row.row);
  return rows;
}

/// Returns an item of each of two arms, as `of` finds it.
template <class Of>
auto of_both(const GivenAnswer& given, const Of& of) {
  return std::array{of(given.arms.at(0)), of(given.arms.at(1))};
}
inline std::array<std::vector<TrajectoryRow>, 2> rows_of_both(const GivenAnswer& given) {
  return of_both(given, [](const GivenArm& arm) { return arm.parts.front().rows; });
}
inline std::array<std::vector<TimedRow>, 2> timed_of_both(const GivenAnswer& given) {
  return of_both(given, [](const GivenArm& arm) { return arm.motion->rows; });
}
inline std::array<Stated, 2> stated_of_both(const GivenAnswer& given) {
  return of_both(given, [](const GivenArm& arm) { return arm.stated; });
}

}  // namespace swivel
