// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>

#include "swivel/core/base/types.hpp"

namespace swivel {

struct LatticeInfo;

/// Why a node does not exist, before collision is asked.
enum class NodeStatus : std::uint8_t { kValid, kNoIk, kSingular, kLimit };

/// What a lattice says of itself and of its nodes to those who explain or draw it: answers,
/// diagnosis, maps. The part of a Lattice that no search needs.
class LatticeDescription {
 public:
  virtual ~LatticeDescription() = default;
  LatticeDescription& operator=(const LatticeDescription&) = delete;

  /// The size of the lattice and how its nodes are laid out; method, completeness and cost are left
  /// to the caller.
  [[nodiscard]] virtual LatticeInfo describe() const = 0;
  /// Where a node stands in a grid of arm angles (LatticeInfo::grid).
  struct GridPlace {
    int cell = 0;  ///< (branch, winding, arm angle) as one number: (branch * windings + winding) *
                   ///< angles + angle
    int rank = 0;  ///< of its roll; 0 where the tool may not stand turned
    double roll = 0;  ///< rad
  };
  /// Slots of such a grid are rank * cells + cell; but a layer that is the given start alone may
  /// have one slot. Of other lattices {slot, 0, 0}.
  [[nodiscard]] virtual GridPlace grid_place(int layer, int slot) const {
    static_cast<void>(layer);
    return {slot, 0, 0};
  }
  /// The slot after a node on its curve of self-motion; -1 where there is none.
  [[nodiscard]] virtual int next_on_arc(int layer, int slot) const = 0;

  /// Why a node, or its row, is missing: what it fails first, and for limits which joints.
  struct NodeFault {
    NodeStatus status = NodeStatus::kValid;
    std::uint8_t joints = 0;    ///< bit k: joint k is outside its limits
    Config q = Config::Zero();  ///< of kLimit: the row as it would be, each joint outside on the
                                ///< side that it is nearer to
  };
  [[nodiscard]] virtual NodeFault fault(int layer, int slot) const = 0;
  /// How far from the base's end of the arm a layer's pose is, where the arm cannot be so long or
  /// so short whatever its joints.
  struct Reach {
    double distance = 0, limit = 0;  ///< m
  };
  [[nodiscard]] virtual std::optional<Reach> out_of_reach(int) const { return std::nullopt; }
  /// True where it is proved that no joints within their limits reach the layer's pose, whatever
  /// the redundancy coordinate.
  [[nodiscard]] virtual bool proved_unreachable(int) const { return false; }
  /// The redundancy coordinate of a node, rad: the carried arm angle of S-R-S arms.
  [[nodiscard]] virtual double phi(int layer, int slot) const = 0;
  /// Signs that name the node's solution, for reports: 0..7.
  [[nodiscard]] virtual int branch(int layer, int slot) const = 0;

 protected:
  LatticeDescription() = default;
  LatticeDescription(const LatticeDescription&) = default;
};

}  // namespace swivel
