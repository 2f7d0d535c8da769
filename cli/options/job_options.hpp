// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "swivel/core/problem/job.hpp"
#include "swivel/core/problem/workcell.hpp"

namespace swivel::cli {

/// Throws InputError for the first of these options, by name, that is given (true): only problems
/// with one path take them. `kind` says what `file` is one of: "jobs" or "workcells".
void refuse_options(const std::string& kind, const std::string& file,
                    const std::vector<std::pair<bool, const char*>>& options);

/// Throws InputError for a planner that only problems with one path have.
void require_planner_of(const std::string& kind, const SearchOptions& search);

/// Returns the job with the lattice, the episode and the placement that the command line chooses.
/// Throws InputError.
[[nodiscard]] Job chosen_job(Job job, const LatticeOptions& lattice, const EpisodeChoice& episode);

/// Returns the workcell alike.
[[nodiscard]] Workcell chosen_workcell(Workcell cell, const LatticeOptions& lattice,
                                       const EpisodeChoice& episode);

/// Returns the task and the scene that an arm of a workcell has, as a problem for records and
/// messages: its path may be on the tool of the other arm, so that it cannot be planned.
[[nodiscard]] PathProblem problem_of_arm(const Workcell& cell, std::size_t arm);

/// Returns the joints between the base and the tips of a workcell's arms that are held. Throws
/// InputError.
[[nodiscard]] std::vector<HeldJoint> held_joints(const Workcell& cell);

}  // namespace swivel::cli
