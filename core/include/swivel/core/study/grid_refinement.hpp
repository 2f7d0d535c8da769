// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "swivel/core/study/placement.hpp"

namespace swivel {

/// Decides which cells of a grid of placements are worth planning: first a coarse grid; then, with
/// half the stride each time, the neighbours of the best placements until those have none left, and
/// the cells along the border between placements with a path and placements without. In all it
/// takes at most a third of the cells (and at least one).
class GridRefinement {
 public:
  /// Begins with a grid and the criteria by which placements are compared.
  GridRefinement(PlacementGrid grid, std::vector<PlacementCriterion> criteria);

  /// Returns the next cells to plan, in ascending order; none when done. Everything returned before
  /// must have been learned.
  [[nodiscard]] std::vector<std::uint64_t> next();
  /// Takes the result of a cell that next() returned.
  void learn(PlacementRow row);

 private:
  [[nodiscard]] std::vector<std::uint64_t> coarse_cells() const;
  [[nodiscard]] std::vector<std::uint64_t> beside_the_best() const;
  [[nodiscard]] std::vector<std::uint64_t> along_the_border() const;
  [[nodiscard]] std::vector<std::uint64_t> at_most(std::vector<std::uint64_t> cells,
                                                   std::size_t most);

  PlacementGrid grid_;
  std::vector<PlacementCriterion> criteria_;
  std::vector<std::size_t> varied_;  // axes
  std::size_t left_;                 // cells that may still be planned
  int stride_ = 1;
  std::size_t for_border_ = 0;  // of these, cells that may go to the border at this stride
  bool begun_ = false;
  std::vector<PlacementRow> rows_;
  std::map<std::uint64_t, std::size_t> known_;  // cells, with their index in rows_
};

}  // namespace swivel
