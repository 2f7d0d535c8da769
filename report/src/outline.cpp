// SPDX-License-Identifier: BSD-3-Clause
#include "outline.hpp"

#include <cstdint>

namespace swivel::detail {

namespace {

/// The directions of a side; the next one is a quarter turn to the left.
enum Direction : unsigned { kRight, kUp, kLeft, kDown };

/// The sides between cells that are inside and those that are not, as steps between corners that
/// have the inside to their left.
class Sides {
 public:
  Sides(int rows, int columns, const std::function<bool(int, int)>& inside)
      : across_(columns + 1), open_(static_cast<std::size_t>(across_) * (rows + 1)) {
    const auto is = [&](int r, int c) {
      return r >= 0 && r < rows && c >= 0 && c < columns && inside(r, c);
    };
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        if (!is(r, c)) continue;
        if (!is(r - 1, c)) add({c, r}, kRight);
        if (!is(r, c + 1)) add({c + 1, r}, kUp);
        if (!is(r + 1, c)) add({c + 1, r + 1}, kLeft);
        if (!is(r, c - 1)) add({c, r + 1}, kDown);
      }
  }

  [[nodiscard]] bool has(const GridCorner& from, unsigned direction) const {
    return (open_[index(from)] >> direction & 1) != 0;
  }
  /// Removes the sides of the loop that begins with the side to the right of `start`. Returns the
  /// corners at which it turns.
  std::vector<GridCorner> take_loop(const GridCorner& start) {
    std::vector<GridCorner> corners{start};
    GridCorner at = start;
    for (unsigned direction = kRight;;) {
      open_[index(at)] &= static_cast<std::uint8_t>(~(1U << direction));
      at.column += direction == kRight ? 1 : direction == kLeft ? -1 : 0;
      at.row += direction == kUp ? 1 : direction == kDown ? -1 : 0;
      unsigned next = direction + 1;
      for (const unsigned turn : {0U, 3U})
        if (!has(at, next % 4)) next = direction + turn;
      if (!has(at, next % 4)) return corners;  // at the start again
      if (next % 4 != direction) corners.push_back(at);
      direction = next % 4;
    }
  }

 private:
  [[nodiscard]] std::size_t index(const GridCorner& at) const {
    return static_cast<std::size_t>(at.row) * across_ + static_cast<std::size_t>(at.column);
  }
  void add(const GridCorner& from, Direction direction) {
    open_[index(from)] |= static_cast<std::uint8_t>(1U << direction);
  }
  std::size_t across_;
  std::vector<std::uint8_t> open_;  ///< by corner: a bit for each direction
};

}  // namespace

std::vector<std::vector<GridCorner>> outlines(int rows, int columns,
                                              const std::function<bool(int, int)>& inside) {
  Sides sides(rows, columns, inside);
  std::vector<std::vector<GridCorner>> loops;
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c <= columns; ++c)
      // A loop has a side to the right, and the lowest and leftmost of these begins at a corner.
      while (sides.has({c, r}, kRight)) loops.push_back(sides.take_loop({c, r}));
  return loops;
}

}  // namespace swivel::detail
