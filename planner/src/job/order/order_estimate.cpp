// SPDX-License-Identifier: BSD-3-Clause
#include "job/order/order_estimate.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "job/transitions/job_transitions.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/lattice/kinds/make_lattice.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();  // cost of what is not there
/// Nodes of an end of a run that are looked at, the cheapest ones, and pairs of nodes of all runs.
constexpr std::size_t kFewestNodes = 16, kMostNodes = 512, kMostPairs = 40'000'000;

std::size_t most_nodes(std::size_t runs) {
  std::size_t nodes = kMostNodes;
  while (nodes > kFewestNodes && nodes * nodes * runs * runs > kMostPairs) nodes /= 2;
  return nodes;
}

/// A node at which a run may begin or end, and what the run costs more than at its best if it does.
struct Gate {
  Gate(const Config& joints, double more) : q(joints), regret(more) {}
  Config q;
  double regret = 0;
};

/// The ends of one run without obstacles.
struct Gates {
  double least = kNever;           ///< cost of the run at its best
  std::vector<Gate> begins, ends;  ///< by ascending regret
};

/// Returns the nodes at which a path may begin, and sets `least` to the cost of its best path.
std::vector<Gate> begins_of(const PreparedRobot& robot, const PathProblem& problem,
                            std::size_t most, double& least, const Budget& budget) {
  const Chain& chain = robot.arm().chain;
  const ToolPath path = path_within_scale(problem, chain, budget);
  const auto lattice = make_lattice(chain, robot.arm_class(), path, problem, budget);
  const auto values = make_cost_to_go(*lattice, Pruning::kNone, budget);
  values->set_single_use();
  values->sweep(lattice->layers() - 1);
  least = values->best();
  std::vector<Gate> gates;
  for (int slot = 0; slot < lattice->slots(0); ++slot)
    if (values->at(0, slot) != kUnreachable)
      gates.emplace_back(values->config(0, slot), values->at(0, slot) - least);
  std::stable_sort(gates.begin(), gates.end(),
                   [](const Gate& a, const Gate& b) { return a.regret < b.regret; });
  if (gates.size() > most)
    gates.erase(gates.begin() + static_cast<std::ptrdiff_t>(most), gates.end());
  return gates;
}

/// Returns the least of the regrets and the distance from an end to a begin.
double least_between(const std::vector<Gate>& ends, const std::vector<Gate>& begins,
                     const Lattice& metric) {
  double best = kNever;
  for (const Gate& end : ends) {
    if (end.regret >= best) break;
    for (const Gate& begin : begins) {
      if (end.regret + begin.regret >= best) break;
      best =
          std::min(best, end.regret + begin.regret + transition_distance(metric, end.q, begin.q));
    }
  }
  return best;
}

}  // namespace

OrderCosts estimate_order_costs(const PreparedRobot& robot, const Problem& job,
                                const ParallelFor& work, const Budget& budget) {
  const TraceSpan span("order");
  const std::size_t runs = 2 * job.arm().strokes.size();
  std::vector<Gates> gates(runs);
  // Part 2 r finds where run r begins; part 2 r + 1 where it ends, which is where its path, taken
  // from its end to its begin, would begin.
  work.for_each(static_cast<int>(2 * runs), [&](int part, int) {
    const auto run = static_cast<std::size_t>(part) / 2;
    const bool reversed = run % 2 == 1, of_ends = part % 2 == 1;
    if (reversed && !job.arm().strokes[run / 2].reversible) return;
    PathProblem problem = problem_of_run(job, {run / 2, reversed});
    if (of_ends) {
      std::reverse(problem.waypoints.begin(), problem.waypoints.end());
      std::reverse(problem.steps.begin(), problem.steps.end());
      std::swap(problem.start, problem.end);
    }
    double least = kNever;
    auto found = begins_of(robot, problem, most_nodes(runs), least, budget);
    (of_ends ? gates[run].ends : gates[run].begins) = std::move(found);
    if (!of_ends) gates[run].least = least;
  });
  budget.tell(Stage::kSearch);  // the lattices of all strokes are swept
  const PathProblem first = problem_of_run(job, {0, false});
  const ToolPath path = path_within_scale(first, robot.arm().chain, budget);
  const auto metric = make_lattice(robot.arm().chain, robot.arm_class(), path, first, budget);
  const std::vector<Gate> home{Gate(job.arm().home.value_or(Config::Zero()), 0)};
  OrderCosts costs;
  costs.strokes = job.arm().strokes.size();
  costs.follow.assign(runs, std::vector<double>(runs, kNever));
  costs.first.assign(runs, kNever);
  costs.last.assign(runs, kNever);
  work.for_each(static_cast<int>(runs), [&](int part, int) {
    const auto run = static_cast<std::size_t>(part);
    const Gates& here = gates[run];
    if (here.least == kNever) return;
    costs.first[run] =
        here.least + (job.arm().home ? least_between(home, here.begins, *metric) : 0.0);
    costs.last[run] = job.arm().home ? least_between(here.ends, home, *metric) : 0.0;
    for (std::size_t next = 0; next < runs; ++next)
      if (next / 2 != run / 2 && gates[next].least != kNever) {
        budget.poll();
        costs.follow[run][next] =
            gates[next].least + least_between(here.ends, gates[next].begins, *metric);
      }
  });
  return costs;
}

}  // namespace swivel
