// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/workcell/complete_workcell.hpp"

#include <utility>

#include "swivel/core/messages/input_error.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/complete_rows.hpp"

namespace swivel {

namespace {

/// Calls `work` on both arms and returns what it returns. Puts the name of the arm before the
/// message of an InputError.
template <class Work>
auto of_both(const PreparedWorkcell& prepared, const Work& work) {
  const auto of = [&](std::size_t arm) {
    try {
      return work(arm);
    } catch (const InputError& error) {
      throw InputError("arm '" + prepared.name(arm) + "'", error.what());
    }
  };
  return std::array{of(0), of(1)};
}

}  // namespace

std::array<std::vector<TrajectoryRow>, 2> complete_rows(
    const PreparedWorkcell& prepared, std::array<std::vector<TrajectoryRow>, 2> rows,
    const std::array<Stated, 2>& stated, const Budget& budget) {
  return of_both(prepared, [&](std::size_t arm) {
    return complete_rows(prepared.robot(arm), prepared.problem(arm), std::move(rows[arm]),
                         stated[arm], budget);
  });
}

std::array<std::vector<TimedRow>, 2> complete_motion(const PreparedWorkcell& prepared,
                                                     std::array<std::vector<TimedRow>, 2> rows,
                                                     const std::array<Stated, 2>& stated,
                                                     const Budget& budget) {
  return of_both(prepared, [&](std::size_t arm) {
    return complete_motion(prepared.robot(arm), prepared.problem(arm), std::move(rows[arm]),
                           stated[arm], budget);
  });
}

std::array<std::vector<TrajectoryRow>, 2> rows_at_layers(
    const PreparedWorkcell& prepared, const std::array<std::vector<TimedRow>, 2>& rows,
    const std::array<Stated, 2>& stated, const Budget& budget) {
  return of_both(prepared, [&](std::size_t arm) {
    std::vector<TrajectoryRow> places;
    for (const TimedRow& row : rows[arm]) places.push_back(row.row);
    return rows_at_layers(prepared.robot(arm), prepared.problem(arm), places, stated[arm], budget);
  });
}

}  // namespace swivel
