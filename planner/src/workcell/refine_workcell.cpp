// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/workcell/refine_workcell.hpp"

#include <algorithm>
#include <utility>

#include "swivel/collision/arms/inter_arm_world.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/planner/refine/refine.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "workcell/timed_workcell.hpp"

namespace swivel {

namespace {

/// What an arm must keep from the other one, which moves through given rows.
class BesideOther final : public LayerCheck {
 public:
  /// `arm`: the number of the arm that is asked about; `other`: the rows of the other one.
  BesideOther(const PreparedWorkcell& prepared, std::size_t arm,
              const std::vector<TrajectoryRow>& other, const Budget& budget)
      : arm_(arm),
        other_(other),
        radii_{prepared.robot(0).radii(), prepared.robot(1).radii()},
        moves_(prepared.problem(0).limits.edges == EdgeMode::kContinuous ||
               prepared.problem(1).limits.edges == EdgeMode::kContinuous),
        tolerance_(std::min(prepared.problem(0).limits.edge_tolerance,
                            prepared.problem(1).limits.edge_tolerance)),
        query_(prepared.between()),
        budget_(budget) {}

  bool node(int layer, const Config& q, double extra) override {
    const auto both = at(layer, q);
    if (query_.find_violating_pair(both, ClearanceRule::kNode, -extra)) return false;
    // The motions from and to the node will have to keep this.
    return !moves_ || extra <= 0 ||
           !query_.find_violating_pair(both, ClearanceRule::kMotion, -tolerance_);
  }
  bool edge(int layer, const Config& from, const Config& to) override {
    return !moves_ || !query_.find_pair_blocking_motion(radii_, at(layer, from), at(layer + 1, to),
                                                        0, budget_);
  }

 private:
  /// Returns the joints of both arms at a layer, by arm.
  [[nodiscard]] std::array<Config, 2> at(int layer, const Config& q) const {
    std::array<Config, 2> both;
    both[arm_] = q;
    both[1 - arm_] = other_[static_cast<std::size_t>(layer)].q;
    return both;
  }

  std::size_t arm_;
  const std::vector<TrajectoryRow>& other_;
  std::array<std::array<double, kDof>, 2> radii_;
  bool moves_;
  double tolerance_;
  InterArmWorld::Query query_;
  Budget budget_;
};

}  // namespace

void require_refinable(const PreparedWorkcell& prepared) {
  if (const auto given = prepared.given_arm())
    throw InputError(prepared.problem(*given).source,
                     "its motion is given, beside which nothing is refined yet: allowed are two "
                     "arms that are planned");
}

RefinedRuns refine_workcell(const PreparedWorkcell& prepared,
                            const std::array<std::vector<TrajectoryRow>, 2>& rows,
                            const Budget& budget, double extra_clearance) {
  const TraceSpan span("refine workcell");
  constexpr int kMostRepeats = 4;
  constexpr double kWorthIt = 1 - 1e-3;
  require_refinable(prepared);
  RefinedRuns result;
  result.runs.resize(2);
  for (std::size_t k = 0; k < 2; ++k) result.runs[k].rows = rows[k];
  for (int turn = 0; turn < kMostRepeats; ++turn) {
    const double before = result.cost;
    for (std::size_t k = 0; k < 2; ++k) {
      BesideOther beside(prepared, k, result.runs[1 - k].rows, budget);
      RefineOptions options;
      options.second_seed = false;  // it is planned without the other arm
      options.extra_clearance = extra_clearance;
      options.by_layer = &beside;
      Refined found =
          refine(prepared.robot(k), prepared.problem(k), result.runs[k].rows, options, budget);
      Refined& arm = result.runs[k];
      if (turn == 0) {
        arm = std::move(found);
        continue;
      }
      arm.rounds += found.rounds;
      arm.nodes_asked += found.nodes_asked;
      arm.edges_asked += found.edges_asked;
      if (!found.refined) continue;
      arm.refined = true;
      arm.reason.clear();
      arm.rows = std::move(found.rows);
      arm.cost = found.cost;
      arm.bend = found.bend;
    }
    ++result.turns;
    result.cost = result.runs[0].cost + result.runs[1].cost;
    if (turn == 0) result.cost_before = result.runs[0].cost_before + result.runs[1].cost_before;
    const double was = turn == 0 ? result.cost_before : before;
    if (!(result.cost < kWorthIt * was)) break;
  }
  return result;
}

}  // namespace swivel
