// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "swivel/core/base/zeroed_array.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {

/// The costs of those tiles of a grid that hold any; a tile is `kTileWidth` neighbouring angles of
/// one IK solution. The time to make, clear, copy and restore the table grows with the tiles that
/// are held, not with the grid. Memory: 4 bytes a tile of the grid, 68 a tile held.
class TileTable {
 public:
  // angles: a cache line of costs, a vector of the widest unit
  static constexpr int kTileWidth = 8;
  using Costs = std::array<double, kTileWidth>;

  TileTable() = default;
  /// Makes an empty table for tiles 0 ... tiles - 1. Takes over the memory of `recycled`.
  explicit TileTable(std::size_t tiles, TileTable&& recycled = TileTable())
      : held_(std::move(recycled.held_)) {
    recycled.held_ = {};
    if (recycled.slot_.size() >= tiles) {
      slot_ = std::move(recycled.slot_);
      clear();
    } else {
      held_.costs.clear();
      held_.tile.clear();
      slot_ = ZeroedArray<std::uint32_t>(tiles);
    }
    if (held_.costs.empty()) {
      held_.costs.emplace_back().fill(kUnreachable);
      held_.tile.push_back(0);
    }
  }

  /// Returns the number of tiles of the grid, 0 for a table that was made without.
  [[nodiscard]] std::size_t tiles() const { return slot_.size(); }
  /// Returns the costs of a tile, kUnreachable where it is not held.
  [[nodiscard]] const Costs& operator[](std::size_t tile) const { return held_.costs[slot_[tile]]; }
  [[nodiscard]] bool holds(std::size_t tile) const { return slot_[tile] != 0; }
  /// Returns the costs of a tile to write to, and holds it from now on: kUnreachable if it was not
  /// held before.
  [[nodiscard]] Costs& hold(std::size_t tile) {
    std::uint32_t& slot = slot_[tile];
    if (slot == 0) {
      slot = static_cast<std::uint32_t>(held_.costs.size());
      held_.costs.emplace_back().fill(kUnreachable);
      held_.tile.push_back(static_cast<std::uint32_t>(tile));
    }
    return held_.costs[slot];
  }
  void clear() {
    for (std::size_t k = 1; k < held_.tile.size(); ++k) slot_[held_.tile[k]] = 0;
    held_.costs.resize(std::min<std::size_t>(1, held_.costs.size()));
    held_.tile.resize(held_.costs.size());
  }

  /// The tiles that are held, as a value.
  class Held {
    friend class TileTable;
    std::vector<Costs> costs;         // the first stands for tiles not held
    std::vector<std::uint32_t> tile;  // tile of each of `costs`
  };
  [[nodiscard]] const Held& held() const { return held_; }
  void restore(const Held& held) {
    clear();
    held_ = held;
    for (std::size_t k = 1; k < held_.tile.size(); ++k)
      slot_[held_.tile[k]] = static_cast<std::uint32_t>(k);
  }

 private:
  ZeroedArray<std::uint32_t> slot_;  // [tile] -> held_.costs; 0: not held
  Held held_;
};

}  // namespace swivel
