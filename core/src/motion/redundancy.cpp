// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/motion/redundancy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "kinematics/srs/exact_chain_turned.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/kinematics/equations/alignment.hpp"
#include "swivel/core/kinematics/srs/arm_angle.hpp"
#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"
#include "swivel/core/motion/arc_lengths.hpp"

namespace swivel {

namespace {

/// Returns the joints at an arm angle, with the row's branch and the whole turns nearest to its
/// joints.
std::optional<Config> joints_near(const Chain& chain, const SrsArm& arm, const ArmPlane& plane,
                                  const std::array<ElbowCircle, 2>& circles, const Pose& tool,
                                  double angle, const TrajectoryRow& row,
                                  const std::optional<double>& last_joint = {}) {
  std::optional<Config> q = srs_ik(arm, circles, angle, row.branch);
  if (last_joint) (*q)[kDof - 1] = *last_joint;
  if (!arm.exact)
    q = last_joint ? solve_exact_chain_turned(chain, arm, plane, tool, angle, *q)
                   : solve_exact_chain(chain, arm, plane, tool, angle, *q);
  if (!q) return std::nullopt;
  for (Eigen::Index j = 0; j < kDof; ++j) (*q)[j] = row.q[j] + wrap_angle((*q)[j] - row.q[j]);
  return q;
}

/// Solves for the joints of each layer from its arm angle; branches and whole turns of joints stay
/// those of the rows.
class ArmAngles final : public LayerSolver {
 public:
  ArmAngles(const SrsLattice& lattice, const std::vector<TrajectoryRow>& rows)
      : lattice_(&lattice), rows_(&rows) {
    for (int i = 0; i < layers(); ++i) {
      const Pose& tool = lattice.path().layer(i).tool;
      reachable_.push_back(reach_status(lattice.arm(), lattice.plane(i).reach) ==
                           ReachStatus::kReachable);
      circles_.push_back(reachable_.back() ? elbow_circles(lattice.arm(), lattice.plane(i), tool)
                                           : std::array<ElbowCircle, 2>{});
    }
  }
  [[nodiscard]] int layers() const override { return lattice_->layers(); }
  [[nodiscard]] double travel(int layer) const override {
    return lattice_->path().layer(layer).travel;
  }
  [[nodiscard]] std::optional<Config> joints(int layer, double angle) const override {
    const auto i = static_cast<std::size_t>(layer);
    const TrajectoryRow& row = (*rows_)[i];
    if (!reachable_[i]) return std::nullopt;
    return joints_near(lattice_->chain(), lattice_->arm(), lattice_->plane(layer), circles_[i],
                       lattice_->path().layer(layer).tool, angle, row, lattice_->last_joint());
  }

 private:
  const SrsLattice* lattice_;
  const std::vector<TrajectoryRow>* rows_;
  std::vector<bool> reachable_;
  std::vector<std::array<ElbowCircle, 2>> circles_;
};

double nearest_sine(const SrsArm& arm, const Config& q) {
  return std::min({std::abs(std::sin(arm.shoulder_angle(q))),
                   std::abs(std::sin(arm.elbow_angle(q))), std::abs(std::sin(arm.wrist_angle(q)))});
}

std::vector<int> changes_of_branch(const std::vector<TrajectoryRow>& rows) {
  std::vector<int> found;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i)
    if (rows[i].branch != rows[i + 1].branch) found.push_back(static_cast<int>(i));
  return found;
}

class ArmAngleRedundancy final : public Redundancy {
 public:
  ArmAngleRedundancy(const Chain& chain, const SrsArm& arm, const ToolPath& path,
                     const PathProblem& problem, const Budget& budget,
                     std::optional<double> last_joint = {})
      : grid_(chain, arm, path, problem, budget, {}, last_joint,
              SrsLattice::possible_circles(chain, arm, path, problem)) {}
  [[nodiscard]] const Lattice& lattice() const override { return grid_; }
  [[nodiscard]] bool has_grid() const override { return true; }
  [[nodiscard]] std::unique_ptr<LayerSolver> solver(
      std::vector<TrajectoryRow>& rows) const override {
    for (std::size_t i = 1; i < rows.size(); ++i)
      rows[i].phi = rows[i - 1].phi + wrap_angle(rows[i].phi - rows[i - 1].phi);
    return std::make_unique<ArmAngles>(grid_, rows);
  }
  [[nodiscard]] double coordinate(int layer, const Config& q) const override {
    const ArmPlane& plane = grid_.plane(layer);
    return arm_angle(
        grid_.arm(),
        grid_.last_joint() ? carry_plane(grid_.arm(), plane, grid_.chain().tool(q)) : plane, q);
  }
  void label(std::vector<TrajectoryRow>& rows) const override {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      TrajectoryRow& row = rows[i];
      row.phi = wrap_angle(row.phi);
      if (grid_.last_joint())
        row.roll =
            roll_between(grid_.path().layer(static_cast<int>(i)).tool, grid_.chain().tool(row.q));
    }
  }
  [[nodiscard]] double most_change() const override { return grid_.most_turn(); }
  [[nodiscard]] std::vector<int> jumps(const std::vector<TrajectoryRow>& rows) const override {
    return changes_of_branch(rows);
  }
  [[nodiscard]] double singular_sine(const Config& q) const override {
    return nearest_sine(grid_.arm(), q);
  }
  [[nodiscard]] double step_error(int layer, const TrajectoryRow& a,
                                  const TrajectoryRow& b) const override {
    return std::max(swivel::step_error(grid_, layer, 0, a.branch, a.phi, b.phi - a.phi),
                    swivel::step_error(grid_, layer, 1, b.branch, b.phi, b.phi - a.phi));
  }

 private:
  SrsLattice grid_;
};

/// Solves for the joints of each layer from the roll; arm angles, branches and whole turns of
/// joints stay those of the rows.
class Rolls final : public LayerSolver {
 public:
  /// Takes rows whose phi is the roll, and their arm angles.
  Rolls(const Chain& chain, const SrsArm& arm, const ToolPath& path,
        const std::vector<ArmPlane>& planes, const std::vector<TrajectoryRow>& rows,
        std::vector<double> angles)
      : chain_(&chain),
        arm_(&arm),
        path_(&path),
        planes_(&planes),
        rows_(&rows),
        angles_(std::move(angles)) {}
  [[nodiscard]] int layers() const override { return path_->size(); }
  [[nodiscard]] double travel(int layer) const override { return path_->layer(layer).travel; }
  [[nodiscard]] std::optional<Config> joints(int layer, double roll) const override {
    const auto i = static_cast<std::size_t>(layer);
    const Pose tool = rolled(path_->layer(layer).tool, roll);
    const ArmPlane plane = carry_plane(*arm_, (*planes_)[i], tool);
    if (reach_status(*arm_, plane.reach) != ReachStatus::kReachable) return std::nullopt;
    return joints_near(*chain_, *arm_, plane, elbow_circles(*arm_, plane, tool), tool, angles_[i],
                       (*rows_)[i]);
  }

 private:
  const Chain* chain_;
  const SrsArm* arm_;
  const ToolPath* path_;
  const std::vector<ArmPlane>* planes_;
  const std::vector<TrajectoryRow>* rows_;
  std::vector<double> angles_;
};

class RollRedundancy final : public Redundancy {
 public:
  RollRedundancy(const Chain& chain, const SrsArm& arm, const ToolPath& path,
                 const PathProblem& problem, const Budget& budget)
      : arm_(&arm),
        // The lattice has no nodes: refinement does not need them.
        lattice_(chain, path, problem,
                 std::vector<std::vector<ExplicitLattice::Point>>(
                     static_cast<std::size_t>(path.size()))),
        planes_(carried_planes(arm, path, budget)),
        roll_slope_(problem.limits.roll_slope),
        most_change_(problem.limits.roll_slope * problem.resolution.ds) {
    const Roll& free = *chain.free_roll;
    if (!free.circle()) range_ = {free.lower, free.upper};
  }
  [[nodiscard]] bool is_roll() const override { return true; }
  [[nodiscard]] Range range(int layer) const override {
    const Roll& window = lattice_.path().layer(layer).window;
    return {std::max(range_.low, window.lower), std::min(range_.high, window.upper)};
  }
  [[nodiscard]] const Lattice& lattice() const override { return lattice_; }
  [[nodiscard]] bool has_grid() const override { return false; }
  [[nodiscard]] std::unique_ptr<LayerSolver> solver(
      std::vector<TrajectoryRow>& rows) const override {
    std::vector<double> angles;
    const std::vector<double> rolls = rolls_of(rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      angles.push_back(rows[i].phi);
      rows[i].phi = rolls[i];
    }
    return std::make_unique<Rolls>(lattice_.chain(), *arm_, lattice_.path(), planes_, rows,
                                   std::move(angles));
  }
  [[nodiscard]] double coordinate(int layer, const Config& q) const override {
    return roll_between(lattice_.path().layer(layer).tool, lattice_.chain().tool(q));
  }
  void label(std::vector<TrajectoryRow>& rows) const override {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      TrajectoryRow& row = rows[i];
      row.roll = row.phi;
      const Pose tool = rolled(lattice_.path().layer(static_cast<int>(i)).tool, row.roll);
      row.phi = wrap_angle(arm_angle(*arm_, carry_plane(*arm_, planes_[i], tool), row.q));
    }
  }
  [[nodiscard]] double most_change() const override { return most_change_; }
  [[nodiscard]] double most_change_on(int step) const override {
    constexpr double kRounding = 1e-9;  // rad
    return roll_slope_ *
               (lattice_.path().layer(step + 1).travel - lattice_.path().layer(step).travel) +
           kRounding;
  }
  [[nodiscard]] std::vector<int> jumps(const std::vector<TrajectoryRow>& rows) const override {
    return changes_of_branch(rows);
  }
  [[nodiscard]] double singular_sine(const Config& q) const override {
    return nearest_sine(*arm_, q);
  }
  [[nodiscard]] double step_error(int, const TrajectoryRow&, const TrajectoryRow&) const override {
    throw std::logic_error("step error of a tool that may turn");
  }

 private:
  const SrsArm* arm_;
  ExplicitLattice lattice_;
  std::vector<ArmPlane> planes_;
  double roll_slope_, most_change_;
  Range range_;
};

class ArcLengthRedundancy final : public Redundancy {
 public:
  ArcLengthRedundancy(const Chain& chain, const ArmClass& arm, const ToolPath& path,
                      const PathProblem& problem)
      : arm_(&arm),
        // The lattice has no nodes: refinement does not need them.
        lattice_(chain, path, problem,
                 std::vector<std::vector<ExplicitLattice::Point>>(
                     static_cast<std::size_t>(path.size()))),
        alignments_(alignments_of(chain)) {}
  [[nodiscard]] const Lattice& lattice() const override { return lattice_; }
  [[nodiscard]] bool has_grid() const override { return false; }
  [[nodiscard]] std::unique_ptr<LayerSolver> solver(
      std::vector<TrajectoryRow>& rows) const override {
    std::vector<Config> origins;
    for (TrajectoryRow& row : rows) {
      row.phi = 0;
      origins.push_back(row.q);
    }
    return std::make_unique<ArcLengths>(lattice_.chain(), lattice_.path(), std::move(origins));
  }
  // lengths begin at the joints
  [[nodiscard]] double coordinate(int, const Config&) const override { return 0; }
  void label(std::vector<TrajectoryRow>& rows) const override {
    for (TrajectoryRow& row : rows) {
      row.phi = arc_angle(lattice_.chain(), row.q);
      row.branch = arc_branch(lattice_.chain(), arm_->lock, row.q);
    }
  }
  [[nodiscard]] double most_change() const override {
    return std::numeric_limits<double>::infinity();
  }
  [[nodiscard]] std::vector<int> jumps(const std::vector<TrajectoryRow>&) const override {
    return {};
  }
  [[nodiscard]] double singular_sine(const Config& q) const override {
    double least = 1;
    for (const Alignment& a : alignments_) least = std::min(least, std::abs(std::sin(a.away(q))));
    return least;
  }
  [[nodiscard]] double step_error(int, const TrajectoryRow&, const TrajectoryRow&) const override {
    throw std::logic_error("step error of an arm without an arm angle");
  }

 private:
  const ArmClass* arm_;
  ExplicitLattice lattice_;
  std::vector<Alignment> alignments_;
};

}  // namespace

std::unique_ptr<const Redundancy> make_redundancy(const Chain& chain, const ArmClass& arm,
                                                  const ToolPath& path, const PathProblem& problem,
                                                  const Budget& budget) {
  if (arm.srs) return std::make_unique<ArmAngleRedundancy>(chain, *arm.srs, path, problem, budget);
  return std::make_unique<ArcLengthRedundancy>(chain, arm, path, problem);
}

std::unique_ptr<const Redundancy> make_coaxial_redundancy(const Chain& chain, const SrsArm& arm,
                                                          const ToolPath& path,
                                                          const PathProblem& problem,
                                                          double last_joint, const Budget& budget) {
  return std::make_unique<ArmAngleRedundancy>(chain, arm, path, problem, budget, last_joint);
}

std::unique_ptr<const Redundancy> make_roll_redundancy(const Chain& chain, const SrsArm& arm,
                                                       const ToolPath& path,
                                                       const PathProblem& problem,
                                                       const Budget& budget) {
  return std::make_unique<RollRedundancy>(chain, arm, path, problem, budget);
}

}  // namespace swivel
