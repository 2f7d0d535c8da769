// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/self_motion/self_motion.hpp"
#include "swivel/core/lattice/explicit_lattice.hpp"

namespace swivel {

/// Returns two bits that name a solution in reports: the sign of the determinant of the three axes
/// on which `method`'s closed form is built, and that of the other three joints. For a method
/// without a lock, returns the sign of the determinant without joint 3.
[[nodiscard]] int arc_branch(const Chain& chain, const LockMethod& method, const Config& q);
/// Returns the generalised arm angle, rad: the angle of a point on axis 4, the foot nearest axis 3,
/// about the line from the foot on axis 2 nearest axis 1 to the foot on axis 6 nearest axis 7,
/// measured from the base's vertical. For an arm of six joints, returns the roll; for one with a
/// slide the carriage angle: that of the joint behind it, or before it where none is behind.
[[nodiscard]] double arc_angle(const Chain& chain, const Config& q);

/// Lattice of an arm that has no circle of arm angles: the nodes of a layer are points on its arcs
/// of self-motion (self_motion.hpp), transported from layer to layer. Layer 0 has the ends of arcs,
/// and points between them at most 1.5 `resolution.arc` apart. Every other layer has the ends of
/// its arcs and the images of the nodes of the layer before, found by Newton steps of least
/// weighted norm, except images nearer than half of `resolution.arc` to a node kept before or to
/// the end; gaps of more than 1.5 `resolution.arc` are filled evenly. A motion along which the arm
/// drifts therefore meets nodes, which no grid of a coordinate ensures. The nodes depend on
/// geometry, weights and limits of the joints alone; obstacles never change them. A given start or
/// end takes the place of its layer's nodes. A bounded joint with a range of more than a turn is
/// treated as a circle, and path_joints() finds its values.
///
/// With `resolution.knot` only every few layers of the tool's path, the *knots*, have nodes
/// (Lattice::has_layers_between()). So a path may drift along the self-motion by less from layer to
/// layer than nodes lie apart.
class ArcLattice final : public ExplicitLattice {
 public:
  /// Builds the nodes of every layer. `chain` and `path` must outlive the lattice. If `method` has
  /// no lock, the arcs of a layer are those that a search finds (self_motion.hpp) and those that
  /// continue the layer before; "no path" then means that none was found. `srs`: of an S-R-S arm
  /// its geometry, which must outlive the lattice: then branches and arm angles are those of such
  /// arms. Throws InputError and Stopped.
  ArcLattice(const Chain& chain, const LockMethod& method, const ToolPath& path,
             const PathProblem& problem, const Budget& budget = {}, const SrsArm* srs = nullptr);

  /// Returns arc_branch() of the node; phi() returns its arc_angle(), rad. Of an S-R-S arm they are
  /// its branch and its carried arm angle.
  [[nodiscard]] int branch(int layer, int slot) const override;
  [[nodiscard]] double phi(int layer, int slot) const override;

  /// Returns the next slot on the node's arc, also in a lattice made by with_windings(), whose
  /// nodes have no neighbour_in_redundancy().
  [[nodiscard]] int next_on_arc(int layer, int slot) const override;
  [[nodiscard]] std::vector<NodeFault> beyond_limits(int layer) const override;
  [[nodiscard]] LatticeInfo describe() const override;
  /// Returns the number of arcs of all layers together.
  [[nodiscard]] std::int64_t arcs() const { return data_.arcs; }
  [[nodiscard]] std::vector<TrajectoryRow> path_rows(const std::vector<int>& slots) const override;
  [[nodiscard]] std::unique_ptr<Lattice> with_windings(const Joints& joints) const override;
  /// Inserted knots have the images of the nodes of the knot before, and what fills the gaps. The
  /// nodes of other knots stay.
  [[nodiscard]] std::unique_ptr<Lattice> with_knots(const std::set<int>& steps,
                                                    const Budget& budget) const override;
  [[nodiscard]] std::vector<Joints> joints_with_windings() const override { return data_.windings; }
  [[nodiscard]] int slot_on_circles(int layer, int slot) const override {
    return data_.on_circles.empty()
               ? slot
               : data_.on_circles[static_cast<std::size_t>(layer)][static_cast<std::size_t>(slot)];
  }
  /// Images of a node in other turns place all bodies alike.
  [[nodiscard]] bool shares_body_poses(unsigned groups) const override {
    return !data_.on_circles.empty() || ExplicitLattice::shares_body_poses(groups);
  }
  void slots_with_same_body_poses(int layer, int slot, unsigned groups,
                                  std::vector<int>& out) const override;

 private:
  struct Data {
    explicit Data(Knots of) : knots(std::move(of)) {}
    Knots knots;
    Layers points;
    std::array<bool, kDof> circles{};
    std::vector<std::array<bool, kDof>> windings{};
    // next_on_arc() of a lattice by with_windings(), by layer and slot
    std::vector<std::vector<int>> next{};
    // slot_on_circles() of a lattice by with_windings(), by layer and slot
    std::vector<std::vector<int>> on_circles{};
    std::int64_t arcs = 0;
    std::shared_ptr<const SelfMotion> motion{};
    // The points before any with_windings() call, of a lattice by it that has layers between.
    Layers unwound{};
    const SrsArm* srs = nullptr;
    std::vector<ArmPlane> planes{};  // of an S-R-S arm, by layer of the whole path
  };
  static Data build(const Chain& chain, const LockMethod& method, const ToolPath& path,
                    const PathProblem& problem, const Budget& budget);
  ArcLattice(const Chain& chain, const LockMethod& method, const PathProblem& problem, Data&& data);

  /// Returns the row of joints at a layer of the whole path, with branch and arm angle.
  [[nodiscard]] TrajectoryRow labelled(int layer, const Config& q) const;
  /// Returns the posture that the problem gives for a layer; nothing if it gives none.
  [[nodiscard]] std::optional<Config> given(int layer) const;
  [[nodiscard]] std::optional<Config> row_between(int layer, int a, int b, int i, double t,
                                                  const Config& chord) const override;
  /// A node in one turn of each joint that is told apart, and a number that orders these turns.
  struct WoundPoint {
    std::int64_t turns;
    int slot;  // in the lattice whose turns are told apart
    Config q;
  };
  /// Replaces the points from `first` on by their images within the limits of a joint.
  void add_images(std::size_t joint, std::size_t first, std::vector<WoundPoint>& images) const;

  LockMethod method_;
  PathProblem problem_;  // for with_windings
  Data data_;            // without the points, which the base class keeps
};

}  // namespace swivel
