// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "swivel/core/answer/timed_path.hpp"
#include "swivel/core/problem/robot_model.hpp"
#include "swivel/planner/problem/problem_planner.hpp"
#include "swivel/report/run_map.hpp"

namespace swivel {

/// Returns false in a build with SWIVEL_REPORT=OFF, which has no page to fill.
[[nodiscard]] bool page_available();

/// What became of the lattice's path. A member is null where the path was not refined, or has no
/// times.
struct PageMotion {
  const std::vector<TrajectoryRow>* refined =
      nullptr;  ///< a row in each layer: shown in the path's place, the path beside it
  const TimedPath* motion = nullptr;  ///< of the rows shown; played in its own time
};

/// What the page says and shows besides its data.
struct PageWords {
  std::string which;  ///< of the problems that one file describes, for the title
  std::string
      answer;  ///< shown with the map where JavaScript is switched off: answer_text, advice_text
  /// The robot with its visual shapes in place of its collision shapes, which the page may then
  /// show; null: none.
  const RobotModel* visual = nullptr;
  std::vector<std::string> unread;  ///< a message for each visual shape that is missing there
};

/// Returns one HTML file that needs nothing else: the arm among the scene in three dimensions, the
/// (s, phi) map, plots over s and over time, summary. `result_json`: the result in the format of
/// `--json`. The file is made after planning: clearances along the path are asked for again. Throws
/// Stopped.
[[nodiscard]] std::string to_page(const PlanView& view, const LatticeMap& map,
                                  const std::string& result_json, const PageMotion& motion = {},
                                  const Budget& budget = {}, const PageWords& words = {});

/// Returns the page of the last answer of a planner that kept its view, which must not be empty:
/// one HTML file that needs nothing else, with one path as above; with strokes and transitions in
/// the order in which they are executed; or with both arms, moved together, and where these meet if
/// each has a path by itself and both together have none. `result_json`: the result in the format
/// of `--json`. `maps` are those of make_maps(); where there are none, they are made. The file is
/// made after planning: clearances along the rows are asked for again. page_available() says
/// whether this build can make it. Throws Stopped.
[[nodiscard]] std::string to_page(const ProblemPlanner& planner, const Answer& answer,
                                  const std::string& result_json, std::span<const RunMap> maps = {},
                                  const Budget& budget = {}, const PageWords& words = {});

}  // namespace swivel
