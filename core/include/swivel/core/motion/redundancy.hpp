// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>
#include <memory>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/kinematics/closed_form/arm_class.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/motion/layer_solver.hpp"

namespace swivel {

/// The degree of freedom that a tool path leaves to an arm, as one coordinate in each layer: what refinement knows of an arm.
class Redundancy {
 public:
  virtual ~Redundancy() = default;
  Redundancy(const Redundancy&) = delete;
  Redundancy& operator=(const Redundancy&) = delete;

  /// The rules of nodes and edges along the path; it need not list its nodes.
  [[nodiscard]] virtual const Lattice& lattice() const = 0;
  /// Whether nodes are those of a grid in the coordinate, as fine as the resolution says.
  [[nodiscard]] virtual bool has_grid() const = 0;
  /// The phi of rows becomes the coordinate, about the joints that they have. The rows must outlive the solver.
  [[nodiscard]] virtual std::unique_ptr<LayerSolver> solver(std::vector<TrajectoryRow>& rows) const = 0;
  /// A coordinate of joints at a layer, rad; solver() makes it continuous along the rows.
  [[nodiscard]] virtual double coordinate(int layer, const Config& q) const = 0;
  /// The phi and branch of rows become again what they are in trajectories.
  virtual void label(std::vector<TrajectoryRow>& rows) const = 0;
  /// Of the coordinate from a layer to the next, rad: what the lattice's window allows.
  [[nodiscard]] virtual double most_change() const = 0;
  /// The same on one step, where it is less.
  [[nodiscard]] virtual double most_change_on(int step) const {
    static_cast<void>(step);
    return most_change();
  }
  /// Whether the coordinate is the roll of the tool.
  [[nodiscard]] virtual bool is_roll() const { return false; }
  /// What the coordinate may be at a layer, rad.
  struct Range {
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  };
  [[nodiscard]] virtual Range range(int layer) const {
    static_cast<void>(layer);
    return {};
  }
  /// Layers from which the joints jump to the next: through a singularity, to another solution.
  [[nodiscard]] virtual std::vector<int> jumps(const std::vector<TrajectoryRow>& rows) const = 0;
  /// Sine of the angle nearest to singular.
  [[nodiscard]] virtual double singular_sine(const Config& q) const = 0;
  /// Step error (docs/model.md) of the edge from `a`, at a layer, to `b`: the larger of both ends. Only where limits.step_error may
  /// be given.
  [[nodiscard]] virtual double step_error(int layer, const TrajectoryRow& a, const TrajectoryRow& b) const = 0;

 protected:
  Redundancy() = default;
};

/// The arm angle of S-R-S arms, of others the length along the self-motion. All arguments but the problem must outlive it.
[[nodiscard]] std::unique_ptr<const Redundancy> make_redundancy(const Chain& chain, const ArmClass& arm, const ToolPath& path,
                                                                const Problem& problem, const Budget& budget);

/// The arm angle of an S-R-S arm whose joint 7 rests (last_joint_at_rest): the tool turns as the other joints make it. All
/// arguments but the problem must outlive it.
[[nodiscard]] std::unique_ptr<const Redundancy> make_coaxial_redundancy(const Chain& chain, const SrsArm& arm, const ToolPath& path,
                                                                        const Problem& problem, double last_joint,
                                                                        const Budget& budget);

/// The roll of the tool of an S-R-S arm that has a free one (Chain::free_roll), at the arm angles that rows have: `path` is that of
/// the tool as the waypoints have it. All arguments but the problem must outlive it.
[[nodiscard]] std::unique_ptr<const Redundancy> make_roll_redundancy(const Chain& chain, const SrsArm& arm, const ToolPath& path,
                                                                     const Problem& problem, const Budget& budget);

}  // namespace swivel
