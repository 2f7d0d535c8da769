// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/budget.hpp"
#include "swivel/core/problem.hpp"
#include "swivel/core/srs.hpp"
#include "swivel/core/tool_path.hpp"

namespace swivel {

/// Why a node does not exist, before collision is asked.
enum class NodeStatus : std::uint8_t { kValid, kNoIk, kSingular, kLimit };

/// The joints of all labels of one layer over a run of arm angles. Reused from layer to layer; nothing is stored per lattice node.
/// Labels share the arrays of what they have in common: four branches have a triple's solution each.
class LayerNodes {
 public:
  /// Joint k (0..6) of label, an array over the run.
  [[nodiscard]] const double* q(int label, int k) const { return data_.data() + at(label).q[static_cast<std::size_t>(k)]; }
  /// Arrays over the run, of zeros and infinities: a node exists (IK, singularity, limits) where both are 0.
  [[nodiscard]] const double* shoulder_bar(int label) const { return data_.data() + at(label).bar[0]; }
  [[nodiscard]] const double* wrist_bar(int label) const { return data_.data() + at(label).bar[1]; }
  [[nodiscard]] bool valid(int label, int k) const { return shoulder_bar(label)[k] + wrist_bar(label)[k] == 0; }
  /// False where no node of the label exists, whatever the arm angle.
  [[nodiscard]] bool alive(int label) const { return at(label).alive; }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] std::size_t bytes() const { return static_cast<std::size_t>(data_.size()) * sizeof(double); }
  /// Copies `count` entries of every array from one place of the run to another.
  void repeat(int from, int to, int count);
  [[nodiscard]] Config config(int label, int k) const {
    Config c;
    for (int j = 0; j < kDof; ++j) c[j] = q(label, j)[k];
    return c;
  }

 private:
  friend class Lattice;
  struct Offsets {  // into data_
    std::array<std::size_t, kDof> q{};
    std::array<std::size_t, 2> bar{};
    bool alive = false;
  };
  [[nodiscard]] const Offsets& at(int label) const { return offsets_[static_cast<std::size_t>(label)]; }
  struct Layout {  // what the offsets depend on
    std::uint64_t lattice = 0;
    int count = 0;
    bool elbow0 = false, elbow1 = false, start = false;
    bool operator==(const Layout&) const = default;
  };
  Layout layout_;
  int layer_ = -1, first_ = 0, count_ = 0;
  Eigen::ArrayXd data_;
  std::vector<Offsets> offsets_;  // [label]
};

/// The images of a bounded joint, an angle plus whole turns, are told apart as windings: as many as the range has turns, begun ones
/// counted. A begun turn of up to 1e-3 rad, as limits written 3.1416 have it, is cut off at the upper end, or at the lower where a
/// given start lies in it: no pose is lost by that, but joints do not move through the part that was cut off. A joint with a range
/// of over 64 turns is treated as a continuous one (JointLimit::wide): its angles begin in the turn about 0, or in the nearest that
/// leaves 31 turns to both limits.
///
/// The (s, phi) lattice of a problem: layers along the path, a circle of arm angles in each, `labels` = 8 branches x windings of
/// nodes at each angle. design.md 1. A slot numbers a layer's nodes in the order of ties: (branch, winding, j) = label * angles +
/// j. Immutable, so safe to share between threads. Nodes are computed when asked for; the same node has the same bits however
/// asked.
class Lattice {
 public:
  /// Throws InputError when the start does not fit, for more than 1024 windings, and when the lattice is too large for the memory
  /// of the machine. Throws Stopped.
  Lattice(const Chain& chain, const SrsArm& arm, const ToolPath& path, const Problem& problem, const Budget& budget = {});

  [[nodiscard]] int layers() const { return path_->size(); }
  [[nodiscard]] int angles() const { return angles_; }
  [[nodiscard]] int labels() const { return kBranches * windings_; }
  [[nodiscard]] int windings() const { return windings_; }
  [[nodiscard]] int window() const { return window_; }
  /// Slots per layer.
  [[nodiscard]] int width() const { return labels() * angles_; }
  [[nodiscard]] std::int64_t nodes() const { return static_cast<std::int64_t>(layers()) * width(); }
  [[nodiscard]] int label_of(int slot) const { return slot / angles_; }
  [[nodiscard]] int angle_of(int slot) const { return slot % angles_; }
  [[nodiscard]] int branch_of(int slot) const { return label_of(slot) / windings_; }

  [[nodiscard]] const Chain& chain() const { return *chain_; }
  [[nodiscard]] const SrsArm& arm() const { return *arm_; }
  [[nodiscard]] const ToolPath& path() const { return *path_; }
  [[nodiscard]] const Limits& limits() const { return limits_; }
  [[nodiscard]] const Cost& cost() const { return cost_; }
  [[nodiscard]] const ArmPlane& plane(int layer) const { return planes_[static_cast<std::size_t>(layer)]; }

  /// Carried arm angle of a node, rad.
  [[nodiscard]] double phi(int layer, int slot) const;
  /// True where layer 0 is the given start alone.
  [[nodiscard]] bool has_start() const { return start_.has_value(); }
  /// Slot that stands for the given start in layer 0 (its label, the grid angle nearest to its own).
  [[nodiscard]] int start_slot() const { return start_->slot; }

  /// Nodes j = first ... first + count - 1 of every label, taken around the circle; first < angles, count <= 2 angles.
  void solve(int layer, int first, int count, LayerNodes& out) const;
  void solve(int layer, LayerNodes& out) const { solve(layer, 0, angles_, out); }
  /// The same bit by bit: room for the run, then entries begin ... end - 1 of it for the labels of one sign of the elbow (0, 1).
  void lay_out(int layer, int first, int count, LayerNodes& out) const;
  void solve_part(int elbow, int begin, int end, LayerNodes& out) const;
  /// Joint 4 of a layer's nodes by the sign of the elbow, where the arm angle does not move it: exact arms, layers without a start.
  [[nodiscard]] std::optional<double> elbow_angle(int layer, int elbow) const;
  /// False where no node of the layer exists, because its pose is out of reach or joint 4 cannot bend as it asks.
  [[nodiscard]] bool alive(int layer) const { return (layer == 0 && start_) || elbow_alive(layer, 0) || elbow_alive(layer, 1); }
  [[nodiscard]] int elbow_of(int label) const { return label / windings_ & kElbowBit ? 1 : 0; }
  /// One node; none where it does not exist.
  [[nodiscard]] std::optional<Config> node(int layer, int slot) const;
  /// Manipulability bound alone; everything else that makes a node kinematically valid is in solve().
  [[nodiscard]] bool manipulable(const Config& q) const;
  [[nodiscard]] bool asks_manipulability() const { return limits_.manipulability > 0; }

  /// Why nodes of a layer are missing: what each node fails first, and for limits which joints.
  struct NodeFault {
    NodeStatus status = NodeStatus::kValid;
    std::uint8_t joints = 0;    ///< bit k: joint k is outside its limits
    Config q = Config::Zero();  ///< of kLimit: the joints of the closed form, of any winding
  };
  [[nodiscard]] NodeFault fault(int layer, int slot) const;

  // Edges between slot a of `layer` and slot b of the next; joints as node() gives them.
  /// |circular difference of phi| within the window.
  [[nodiscard]] bool in_window(int layer, int a, int b) const;
  /// First angle index and count of the run of successors' angles that may lie in the window (around the circle, each once).
  struct Run {
    int first = 0, count = 0;
  };
  [[nodiscard]] Run successors(int layer, int a) const;
  [[nodiscard]] Run predecessors(int layer, int b) const;
  /// q1 - q0, on the circle for continuous joints.
  [[nodiscard]] Config delta(const Config& q0, const Config& q1) const;
  /// Every |delta| within joint_step and the speed limits of the step from `layer`.
  [[nodiscard]] bool step_allowed(int layer, const Config& delta) const;
  /// Largest |delta_j| allowed on the step from `layer`.
  [[nodiscard]] const Config& step_bound(int layer) const {
    return step_bounds_[step_bounds_.size() == 1 ? 0 : static_cast<std::size_t>(layer)];
  }
  /// Cost of a move, a multiple of 2^-40 units. Source: design.md 1 "Cost".
  [[nodiscard]] double edge_cost(const Config& delta) const;
  /// Tool-path, tool-angle and step-error bounds of the joint-linear move from q0 (slot a) to q1 (slot b).
  [[nodiscard]] bool follows_path(int layer, int a, const Config& q0, int b, const Config& q1) const;
  [[nodiscard]] bool asks_path_error() const { return limits_.tool_path_error || limits_.tool_angle_error || limits_.step_error; }

  [[nodiscard]] const std::array<bool, kDof>& continuous() const { return continuous_; }
  /// What each joint's move is multiplied by before the metric: the weights, or 1/speed for CostMetric::kTime.
  [[nodiscard]] const std::array<double, kDof>& cost_scale() const { return cost_scale_; }
  /// The least power of two that no cost_scale() exceeds; 1 where all are 0. Costs are rounded in this unit, so sums of a path's
  /// costs are exact whatever the size of the weights.
  [[nodiscard]] double cost_unit() const { return cost_unit_; }

 private:
  struct Images {
    double base = 0, upper = 0;  // image 0 lies in [base, base + 2 pi); valid up to upper
    int count = 1;
  };
  static Images images_between(double lower, double upper, double start);
  struct Start {
    int slot = 0;
    double phi = 0;
    Config q;
  };
  void solve_exact(int elbow, int begin, int end, LayerNodes& out) const;
  void solve_polished(int elbow, int begin, int end, LayerNodes& out) const;
  void lay_out_start(LayerNodes& out) const;
  [[nodiscard]] bool elbow_alive(int layer, int elbow) const { return elbow_alive_[static_cast<std::size_t>(2 * layer + elbow)]; }
  void place_start(const Config& q, const std::string& source);
  [[nodiscard]] int winding_images(int winding, int joint) const;
  [[nodiscard]] Run grid_run(double phi) const;

  std::uint64_t id_;  // of a lattice and its copies; so that layouts outlive lattices safely
  const Chain* chain_;
  const SrsArm* arm_;
  const ToolPath* path_;
  Limits limits_;
  Cost cost_;
  int angles_ = 0, windings_ = 1, window_ = 1;
  std::array<Images, kDof> images_;
  std::size_t tracks_ = 0;  // arrays in a LayerNodes
  std::array<bool, kDof> continuous_{};
  std::array<double, kDof> cost_scale_{};
  double cost_unit_ = 1;
  std::vector<double> sine_, cosine_;  // of the grid angles, three times around
  std::vector<ArmPlane> planes_;
  std::vector<ReachStatus> reach_;
  std::vector<std::array<ElbowCircle, 2>> circles_;  // per layer; empty where out of reach
  std::vector<std::uint8_t> elbow_alive_;            // [layer][elbow]: its angle lies within the limits
  std::vector<Config> step_bounds_;
  std::optional<Start> start_;
};

/// Distance of the tool from its straight step, at t = 1/4, 1/2, 3/4 of a joint-linear move, m.
[[nodiscard]] std::array<double, 3> path_deviation(const Chain& chain, const ToolPath& path, int layer, const Config& q0,
                                                   const Config& delta);
/// Angle between the tool and the path at the foot of that distance, rad.
[[nodiscard]] std::array<double, 3> angle_deviation(const Chain& chain, const ToolPath& path, int layer, const Config& q0,
                                                    const Config& delta);

/// Second-order estimate of the step error in joint space at one end of a step, rad. Paper Eq. (15) with the cross product of Eq.
/// (12) replaced by the part normal to the tangent plane: 1/2 |(I - P_T) d^2 theta / dt^2| along (1, dphi). end 0: at layer; end 1:
/// at layer + 1 by the same step's motion. Infinite where a neighbouring solution does not exist.
[[nodiscard]] double step_error(const Lattice& lattice, int layer, int end, int branch, double phi, double dphi);

}  // namespace swivel
