// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>

#include "swivel/core/base/types.hpp"

namespace swivel {

struct LatticeInfo;

/// Why a node does not exist, before collision is asked.
enum class NodeStatus : std::uint8_t { kValid, kNoIk, kSingular, kLimit };

/// Describes a lattice and its nodes to those who explain or draw it: answers, diagnosis and maps.
/// This is the part of a Lattice that no search needs.
class LatticeDescription {
 public:
  virtual ~LatticeDescription() = default;
  LatticeDescription& operator=(const LatticeDescription&) = delete;

  /// Returns the size of the lattice and how its nodes are laid out. The fields for method,
  /// completeness and cost are left to the caller.
  [[nodiscard]] virtual LatticeInfo describe() const = 0;
  /// The place of a node in a grid of arm angles (LatticeInfo::grid).
  struct GridPlace {
    /// Branch, winding and arm angle as one number: (branch * windings + winding) * angles + angle.
    int cell = 0;
    int rank = 0;     ///< rank of the node's roll; 0 if the tool may not turn
    double roll = 0;  ///< rad
  };
  /// Returns the place of a slot in the grid. A slot is rank * cells + cell, except in a layer that
  /// is a given start or end alone, which may have one slot. A lattice without a grid returns
  /// {slot, 0, 0}.
  [[nodiscard]] virtual GridPlace grid_place(int layer, int slot) const {
    static_cast<void>(layer);
    return {slot, 0, 0};
  }
  /// Returns the slot after a node on its curve of self-motion; -1 if there is none.
  [[nodiscard]] virtual int next_on_arc(int layer, int slot) const = 0;

  /// Why a node or its row is missing: the first requirement that fails, and for limits which
  /// joints.
  struct NodeFault {
    NodeStatus status = NodeStatus::kValid;
    std::uint8_t joints = 0;  ///< bit k: joint k is outside its limits
    /// For kLimit: the row as it would be, with each joint that is outside on the side to which it
    /// is nearer.
    Config q = Config::Zero();
  };
  [[nodiscard]] virtual NodeFault fault(int layer, int slot) const = 0;
  /// Returns points of a layer's self-motion, or of its IK solutions, that are outside of joint
  /// limits, as faults of kind kLimit. Of a lattice whose slots without a node have a fault() there
  /// are none.
  [[nodiscard]] virtual std::vector<NodeFault> beyond_limits(int /*layer*/) const { return {}; }
  /// The distance of a layer's pose from the base's end of the arm, and the limit that it breaks
  /// because the arm can be neither so long nor so short, whatever its joints.
  struct Reach {
    double distance = 0, limit = 0;  ///< m
  };
  [[nodiscard]] virtual std::optional<Reach> out_of_reach(int) const { return std::nullopt; }
  /// Returns true only if it is proved that no joints within their limits reach the layer's pose,
  /// whatever the redundancy coordinate.
  [[nodiscard]] virtual bool proved_unreachable(int) const { return false; }
  /// Returns the redundancy coordinate of a node, rad; for S-R-S arms the carried arm angle.
  [[nodiscard]] virtual double phi(int layer, int slot) const = 0;
  /// Returns the signs that name the node's solution in reports, as a number 0..7.
  [[nodiscard]] virtual int branch(int layer, int slot) const = 0;

 protected:
  LatticeDescription() = default;
  LatticeDescription(const LatticeDescription&) = default;
};

}  // namespace swivel
