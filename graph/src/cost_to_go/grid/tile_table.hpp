// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "swivel/core/base/zeroed_array.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {

/// The costs of those tiles of a grid that hold any; a tile is `kTileWidth` neighbouring nodes of a sheet. What it costs to make,
/// clear, copy and restore grows with the tiles that are held, not with the grid. Memory: 4 bytes a tile of the grid, 68 a tile
/// held.
class TileTable {
 public:
  static constexpr int kTileWidth = 8;  // angles: a cache line of costs, one vector of the widest unit
  using Costs = std::array<double, kTileWidth>;

  TileTable() = default;
  /// Of tiles 0 ... tiles - 1. Takes over what `retired` had allocated.
  explicit TileTable(std::size_t tiles, TileTable&& retired = TileTable()) : held_(std::move(retired.held_)) {
    retired.held_ = {};
    if (retired.slot_.size() >= tiles) {
      slot_ = std::move(retired.slot_);
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

  /// Of the grid: 0 until it is given some.
  [[nodiscard]] std::size_t tiles() const { return slot_.size(); }
  /// kUnreachable where none are held.
  [[nodiscard]] const Costs& operator[](std::size_t tile) const { return held_.costs[slot_[tile]]; }
  [[nodiscard]] bool holds(std::size_t tile) const { return slot_[tile] != 0; }
  /// To be filled in by the caller where none were held: then kUnreachable.
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

  /// A copy of what is held.
  class Held {
    friend class TileTable;
    std::vector<Costs> costs;         // the first is that of tiles not held
    std::vector<std::uint32_t> tile;  // of each of costs
  };
  [[nodiscard]] const Held& held() const { return held_; }
  void restore(const Held& held) {
    clear();
    held_ = held;
    for (std::size_t k = 1; k < held_.tile.size(); ++k) slot_[held_.tile[k]] = static_cast<std::uint32_t>(k);
  }

 private:
  ZeroedArray<std::uint32_t> slot_;  // [tile] -> held_.costs; 0: not held
  Held held_;
};

}  // namespace swivel
