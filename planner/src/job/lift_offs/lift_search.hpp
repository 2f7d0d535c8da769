// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/problem/hooks.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/graph/search/cut_program.hpp"
#include "swivel/parallel/executor.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "validity/collision_validity.hpp"
#include "validity/hooked_validity.hpp"

namespace swivel {

/// Finds places at which the tool lifts off from a stroke of a job, the cheapest first: the least
/// cost of its runs with their approach and retract, the moves between them, and those from and to
/// home where the stroke is the job's first or last one. Joints move straight, and nothing bars
/// these moves.
class LiftSearch {
 public:
  /// Finds the least number of lift-offs. `check`: the caller's own rule, or null, beside which
  /// `threads` must be 1. Both references must outlive this.
  /// Throws InputError for an arm whose roll and arm angle are both free and for a stroke of more
  /// than 5000 layers, and Stopped.
  LiftSearch(const PreparedRobot& robot, const Problem& job, std::size_t stroke,
             DistanceProofs proofs, std::shared_ptr<StateCheck> check, int threads,
             const Budget& budget);

  /// Returns the least number of lift-offs; none where no number suffices.
  [[nodiscard]] std::optional<int> least() const { return least_; }
  /// Places, and the cost of the runs with the moves between them.
  struct Places {
    std::vector<LiftOff> lift_offs;
    double cost = 0;
  };
  /// Returns the cheapest places of a number of lift-offs that are not left out; none if there are
  /// none. Throws Stopped.
  [[nodiscard]] std::optional<Places> next(int count);
  /// Leaves out a place that next() has returned last, lift-off number `k`, from 0, and as many
  /// layers as `around` on both sides of it.
  void leave_out(std::size_t k, int around);
  /// Returns the arc length, m, that the longest run from an arc length reaches, whatever lines it
  /// begins and ends with.
  [[nodiscard]] double reach(double from);
  /// Returns what a straight move of the joints costs.
  [[nodiscard]] double distance(const Config& from, const Config& to) const;

 private:
  [[nodiscard]] std::vector<CutPlace> find_places(double overlap) const;
  [[nodiscard]] bool turns_on_the_spot(int layer) const;
  /// Returns the approach or retract at a layer.
  [[nodiscard]] CutLine line(int layer, CutProgram::LineKind kind);

  const PreparedRobot* robot_;
  const Problem* job_;
  std::size_t stroke_;
  DistanceProofs proofs_;
  Hooks hooks_;
  Budget budget_;
  PathProblem problem_;  // of the stroke without approach and retract, with sharp corners
  World world_;
  Executor executor_;
  ToolPath path_;
  std::shared_ptr<Lattice> lattice_;
  std::optional<CollisionValidity> collision_;
  std::optional<HookedValidity> validity_;
  std::vector<CutPlace> places_;
  std::optional<CutProgram> program_;
  std::optional<int> least_;
  std::vector<int> last_;  // layers of the places returned last
};

}  // namespace swivel
