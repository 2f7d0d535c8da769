// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <span>
#include <string>
#include <vector>

#include "swivel/core/answer/answer.hpp"
#include "swivel/planner/plan/problem_view.hpp"
#include "swivel/report/lattice_map.hpp"

namespace swivel {

/// The lattice map of one run of an answer: of the one path, of a stroke, or of one of two arms.
struct RunMap {
  std::string name;  ///< "stroke 'seam' backwards", "arm 'left'"; "" of the one path
  /// Its `s` counts along the whole stroke, where lift-offs part that.
  LatticeMap map;
};

/// Makes the maps of all runs of an answer, by make_map(), in the order of ProblemView::runs; none
/// where that is empty. `executed` is executed_problem() of the answer. With `full`, clearance is
/// asked of every node. Throws Stopped.
[[nodiscard]] std::vector<RunMap> make_maps(const ProblemView& view, const Answer& answer,
                                            const Problem& executed, bool full,
                                            const Budget& budget = {});

/// Draws maps as text, one after the other, each as to_text() of one map does, below its name.
[[nodiscard]] std::string to_text(std::span<const RunMap> maps, int columns, bool coloured);

/// Draws maps as one SVG, one below the other, each as to_svg() of one map does, below its name.
[[nodiscard]] std::string to_svg(std::span<const RunMap> maps);

}  // namespace swivel
