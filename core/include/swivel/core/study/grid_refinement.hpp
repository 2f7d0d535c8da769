// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "swivel/core/study/placement.hpp"

namespace swivel {

/// Which cells of a grid are worth planning: a coarse grid first; then, with half the stride each time, the neighbours of the best
/// placements until those have none left, and the cells along the border between placements with a path and placements without.
/// At most a third of the cells in all.
class GridRefinement {
 public:
  GridRefinement(PlacementGrid grid, std::vector<PlacementCriterion> criteria);

  /// The next cells, in ascending order; none when done. What was asked for before must have been learned.
  [[nodiscard]] std::vector<std::uint64_t> next();
  void learn(PlacementRow row);

 private:
  [[nodiscard]] std::vector<std::uint64_t> coarse_cells() const;
  [[nodiscard]] std::vector<std::uint64_t> beside_the_best() const;
  [[nodiscard]] std::vector<std::uint64_t> along_the_border() const;
  [[nodiscard]] std::vector<std::uint64_t> at_most(std::vector<std::uint64_t> cells, std::size_t most);

  PlacementGrid grid_;
  std::vector<PlacementCriterion> criteria_;
  std::vector<std::size_t> varied_;  // axes
  std::size_t left_;                 // cells that may still be planned
  int stride_ = 1;
  std::size_t for_border_ = 0;  // of them, those along the border at this stride
  bool begun_ = false;
  std::vector<PlacementRow> rows_;
  std::map<std::uint64_t, std::size_t> known_;  // cells, with their place in rows_
};

}  // namespace swivel
