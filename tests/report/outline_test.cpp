// SPDX-License-Identifier: BSD-3-Clause
// The outlines of cells, against the cells.
#include "outline.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "seed.hpp"

namespace swivel::detail {
namespace {

using namespace test;

struct Cells {
  int rows = 0, columns = 0;
  std::vector<char> in;
  [[nodiscard]] bool at(int row, int column) const {
    return in[static_cast<std::size_t>(row * columns + column)] != 0;
  }
};

/// Returns cells, each inside by chance: of few kinds of neighbours, or in blocks.
Cells random_cells(Random& random) {
  Cells cells{1 + random.below(9), 1 + random.below(9), {}};
  cells.in.resize(static_cast<std::size_t>(cells.rows * cells.columns));
  const double share = random.uniform(0, 1);
  const bool checkered = random.coin(0.2);
  for (int row = 0; row < cells.rows; ++row)
    for (int column = 0; column < cells.columns; ++column)
      cells.in[static_cast<std::size_t>(row * cells.columns + column)] =
          static_cast<char>(checkered ? (row + column) % 2 : random.coin(share));
  return cells;
}

/// Returns how many sides of the loops a ray to the left from the middle of a cell crosses.
int crossed(const std::vector<std::vector<GridCorner>>& loops, int row, int column) {
  int count = 0;
  for (const auto& loop : loops)
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const GridCorner &from = loop[k], &to = loop[(k + 1) % loop.size()];
      count +=
          from.column == to.column && from.column <= column && (from.row <= row) != (to.row <= row);
    }
  return count;
}

TEST(Outlines, GoAroundTheCellsThatAreInside) {
  Random random(seed("Outlines.GoAroundTheCellsThatAreInside"));
  int holes = 0, empty = 0, inside = 0;
  const int kTrials = trials(2000);
  for (int trial = 0; trial < kTrials; ++trial) {
    const Cells cells = random_cells(random);
    const auto loops = outlines(cells.rows, cells.columns,
                                [&](int row, int column) { return cells.at(row, column); });
    for (const auto& loop : loops) {
      ASSERT_GE(loop.size(), 4U);
      ASSERT_EQ(loop.size() % 2, 0U);
      double area = 0;
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const GridCorner &from = loop[k], &to = loop[(k + 1) % loop.size()];
        // Horizontal and vertical sides alternately, none of them empty.
        ASSERT_EQ(from.row == to.row, k % 2 == 0) << "trial " << trial;
        ASSERT_NE(from, to);
        area += from.column * to.row - to.column * from.row;
      }
      holes += area < 0;
    }
    for (int row = 0; row < cells.rows; ++row)
      for (int column = 0; column < cells.columns; ++column) {
        ASSERT_EQ(crossed(loops, row, column) % 2 == 1, cells.at(row, column)) << "trial " << trial;
        inside += cells.at(row, column);
      }
    empty += loops.empty();
  }
  EXPECT_GE(holes, at_least(100));
  EXPECT_GE(empty, at_least(20));
  EXPECT_GE(inside, at_least(20000));
}

}  // namespace
}  // namespace swivel::detail
