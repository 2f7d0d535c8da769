// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/lattice/body_pose_classes.hpp"
#include "swivel/core/lattice/knots.hpp"
#include "swivel/core/lattice/lattice_description.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

struct CircleTurns;
struct TrajectoryRow;

// rad: a joint may be outside its limits by so much
inline constexpr double kLimitTolerance = 1e-9;

/// A layered graph along a tool path: each layer has nodes (postures at which the tool is where the
/// path wants it), and joint-linear moves may join nodes of neighbouring layers. Searches, verdicts
/// and diagnosis know an arm only through this class. The class itself has the nodes and edges that
/// searches need; its base BodyPoseClasses answers what collision questions need, and its base
/// LatticeDescription describes nodes to reports. Derived classes decide which nodes a layer has:
/// srs_lattice.hpp has a grid of arm angles, explicit_lattice.hpp a list of nodes. docs/model.md
/// defines all of this.
///
/// A slot is the number of a node within its layer, in the order that settles ties; a slot may
/// stand for no node. Configurations are in rad, by joint; lengths are in m. A lattice is immutable
/// once made, except by take_clearances(), so that threads may share it. Every function that
/// returns the joints of a node returns the same values, bit for bit.
class Lattice : public BodyPoseClasses, public LatticeDescription {
 public:
  [[nodiscard]] const Chain& chain() const { return *chain_; }
  [[nodiscard]] const ToolPath& path() const { return *path_; }
  [[nodiscard]] const Limits& limits() const { return limits_; }
  /// Replaces the clearances and the edge mode by those of `limits`. No node and no edge of the
  /// lattice depends on them.
  void take_clearances(const Limits& limits) { limits_ = with_clearances(limits_, limits); }
  /// Returns the limits `kinematics` with clearances and edge mode replaced by those of
  /// `clearances`.
  [[nodiscard]] static Limits with_clearances(Limits kinematics, const Limits& clearances) {
    kinematics.clearance = clearances.clearance;
    kinematics.self_clearance = clearances.self_clearance;
    kinematics.edges = clearances.edges;
    kinematics.edge_clearance = clearances.edge_clearance;
    kinematics.edge_tolerance = clearances.edge_tolerance;
    return kinematics;
  }
  [[nodiscard]] const Cost& cost() const { return cost_; }
  [[nodiscard]] int layers() const { return path_->size(); }

  // --- nodes
  /// Returns the number of slots of a layer, which are 0 ... slots - 1.
  [[nodiscard]] virtual int slots(int layer) const = 0;
  /// Returns the number of nodes of all layers together.
  [[nodiscard]] virtual std::int64_t nodes() const = 0;
  /// Returns the joints of a node; nothing if the slot has no node.
  [[nodiscard]] virtual std::optional<Config> node(int layer, int slot) const = 0;
  /// Returns the joints that a trajectory has at the node with joints `q`: joints that reach the
  /// tool pose on the exact chain and keep the limits. For an arm with an exact closed form this is
  /// `q` itself. Any other arm has the nodes of the ideal S-R-S arm fitted to it, and Newton's
  /// method finds the exact joints near each. Returns nothing if Newton does not converge or its
  /// result is outside the limits; the node is then invalid.
  [[nodiscard]] virtual std::optional<Config> exact_config(int layer, int slot,
                                                           const Config& q) const;
  /// Returns the exact joints of the node of a slot; nothing if it has no node or no exact joints.
  [[nodiscard]] std::optional<Config> exact_config(int layer, int slot) const;
  /// Returns whether nodes are only near their exact joints, so that exact_config() differs from
  /// node().
  [[nodiscard]] virtual bool is_approximate() const { return false; }
  struct Node {
    int slot = 0;
    Config q;
  };
  /// Replaces `out` by all nodes of a layer that exist, in the order of their slots.
  virtual void layer_nodes(int layer, std::vector<Node>& out) const = 0;
  /// Returns whether a posture that the problem gives is the only node of a layer: its start in
  /// layer 0, or its end in the last layer.
  [[nodiscard]] bool is_given(int layer) const {
    return (layer == 0 && starts_given_) || (layer == layers() - 1 && end_);
  }
  /// Returns whether a path must end at the node at which it begins (Task::closed): the nodes of
  /// the last layer are those of layer 0, slot by slot and bit for bit.
  [[nodiscard]] bool is_closed() const { return path_->closed() && !starts_given_; }
  /// Returns whether joints `q` keep limits().manipulability. Every other condition on a node is
  /// part of node() and exact_config().
  [[nodiscard]] bool manipulable(const Config& q) const;
  [[nodiscard]] bool asks_manipulability() const { return limits_.manipulability > 0; }

  // --- layers of the tool's path between two layers of the lattice
  /// Returns whether the lattice has nodes only at its knots, every few layers of the tool's path.
  /// Between two knots the joints follow the chord from node to node, evenly over the travel, each
  /// layer's moved onto its tool pose by Newton steps of least weighted norm. What nodes and moves
  /// must keep then also holds at the layers between, and is part of an edge's validity.
  [[nodiscard]] bool has_layers_between() const { return !knots_.are_all(); }
  /// Returns the layers of path_of_rows() that are layers of the lattice.
  [[nodiscard]] const Knots& knots() const { return knots_; }
  /// Returns the path that has a layer for each row of a trajectory: path(), or the finer path that
  /// includes the layers between if has_layers_between().
  [[nodiscard]] const ToolPath& path_of_rows() const { return knots_.whole(); }
  /// Returns the layer of path_of_rows() at which `layer` of the lattice is.
  [[nodiscard]] int layer_of_rows(int layer) const { return knots_.layer(layer); }
  /// Returns whether a step has layers between that may have nodes in a lattice by with_knots().
  [[nodiscard]] bool can_halve(int step) const {
    return layer_of_rows(step + 1) - layer_of_rows(step) > 1;
  }
  /// Returns a lattice that has a layer more in the middle of each of some steps, given by the
  /// layers at which they begin; those without layers between are left out. The nodes of all other
  /// layers stay what they are. Returns null if all are left out, or if the lattice cannot have
  /// more layers. Throws Stopped.
  [[nodiscard]] virtual std::unique_ptr<Lattice> with_knots(const std::set<int>& steps,
                                                            const Budget& budget) const {
    static_cast<void>(steps), static_cast<void>(budget);
    return nullptr;
  }
  /// Returns the steps of each with_knots() call that led to this lattice, the first one first.
  [[nodiscard]] const std::vector<std::set<int>>& halvings() const { return knots_.halvings(); }
  /// How far a move turns the tool about its own z axis, compared with what limits.roll_slope
  /// allows for the distance that the tool travels meanwhile.
  struct RollStep {
    double change = 0, most = 0;  ///< rad
    double over = 0;              ///< m
    bool allowed = true;
  };
  /// The trajectory rows between row qa (slot a of a layer) and row qb (slot b of the next), up to
  /// the first requirement that fails, if any; clearances are not looked at.
  struct InterpolatedEdge {
    enum class Fault : std::uint8_t {
      kNone,
      kNoIk,
      kSingular,
      kLimit,
      kManipulability,
      kStep,
      kRollSlope,
      kPathError,
      kAngleError
    };
    std::vector<Config> rows;
    std::vector<double> rolls;  ///< of the rows, rad; none where no roll is chosen
    Fault fault = Fault::kNone;
    /// For kLimit: bit k is set if joint k is outside its limits.
    std::uint8_t joints = 0;
    /// The row at fault, if it has joints; for a move, the row that it leads to.
    Config q = Config::Zero();
    RollStep roll;  ///< for kRollSlope
  };
  [[nodiscard]] InterpolatedEdge interpolate_edge(int layer, int a, const Config& qa, int b,
                                                  const Config& qb) const;

  // --- paths, each given by one slot for each layer from layer 0 on
  using Joints = std::array<bool, kDof>;
  /// Returns which joints are treated as circles although they are bounded: those with a range of
  /// more than a turn, until with_windings() tells their turns apart.
  [[nodiscard]] const Joints& circles() const { return circles_; }
  /// Returns the joints of each row of a path, from layer 0 to that of its last slot, with those at
  /// the layers between; joints that turn do not jump. Circles are turned as a whole so that all
  /// rows are inside their limits and the first one is as near to the middle of its range as
  /// possible, the lower of two equally near, or so that the path begins at the given start, or
  /// ends at the given end. Returns an empty list if off_limits() has any.
  [[nodiscard]] std::vector<Config> path_joints(const std::vector<int>& slots) const;
  /// Returns the trajectory rows of a path: the joints of path_joints() with path length, arm angle
  /// and branch of each row.
  [[nodiscard]] virtual std::vector<TrajectoryRow> path_rows(const std::vector<int>& slots) const;
  /// Returns the circle that leaves its limits along a path in every turn, of several the one that
  /// leaves them furthest. If the best path of a lattice has none, it is the answer; else the turns
  /// of that joint must be told apart.
  [[nodiscard]] Joints off_limits(const std::vector<int>& slots) const;
  /// Returns a lattice in which the given joints are no longer circles: for each node, every
  /// combination of their values within the limits that differ by whole turns is a node of its own.
  /// Returns null for a lattice that treats no bounded joint as a circle.
  [[nodiscard]] virtual std::unique_ptr<Lattice> with_windings(const Joints& joints) const;
  /// Returns the arguments of the with_windings() calls that led to this lattice, the first one
  /// first.
  [[nodiscard]] virtual std::vector<Joints> joints_with_windings() const { return {}; }
  /// Returns the slot that a node has in the lattice before any with_windings() call, where it is
  /// one node with its images in other turns; -1 where that is not known.
  [[nodiscard]] virtual int slot_on_circles(int layer, int slot) const {
    static_cast<void>(layer);
    return joints_with_windings().empty() ? slot : -1;
  }

  // --- description, see LatticeDescription
  [[nodiscard]] LatticeInfo describe() const override;
  [[nodiscard]] int next_on_arc(int layer, int slot) const override {
    return neighbour_in_redundancy(layer, slot, 1);
  }

  // --- nodes near a node
  /// Returns the slot before (`by` = -1) or after (+1) a node along the redundancy coordinate; -1
  /// if there is none.
  [[nodiscard]] virtual int neighbour_in_redundancy(int layer, int slot, int by) const = 0;
  /// Returns the slot before (`by` = -1) or after (+1) a node along the roll, the second redundancy
  /// coordinate; -1 if there is none, or if the lattice has no such coordinate.
  [[nodiscard]] virtual int neighbour_in_roll(int layer, int slot, int by) const {
    static_cast<void>(layer), static_cast<void>(slot), static_cast<void>(by);
    return -1;
  }
  /// Returns the slot in the layer before (`by` = -1) or after (+1) that continues a node; -1 if
  /// there is none.
  [[nodiscard]] virtual int neighbour_along_path(int layer, int slot, int by) const = 0;

  // --- edges from slot a of `layer` to slot b of layer + 1; joints are those of node() unless the
  // comment says otherwise
  /// The slots first ... last - 1 of a layer.
  struct SlotRun {
    int first = 0, last = 0;
  };
  /// Returns whether an edge may join the two slots, judged by their slots alone.
  [[nodiscard]] virtual bool in_window(int layer, int a, int b) const = 0;
  /// Returns whether an edge may join the two slots, judged by their slots and without regard to
  /// rolls.
  [[nodiscard]] virtual bool in_arm_window(int layer, int a, int b) const {
    return in_window(layer, a, b);
  }
  /// Returns by how much the move from row q0 (slot a) to row q1 (slot b) turns the tool about its
  /// own z axis; nothing if the tool is not free to turn.
  [[nodiscard]] virtual std::optional<RollStep> roll_step(int layer, int a, const Config& q0, int b,
                                                          const Config& q1) const;
  /// Replaces `out` by the runs of slots b for which in_window(layer, a, b) holds.
  virtual void successors(int layer, int a, std::vector<SlotRun>& out) const = 0;
  /// Returns q1 - q0, rad, wrapped into one turn for continuous joints.
  [[nodiscard]] Config delta(const Config& q0, const Config& q1) const;
  /// Returns for each joint a number, rad, that the absolute value of no delta(q, p) is less than,
  /// for all p with lower <= p <= upper.
  [[nodiscard]] Config least_delta(const Config& q, const Config& lower, const Config& upper) const;
  /// Returns whether every |delta_j| is within step_bound(layer).
  [[nodiscard]] bool step_allowed(int layer, const Config& delta) const;
  /// Returns the largest |delta_j| between nodes on the step from `layer`, rad, by joint: the least
  /// of joint_step and what the speed limits allow; for the roll of an arm of six joints, what
  /// roll_slope allows (roll_step_bound()). It is wider than row_step_bound() by twice the fit
  /// error.
  [[nodiscard]] const Config& step_bound(int layer) const {
    return step_bounds_[step_bounds_.size() == 1 ? 0 : static_cast<std::size_t>(layer)];
  }
  /// Returns whether a move between rows keeps row_step_bound(). Where is_approximate(), this is
  /// part of an edge's validity.
  [[nodiscard]] bool row_step_allowed(int layer, const Config& delta) const;
  [[nodiscard]] const Config& row_step_bound(int layer) const {
    return row_step_bounds_[row_step_bounds_.size() == 1 ? 0 : static_cast<std::size_t>(layer)];
  }
  /// Returns by how much the joints of a row differ from those of their node on this arm, as
  /// measured (SrsArm::fit_error), rad, by joint; 0 if every node is exact. Limits and steps of
  /// nodes are wider by this, so that few rows are missed.
  [[nodiscard]] const Config& fit_error() const { return fit_error_; }
  /// Returns the cost of a move by `delta`, rad, in the cost metric: a multiple of 2^-40
  /// cost_unit().
  [[nodiscard]] double edge_cost(const Config& delta) const;
  /// Returns whether the joint-linear move from row q0 (slot a) to row q1 (slot b) keeps the limits
  /// on tool path error, tool angle error and step error that are set.
  [[nodiscard]] bool follows_path(int layer, int a, const Config& q0, int b,
                                  const Config& q1) const;
  /// Returns whether the move from slot a to slot b keeps the limit on step error, if that is set.
  [[nodiscard]] bool keeps_step_error(int layer, int a, int b) const {
    return !limits_.step_error || step_error_allowed(layer, a, b);
  }
  [[nodiscard]] bool asks_path_error() const {
    return limits_.tool_path_error || limits_.tool_angle_error || limits_.step_error;
  }

  [[nodiscard]] const std::array<bool, kDof>& continuous() const { return continuous_; }
  /// Returns by what the cost metric multiplies the move of each joint: the weights, or 1/speed,
  /// s/rad, for CostMetric::kTime.
  [[nodiscard]] const std::array<double, kDof>& cost_scale() const { return cost_scale_; }
  /// Returns the least power of two that no cost_scale() exceeds, nor the cost of half a turn of
  /// roll at any layer; 1 where all are 0. Costs are rounded to 2^-40 of this unit, so that sums of
  /// a path's costs are exact whatever the size of the weights.
  [[nodiscard]] double cost_unit() const { return cost_unit_; }
  /// Returns a cost of up to 2048 cost_unit(), rounded as edge_cost() rounds.
  [[nodiscard]] double rounded_cost(double cost) const;
  // --- the order of answers: by coarse cost, off_middle() and slot of the first node; then by
  // cost, then by slots (docs/model.md)
  /// Returns the cost of a path in whole steps of 2^-24 cost_unit(), rounded to the nearest. Costs
  /// of mirrored branches differ by rounding errors far below such a step, so that their coarse
  /// costs are equal.
  [[nodiscard]] double coarse_cost(double cost) const { return std::round(cost * steps_); }
  /// Returns a bound that no cost with the coarse cost of `cost` exceeds.
  [[nodiscard]] double largest_of_same_coarse_cost(double cost) const {
    return (coarse_cost(cost) + 0.5) / steps_;
  }
  /// Returns how far joints are from the middles of their ranges: the sum over the joints of
  /// distance times weight in steps of 2^-24 cost_unit(), each term rounded. The weight is
  /// cost_scale(), but at least a hundredth of the largest, and 1 where all are 0. A joint without
  /// a range (continuous, or of over 64 turns) counts nothing. A bounded joint that is treated as a
  /// circle counts at the image within its limits that is nearest to the middle.
  [[nodiscard]] double off_middle(const Config& q) const;
  /// Returns whether nodes have a cost of their own besides the costs of edges.
  [[nodiscard]] virtual bool has_node_costs() const { return false; }
  /// Returns the cost of a node, >= 0, rounded as edge_cost() rounds.
  [[nodiscard]] virtual double node_cost(int layer, int slot) const {
    static_cast<void>(layer), static_cast<void>(slot);
    return 0;
  }
  /// Returns the cost of a tool that stands turned by `roll` (rad) at a layer: Cost::roll times
  /// |roll| times the layer's share of the path, which is half of the step before it and half of
  /// the one after.
  [[nodiscard]] double roll_cost(int layer, double roll) const;
  /// Returns roll_cost() per rad at a layer; 0 where the roll costs nothing.
  [[nodiscard]] double roll_weight(int layer) const;
  [[nodiscard]] bool roll_costs() const { return !roll_weights_.empty(); }

 protected:
  Lattice(const Lattice&) = default;  // derived classes copy themselves
  /// Builds what all lattices share. `fit_error`: rad, by joint. Throws InputError if a speed limit
  /// of the tool or the time metric needs joint speeds that the robot does not state, if such a
  /// speed is outside of 1e-6 ... 1e6 rad/s, or if limits.joint_margin leaves a joint no range.
  Lattice(const Chain& chain, Knots knots, const PathProblem& problem,
          const Config& fit_error = Config::Zero());
  /// Returns the largest move of each joint, rad, on each step of a path; one entry if all steps
  /// are alike.
  [[nodiscard]] static std::vector<Config> step_bounds_along(const Chain& chain,
                                                             const ToolPath& path,
                                                             const Limits& limits,
                                                             const Resolution& resolution);
  /// Calls visit(x) for the values of bounded joint j that differ from q by whole turns and lie
  /// within its limits less limits().joint_margin, lowest first.
  template <class Visit>
  void each_image(std::size_t j, double q, const Visit& visit) const {
    const double lower = chain_->limit[j].lower + limits_.joint_margin,
                 upper = chain_->limit[j].upper - limits_.joint_margin;
    for (double x = q + kTwoPi * std::ceil((lower - q) / kTwoPi); x <= upper; x += kTwoPi) visit(x);
  }
  /// Returns the term of off_middle() for bounded joint j at value x, rad.
  [[nodiscard]] double off_middle(std::size_t j, double x) const {
    return std::round(middle_weight_[j] *
                      std::abs(x - (chain_->limit[j].lower + chain_->limit[j].upper) / 2) * steps_);
  }
  /// Treats joints as circles from now on, besides those that are continuous.
  void treat_as_circles(const Joints& circles);
  /// Turns the rows of a whole path that leads to a given end by whole turns of its joints, so that
  /// the last row is that end; rows that begin at a given start stay. Joints of the last row that
  /// equal the end's but for rounding become the end's, and on a closed path those of the first.
  void turn_to_end(std::vector<Config>& rows) const;
  /// Sets row_step_bound() of every step (one entry if all are alike), and step_bound() from it.
  void set_row_step_bounds(std::vector<Config> bounds);
  /// Returns whether the larger of the second-order estimates of step error at both ends of an edge
  /// is within limits().step_error. Asked only if that is set.
  [[nodiscard]] virtual bool step_error_allowed(int layer, int a, int b) const = 0;

  // --- rows between two knots, from slot a of `layer` to slot b of the next; `i` is the layer of
  // path_of_rows(), which is at the share t of the way
  /// Returns the joints at layer i to which Newton steps of least norm lead from those on the
  /// chord; nothing where they lead to none. Asked only if has_layers_between().
  [[nodiscard]] virtual std::optional<Config> row_between(int layer, int a, int b, int i, double t,
                                                          const Config& chord) const;
  /// Returns whether the roll is chosen besides the joints, so that rows have roll_of_row().
  [[nodiscard]] virtual bool chooses_roll() const { return false; }
  /// Returns the roll of the row with joints q at layer i, rad; at the nodes i is their layer, and
  /// t 0 or 1.
  [[nodiscard]] virtual double roll_of_row(int layer, int a, int b, int i, double t,
                                           const Config& q) const;
  /// Returns by how much the roll changes on the step to layer i between rows with joints and rolls
  /// `from` and `to`, rad; nothing where that is not limited from row to row.
  [[nodiscard]] virtual std::optional<RollStep> roll_between_rows(int i, const Config& from,
                                                                  double from_roll,
                                                                  const Config& to,
                                                                  double to_roll) const;
  /// Returns the row of joints at layer i at which the tool is turned by `roll`, rad. Asked only
  /// of layers between.
  [[nodiscard]] virtual TrajectoryRow row(int i, const Config& q, double roll) const;
  /// Returns the largest |delta_j| on the step from layer i of path_of_rows(), rad.
  [[nodiscard]] const Config& step_bound_of_rows(int i) const {
    return steps_of_rows_[steps_of_rows_.size() == 1 ? 0 : static_cast<std::size_t>(i)];
  }

  const Chain* chain_;
  Knots knots_;
  const ToolPath* path_;  // that of the knots
  Limits limits_;
  Cost cost_;
  std::array<bool, kDof> continuous_{};  // wide joints and joints treated as circles too
  Joints circles_{};                     // joints treated as circles although they are bounded
  bool starts_given_ = false;            // the path begins at PathProblem::start
  std::optional<Config> end_;            // PathProblem::end, unless the path ends early

 private:
  /// The rows of a path, in whatever turn circles are.
  struct Followed {
    std::vector<Config> q;
    std::vector<double> rolls;       // none unless chooses_roll()
    std::vector<std::size_t> nodes;  // the row of each slot
  };
  [[nodiscard]] Followed followed(const std::vector<int>& slots) const;
  [[nodiscard]] CircleTurns turns_along(const std::vector<Config>& rows) const;
  /// Turns the rows of a path into the limits of the circles. Returns false if they do not fit.
  bool turn_into_limits(std::vector<Config>& rows) const;
  /// Notes what joints `q` of a layer of path_of_rows() between two knots do not keep, if anything.
  void check_row(int i, const Config& q, InterpolatedEdge& edge) const;
  /// Notes what the move to row `to` of layer i of path_of_rows() does not keep, if anything.
  void check_step(int i, const Config& from, double from_roll, const Config& to, double to_roll,
                  InterpolatedEdge& edge) const;

  std::array<double, kDof> cost_scale_{};
  double cost_unit_ = 1, steps_ = 1;  // steps_: coarse steps in a cost of 1, 2^24 / cost_unit_
  std::array<double, kDof> middle_weight_{};
  std::vector<double> roll_weights_;   // by layer; empty where the roll costs nothing
  std::optional<Config> given_start_;  // PathProblem::start
  Config fit_error_;
  std::vector<Config> step_bounds_, row_step_bounds_;  // one entry for all steps, or one for each
  std::vector<Config> steps_of_rows_;                  // the same of path_of_rows()
};

/// Returns how far limits.joint_step lets each joint move between neighbouring layers: as many rad,
/// or, for a slide, kSlideForTurn as many m.
[[nodiscard]] Config joint_steps(const Chain& chain, const Limits& limits);
/// Returns by how much limits.roll_slope lets the roll of an arm of six joints change on a step,
/// rad: roll_slope times the step's travel or half of resolution.ds, whichever is longer, and half
/// a turn at most. Nodes that lie resolution.arc apart cannot express less.
[[nodiscard]] double roll_step_bound(const ToolPath& path, int step, const Limits& limits,
                                     const Resolution& resolution);

/// Returns the distance of the tool from its straight step at t = 1/4, 1/2 and 3/4 of a
/// joint-linear move from q0 by `delta` (rad), m. The step is the segment that leads from `layer`
/// of the path to the next: a tool that moves out beyond one of its ends is off the path.
[[nodiscard]] std::array<double, 3> path_deviation(const Chain& chain, const ToolPath& path,
                                                   int layer, const Config& q0,
                                                   const Config& delta);
/// Returns the angle between the tool and the path at t = 1/4, 1/2 and 3/4 of a joint-linear move
/// from q0 by `delta`, rad. Among the places of the straight step that are as near to the tool's
/// origin as any (places_near()), the path is taken at the one whose share of the step is nearest
/// to t: at t itself where the step has next to no length. For a tool that may turn about its z
/// axis only the angle between the z axes counts.
[[nodiscard]] std::array<double, 3> angle_deviation(const Chain& chain, const ToolPath& path,
                                                    int layer, const Config& q0,
                                                    const Config& delta);
/// Returns whether none of path_deviation() is above `most`, m, without which any is allowed.
[[nodiscard]] bool keeps_path_error(const Chain& chain, const ToolPath& path, int layer,
                                    const Config& q0, const Config& delta,
                                    const std::optional<double>& most);
/// Returns whether none of angle_deviation() is above `most`, rad, without which any is allowed.
[[nodiscard]] bool keeps_angle_error(const Chain& chain, const ToolPath& path, int layer,
                                     const Config& q0, const Config& delta,
                                     const std::optional<double>& most);

}  // namespace swivel
