// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/report/run_map.hpp"

namespace swivel {

namespace {

/// Returns the name of the map of a run, by its index in ProblemView::runs.
std::string name_of(const Answer& answer, const Problem& executed, std::size_t run) {
  if (is_path(executed)) return "";
  if (executed.arms.size() == 2) return "arm '" + answer.arms[run].name + "'";
  return "stroke " + words(answer.arm().runs[run].run, executed);
}

}  // namespace

std::vector<RunMap> make_maps(const ProblemView& view, const Answer& answer,
                              const Problem& executed, bool full, const Budget& budget) {
  std::vector<RunMap> maps;
  for (std::size_t k = 0; k < view.runs.size(); ++k) {
    RunMap& made =
        maps.emplace_back(name_of(answer, executed, k), make_map(view.runs[k], full, budget));
    if (executed.arms.size() == 2) continue;
    const StrokeRun& of = answer.arm().runs[k].run;
    for (double& s : made.map.s) s += s_of_piece(executed.arm().strokes[of.stroke]);
  }
  return maps;
}

}  // namespace swivel
