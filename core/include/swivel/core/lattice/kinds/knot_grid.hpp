// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"

namespace swivel {

class PoseNewton;

/// Lattice of an S-R-S arm whose layers are *knots*, every few layers of the tool's path
/// (`resolution.knot`): at each the arm angle is chosen, and the *roll* if the tool may stand
/// turned about its own z axis. docs/model.md defines it.
///
/// A step of either grid moves the joints by far more than a layer of the path does, so that a
/// change between neighbouring layers would seldom pay. Between two knots the joints follow the
/// chord (Lattice::has_layers_between()); the roll changes linearly.
///
/// Nodes of one roll are those of an SrsLattice for a tool turned by that roll. Their arm angles
/// are measured from the path's carried plane, turned by the smallest rotation that takes the tool
/// as the path has it to the turned tool. A slot is (rank of the roll, branch, winding, j). Rank 0
/// is the roll nearest to none, or to that of a given start (of a given end without a start), so
/// that among equally good paths the one that turns least wins. Edges lead to arm angles as far
/// away as the steps between the knots allow together (SrsLattice::window()), and to rolls within
/// roll_slope times the path length, rounded down to whole cells, unless waypoints have windows or
/// the step leads to a given end. The branch stays, or changes one bit near its singular pose
/// (may_flip()). Bounded joints of more than a turn are circles
/// if that is asked for and no arcs are; no edge moves one by half a turn. Immutable once made.
class KnotGrid final : public Lattice {
 public:
  ~KnotGrid() override;
  /// Returns the lattice of the whole path. `chain`, `arm` and `path` must outlive it.
  /// `last_joint`: where joint 7 rests, rad (last_joint_at_rest()); there is no roll to choose
  /// then, because joint 7 would only undo it. `circles`: whether joints that can be circles are.
  /// Throws InputError as SrsLattice does, and for a start or end whose roll is outside the range,
  /// a roll_slope of less than a cell from knot to knot, and limits.step_error; Stopped.
  [[nodiscard]] static std::unique_ptr<KnotGrid> make(
      const Chain& chain, const SrsArm& arm, const ToolPath& path, const PathProblem& problem,
      const Budget& budget = {}, std::optional<double> last_joint = {}, bool circles = false);

  // --- rolls
  [[nodiscard]] int rolls() const { return static_cast<int>(turned_.size()); }
  /// Returns the roll of a slot, rad. If waypoints have windows (Waypoint::roll), a rank stands for
  /// a fraction of each layer's window; otherwise it stands for one roll at all layers.
  [[nodiscard]] double roll(int layer, int slot) const {
    const Given* const only = given(layer);
    return only ? only->roll : roll_of_rank(layer, slot / width_);
  }
  [[nodiscard]] double roll_of_rank(int layer, int rank) const {
    return turned_[static_cast<std::size_t>(rank)]->rolls[static_cast<std::size_t>(layer)];
  }
  /// Returns the nodes for a tool that stands turned by the roll of a rank. The layers of the
  /// returned lattice are the knots.
  [[nodiscard]] const SrsLattice& at_roll(int rank) const {
    return turned_[static_cast<std::size_t>(rank)]->lattice;
  }
  [[nodiscard]] const SrsArm& arm() const { return *arm_; }
  [[nodiscard]] int rank_of(int layer, int slot) const { return given(layer) ? 0 : slot / width_; }
  /// Returns the slot within the lattice at_roll(rank_of(layer, slot)).
  [[nodiscard]] int inner(int layer, int slot) const {
    const Given* const only = given(layer);
    return only ? only->lattice.given_slot(layer) : slot % width_;
  }
  [[nodiscard]] int slot_of(int rank, int inner) const { return rank * width_ + inner; }
  /// Returns the number of slots of one roll.
  [[nodiscard]] int width() const { return width_; }
  /// Returns the ranks, in order, of the rolls that an edge of `step` may join to the roll `rank`:
  /// if `forward`, rolls of the layer after the step for a roll of the layer before it; otherwise
  /// the other way round.
  [[nodiscard]] const std::vector<int>& near(int step, int rank, bool forward) const {
    const Near& lists =
        near_[static_cast<std::size_t>(windows_[static_cast<std::size_t>(step)].near)];
    return (forward ? lists.after : lists.before)[static_cast<std::size_t>(rank)];
  }
  /// Returns by how many cells the arm angle may change on a step; widest_phi_window() returns the
  /// largest value of all steps.
  [[nodiscard]] int phi_window(int step) const {
    return windows_[static_cast<std::size_t>(step)].phi;
  }
  [[nodiscard]] int widest_phi_window() const { return widest_; }
  /// The bits of branches of which an edge may change one.
  static constexpr std::array<int, 2> kFlips{kShoulderBit, kWristBit};
  /// Returns whether an edge from or to a node with joints `q`, rad, may change a bit of the branch
  /// (one of kFlips): whether joint 2 or 6 is near its singular pose.
  [[nodiscard]] bool may_flip(int bit, const Config& q) const {
    return is_near_singular(bit == kShoulderBit ? arm_->shoulder_angle(q) : arm_->wrist_angle(q));
  }
  /// Returns may_flip() of a node that has an angle, rad, from the singular pose of that joint.
  [[nodiscard]] static bool is_near_singular(double angle) {
    constexpr double kNear = 0.5;  // rad
    return std::abs(angle - kPi * std::round(angle / kPi)) < kNear;
  }

  /// Inserted knots have the rolls and arm angles of the others, in the same slots.
  [[nodiscard]] std::unique_ptr<Lattice> with_knots(const std::set<int>& steps,
                                                    const Budget& budget) const override;
  [[nodiscard]] std::unique_ptr<Lattice> with_windings(const Joints& joints) const override;
  [[nodiscard]] std::vector<Joints> joints_with_windings() const override {
    return layout_.told_apart;
  }

  [[nodiscard]] LatticeInfo describe() const override;
  [[nodiscard]] GridPlace grid_place(int layer, int slot) const override {
    return {inner(layer, slot), rank_of(layer, slot), roll(layer, slot)};
  }

  [[nodiscard]] int slots(int layer) const override { return given(layer) ? 1 : rolls() * width_; }
  [[nodiscard]] std::int64_t nodes() const override;
  [[nodiscard]] std::optional<Config> node(int layer, int slot) const override {
    return at(layer, slot).node(layer, inner(layer, slot));
  }
  using Lattice::exact_config;
  [[nodiscard]] std::optional<Config> exact_config(int layer, int slot,
                                                   const Config& q) const override {
    return at(layer, slot).exact_config(layer, inner(layer, slot), q);
  }
  [[nodiscard]] bool is_approximate() const override { return at_roll(0).is_approximate(); }
  void layer_nodes(int layer, std::vector<Node>& out) const override;
  [[nodiscard]] NodeFault fault(int layer, int slot) const override {
    return at(layer, slot).fault(layer, inner(layer, slot));
  }
  /// Where no roll is free, returns that of the SrsLattice.
  [[nodiscard]] bool proved_unreachable(int layer) const override;
  /// If no roll is within reach, returns the values of the roll that misses least.
  [[nodiscard]] std::optional<Reach> out_of_reach(int layer) const override;
  [[nodiscard]] double phi(int layer, int slot) const override {
    return at(layer, slot).phi(layer, inner(layer, slot));
  }
  [[nodiscard]] int branch(int layer, int slot) const override {
    return at(layer, slot).branch(layer, inner(layer, slot));
  }
  [[nodiscard]] bool has_node_costs() const override { return roll_costs(); }
  [[nodiscard]] double node_cost(int layer, int slot) const override {
    return roll_cost(layer, roll(layer, slot));
  }
  [[nodiscard]] int neighbour_in_redundancy(int layer, int slot, int by) const override;
  [[nodiscard]] int neighbour_in_roll(int layer, int slot, int by) const override;
  [[nodiscard]] int neighbour_along_path(int layer, int slot, int by) const override;
  /// Nodes of one roll share poses as the nodes of an SrsLattice do, if they are exact.
  [[nodiscard]] bool shares_body_poses(unsigned groups) const override {
    return !is_approximate() && (groups & kFollowers) == 0;
  }
  void slots_with_same_body_poses(int layer, int slot, unsigned groups,
                                  std::vector<int>& out) const override;
  [[nodiscard]] unsigned manipulability_groups() const override {
    return at_roll(0).manipulability_groups();
  }
  [[nodiscard]] bool all_below_manipulability(int layer, const Config& q) const override {
    return !is_approximate() && at_roll(0).all_below_manipulability(layer, q);
  }
  [[nodiscard]] PoseErrorBound pose_error_of_node(int layer, int group,
                                                  const Config& q) const override;
  [[nodiscard]] PoseErrorBound pose_error_between(int layer, int group,
                                                  const Config& q) const override;
  [[nodiscard]] bool in_window(int layer, int a, int b) const override;
  [[nodiscard]] bool in_arm_window(int layer, int a, int b) const override;
  /// Returns the change of roll from knot to knot. interpolate_edge() finds that of the rows
  /// between.
  [[nodiscard]] std::optional<RollStep> roll_step(int layer, int a, const Config& q0, int b,
                                                  const Config& q1) const override;
  void successors(int layer, int a, std::vector<SlotRun>& out) const override;

 private:
  /// The rolls that nodes may have.
  struct Rolls {
    // In the order of their grid, rad; with windows, fractions of a window from 0 to 1.
    std::vector<double> values;
    // The rank of each entry of `values`, and the entry of each rank.
    std::vector<int> rank, value_of;
  };
  /// What tells lattices of one path apart.
  struct Layout {
    Knots knots;
    std::optional<double> last_joint;
    Joints wound{};  // no circles
    std::vector<Joints> told_apart{};
    Rolls rolls{};  // none before the first lattice has chosen them
  };
  KnotGrid(const Chain& chain, const SrsArm& arm, const PathProblem& problem, const Budget& budget,
           Layout layout);
  [[nodiscard]] std::unique_ptr<Lattice> laid_out(Layout layout, const Budget& budget) const;
  /// Finds out which joints are circles, and keeps edges from moving one that may be by half a
  /// turn.
  void lay_out_circles();
  /// Returns the path of the knots for a tool that is turned by `rolls` there, rad.
  [[nodiscard]] ToolPath at_rolls(const std::vector<double>& rolls) const;
  /// Returns where joint 7 rests, rad, if it does.
  [[nodiscard]] const std::optional<double>& last_joint() const { return layout_.last_joint; }
  [[nodiscard]] bool step_error_allowed(int, int, int) const override { return true; }
  [[nodiscard]] const SrsLattice& at(int layer, int slot) const {
    const Given* const only = given(layer);
    return only ? only->lattice : at_roll(slot / width_);
  }
  /// Places the start and the end that the problem gives, each at the roll of its joints.
  void place_given(const PathProblem& problem, const Budget& budget);
  void choose_rolls(double droll);
  /// Returns the roll, rad, that an entry of Rolls::values stands for at each layer.
  [[nodiscard]] std::vector<double> rolls_along(int value) const;
  [[nodiscard]] double way(int step) const;
  void find_near(const PathProblem& problem);
  /// Returns whether limits.roll_slope lets the roll of the last step change from that of a rank to
  /// that of the given end.
  [[nodiscard]] bool may_end_from(int rank) const;
  /// Returns the rank at which a node that a given start or end continues stands: 0 for the start,
  /// and the one nearest to its roll for the end.
  [[nodiscard]] int rank_beside(int layer) const;
  /// Returns the roll that is chosen for layer i of the whole path, rad.
  [[nodiscard]] double chosen_roll(int layer, int a, int b, int i, double t) const;
  [[nodiscard]] std::optional<Config> row_between(int layer, int a, int b, int i, double t,
                                                  const Config& chord) const override;
  [[nodiscard]] bool chooses_roll() const override { return chain_->free_roll.has_value(); }
  /// Returns the chosen roll, or what it becomes with joint 7 at rest.
  [[nodiscard]] double roll_of_row(int layer, int a, int b, int i, double t,
                                   const Config& q) const override;
  /// The rolls of nodes keep roll_slope by near(). Between them windows and joint 7 at rest may
  /// make the roll change faster.
  [[nodiscard]] std::optional<RollStep> roll_between_rows(int i, const Config& from,
                                                          double from_roll, const Config& to,
                                                          double to_roll) const override;
  [[nodiscard]] TrajectoryRow row(int i, const Config& q, double roll) const override;
  /// Appends the slots of a run of the next layer to which an edge may change a bit of the branch;
  /// all of them for none.
  void add_flips(int layer, int bit, const SlotRun& run, std::vector<SlotRun>& out) const;

  struct Turned {
    Turned(std::vector<double> by, ToolPath knots, const Chain& chain, const SrsArm& arm,
           const PathProblem& problem, const Budget& budget, std::vector<ArmPlane> planes,
           const std::optional<double>& last_joint, const Joints& circles)
        : rolls(std::move(by)),
          path(std::move(knots)),
          lattice(chain, arm, path, problem, budget, std::move(planes), last_joint, circles) {}
    std::vector<double> rolls;  // rad, by layer
    ToolPath path;
    SrsLattice lattice;
  };
  /// A posture that the problem gives for the first or the last layer: the tool stands turned by
  /// `roll` (rad) along `path`, and `lattice` has the posture at that layer.
  struct Given {
    Given(double by, ToolPath turned, const Chain& chain, const SrsArm& arm,
          const PathProblem& problem, const Budget& budget, std::vector<ArmPlane> planes,
          const Joints& circles)
        : roll(by),
          path(std::move(turned)),
          lattice(chain, arm, path, problem, budget, std::move(planes), {}, circles) {}
    double roll;
    ToolPath path;
    SrsLattice lattice;
  };
  /// Returns the only node of a layer for which is_given() holds; null for other layers.
  [[nodiscard]] const Given* given(int layer) const {
    if (layer == 0 && start_) return start_.get();
    return layer == layers() - 1 ? last_.get() : nullptr;
  }
  struct Window {
    int phi = 1, near = 0;  // phi: cells; near: index into near_
  };
  struct Near {
    std::vector<std::vector<int>> after, before;  // by rank
  };

  const SrsArm* arm_;
  Layout layout_;
  PathProblem problem_;
  std::vector<ArmPlane> planes_;  // by layer of the whole path, for a tool that is not turned
  std::unique_ptr<const PoseNewton> newton_;
  Config scale2_;                                // squares of the weights of Newton steps
  bool circle_ = false;                          // rolls cover a whole turn
  bool windows_of_roll_ = false;                 // some waypoint has a window of rolls
  std::vector<std::unique_ptr<Turned>> turned_;  // by rank
  std::unique_ptr<const Given> start_, last_;
  int width_ = 0, widest_ = 1;
  std::vector<Window> windows_;  // by step
  std::vector<Near> near_;
};

}  // namespace swivel
