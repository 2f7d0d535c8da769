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

/// The degree of freedom that a tool path leaves to an arm, as one coordinate in each layer: the
/// interface of an arm for refinement.
class Redundancy {
 public:
  virtual ~Redundancy() = default;
  Redundancy(const Redundancy&) = delete;
  Redundancy& operator=(const Redundancy&) = delete;

  /// Returns a lattice with the rules of nodes and edges along the path; it need not list its
  /// nodes.
  [[nodiscard]] virtual const Lattice& lattice() const = 0;
  /// Returns true if nodes are those of a grid in the coordinate, as fine as the resolution says.
  [[nodiscard]] virtual bool has_grid() const = 0;
  /// Sets the phi of rows to the coordinate, and returns a solver about the joints that they have.
  /// The rows must outlive the solver.
  [[nodiscard]] virtual std::unique_ptr<LayerSolver> solver(
      std::vector<TrajectoryRow>& rows) const = 0;
  /// Returns the coordinate of joints q at a layer, rad; solver() makes it continuous along the
  /// rows.
  [[nodiscard]] virtual double coordinate(int layer, const Config& q) const = 0;
  /// Sets the phi, branch and roll of rows back to what they mean in trajectories.
  virtual void label(std::vector<TrajectoryRow>& rows) const = 0;
  /// Returns the most that the coordinate may change from a layer to the next, rad.
  [[nodiscard]] virtual double most_change() const = 0;
  /// Returns the most that the coordinate may change on one step, rad, where that is less than
  /// most_change().
  [[nodiscard]] virtual double most_change_on(int step) const {
    static_cast<void>(step);
    return most_change();
  }
  /// Returns true if the coordinate is the roll of the tool.
  [[nodiscard]] virtual bool is_roll() const { return false; }
  /// A range of the coordinate, rad.
  struct Range {
    double low = -std::numeric_limits<double>::infinity(),
           high = std::numeric_limits<double>::infinity();
  };
  /// Returns the allowed range of the coordinate at a layer; unbounded by default.
  [[nodiscard]] virtual Range range(int layer) const {
    static_cast<void>(layer);
    return {};
  }
  /// Returns the layers from which the joints of rows jump to the next layer, through a
  /// singularity, to another solution.
  [[nodiscard]] virtual std::vector<int> jumps(const std::vector<TrajectoryRow>& rows) const = 0;
  /// Returns the sine of the arm's angle that is nearest to singular at joints q.
  [[nodiscard]] virtual double singular_sine(const Config& q) const = 0;
  /// Returns the step error (docs/model.md) of the edge from row a at `layer` to row b at the next,
  /// rad: the larger of those at both ends. Only for arms with which limits.step_error may be
  /// given; others throw std::logic_error.
  [[nodiscard]] virtual double step_error(int layer, const TrajectoryRow& a,
                                          const TrajectoryRow& b) const = 0;

 protected:
  Redundancy() = default;
};

/// Returns the redundancy of an arm: the arm angle of an S-R-S arm, the length along the
/// self-motion of another one. All arguments but the problem must outlive it.
[[nodiscard]] std::unique_ptr<const Redundancy> make_redundancy(const Chain& chain,
                                                                const ArmClass& arm,
                                                                const ToolPath& path,
                                                                const PathProblem& problem,
                                                                const Budget& budget);

/// Returns the arm angle of an S-R-S arm whose joint 7 rests at `last_joint`, rad
/// (last_joint_at_rest()), so that the other joints turn the tool. All arguments but the problem
/// must outlive it.
[[nodiscard]] std::unique_ptr<const Redundancy> make_coaxial_redundancy(
    const Chain& chain, const SrsArm& arm, const ToolPath& path, const PathProblem& problem,
    double last_joint, const Budget& budget);

/// Returns the roll of the tool of an S-R-S arm that has a free one (Chain::free_roll), at the arm
/// angles that rows have. `path` is that of the tool as the waypoints have it, not turned. All
/// arguments but the problem must outlive it.
[[nodiscard]] std::unique_ptr<const Redundancy> make_roll_redundancy(const Chain& chain,
                                                                     const SrsArm& arm,
                                                                     const ToolPath& path,
                                                                     const PathProblem& problem,
                                                                     const Budget& budget);

}  // namespace swivel
