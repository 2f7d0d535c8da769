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
struct CircleTurns;

/// The joints of all IK solutions of one layer over a run of arm angles; a buffer to be reused from
/// layer to layer, since a lattice does not store its nodes. IK solutions share the arrays of what
/// they have in common: the solution of one triple (shoulder or wrist) belongs to four branches.
/// Branches with a moved cell in the layer have arrays of their own.
class LayerNodes {
 public:
  /// Returns joint k (0..6) of an IK solution, rad: an array over the run.
  [[nodiscard]] const double* q(int solution, int k) const {
    return data_.data() + at(solution).q[static_cast<std::size_t>(k)];
  }
  /// Returns one of two arrays over the run (`which` is 0 or 1) whose entries are 0 or infinite. A
  /// node exists, as far as IK, singularity and limits tell, where both are 0.
  [[nodiscard]] const double* mask(int solution, std::size_t which) const {
    return data_.data() + at(solution).mask[which];
  }
  [[nodiscard]] bool valid(int solution, int k) const {
    return mask(solution, 0)[k] + mask(solution, 1)[k] == 0;
  }
  /// Returns false if no node of the IK solution exists, whatever the arm angle.
  [[nodiscard]] bool alive(int solution) const { return at(solution).alive; }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] std::size_t bytes() const {
    return static_cast<std::size_t>(data_.size()) * sizeof(double);
  }
  /// Copies `count` entries of every array of an elbow's IK solutions from index `from` of the run
  /// to index `to`.
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
    bool elbow0 = false, elbow1 = false, given = false;
    std::uint8_t moved = 0;  // bit b: branch b has arrays of its own
    bool operator==(const Layout&) const = default;
  };
  Layout layout_;
  int layer_ = -1, first_ = 0, count_ = 0;
  Eigen::ArrayXd data_;
  std::vector<Offsets> offsets_;  // [solution]
  // [elbow][sign of the triples]: what is solved for the first winding.
  std::array<std::array<Offsets, 2>, 2> shared_;
  struct Span {
    std::size_t begin = 0, end = 0;
  };
  // [elbow], indices into data_: arrays of the IK solutions, and those of branches with their own.
  std::array<std::array<Span, 2>, 2> arrays_;
};

/// The (s, phi) lattice of an S-R-S arm: layers along the path, and in each layer a circle of
/// `angles` arm angles with `solutions` = 8 branches x windings of nodes at each angle.
/// docs/model.md defines it. A slot numbers a layer's nodes in the order that settles ties:
/// solution * angles + j, where the solution is branch * windings + winding. The lattice is
/// immutable, so that threads may share it. Nodes are computed when asked for; a node has the same
/// bits however it is asked for.
///
/// Windings tell apart the images of a bounded joint, which are one angle plus whole turns. A joint
/// has as many as its range has turns, a begun turn counted as one. A begun turn of up to 1e-3 rad,
/// as in limits written 3.1416, is cut off at the upper end, or at the lower one if a given start
/// or end lies in it. No pose is lost by that, but joints do not move through the part that was cut
/// off. A joint with a range of over 64 turns is treated as continuous (JointLimit::wide): its
/// angles begin in the turn about 0, or in the nearest turn that leaves 31 turns to both limits.
///
/// Joints of several images can be *circles* instead, whose images count as one node, with the
/// joint in the turn about the middle of its range. A path of the lattice with circles may leave
/// their limits; path_joints() looks for turns in which it does not. Edges and costs are those of
/// the lattice that tells windings apart, as long as no edge moves a circle by half a turn.
///
/// An arm that is not exactly S-R-S has the nodes of the ideal arm fitted to it, with limits wider
/// by the arm's fit error. Newton's method finds exact configurations from them.
///
/// A cell is the set of arm angles nearest to grid angle j. With `resolution.arcs` a cell has a
/// node wherever it meets an arc: if there is none at the grid angle itself, the node is *moved* to
/// the nearest angle on the arcs of its IK solution, or to the middle of an arc that lies in the
/// cell as a whole. Moved cells are few; they are found when the lattice is made and stored in 80
/// bytes each. The window counts cells, moved or not.
class SrsLattice final : public Lattice {
 public:
  /// Builds the lattice of `path`, which must outlive it, as must `chain` and `arm`. `planes`: the
  /// planes of the path's layers from which arm angles are measured; carried_planes() if empty.
  /// `last_joint`: where joint 7 rests, rad, for an arm whose tool turns freely about that joint's
  /// axis, in a problem without a start and an end. `circles`: which joints are circles, as
  /// possible_circles() allows. Throws InputError if start or end do not fit, for more than 1024
  /// windings, and if the lattice is too large for the machine's memory; Stopped.
  SrsLattice(const Chain& chain, const SrsArm& arm, const ToolPath& path,
             const PathProblem& problem, const Budget& budget = {},
             std::vector<ArmPlane> planes = {}, std::optional<double> last_joint = {},
             const Joints& circles = {});
  /// Returns which joints can be circles: bounded joints of several images that no edge moves by
  /// half a turn. None can with `resolution.arcs`, whose nodes at the ends of arcs depend on the
  /// turns. `step_bounds`: the largest moves of rows on each step, rad; one entry if all steps are
  /// alike.
  [[nodiscard]] static Joints possible_circles(const Chain& chain, const SrsArm& arm,
                                               const PathProblem& problem,
                                               const std::vector<Config>& step_bounds);
  /// Returns possible_circles() for a path all of whose layers are layers of the lattice.
  [[nodiscard]] static Joints possible_circles(const Chain& chain, const SrsArm& arm,
                                               const ToolPath& path, const PathProblem& problem) {
    return possible_circles(chain, arm, problem,
                            step_bounds_along(chain, path, problem.limits, problem.resolution));
  }

  [[nodiscard]] int angles() const { return angles_; }
  [[nodiscard]] int solutions() const { return kBranches * windings_; }
  [[nodiscard]] int windings() const { return windings_; }
  [[nodiscard]] int window() const { return window_; }
  /// Returns the number of slots of every layer.
  [[nodiscard]] int width() const { return solutions() * angles_; }
  [[nodiscard]] int solution_of(int slot) const { return slot / angles_; }
  [[nodiscard]] int angle_of(int slot) const { return slot % angles_; }
  [[nodiscard]] int branch_of(int slot) const { return solution_of(slot) / windings_; }
  [[nodiscard]] const SrsArm& arm() const { return *arm_; }
  [[nodiscard]] const ArmPlane& plane(int layer) const {
    return planes_[static_cast<std::size_t>(layer)];
  }
  /// Returns whether layer 0 is the given start alone.
  [[nodiscard]] bool has_start() const { return start_.has_value(); }
  /// Returns the slot that stands for the given start in layer 0: the start's IK solution at the
  /// grid angle nearest to its arm angle.
  [[nodiscard]] int start_slot() const { return start_->slot; }
  /// Returns the slot that stands for a given start or end in a layer for which is_given() holds.
  [[nodiscard]] int given_slot(int layer) const { return given(layer)->slot; }

  [[nodiscard]] std::unique_ptr<Lattice> with_windings(const Joints& joints) const override;
  [[nodiscard]] std::vector<Joints> joints_with_windings() const override { return told_apart_; }
  [[nodiscard]] int slot_on_circles(int layer, int slot) const override;

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
  /// Returns the distance of the wrist centre from the shoulder, m, if the arm cannot have it.
  [[nodiscard]] std::optional<Reach> out_of_reach(int layer) const override;
  /// Returns true for an exact arm if the pose is out of reach, or if no IK solution has an arc
  /// within the limits.
  [[nodiscard]] bool proved_unreachable(int layer) const override;
  [[nodiscard]] double phi(int layer, int slot) const override;
  /// Returns by how much the arm angle may change along an edge, rad.
  [[nodiscard]] double most_turn() const {
    // off-grid nodes, and a given end, may be half a cell from the grid
    return (window_ + (off_grid_.empty() && !last_ ? 0 : 1)) * kTwoPi / angles_ + 1e-9;
  }
  [[nodiscard]] int branch(int, int slot) const override { return branch_of(slot); }
  [[nodiscard]] int neighbour_in_redundancy(int layer, int slot, int by) const override;
  [[nodiscard]] int neighbour_along_path(int layer, int slot, int by) const override;
  /// Returns where joint 7 rests, rad, with the tool turned as the other joints make it; nothing if
  /// joint 7 moves.
  [[nodiscard]] const std::optional<double>& last_joint() const { return last_joint_; }
  /// All groups but followers share poses. The last link and the tool have one pose in a layer,
  /// with links 5 and 6 where joint 7 rests. Links 3 and 4 share theirs for an arm angle and a sign
  /// of the elbow. Links 1 and 2 depend on the shoulder's sign too, links 5 and 6 on the wrist's.
  [[nodiscard]] bool shares_body_poses(unsigned groups) const override {
    return (groups & kFollowers) == 0;
  }
  void slots_with_same_body_poses(int layer, int slot, unsigned groups,
                                  std::vector<int>& out) const override;
  /// The groups that determine manipulability are those of the elbow. The other branch of the
  /// shoulder or of the wrist leaves the axis of each joint where it is or reverses it, which
  /// reverses a column of the Jacobian J and leaves J J^T as it is.
  [[nodiscard]] unsigned manipulability_groups() const override;
  [[nodiscard]] bool all_below_manipulability(int layer, const Config& q) const override;
  [[nodiscard]] PoseErrorBound pose_error_of_node(int layer, int group,
                                                  const Config& q) const override;
  [[nodiscard]] PoseErrorBound pose_error_between(int layer, int group,
                                                  const Config& q) const override;
  [[nodiscard]] bool in_window(int layer, int a, int b) const override;
  void successors(int layer, int a, std::vector<SlotRun>& out) const override;

  // --- arcs
  /// Replaces `out` by the arcs of arm angles, rad, at which the joints of an IK solution are
  /// within their limits. They are found in closed form, whether nodes are there or not. A layer of
  /// a given start or end counts as any other. For an arm that is not exactly S-R-S, the limits are
  /// narrowed by the fit error, so that the rows are within their limits as well.
  void arcs(int layer, int solution, std::vector<AngleArc>& out) const;
  /// The node of a cell that does not stand at the grid angle; phi is its arm angle, rad.
  struct OffGridNode {
    int slot = 0;
    double phi = 0;
    Config q;
  };
  /// Returns the off-grid nodes of a layer, in the order of slots.
  [[nodiscard]] std::span<const OffGridNode> off_grid_nodes(int layer) const {
    if (off_grid_.empty()) return {};
    const std::size_t begin = off_grid_begin_[static_cast<std::size_t>(layer)];
    return {off_grid_.data() + begin, off_grid_begin_[static_cast<std::size_t>(layer) + 1] - begin};
  }

  // --- nodes of whole runs, in vector code
  /// Computes the nodes j = first ... first + count - 1 of every IK solution, taken around the
  /// circle; first < angles and count <= 2 angles.
  void solve(int layer, int first, int count, LayerNodes& out) const;
  void solve(int layer, LayerNodes& out) const { solve(layer, 0, angles_, out); }
  /// Number of elbow sides: the sign of the elbow divides the IK solutions into two halves in their
  /// order. One elbow side is solved at a time.
  static constexpr int kElbowSides = 2;
  [[nodiscard]] int elbow_side_of(int solution) const {
    return solution / windings_ & kElbowBit ? 1 : 0;
  }
  /// Together these two give the result of solve(), bit for bit: lay_out() makes room for the run,
  /// and solve_part() computes its entries begin ... end - 1 for the IK solutions of one elbow
  /// side.
  void lay_out(int layer, int first, int count, LayerNodes& out) const;
  void solve_part(int side, int begin, int end, LayerNodes& out) const;
  /// Returns false if no node of the layer exists, because its pose is out of reach or joint 4
  /// cannot bend as it asks.
  [[nodiscard]] bool alive(int layer) const { return alive(layer, 0) || alive(layer, 1); }
  /// Returns whether an elbow side can have nodes in a layer.
  [[nodiscard]] bool alive(int layer, int side) const {
    const Given* const only = given(layer);
    return only ? elbow_side_of(solution_of(only->slot)) == side : elbow_alive(layer, side);
  }
  /// Returns false if no edge leads from elbow side `side` of `layer` to side `other` of the
  /// neighbouring layer `other_layer`. `step_layer`: the first layer of the step between them.
  [[nodiscard]] bool may_change_elbow_side(int step_layer, int layer, int side, int other_layer,
                                           int other) const;
  /// Returns false if no edge of a step changes the elbow side.
  [[nodiscard]] bool may_change_elbow_side(int step_layer) const {
    return may_change_elbow_side(step_layer, step_layer, 0, step_layer + 1, 1) ||
           may_change_elbow_side(step_layer, step_layer, 1, step_layer + 1, 0);
  }
  /// The joints whose sign is the branch: a branch flips only through the zero of one of them. The
  /// first two tell apart the IK solutions of one elbow side.
  static constexpr std::array<int, 3> kMiddleJoints{1, 5, 3};
  /// Joints that must also agree near such a zero. Joints of several turns tell windings apart.
  static constexpr std::array<int, 5> kOuterJoints{0, 2, 4, 6, 3};

  /// A run of arm angles in a layer, around the circle: the index of the first one and their
  /// number.
  struct Run {
    int first = 0, count = 0;
  };
  [[nodiscard]] Run run_after(int layer, int a) const;
  [[nodiscard]] Run run_before(int layer, int b) const;

 private:
  struct Images {
    // Image 0 lies in [base, base + 2 pi); values are valid up to upper, rad.
    double base = 0, upper = 0;
    int count = 1;
  };
  /// `highest`: the highest value, rad, that a given start or end has of the joint; `lower` if none
  /// is given.
  static Images images_between(double lower, double upper, double highest, double fit_error);
  /// A posture that the problem gives for the first or the last layer, as that layer's only node.
  struct Given {
    int slot = 0;
    double phi = 0;
    // node: the fitted arm's solution at the posture, or the given joints if it has none; row: the
    // given joints
    Config node, row;
  };
  /// Returns the only node of a layer for which is_given() holds; null for other layers.
  [[nodiscard]] const Given* given(int layer) const {
    if (layer == 0 && start_) return &*start_;
    return layer == layers() - 1 && last_ ? &*last_ : nullptr;
  }
  void lay_out_given(const Given& given, LayerNodes& out) const;
  /// Copies the entries begin ... end - 1 that an IK solution with arrays of its own has in common
  /// with others.
  void copy_shared(int solution, int begin, int end, LayerNodes& out) const;
  /// Returns the grid angle of a slot's cell, rad.
  [[nodiscard]] double cell_angle(int slot) const {
    return -kPi + kTwoPi * angle_of(slot) / angles_;
  }
  [[nodiscard]] const OffGridNode* find_off_grid(int layer, int slot) const;
  /// Returns the node of a slot's IK solution at the arm angle with this sine and cosine.
  [[nodiscard]] std::optional<Config> solved(int layer, int slot, double sine, double cosine) const;
  void prepare_arcs();
  void triple_arcs(int layer, int solution, int triple, std::vector<AngleArc>& out) const;
  [[nodiscard]] bool elbow_within(int layer, int solution) const;
  void place_off_grid_nodes(const Budget& budget);
  /// Returns the index of an IK solution's winding among the windings of a triple (0: shoulder, 1:
  /// wrist).
  [[nodiscard]] int triple_winding(int solution, int triple) const;
  [[nodiscard]] int triple_windings(int triple) const {
    return static_cast<int>(triple_limits_[static_cast<std::size_t>(triple)].size());
  }
  void place_off_grid_nodes_of(int layer, int solution, const std::vector<AngleArc>& arcs);
  /// Returns what the vector kernel has to solve for a layer's shoulder (triple 0) or wrist (1).
  /// The caller adds the run and where the results go.
  [[nodiscard]] TripleTask triple_task(const ElbowCircle& circle, int triple) const;
  [[nodiscard]] bool step_error_allowed(int layer, int a, int b) const override;
  /// Returns joint 4, rad, of a layer's nodes with a sign of the elbow; the arm angle does not
  /// change it. Nothing for a layer of a given start or end.
  [[nodiscard]] std::optional<double> elbow_angle(int layer, int elbow) const;
  [[nodiscard]] bool elbow_alive(int layer, int elbow) const {
    return elbow_alive_[static_cast<std::size_t>(2 * layer + elbow)];
  }
  SrsLattice(const SrsLattice&) = default;
  /// Sets which joints are circles, and the images of all joints, which must hold the given start
  /// and end. Throws InputError for too many windings.
  void set_circles(const Joints& circles, const std::array<std::optional<Config>, 2>& given);
  /// Places what depends on the images: the given start and end, elbow sides, nodes of arcs.
  void place_nodes(const std::array<std::optional<Config>, 2>& given, const Budget& budget);
  /// Returns the node of a layer whose posture `q` is given.
  [[nodiscard]] Given placed(int layer, const Config& q) const;
  /// Returns the solution of the fitted arm at the arm angle and the branch of a given posture `q`,
  /// at the images near it; nothing if there is none near it.
  [[nodiscard]] std::optional<Config> fitted(int layer, const Config& q, double phi) const;
  [[nodiscard]] bool singular(const Config& q) const;
  /// Returns a set of bits: bit k is set if joint k of a row is outside its limits.
  [[nodiscard]] std::uint8_t joints_outside(const Config& row) const;
  [[nodiscard]] int winding_images(int winding, int joint) const;
  [[nodiscard]] Run grid_run(double phi) const;

  /// Returns the exact configuration of a node on the exact chain, whatever its limits. Where joint
  /// 7 rests, the tool may turn as in the node.
  [[nodiscard]] std::optional<Config> on_exact_chain(int layer, int slot, const Config& q) const;

  // Identifies a lattice and its copies, so that a Layout may outlive its lattice.
  std::uint64_t id_;
  std::string source_;  // the problem's, for messages
  bool has_arcs_ = false;
  std::vector<Joints> told_apart_;  // joints_with_windings()
  const SrsArm* arm_;
  std::optional<double> last_joint_;
  int angles_ = 0, windings_ = 1, window_ = 1;
  std::array<Images, kDof> images_;
  std::size_t tracks_ = 0;             // number of arrays in a LayerNodes
  std::vector<double> sine_, cosine_;  // of the grid angles, three times around
  std::vector<ArmPlane> planes_;
  std::vector<ReachStatus> reach_;
  std::vector<std::array<ElbowCircle, 2>> elbow_circles_;  // per layer; empty where out of reach
  std::vector<std::uint8_t> elbow_alive_;  // [layer][elbow]: its angle lies within the limits
  std::optional<Given> start_, last_;
  std::optional<PoseErrorModel> pose_error_model_;          // for an arm that is not exact
  std::array<std::vector<TripleLimits>, 2> triple_limits_;  // [triple][its winding]
  std::vector<OffGridNode> off_grid_;                       // also empty if resolution.arcs is off
  std::vector<std::size_t> off_grid_begin_;                 // [layer], and the end
  std::vector<std::uint8_t> off_grid_branches_;             // [layer], bits
};

/// Returns the planes of a path's layers, from which arm angles are measured. They are carried
/// along the whole path from its beginning, so that a start between two layers changes no plane of
/// another layer. For a tool that stands turned, returns the planes of the path without the turn,
/// each under the smallest rotation onto the turned tool. Carried around a closed path, the plane
/// comes back turned about the line from shoulder to wrist by an angle of at most half a turn, the
/// holonomy: the plane of each layer is then turned back by the holonomy times its share of the
/// path's travel, so that the last plane is the first one, bit for bit. Throws Stopped.
[[nodiscard]] std::vector<ArmPlane> carried_planes(const SrsArm& arm, const ToolPath& path,
                                                   const Budget& budget = {});

/// Returns the second-order estimate of the step error in joint space at one end of a step, rad:
/// paper Eq. (15), with the cross product of Eq. (12) replaced by the part normal to the tangent
/// plane, 1/2 |(I - P_T) d^2 theta / dt^2| along (1, dphi). `end` 0 is the end at `layer`, 1 the
/// one at layer + 1, with the motion of the same step. `phi`: arm angle at that end, rad; `dphi`:
/// its change over the step, rad. Returns infinity if a neighbouring solution does not exist.
[[nodiscard]] double step_error(const SrsLattice& lattice, int layer, int end, int branch,
                                double phi, double dphi);

}  // namespace swivel
