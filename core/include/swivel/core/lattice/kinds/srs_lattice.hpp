// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "swivel/core/kinematics/srs/limit_arcs.hpp"
#include "swivel/core/kinematics/srs/pose_error_model.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"
#include "swivel/core/lattice/lattice.hpp"

namespace swivel {

struct TripleTask;

/// The joints of all IK solutions of one layer over a run of arm angles. Reused from layer to
/// layer; nothing is stored per lattice node. IK solutions share the arrays of what they have in
/// common: four branches have a triple's solution each. Branches with a moved cell in the layer
/// have arrays of their own.
class LayerNodes {
 public:
  /// Joint k (0..6) of IK solution, an array over the run.
  [[nodiscard]] const double* q(int solution, int k) const {
    return data_.data() + at(solution).q[static_cast<std::size_t>(k)];
  }
  /// Two arrays over the run, of zeros and infinities: a node exists (IK, singularity, limits)
  /// where both are 0.
  [[nodiscard]] const double* mask(int solution, std::size_t which) const {
    return data_.data() + at(solution).mask[which];
  }
  [[nodiscard]] bool valid(int solution, int k) const {
    return mask(solution, 0)[k] + mask(solution, 1)[k] == 0;
  }
  /// False where no node of the IK solution exists, whatever the arm angle.
  [[nodiscard]] bool alive(int solution) const { return at(solution).alive; }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] std::size_t bytes() const {
    return static_cast<std::size_t>(data_.size()) * sizeof(double);
  }
  /// Copies `count` entries of every array of an elbow's IK solutions from one place of the run to
  /// another.
  void repeat(int elbow, int from, int to, int count);
  [[nodiscard]] Config config(int solution, int k) const {
    Config c;
    for (int j = 0; j < kDof; ++j) c[j] = q(solution, j)[k];
    return c;
  }

 private:
  friend class SrsLattice;
  struct Offsets {  // into data_
    std::array<std::size_t, kDof> q{};
    std::array<std::size_t, 2> mask{};
    bool alive = false;
  };
  [[nodiscard]] const Offsets& at(int solution) const {
    return offsets_[static_cast<std::size_t>(solution)];
  }
  struct Layout {  // what the offsets depend on
    std::uint64_t lattice = 0;
    int count = 0;
    bool elbow0 = false, elbow1 = false, start = false;
    std::uint8_t moved = 0;  // bit b: branch b has arrays of its own
    bool operator==(const Layout&) const = default;
  };
  Layout layout_;
  int layer_ = -1, first_ = 0, count_ = 0;
  Eigen::ArrayXd data_;
  std::vector<Offsets> offsets_;  // [solution]
  std::array<std::array<Offsets, 2>, 2>
      shared_;  // [elbow][sign of the triples]: what is solved, of the first winding
  struct Span {
    std::size_t begin = 0, end = 0;
  };
  std::array<std::array<Span, 2>, 2>
      arrays_;  // [elbow]: into data_; the IK solutions' own and those of branches with their own
};

/// The images of a bounded joint, an angle plus whole turns, are told apart as windings: as many as
/// the range has turns, begun ones counted. A begun turn of up to 1e-3 rad, as limits
/// written 3.1416 have it, is cut off at the upper end, or at the lower where a given start lies in
/// it: no pose is lost by that, but joints do not move through the part that was cut off. A joint
/// with a range of over 64 turns is treated as a continuous one (JointLimit::wide): its angles
/// begin in the turn about 0, or in the nearest that leaves 31 turns to both limits.
///
/// An arm that is not exactly S-R-S has the nodes of the ideal arm fitted to it, with limits wider
/// by the arm's fit error; exact configurations are solved from them by Newton.
///
/// The (s, phi) lattice of a problem: layers along the path, a circle of arm angles in each,
/// `solutions` = 8 branches x windings of nodes at each angle. docs/model.md. A slot numbers a
/// layer's nodes in the order of ties: (branch, winding, j) = solution * angles + j. Immutable, so
/// safe to share between threads. Nodes are computed when asked for; the same node has the same
/// bits however asked.
///
/// With `resolution.arcs` a cell, the arm angles nearest to grid angle j, has a node wherever it
/// meets an arc: if there is none at its own angle, it is *moved* to the nearest angle of the IK
/// solution's arcs, or to the middle of an arc that lies in the cell as a whole. Moved cells are
/// few, found when the lattice is made, and kept: 80 bytes each. The window counts cells, moved or
/// not.
class SrsLattice final : public Lattice {
 public:
  /// Throws InputError when the start does not fit, for more than 1024 windings, and when the
  /// lattice is too large for the memory of the machine. Throws Stopped. `planes`: of the path's
  /// layers, where they are not carried_planes(). `last_joint`: where joint 7 stays, rad, of an arm
  /// whose tool turns freely about that joint's axis; without a start.
  SrsLattice(const Chain& chain, const SrsArm& arm, const ToolPath& path, const Problem& problem,
             const Budget& budget = {}, std::vector<ArmPlane> planes = {},
             std::optional<double> last_joint = {});

  [[nodiscard]] int angles() const { return angles_; }
  [[nodiscard]] int solutions() const { return kBranches * windings_; }
  [[nodiscard]] int windings() const { return windings_; }
  [[nodiscard]] int window() const { return window_; }
  /// Slots of every layer.
  [[nodiscard]] int width() const { return solutions() * angles_; }
  [[nodiscard]] int solution_of(int slot) const { return slot / angles_; }
  [[nodiscard]] int angle_of(int slot) const { return slot % angles_; }
  [[nodiscard]] int branch_of(int slot) const { return solution_of(slot) / windings_; }
  [[nodiscard]] const SrsArm& arm() const { return *arm_; }
  [[nodiscard]] const ArmPlane& plane(int layer) const {
    return planes_[static_cast<std::size_t>(layer)];
  }
  /// True where layer 0 is the given start alone.
  [[nodiscard]] bool has_start() const { return start_.has_value(); }
  /// Slot that stands for the given start in layer 0 (its IK solution, the grid angle nearest to
  /// its own).
  [[nodiscard]] int start_slot() const { return start_->slot; }

  [[nodiscard]] LatticeInfo describe() const override;
  [[nodiscard]] int slots(int) const override { return width(); }
  [[nodiscard]] std::int64_t nodes() const override {
    return static_cast<std::int64_t>(layers()) * width();
  }
  [[nodiscard]] std::optional<Config> node(int layer, int slot) const override;
  using Lattice::exact_config;
  [[nodiscard]] std::optional<Config> exact_config(int layer, int slot,
                                                   const Config& q) const override;
  [[nodiscard]] bool is_approximate() const override { return !arm_->exact; }
  void layer_nodes(int layer, std::vector<Node>& out) const override;
  [[nodiscard]] NodeFault fault(int layer, int slot) const override;
  /// The wrist centre from the shoulder.
  [[nodiscard]] std::optional<Reach> out_of_reach(int layer) const override;
  /// Of exact arms: out of reach, or no IK solution has an arc.
  [[nodiscard]] bool proved_unreachable(int layer) const override;
  [[nodiscard]] double phi(int layer, int slot) const override;
  /// The most that phi may change along an edge, rad.
  [[nodiscard]] double most_turn() const {
    return (window_ + (off_grid_.empty() ? 0 : 1)) * kTwoPi / angles_ +
           1e-9;  // both ends half a cell from the grid
  }
  [[nodiscard]] int branch(int, int slot) const override { return branch_of(slot); }
  [[nodiscard]] int neighbour_in_redundancy(int layer, int slot, int by) const override;
  [[nodiscard]] int neighbour_along_path(int layer, int slot, int by) const override;
  /// Where joint 7 stays, rad: the tool turns about its axis as the other joints make it.
  [[nodiscard]] const std::optional<double>& last_joint() const { return last_joint_; }
  /// The last link and the tool stand where the layer puts them, with links 5 and 6 where joint 7
  /// stays; links 3 and 4 where arm angle and sign of the elbow do; links 1 and 2 depend on the
  /// shoulder's sign too, 5 and 6 on the wrist's.
  [[nodiscard]] bool shares_body_poses(unsigned groups) const override {
    return (groups & kFollowers) == 0;
  }
  void slots_with_same_body_poses(int layer, int slot, unsigned groups,
                                  std::vector<int>& out) const override;
  /// The elbow's: the other shoulder and the other wrist leave each joint's axis where it is, or
  /// turn it round, which turns a column of J round and leaves J J^T as it is.
  [[nodiscard]] unsigned manipulability_groups() const override;
  [[nodiscard]] bool all_below_manipulability(int layer, const Config& q) const override;
  [[nodiscard]] PoseErrorBound pose_error_of_node(int layer, int group,
                                                  const Config& q) const override;
  [[nodiscard]] PoseErrorBound pose_error_between(int layer, int group,
                                                  const Config& q) const override;
  [[nodiscard]] bool in_window(int layer, int a, int b) const override;
  void successors(int layer, int a, std::vector<SlotRun>& out) const override;

  // --- arcs
  /// Replaces `out` by the arcs of arm angles at which an IK solution's joints are within their
  /// limits, found in closed form, whether nodes are there or not; a given start counts as any
  /// pose. Of an arm that is not exactly S-R-S those at which rows are as well: within limits
  /// narrowed by the fit error.
  void arcs(int layer, int solution, std::vector<AngleArc>& out) const;
  /// A cell whose node does not stand at its own angle.
  struct OffGridNode {
    int slot = 0;
    double phi = 0;
    Config q;
  };
  /// Of a layer, in order of slots.
  [[nodiscard]] std::span<const OffGridNode> off_grid_nodes(int layer) const {
    if (off_grid_.empty()) return {};
    const std::size_t begin = off_grid_begin_[static_cast<std::size_t>(layer)];
    return {off_grid_.data() + begin, off_grid_begin_[static_cast<std::size_t>(layer) + 1] - begin};
  }

  // --- nodes of whole runs, in vector code
  /// Nodes j = first ... first + count - 1 of every IK solution, taken around the circle; first <
  /// angles, count <= 2 angles.
  void solve(int layer, int first, int count, LayerNodes& out) const;
  void solve(int layer, LayerNodes& out) const { solve(layer, 0, angles_, out); }
  /// IK solutions fall into two elbow sides, the signs of the elbow, each a half of them in order;
  /// an elbow side is solved together.
  static constexpr int kElbowSides = 2;
  [[nodiscard]] int elbow_side_of(int solution) const {
    return solution / windings_ & kElbowBit ? 1 : 0;
  }
  /// The same as solve(), bit by bit: room for the run, then entries begin ... end - 1 of it for
  /// the IK solutions of one elbow side.
  void lay_out(int layer, int first, int count, LayerNodes& out) const;
  void solve_part(int side, int begin, int end, LayerNodes& out) const;
  /// False where no node of the layer exists, because its pose is out of reach or joint 4 cannot
  /// bend as it asks.
  [[nodiscard]] bool alive(int layer) const { return alive(layer, 0) || alive(layer, 1); }
  /// Whether an elbow side has nodes in a layer at all.
  [[nodiscard]] bool alive(int layer, int side) const {
    return layer == 0 && start_ ? elbow_side_of(solution_of(start_->slot)) == side
                                : elbow_alive(layer, side);
  }
  /// False where no edge leads from an elbow side of `layer` to another of a neighbouring layer;
  /// the step's number is `step_layer`.
  [[nodiscard]] bool may_change_elbow_side(int step_layer, int layer, int side, int other_layer,
                                           int other) const;
  /// The same of either elbow side of a step's first layer and the other one of the next.
  [[nodiscard]] bool may_change_elbow_side(int step_layer) const {
    return may_change_elbow_side(step_layer, step_layer, 0, step_layer + 1, 1) ||
           may_change_elbow_side(step_layer, step_layer, 1, step_layer + 1, 0);
  }
  /// A branch flips only through the zero of a middle joint: these tell IK solutions apart, the
  /// first two those of one elbow side.
  static constexpr std::array<int, 3> kMiddleJoints{1, 5, 3};
  /// Near such a zero the outer joints must meet as well. Joints of several turns tell windings
  /// apart.
  static constexpr std::array<int, 5> kOuterJoints{0, 2, 4, 6, 3};

  /// First angle index and count of the run of angles of a neighbouring layer that lie in the
  /// window, around the circle, each once.
  struct Run {
    int first = 0, count = 0;
  };
  [[nodiscard]] Run run_after(int layer, int a) const;
  [[nodiscard]] Run run_before(int layer, int b) const;

 private:
  struct Images {
    double base = 0, upper = 0;  // image 0 lies in [base, base + 2 pi); valid up to upper
    int count = 1;
  };
  static Images images_between(double lower, double upper, double start, double fit_error);
  struct Start {
    int slot = 0;
    double phi = 0;
    Config node, row;  // the fitted arm's solution there, or the given joints where it has none;
                       // the given joints
  };
  void lay_out_start(LayerNodes& out) const;
  /// Entries begin ... end - 1 of what an IK solution with arrays of its own has in common with
  /// others.
  void copy_shared(int solution, int begin, int end, LayerNodes& out) const;
  /// The grid angle of a slot's cell, rad.
  [[nodiscard]] double cell_angle(int slot) const {
    return -kPi + kTwoPi * angle_of(slot) / angles_;
  }
  [[nodiscard]] const OffGridNode* find_off_grid(int layer, int slot) const;
  /// The node of a slot at an arm angle.
  [[nodiscard]] std::optional<Config> solved(int layer, int slot, double sine, double cosine) const;
  void prepare_arcs();
  void triple_arcs(int layer, int solution, int triple, std::vector<AngleArc>& out) const;
  [[nodiscard]] bool elbow_within(int layer, int solution) const;
  void place_off_grid_nodes(const Budget& budget);
  /// Of an IK solution, among the windings of a triple.
  [[nodiscard]] int triple_winding(int solution, int triple) const;
  [[nodiscard]] int triple_windings(int triple) const {
    return static_cast<int>(triple_limits_[static_cast<std::size_t>(triple)].size());
  }
  void place_off_grid_nodes_of(int layer, int solution, const std::vector<AngleArc>& arcs);
  /// What a layer's shoulder (0) or wrist (1) triple asks of the kernel; the run and where its
  /// results go are the caller's.
  [[nodiscard]] TripleTask triple_task(const ElbowCircle& circle, int triple) const;
  [[nodiscard]] bool step_error_allowed(int layer, int a, int b) const override;
  /// Joint 4 of a layer's nodes by the sign of the elbow, which the arm angle does not move: layers
  /// without a start.
  [[nodiscard]] std::optional<double> elbow_angle(int layer, int elbow) const;
  [[nodiscard]] bool elbow_alive(int layer, int elbow) const {
    return elbow_alive_[static_cast<std::size_t>(2 * layer + elbow)];
  }
  void place_start(const Problem& problem);
  /// The fitted arm's solution at the start's arm angle and branch, at the images near the start;
  /// none where there is none near it.
  [[nodiscard]] std::optional<Config> fitted_start(const Config& q, double phi) const;
  [[nodiscard]] bool singular(const Config& q) const;
  /// Bit k: joint k of a row is outside its limits.
  [[nodiscard]] std::uint8_t joints_outside(const Config& row) const;
  [[nodiscard]] int winding_images(int winding, int joint) const;
  [[nodiscard]] Run grid_run(double phi) const;

  /// The exact configuration of a node on the exact chain, limits aside; for the tool as the node
  /// turns it where joint 7 stays.
  [[nodiscard]] std::optional<Config> on_exact_chain(int layer, int slot, const Config& q) const;

  std::uint64_t id_;  // of a lattice and its copies; so that layouts outlive lattices safely
  const SrsArm* arm_;
  std::optional<double> last_joint_;
  int angles_ = 0, windings_ = 1, window_ = 1;
  std::array<Images, kDof> images_;
  std::size_t tracks_ = 0;             // arrays in a LayerNodes
  std::vector<double> sine_, cosine_;  // of the grid angles, three times around
  std::vector<ArmPlane> planes_;
  std::vector<ReachStatus> reach_;
  std::vector<std::array<ElbowCircle, 2>> circles_;  // per layer; empty where out of reach
  std::vector<std::uint8_t> elbow_alive_;  // [layer][elbow]: its angle lies within the limits
  std::optional<Start> start_;
  std::optional<PoseErrorModel> pose_error_model_;          // of an arm that is not exact
  std::array<std::vector<TripleLimits>, 2> triple_limits_;  // [triple][its winding]
  std::vector<OffGridNode> off_grid_;            // empty too where resolution.arcs is off
  std::vector<std::size_t> off_grid_begin_;      // [layer], and the end
  std::vector<std::uint8_t> off_grid_branches_;  // [layer], bits
};

/// The planes of a path's layers, carried from the beginning of the whole path: where it begins at
/// a start between two layers, that start changes no other plane. Where the tool stands turned:
/// those of the path without, each under the smallest rotation onto the turned tool.
[[nodiscard]] std::vector<ArmPlane> carried_planes(const SrsArm& arm, const ToolPath& path,
                                                   const Budget& budget = {});

/// Second-order estimate of the step error in joint space at one end of a step, rad. Paper Eq. (15)
/// with the cross product of Eq. (12) replaced by the part normal to the tangent plane: 1/2 |(I -
/// P_T) d^2 theta / dt^2| along (1, dphi). end 0: at layer; end 1: at layer + 1 by the same step's
/// motion. Infinite where a neighbouring solution does not exist.
[[nodiscard]] double step_error(const SrsLattice& lattice, int layer, int end, int branch,
                                double phi, double dphi);

}  // namespace swivel
