// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/study/grid_refinement.hpp"

#include <algorithm>
#include <set>

namespace swivel {

namespace {

constexpr std::size_t kLeaders = 10;  // placements whose neighbours are planned

std::vector<std::uint64_t> listed(const std::set<std::uint64_t>& cells) {
  return {cells.begin(), cells.end()};
}

}  // namespace

GridRefinement::GridRefinement(PlacementGrid grid, std::vector<PlacementCriterion> criteria)
    : grid_(std::move(grid)),
      criteria_(std::move(criteria)),
      left_(static_cast<std::size_t>(grid_.size() / 3)) {
  int longest = 1;
  for (std::size_t a = 0; a < grid_.axes().size(); ++a) {
    const int count = grid_.axes()[a].count;
    if (count > 1) varied_.push_back(a);
    longest = std::max(longest, count);
  }
  left_ = std::max<std::size_t>(1, left_);
  // The coarse grid has an eighth of the cells at most.
  for (stride_ = 4; stride_ < longest && 8 * coarse_cells().size() > grid_.size(); stride_ *= 2) {
  }
}

void GridRefinement::learn(PlacementRow row) {
  known_[row.cell] = rows_.size();
  rows_.push_back(std::move(row));
}

std::vector<std::uint64_t> GridRefinement::next() {
  if (!begun_) {
    begun_ = true;
    return at_most(coarse_cells(), left_);
  }
  for (;;) {
    if (std::vector<std::uint64_t> cells = at_most(beside_the_best(), left_); !cells.empty())
      return cells;
    std::vector<std::uint64_t> cells = at_most(along_the_border(), for_border_);
    for_border_ -= cells.size();
    if (!cells.empty()) return cells;
    if (stride_ == 1) return {};
    stride_ /= 2;
    for_border_ = left_ / 2;  // the rest stays for the best
  }
}

/// Returns every stride_-th cell along each axis, and the last.
std::vector<std::uint64_t> GridRefinement::coarse_cells() const {
  std::vector<std::vector<int>> found{std::vector<int>(grid_.axes().size(), 0)};
  for (const std::size_t a : varied_) {
    std::vector<std::vector<int>> more;
    const int last = grid_.axes()[a].count - 1;
    for (const std::vector<int>& index : found)
      for (int k = 0; k < last + stride_; k += stride_) {
        more.push_back(index);
        more.back()[a] = std::min(k, last);
      }
    found = std::move(more);
  }
  std::set<std::uint64_t> cells;
  for (const std::vector<int>& index : found) cells.insert(grid_.cell(index));
  return listed(cells);
}

std::vector<std::uint64_t> GridRefinement::beside_the_best() const {
  std::set<std::uint64_t> cells;
  for (const PlacementRow& row : best_placements(rows_, criteria_, kLeaders)) {
    const std::vector<int> center = grid_.indices(row.cell);
    std::vector<std::vector<int>> around{center};
    for (const std::size_t a : varied_) {
      const int last = grid_.axes()[a].count - 1;
      // Diagonals too in the plane; in more dimensions they would be too many.
      const std::size_t before = varied_.size() <= 2 ? around.size() : 1;
      for (std::size_t k = 0; k < before; ++k)
        for (const int way : {-stride_, stride_}) {
          std::vector<int> index = around[k];
          index[a] = std::clamp(index[a] + way, 0, last);
          around.push_back(std::move(index));
        }
    }
    for (const std::vector<int>& index : around)
      if (const std::uint64_t cell = grid_.cell(index); !known_.contains(cell)) cells.insert(cell);
  }
  return listed(cells);
}

std::vector<std::uint64_t> GridRefinement::along_the_border() const {
  std::set<std::uint64_t> cells;
  const auto add = [&](const std::vector<int>& index) {
    if (const std::uint64_t cell = grid_.cell(index); !known_.contains(cell)) cells.insert(cell);
  };
  for (const PlacementRow& row : rows_) {
    const std::vector<int> here = grid_.indices(row.cell);
    for (const std::size_t a : varied_)
      for (const int far : {stride_, 2 * stride_}) {
        std::vector<int> there = here;
        there[a] = std::min(here[a] + far, grid_.axes()[a].count - 1);
        const auto other = known_.find(grid_.cell(there));
        if (other == known_.end()) continue;
        if ((rows_[other->second].status == PlanStatus::kSolved) ==
            (row.status == PlanStatus::kSolved))
          continue;
        for (const int k : {here[a], std::min(here[a] + stride_, there[a]), there[a]}) {
          std::vector<int> index = here;
          index[a] = k;
          add(index);
          for (const std::size_t b : varied_)
            for (const int aside : {here[b] - stride_, here[b] + stride_}) {
              if (b == a) continue;
              index[b] = std::clamp(aside, 0, grid_.axes()[b].count - 1);
              add(index);
              index[b] = here[b];
            }
        }
      }
  }
  return listed(cells);
}

/// Returns at most so many of the cells, spread evenly, and counts them as planned.
std::vector<std::uint64_t> GridRefinement::at_most(std::vector<std::uint64_t> cells,
                                                   std::size_t most) {
  most = std::min(most, left_);
  if (cells.size() > most) {
    std::vector<std::uint64_t> some;
    for (std::size_t k = 0; k < most; ++k) some.push_back(cells[k * cells.size() / most]);
    cells = std::move(some);
  }
  left_ -= cells.size();
  return cells;
}

}  // namespace swivel
