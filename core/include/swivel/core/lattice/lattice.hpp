// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/lattice/body_pose_classes.hpp"
#include "swivel/core/lattice/lattice_description.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

struct TrajectoryRow;

inline constexpr double kLimitTolerance = 1e-9;  // rad: joint limits are inclusive within this

/// Layers of nodes along a tool path, and the joint-linear moves that may join neighbouring layers:
/// all that searches, verdicts and diagnosis know of an arm. This class is nodes and edges, which
/// searches need; its bases are what collision questions (BodyPoseClasses) and descriptions
/// (LatticeDescription) need besides. How a layer's nodes come about is the business of the classes
/// derived from it (srs_lattice.hpp: a grid of arm angles; explicit_lattice.hpp: a list of nodes).
/// docs/model.md. A slot numbers a layer's nodes in the order that settles ties; a slot may stand
/// for no node. Immutable once made, so safe to share between threads; the same node has the same
/// bits however asked.
class Lattice : public BodyPoseClasses, public LatticeDescription {
 public:
  [[nodiscard]] const Chain& chain() const { return *chain_; }
  [[nodiscard]] const ToolPath& path() const { return *path_; }
  [[nodiscard]] const Limits& limits() const { return limits_; }
  /// Takes over clearances and edge mode of other limits, on which no node and no edge of the
  /// lattice depends.
  void take_clearances(const Limits& limits) { limits_ = with_clearances(limits_, limits); }
  /// `kinematics` but for these.
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
  /// Slots of a layer: 0 ... slots - 1.
  [[nodiscard]] virtual int slots(int layer) const = 0;
  /// Of all layers.
  [[nodiscard]] virtual std::int64_t nodes() const = 0;
  /// One node; none where it does not exist.
  [[nodiscard]] virtual std::optional<Config> node(int layer, int slot) const = 0;
  /// The joints that a trajectory has at a node, whose own joints are q: on the exact chain, within
  /// the limits. Nodes of arms with an exact closed form are exact themselves. Other arms have the
  /// nodes of the ideal arm fitted to them, and rows that Newton finds near those; none where it
  /// does not, or where that row is outside the limits: the node is then invalid.
  [[nodiscard]] virtual std::optional<Config> exact_config(int layer, int slot,
                                                           const Config& q) const;
  /// Of a slot; none where the node does not exist, too.
  [[nodiscard]] std::optional<Config> exact_config(int layer, int slot) const;
  /// False where every node is exact.
  [[nodiscard]] virtual bool is_approximate() const { return false; }
  struct Node {
    int slot = 0;
    Config q;
  };
  /// Replaces `out` by all nodes of a layer that exist, in the order of slots.
  virtual void layer_nodes(int layer, std::vector<Node>& out) const = 0;
  /// Manipulability bound of a row alone; everything else that makes a node kinematically valid is
  /// in node() and exact_config().
  [[nodiscard]] bool manipulable(const Config& q) const;
  [[nodiscard]] bool asks_manipulability() const { return limits_.manipulability > 0; }

  // --- layers of the tool's path that lie between two of the lattice
  /// Whether there are any: of lattices that choose a node every so many layers of the path
  /// (roll_lattice.hpp). What nodes and moves must keep then holds in all of these as well, and is
  /// part of an edge's validity.
  [[nodiscard]] virtual bool has_layers_between() const { return false; }
  /// The path whose layers are the rows of a trajectory: path(), and where has_layers_between() the
  /// one with those as well.
  [[nodiscard]] virtual const ToolPath& path_of_rows() const { return *path_; }
  /// The layer of path_of_rows() that is a layer of the lattice.
  [[nodiscard]] virtual int layer_of_rows(int layer) const { return layer; }
  /// How far a move turns the tool about its z axis, and what limits.roll_slope allows over its
  /// travel.
  struct RollStep {
    double change = 0, most = 0;  ///< rad
    double over = 0;              ///< m
    bool allowed = true;
  };
  /// The rows between row qa (slot a) and row qb (slot b of the next layer), as far as they exist
  /// and keep all but clearance; and what the next row, or the move to it, does not keep.
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
    Fault fault = Fault::kNone;
    std::uint8_t joints = 0;  ///< of kLimit: bit k: joint k is outside its limits
    Config q =
        Config::Zero();  ///< of the row at fault, where it has joints; of a move, where it leads to
    RollStep roll;       ///< of kRollSlope
  };
  [[nodiscard]] virtual InterpolatedEdge interpolate_edge(int layer, int a, const Config& qa, int b,
                                                          const Config& qb) const;

  // --- paths: one slot in each layer, from the first on
  /// The joints of the rows of a path: continuous joints go on without jumps. Empty where the
  /// lattice takes bounded joints of more than a turn as circles and their values leave the limits
  /// along this path.
  [[nodiscard]] virtual std::vector<Config> path_joints(const std::vector<int>& slots) const;
  /// What path_joints() returns, with what a trajectory says of each row; and with the rows at the
  /// layers of the tool's path that lie between those of the lattice.
  [[nodiscard]] virtual std::vector<TrajectoryRow> path_rows(const std::vector<int>& slots) const;
  using Joints = std::array<bool, kDof>;
  /// The joints that the lattice takes as circles and that leave their limits along a path where
  /// their first row is turned nearest to the middle of their range, whether another turn keeps the
  /// limits or not. The best path of a lattice on which there is none is the answer.
  [[nodiscard]] virtual Joints off_nearest(const std::vector<int>& slots) const {
    static_cast<void>(slots);
    return {};
  }
  /// The same nodes with each value of these joints that lies within the limits as a node of its
  /// own: they are circles no more. Null for lattices that take no bounded joint as a circle.
  [[nodiscard]] virtual std::unique_ptr<Lattice> with_windings(const Joints& joints) const;
  /// What with_windings() was called with, from the lattice without on.
  [[nodiscard]] virtual std::vector<Joints> joints_with_windings() const { return {}; }

  // --- description, see LatticeDescription
  [[nodiscard]] LatticeInfo describe() const override;
  [[nodiscard]] int next_on_arc(int layer, int slot) const override {
    return neighbour_in_redundancy(layer, slot, 1);
  }

  // --- nodes near a node
  /// The slot before (by -1) or after (+1) it along the redundancy coordinate; -1 where there is
  /// none.
  [[nodiscard]] virtual int neighbour_in_redundancy(int layer, int slot, int by) const = 0;
  /// The same along a second redundancy coordinate, where there is one.
  [[nodiscard]] virtual int neighbour_in_roll(int layer, int slot, int by) const {
    static_cast<void>(layer), static_cast<void>(slot), static_cast<void>(by);
    return -1;
  }
  /// The slot of a neighbouring layer (by -1 or +1) that continues it; -1 where there is none.
  [[nodiscard]] virtual int neighbour_along_path(int layer, int slot, int by) const = 0;

  // --- edges between slot a of `layer` and slot b of the next; joints as node() gives them, where
  // not said otherwise
  /// Slots first ... last - 1.
  struct SlotRun {
    int first = 0, last = 0;
  };
  /// Whether the two may be joined as far as slots tell.
  [[nodiscard]] virtual bool in_window(int layer, int a, int b) const = 0;
  /// The same as far as anything but the roll tells.
  [[nodiscard]] virtual bool in_arm_window(int layer, int a, int b) const {
    return in_window(layer, a, b);
  }
  /// By how much the move from row q0 (slot a) to row q1 (slot b) turns a tool that may stand
  /// turned; none for other tools.
  [[nodiscard]] virtual std::optional<RollStep> roll_step(int layer, int a, const Config& q0, int b,
                                                          const Config& q1) const;
  /// Replaces `out` by the runs of slots b for which in_window(layer, a, b).
  virtual void successors(int layer, int a, std::vector<SlotRun>& out) const = 0;
  /// q1 - q0, on the circle for continuous joints.
  [[nodiscard]] Config delta(const Config& q0, const Config& q1) const;
  /// Every |delta| within step_bound().
  [[nodiscard]] bool step_allowed(int layer, const Config& delta) const;
  /// Largest |delta_j| allowed on the step from `layer`: joint_step, speed limits and, of the roll
  /// of an arm of six joints, what roll_slope allows (roll_step_bound()); widened by twice the fit
  /// error.
  [[nodiscard]] const Config& step_bound(int layer) const {
    return step_bounds_[step_bounds_.size() == 1 ? 0 : static_cast<std::size_t>(layer)];
  }
  /// The same of a move between rows, by joint_step and speed limits as they are: part of an edge's
  /// validity where is_approximate().
  [[nodiscard]] bool row_step_allowed(int layer, const Config& delta) const;
  [[nodiscard]] const Config& row_step_bound(int layer) const {
    return row_step_bounds_[row_step_bounds_.size() == 1 ? 0 : static_cast<std::size_t>(layer)];
  }
  /// By how much a row's joints differ from their node's on this arm, as measured
  /// (SrsArm::fit_error), rad: 0 where every node is exact. Limits and steps of nodes are wider by
  /// it, so that few rows are missed.
  [[nodiscard]] const Config& fit_error() const { return fit_error_; }
  /// Cost of a move, a multiple of 2^-40 units.
  [[nodiscard]] double edge_cost(const Config& delta) const;
  /// Tool-path, tool-angle and step-error bounds of the joint-linear move from row q0 (slot a) to
  /// row q1 (slot b).
  [[nodiscard]] bool follows_path(int layer, int a, const Config& q0, int b,
                                  const Config& q1) const;
  /// The step error of that move alone is allowed.
  [[nodiscard]] bool keeps_step_error(int layer, int a, int b) const {
    return !limits_.step_error || step_error_allowed(layer, a, b);
  }
  [[nodiscard]] bool asks_path_error() const {
    return limits_.tool_path_error || limits_.tool_angle_error || limits_.step_error;
  }

  [[nodiscard]] const std::array<bool, kDof>& continuous() const { return continuous_; }
  /// What each joint's move is multiplied by before the metric: the weights, or 1/speed for
  /// CostMetric::kTime.
  [[nodiscard]] const std::array<double, kDof>& cost_scale() const { return cost_scale_; }
  /// The least power of two that no cost_scale() and no roll_cost() exceeds; 1 where all are 0.
  /// Costs are rounded in this unit, so sums of a path's costs are exact whatever the size of the
  /// weights.
  [[nodiscard]] double cost_unit() const { return cost_unit_; }
  /// A cost of up to 2048 units, rounded as edge_cost() is.
  [[nodiscard]] double rounded_cost(double cost) const;
  // --- the order of answers: coarse cost, off_middle() and slot of the first node; then cost, then
  // slots (docs/model.md)
  /// The cost of a path in whole steps of 2^-24 units, rounded to the nearest. Costs of mirrored
  /// branches differ by rounding errors far below such a step, so that their coarse costs are
  /// equal.
  [[nodiscard]] double coarse_cost(double cost) const { return std::round(cost * steps_); }
  /// No cost with the same coarse cost is larger.
  [[nodiscard]] double largest_of_same_coarse_cost(double cost) const {
    return (coarse_cost(cost) + 0.5) / steps_;
  }
  /// How far joints are from the middles of their ranges: the sum over the joints of distance times
  /// weight, in the same steps, each rounded. The weight is cost_scale(), but at least a hundredth
  /// of the largest, and 1 where all are 0. A joint without a range (continuous, or of over 64
  /// turns) counts nothing. A bounded joint that is taken as a circle counts at the image within
  /// its limits that is nearest to the middle.
  [[nodiscard]] double off_middle(const Config& q) const;
  /// Whether nodes cost something by themselves, besides the edges to and from them.
  [[nodiscard]] virtual bool has_node_costs() const { return false; }
  /// What one costs, >= 0 and rounded.
  [[nodiscard]] virtual double node_cost(int layer, int slot) const {
    static_cast<void>(layer), static_cast<void>(slot);
    return 0;
  }
  /// What it costs that the tool stands turned by so much (rad) at a layer: Cost::roll, for the
  /// length of path that is the layer's, half of the step before it and half of the one after.
  [[nodiscard]] double roll_cost(int layer, double roll) const;
  /// That cost per rad; 0 where the roll costs nothing.
  [[nodiscard]] double roll_weight(int layer) const;
  [[nodiscard]] bool roll_costs() const { return !roll_weights_.empty(); }

 protected:
  Lattice(const Lattice&) = default;  // copied whole, as what it is
  /// Throws InputError where a speed limit or the metric asks for joint speeds that the robot does
  /// not state.
  Lattice(const Chain& chain, const ToolPath& path, const Problem& problem,
          const Config& fit_error = Config::Zero());
  /// Largest move of each joint on each step of a path; one entry where all are the same.
  [[nodiscard]] static std::vector<Config> step_bounds_along(const Chain& chain,
                                                             const ToolPath& path,
                                                             const Limits& limits,
                                                             const Resolution& resolution);
  /// Calls visit(x) for the values of bounded joint j that differ from q by whole turns and lie
  /// within its limits, lowest first.
  template <class Visit>
  void each_image(std::size_t j, double q, const Visit& visit) const {
    const double lower = chain_->limit[j].lower + limits_.joint_margin,
                 upper = chain_->limit[j].upper - limits_.joint_margin;
    for (double x = q + kTwoPi * std::ceil((lower - q) / kTwoPi); x <= upper; x += kTwoPi) visit(x);
  }
  /// What a bounded joint's value counts in off_middle().
  [[nodiscard]] double off_middle(std::size_t j, double x) const {
    return std::round(middle_weight_[j] *
                      std::abs(x - (chain_->limit[j].lower + chain_->limit[j].upper) / 2) * steps_);
  }
  /// Of every step.
  void set_row_step_bounds(std::vector<Config> bounds);
  /// The larger of the second-order estimates at both ends of an edge is within
  /// limits().step_error. Asked only where that is set.
  [[nodiscard]] virtual bool step_error_allowed(int layer, int a, int b) const = 0;

  const Chain* chain_;
  const ToolPath* path_;
  Limits limits_;
  Cost cost_;
  std::array<bool, kDof> continuous_{};  // wide joints, too

 private:
  std::array<double, kDof> cost_scale_{};
  double cost_unit_ = 1, steps_ = 1;  // of coarse costs, in 1: 2^24 / unit
  std::array<double, kDof> middle_weight_{};
  std::vector<double> roll_weights_;  // by layer; empty where the roll costs nothing
  Config fit_error_;
  std::vector<Config> step_bounds_, row_step_bounds_;  // one for all steps, or one each
};

/// By how much limits.roll_slope lets the roll of an arm of six joints change on a step, rad: over
/// the step's travel, and over half of resolution.ds where a stretch of the path is shorter than
/// that, since nodes that lie `arc` apart express no less.
[[nodiscard]] double roll_step_bound(const ToolPath& path, int step, const Limits& limits,
                                     const Resolution& resolution);

/// Distance of the tool from its straight step, at t = 1/4, 1/2, 3/4 of a joint-linear move, m.
[[nodiscard]] std::array<double, 3> path_deviation(const Chain& chain, const ToolPath& path,
                                                   int layer, const Config& q0,
                                                   const Config& delta);
/// Angle between the tool and the path at the foot of that distance, rad.
[[nodiscard]] std::array<double, 3> angle_deviation(const Chain& chain, const ToolPath& path,
                                                    int layer, const Config& q0,
                                                    const Config& delta);

}  // namespace swivel
