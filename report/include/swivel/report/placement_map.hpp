// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "swivel/core/study/placement.hpp"
#include "swivel/planner/study/place.hpp"
#include "swivel/report/ended_by.hpp"

namespace swivel {

class PreparedRobot;

/// What ended the paths of a placement.
[[nodiscard]] std::string ended_by(const PlacementRow& row);

/// Placements over two of the axes of a grid. Where more axes vary, a place shows the best that
/// stands there.
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
  /// From 0, the least merit, to 1, the most.
  [[nodiscard]] double shade(const PlacementRow& row) const;
};

/// For a terminal: a digit where there is a path (9: the best), a letter for what ends them, a dot
/// where nothing was planned.
[[nodiscard]] std::string to_text(const PlacementMap& map, int columns, bool coloured);
/// The same as an SVG drawing.
[[nodiscard]] std::string to_svg(const PlacementMap& map);

/// What the rows do not say.
struct PlacementFacts {
  std::string problem;              ///< file name
  std::string thing;                ///< what is moved, for people
  std::vector<PlacementAxis> axes;  ///< of the grid, or what a sample was drawn between
  bool sample = false;
  std::uint64_t asked = 0;  ///< placements of the whole grid or sample
  std::vector<PlacementCriterion> criteria;
  std::string planner,
      plan_command;  ///< plans the problem with nothing moved, up to the words of the coordinates
};

/// The best placements in three dimensions.
struct PlacementScene {
  const PreparedRobot* robot = nullptr;
  const Problem* problem = nullptr;  ///< with nothing moved
  Movable thing;
  std::vector<PlacedPlan> plans;
};

/// One HTML file that needs nothing else: maps by verdict, by what ends the paths and by quality,
/// the best, and every placement with the command that plans it; the plans of `scene`, above the
/// map as a floor. page_available() says whether this build can.
[[nodiscard]] std::string to_placement_page(const std::vector<PlacementRow>& rows,
                                            const PlacementFacts& facts,
                                            const PlacementScene& scene = {});

}  // namespace swivel
