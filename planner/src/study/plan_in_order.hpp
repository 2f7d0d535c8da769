// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <memory>

#include "swivel/core/messages/input_error.hpp"
#include "swivel/planner/study/plan_many.hpp"

namespace swivel {

/// Returns the row of a problem that is bad input, or throws.
using RowOfBadInput = std::function<EpisodeRow(std::uint64_t number, const InputError& error)>;

/// Plans problems and delivers their rows in order, as plan_many() does. `robot`: as StudyPlanner
/// takes it. `of_bad_input` makes the rows of bad input; what it throws ends the run.
void plan_in_order(const std::shared_ptr<const PreparedRobot>& robot, const Problem& like,
                   std::uint64_t count, const ProblemOf& problem_of, const ManyOptions& options,
                   const RowOfBadInput& of_bad_input,
                   const std::function<void(const EpisodeRow&)>& row_done);

}  // namespace swivel
