// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel::cli {

/// Returns the problem with the lattice, the episode and the placement that the command line
/// chooses. Throws InputError, also for options of a lattice that no arm uses.
[[nodiscard]] Problem chosen_problem(const Problem& problem, const LatticeOptions& lattice,
                                     const EpisodeChoice& episode);

/// Throws InputError for the first of these options, by name, that is given (true): only problems
/// with one path take them. `file` names the problem in the message.
void refuse_options(const Problem& problem, const std::string& file,
                    const std::vector<std::pair<bool, const char*>>& options);

/// Throws InputError for a planner that does not plan such problems.
void require_planner_of(const Problem& problem, const SearchOptions& search);

/// Returns the task and the scene that an arm of two has, as a problem for records and messages:
/// its path may be on the tool of the other arm, so that it cannot be planned.
[[nodiscard]] PathProblem problem_of_arm(const Problem& problem, std::size_t arm);
/// Returns the problem of the first run of the first arm, for records and messages.
[[nodiscard]] PathProblem first_path(const Problem& problem);

/// Returns the joints between the base and the tips of the arms that are held. Throws InputError.
[[nodiscard]] std::vector<HeldJoint> held_joints(const Problem& problem);

}  // namespace swivel::cli
