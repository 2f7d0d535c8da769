// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/self_motion/self_motion.hpp"
#include "swivel/core/lattice/explicit_lattice.hpp"

namespace swivel {

/// Two bits, for reports: sign of the determinant of the triple, and of that of the other three
/// joints. Without a lock the sign of the determinant without joint 3.
[[nodiscard]] int arc_branch(const Chain& chain, const LockMethod& method, const Config& q);
/// The generalised arm angle: of the foot on axis 4 nearest axis 3, about the line from the foot on
/// axis 2 nearest axis 1 to the foot on axis 6 nearest axis 7, measured from the base's vertical,
/// rad. Of an arm of six joints, the roll.
[[nodiscard]] double arc_angle(const Chain& chain, const Config& q);

/// Lattice of an arm that has no circle of arm angles: the nodes of a layer are points on its arcs
/// of self-motion (self_motion.hpp). Transported nodes. Layer 0: the ends of arcs, and points
/// between them at most 1.5 `resolution.arc` apart. Every other layer: the ends; the images of the
/// nodes of the layer before, by Newton steps of least weighted norm, unless nearer than half of
/// `resolution.arc` to a node kept before or to the end; gaps of more than 1.5 `resolution.arc` are
/// filled evenly. So a motion that drifts along with the arm meets nodes, which a grid of any
/// coordinate does not give. The nodes depend on geometry, weights and limits of the joints alone:
/// obstacles never change them. A bounded joint with a range of more than a turn is a circle here:
/// unwrap() finds the values.
class ArcLattice final : public ExplicitLattice {
 public:
  /// A method without a lock gives the arcs that turn up (self_motion.hpp), and those of the layer
  /// before: "no path" then means none found. Throws Stopped.
  ArcLattice(const Chain& chain, const LockMethod& method, const ToolPath& path,
             const Problem& problem, const Budget& budget = {});

  /// arc_branch() and arc_angle() of the node.
  [[nodiscard]] int branch(int layer, int slot) const override;
  [[nodiscard]] double phi(int layer, int slot) const override;

  /// That of neighbour_in_redundancy(), which nodes of a lattice with_windings() lack.
  [[nodiscard]] int next_on_arc(int layer, int slot) const override;
  [[nodiscard]] LatticeInfo describe() const override;
  /// Arcs of all layers.
  [[nodiscard]] std::int64_t arcs() const { return layers_.arcs; }
  /// Joints taken as circles although they are bounded.
  [[nodiscard]] const std::array<bool, kDof>& circles() const { return layers_.circles; }

  using Rows = std::vector<Config>;
  /// The rows of a path: each circle turned as a whole so that all rows are inside its limits, the
  /// first one as near to the middle of its range as can be, the lower of two as near. Or the
  /// joints of which no turn keeps the limits.
  [[nodiscard]] std::variant<Rows, Joints> unwrap(const std::vector<int>& slots) const;
  /// What unwrap() finds.
  [[nodiscard]] std::vector<Config> path_joints(const std::vector<int>& slots) const override;
  [[nodiscard]] Joints off_nearest(const std::vector<int>& slots) const override;
  [[nodiscard]] std::unique_ptr<Lattice> with_windings(const Joints& joints) const override;
  [[nodiscard]] std::vector<Joints> joints_with_windings() const override {
    return layers_.windings;
  }

 private:
  struct Layers {
    std::vector<std::vector<Point>> points;
    std::array<bool, kDof> circles{};
    std::vector<std::array<bool, kDof>> windings{};
    std::vector<std::vector<int>> next{};  // with_windings: next_on_arc, by layer and slot
    std::int64_t arcs = 0;
  };
  static Layers build(const Chain& chain, const LockMethod& method, const ToolPath& path,
                      const Problem& problem, const Budget& budget);
  ArcLattice(const Chain& chain, const LockMethod& method, const ToolPath& path,
             const Problem& problem, Layers&& layers);

  /// A path's rows as they follow from the first, without jumps; from the given start, where there
  /// is one.
  [[nodiscard]] Rows followed(const std::vector<int>& slots) const;
  struct Fit {
    std::optional<double> turn;  // rad, by which all rows stay inside the limits, the first as near
                                 // to the middle as can be
    bool nearest = false;        // they do in the turn in which the first is nearest to the middle
  };
  /// How the rows of a path fit into the limits of circle j.
  [[nodiscard]] Fit fit(std::size_t j, const Rows& rows) const;

  LockMethod method_;
  Problem problem_;  // for with_windings
  Layers layers_;    // without the points, which the base has
};

}  // namespace swivel
