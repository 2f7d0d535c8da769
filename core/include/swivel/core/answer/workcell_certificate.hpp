// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/infeasibility_certificate.hpp"

namespace swivel {

/// A certificate that two arms of a workcell have no paths without conflict at their resolution. It
/// is a tree of sets of pairs of paths. The root is the set of all pairs. A set is divided by a
/// region of conflict, sides A and B of which no member of A is apart from any of B: pairs without
/// conflict keep arm 0 away from A (the first child) or arm 1 away from B (the second). A set that
/// is not divided has an arm without a path, which its cut proves. verify_certificate(Problem)
/// verifies it; docs/theory.md says why that is a proof.
struct WorkcellCertificate {
  using Range = InfeasibilityCertificate::Range;
  /// A move of an arm from a slot of a layer to one of the next.
  struct Move {
    int from = 0, to = 0;
    bool operator==(const Move&) const = default;
  };
  struct Region {
    int layer = 0;
    /// The pair of bodies, of arm 0 and arm 1, that is too near at each pair of nodes; empty names:
    /// some pair is.
    std::array<std::string, 2> bodies;
    std::array<std::vector<Range>, 2> slots;  ///< nodes of each arm, ascending; or
    std::array<std::vector<Move>, 2> moves;   ///< moves of each arm from the layer
    bool operator==(const Region&) const = default;
  };
  /// A set of pairs.
  struct Branch {
    int parent = -1;  ///< index in `tree`; -1: the root
    int arm = -1;     ///< the arm that keeps away from its side of the parent's region
    std::optional<Region> region;
    /// The arm that has no path in a set that is not divided. Witness r of its cut is the r-th
    /// region, from the root on, whose side this arm keeps away from; causes follow.
    int arm_without_path = -1;
    InfeasibilityCertificate cut;
    bool operator==(const Branch&) const = default;
  };

  /// The joints told apart in the lattice of either arm, as in InfeasibilityCertificate.
  std::array<std::vector<std::array<bool, kDof>>, 2> windings;
  std::array<Resolution, 2> resolution;
  std::array<EdgeMode, 2> edges{EdgeMode::kContinuous, EdgeMode::kContinuous};
  int layers = 0;
  std::vector<Branch> tree;  ///< the root first, parents before children
  bool operator==(const WorkcellCertificate&) const = default;
};

}  // namespace swivel
