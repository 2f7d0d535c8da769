// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <span>

#include "swivel/core/lattice.hpp"
#include "swivel/core/srs.hpp"
#include "swivel/core/types.hpp"

namespace swivel {

/// What is known of a node or edge beyond the closed form.
enum class Verdict : std::uint8_t { kUnknown, kValid, kRemoved };

/// What a node fails by, numbered as the Validity likes: a hint for questions about nodes nearby, which often fail by the same.
using Fault = int;
inline constexpr Fault kNoFault = -1;

struct NodeQuestion {
  int layer = 0, slot = 0;
  Config q;
  Fault suspect = kNoFault;
};
struct EdgeQuestion {
  int layer = 0;  ///< of a; b lies in the next layer
  int a = 0, b = 0;
  Config qa, qb;
};

/// What the pose of the bodies that fail depends on besides the layer. The last link and the tool depend on the layer alone; links
/// 3 and 4 on arm angle and elbow sign; links 1 and 2 on the shoulder's sign too, 5 and 6 on the wrist's. So one failure removes
/// every node of the layer that shares what it depends on. design.md 2.
enum Dependence : std::uint8_t {
  kOnShoulder = kShoulderBit,
  kOnWrist = kWristBit,
  kOnElbow = kElbowBit,
  kOnArmAngle = 8,
  kOnEverything = 15,  ///< this branch and arm angle, in all windings
  kOnNodeAlone = 31,
};
/// Calls visit(slot) for every node of the layer of `slot` that agrees with it in what `depends` names, itself included.
template <class Visit>
void for_each_alike(const Lattice& lattice, int slot, std::uint8_t depends, const Visit& visit) {
  if (depends == kOnNodeAlone) return visit(slot);
  const int n = lattice.angles(), branch = lattice.branch_of(slot), angle = lattice.angle_of(slot);
  for (int label = 0; label < lattice.labels(); ++label) {
    const int other = label / lattice.windings();
    if ((other ^ branch) & depends & (kShoulderBit | kWristBit | kElbowBit)) continue;
    const int first = depends & kOnArmAngle ? angle : 0, last = depends & kOnArmAngle ? angle : n - 1;
    for (int j = first; j <= last; ++j) visit(label * n + j);
  }
}

struct NodeAnswer {
  bool valid = false;
  std::uint8_t depends = kOnNodeAlone;  ///< of a failure
  Fault fault = kNoFault;               ///< of a failure
};

/// The costly predicates of nodes and edges, asked in batches; a search asks about each node and edge at most once. A batch throws
/// Stopped where the budget of the caller is spent.
/// Nodes: manipulability, clearance. Edges (both ends valid, joint steps allowed): tool-path error, clearance of the motion.
class Validity {
 public:
  virtual ~Validity() = default;
  /// Spans of equal size.
  virtual void nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) = 0;
  /// answers[k] = 1 where questions[k] is valid.
  virtual void edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) = 0;
  /// False when every edge is valid as it stands, so that none need be asked.
  [[nodiscard]] virtual bool asks_edges() const = 0;
};

}  // namespace swivel
