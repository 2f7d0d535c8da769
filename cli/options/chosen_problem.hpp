// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "options/commands.hpp"
#include "options/search_options.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/io/files/files.hpp"

namespace swivel::cli {

/// Returns the problem with the lattice, the episode and the placement that the command line
/// chooses. Throws InputError, also for options of a lattice that no arm uses.
[[nodiscard]] Problem chosen_problem(const Problem& problem, const LatticeOptions& lattice,
                                     const EpisodeChoice& episode);

/// The problem of a command that plans it many times.
struct ChosenProblem {
  Problem problem;
  PathProblem first;                         ///< first_path() of it
  std::vector<io::InputFiles::File> inputs;  ///< the files that were read
};
/// Loads a problem file, and chooses its lattice as the command line does. `contents`: whether the
/// files that are read are noted with hashes, because results say what they were computed from.
/// Throws InputError.
[[nodiscard]] ChosenProblem load_chosen(const std::string& file, const SearchOptions& search,
                                        io::InputFiles::Contents contents);

/// Returns the task and the scene that an arm of two has, as a problem for records and messages:
/// its path may be on the tool of the other arm, so that it cannot be planned.
[[nodiscard]] PathProblem problem_of_arm(const Problem& problem, std::size_t arm);
/// Returns the problem of the first run of the first arm, for records and messages.
[[nodiscard]] PathProblem first_path(const Problem& problem);

/// Returns the joints between the base and the tips of the arms that are held. Throws InputError.
[[nodiscard]] std::vector<HeldJoint> held_joints(const Problem& problem);

}  // namespace swivel::cli
