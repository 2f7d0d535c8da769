// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/study/placement.hpp"
#include "swivel/planner/study/place.hpp"
#include "swivel/report/ended_by.hpp"

namespace swivel {

class PreparedRobot;

/// Returns what ended the paths of a placement.
[[nodiscard]] std::string ended_by(const PlacementRow& row);

/// Shows placements over two of the axes of a grid. Where more axes vary, a place shows the best
/// placement that stands there.
struct PlacementMap {
  /// `across`, `up`: numbers of axes of the grid. `rows`: any of its cells.
  PlacementMap(const PlacementGrid& grid, std::size_t across, std::size_t up,
               const std::vector<PlacementRow>& rows, std::vector<PlacementCriterion> by);

  PlacementAxis across, up;
  std::vector<PlacementCriterion> criteria;  ///< places are shaded by the first
  std::vector<PlacementRow> shown;
  std::vector<int> at;  ///< index into `shown`, -1 where nothing was planned; across.count values
                        ///< for each of `up`
  std::vector<std::string> ends;  ///< ended_by() of those without a path, the most frequent first
  double least = 0, most = 0;     ///< merit of those with a path
  bool best_of_several = false;   ///< more axes vary
  /// Returns the merit of a row between 0, for the least merit, and 1, for the most.
  [[nodiscard]] double shade(const PlacementRow& row) const;
};

/// Draws the map for a terminal: a digit where there is a path (9: the best), a letter for what
/// ends the paths, a dot where nothing was planned.
[[nodiscard]] std::string to_text(const PlacementMap& map, int columns, bool coloured);
/// Draws the map as SVG.
[[nodiscard]] std::string to_svg(const PlacementMap& map);

/// What a page of placements says besides their rows.
struct PlacementFacts {
  std::string problem;              ///< file name
  std::string thing;                ///< what is moved, for people
  std::vector<PlacementAxis> axes;  ///< of the grid, or what a sample was drawn between
  bool sample = false;
  std::uint64_t asked = 0;  ///< placements of the whole grid or sample
  std::vector<PlacementCriterion> criteria;
  std::string planner,
      plan_command;    ///< plans the problem with nothing moved, up to the words of the coordinates
  std::string answer;  ///< shown where JavaScript is switched off: how many have a path, the best
  std::string map;     ///< shown there as well: to_svg(); empty where there is no map
};

/// How far paths go in a placement that has none.
struct PlacedEnd {
  PlacementCell cell;
  std::vector<SceneObject> scene;   ///< with the objects where they are in this placement
  std::vector<TrajectoryRow> rows;  ///< valid ones, and behind them the pose that none can move to
  std::string past;                 ///< JSON: what that pose is, and which bodies are in its way
  std::string robot;  ///< JSON: the robot with joints held as in the cell; empty: as in all cells
};
/// Returns how far paths go in a placement without a path; nullopt where not even a pose that is
/// not valid is known. `view`: of its plan; `result_json`: its result in the format of `--json`.
/// Throws Stopped.
[[nodiscard]] std::optional<PlacedEnd> placed_end(const PlacementCell& cell, const PlanView& view,
                                                  const std::string& result_json,
                                                  const Budget& budget = {});

/// What the page's view in three dimensions shows.
struct PlacementScene {
  const PreparedRobot* robot = nullptr;
  const PathProblem* problem = nullptr;  ///< with nothing moved, and joints held as the file says
  Movable thing;
  std::vector<PlacedPlan> plans;       ///< of the best
  std::vector<PlacedEnd> ends;         ///< of some that have no path
  const RobotModel* visual = nullptr;  ///< as in PageWords
  std::vector<std::string> unread{};   ///< as in PageWords
};

/// Returns one HTML file that needs nothing else: maps by verdict, by what ends the paths and by
/// quality, the best placements, and every placement with the command that plans it. The plans of
/// `scene` are drawn above the map, which is their floor. page_available() says whether this build
/// can make the file.
[[nodiscard]] std::string to_placement_page(const std::vector<PlacementRow>& rows,
                                            const PlacementFacts& facts,
                                            const PlacementScene& scene = {});

}  // namespace swivel
