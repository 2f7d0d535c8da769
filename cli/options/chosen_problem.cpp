// SPDX-License-Identifier: BSD-3-Clause
#include "options/chosen_problem.hpp"

#include <algorithm>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/problems/problem.hpp"

namespace swivel::cli {

Problem chosen_problem(const Problem& problem, const LatticeOptions& lattice,
                       const EpisodeChoice& episode) {
  Problem chosen = episode.apply(problem);
  for (ArmTask& arm : chosen.arms)
    for (Stroke& stroke : arm.strokes) lattice.apply(stroke);
  if (!lattice.dphi && !lattice.arcs.value_or(false)) return chosen;
  std::vector<UnusedKey> unused = unused_keys_of(chosen.arm(), chosen.source);
  if (chosen.arms.size() == 2)
    unused = unused_by_both(unused, unused_keys_of(chosen.arms[1], chosen.source));
  lattice.require_used(unused);
  return chosen;
}

ChosenProblem load_chosen(const std::string& file, const SearchOptions& search,
                          io::InputFiles::Contents contents) {
  const io::InputFiles noted(contents);
  const Problem loaded = io::load_problem(file);
  ChosenProblem chosen{.inputs = noted.files()};
  chosen.problem = chosen_problem(loaded, search, {});
  chosen.first = first_path(chosen.problem);
  return chosen;
}

PathProblem problem_of_arm(const Problem& problem, std::size_t arm) {
  return problem_of_path(problem, problem.arms[arm], problem.arms[arm].path());
}

PathProblem first_path(const Problem& problem) {
  return problem.arms.size() == 2 ? problem_of_arm(problem, 0)
                                  : problem_of_run(problem, {0, false});
}

std::vector<HeldJoint> held_joints(const Problem& problem) {
  std::vector<HeldJoint> held;
  for (const ArmTask& arm : problem.arms)
    for (const HeldJoint& joint :
         build_arm(*arm.model, arm.base_link, arm.tip_link, arm.hold, arm.tool, arm.roll).held)
      if (std::none_of(held.begin(), held.end(),
                       [&](const HeldJoint& known) { return known.name == joint.name; }))
        held.push_back(joint);
  return held;
}

}  // namespace swivel::cli
