// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/motion.hpp"
#include "swivel/planner/plan/problem_view.hpp"
#include "swivel/planner/workcell/plan_workcell.hpp"
#include "swivel/report/page.hpp"

namespace swivel {

/// A workcell that was planned. `view`: of the plan of `prepared`, with both arms.
struct PlannedWorkcell {
  const PreparedWorkcell& prepared;
  const Problem& cell;
  const Answer& result;
  const ProblemView& view;
  std::span<const RunMap> maps;    ///< those of make_maps() of the view
  const Motion* motion = nullptr;  ///< of the result's trajectories; null if there is none
};

/// Returns one HTML file that needs nothing else: both arms among the scene in three dimensions,
/// moved together, in time where there is a motion, the (s, phi) map of each, plots, tables. Where
/// each arm has a path by itself and both together have none, it shows these paths and where they
/// meet. `result_json`: the result in the format of `--json`. The file is made after planning:
/// clearances along the paths are asked for again. page_available() says whether this build can
/// make the file. Throws Stopped.
[[nodiscard]] std::string to_workcell_page(const PlannedWorkcell& planned,
                                           const std::string& result_json,
                                           const Budget& budget = {}, const PageWords& words = {});

}  // namespace swivel
