// SPDX-License-Identifier: BSD-3-Clause
#include "plan/search_on_knots.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "plan/answer.hpp"

namespace swivel {

namespace {

/// Returns the layer of `finer` that each layer of `coarser` is.
std::vector<int> layers_in(const Lattice& coarser, const Lattice& finer) {
  std::vector<int> here;
  for (int layer = 0, at = 0; layer < coarser.layers(); ++layer) {
    while (finer.layer_of_rows(at) < coarser.layer_of_rows(layer)) ++at;
    here.push_back(at);
  }
  return here;
}

/// Fills Found::rows and returns what they cost, as far as turns of joints are told apart;
/// kUnreachable where no path was found.
double row_cost(const Lattice& lattice, Found& found) {
  if (found.outcome.path.empty()) return kUnreachable;
  found.rows = lattice.path_rows(found.outcome.path);
  return cost_of_rows(lattice, found.outcome.path, found.rows, found.outcome.cost);
}

/// Returns whether a lattice has no path, and layers without nodes lie beside the furthest one that
/// is reached: then it is not known which of them ends all paths.
bool ends_between_knots(const Lattice& lattice, const Found& found) {
  if (!found.outcome.path.empty() || !found.deepest || *found.deepest < 0) return false;
  const int at = *found.deepest;
  return (at > 0 && lattice.can_halve(at - 1)) ||
         (at + 1 < lattice.layers() && lattice.can_halve(at));
}

/// Returns a lattice that has nodes at all layers between the knots before and after a layer.
std::shared_ptr<Lattice> with_all_layers_about(const std::shared_ptr<Lattice>& lattice, int layer,
                                               const HalveSteps& halve, const Budget& budget) {
  const int first = lattice->layer_of_rows(std::max(0, layer - 1)),
            last = lattice->layer_of_rows(std::min(layer + 1, lattice->layers() - 1));
  std::shared_ptr<Lattice> finer;
  for (;;) {
    const std::shared_ptr<Lattice>& now = finer ? finer : lattice;
    std::set<int> steps;
    for (int step = 0; step + 1 < now->layers(); ++step)
      if (now->layer_of_rows(step) >= first && now->layer_of_rows(step) < last) steps.insert(step);
    auto next = halve(now, steps, budget);
    if (!next) return finer;
    finer = std::move(next);
  }
}

/// Searches finer and finer lattices, beginning with one that can be halved.
class Levels {
 public:
  Levels(Searched& first, const SearchLattice& search, const HalveSteps& halve,
         const PlanOptions& options, const Budget& budget)
      : first_(first), search_(search), halve_(halve), options_(options), budget_(budget) {}

  FoundOnKnots run() {
    best_ = search_(first_, nullptr, budget_, &knots_);
    least_ = row_cost(*first_.lattice, best_);
    uneven_ = uneven_steps(*first_.lattice, best_.outcome.path, best_.rows);
    if (best_.decided)
      while (is_worth_halving() && halve()) {
      }
    FoundOnKnots on_knots;
    if (level_of_best_ > 0) on_knots.finer = std::move(finer_[level_of_best_ - 1]);
    const Lattice& lattice = on_knots.finer ? *on_knots.finer->lattice : *first_.lattice;
    if (knots_.bound != kUnreachable && !lattice.has_node_costs() && !lattice.is_approximate() &&
        !options_.hooks.cost)
      told_.bound = knots_.bound;
    on_knots.knots = told_;
    on_knots.found = std::move(best_);
    return on_knots;
  }

 private:
  [[nodiscard]] const Searched& last() const { return finer_.empty() ? first_ : finer_.back(); }
  [[nodiscard]] bool is_worth_halving() const {
    return !uneven_.empty() || worth_halving(knots_, best_.outcome) ||
           ends_between_knots(*last().lattice, best_);
  }
  /// Searches a lattice with more knots than the last one. Returns false where the search ends: in
  /// time, or as there is no such lattice's answer.
  bool halve() {
    const KnotSearch before = std::exchange(knots_, {});
    std::set<int> steps = std::exchange(uneven_, {});
    steps.insert(before.narrow.begin(), before.narrow.end());
    knots_.most = least_;
    const Budget time = best_.outcome.path.empty() ? budget_ : most_of(budget_, options_);
    Found found;
    Searched next;
    try {
      next.lattice = steps.empty()
                         ? with_all_layers_about(last().lattice, *best_.deepest, halve_, time)
                         : halve_(last().lattice, steps, time);
      found = search_(next, &last(), time, can_halve(*next.lattice) ? &knots_ : nullptr);
    } catch (const Stopped&) {
      if (!next.lattice) {  // the time was up before there was one
        best_.decided = !best_.outcome.path.empty();
        told_.halved = false;
        return false;
      }
    }
    // What is searched no more makes room.
    if (!finer_.empty() && finer_.size() != level_of_best_) finer_.back() = {};
    finer_.push_back(std::move(next));
    if (!found.decided && !best_.outcome.path.empty()) {
      told_.halved = false;
      return false;
    }
    take(std::move(found), before.bound);
    return best_.decided;
  }
  /// Keeps the answer of the last lattice if it is the cheapest so far.
  void take(Found found, double bound_before) {
    const Lattice& lattice = *finer_.back().lattice;
    // Without a step to halve the answer is the best of all.
    if (!can_halve(lattice) && !found.outcome.path.empty()) knots_.bound = found.outcome.cost;
    if (knots_.bound == kUnreachable) knots_.bound = bound_before;
    const double cost = row_cost(lattice, found);
    uneven_ = uneven_steps(lattice, found.outcome.path, found.rows);
    if (cost >= least_ && !best_.outcome.path.empty()) return;
    best_ = std::move(found);
    least_ = cost;
    level_of_best_ = finer_.size();
  }

  Searched& first_;
  const SearchLattice& search_;
  const HalveSteps& halve_;
  const PlanOptions& options_;
  const Budget& budget_;
  KnotSearch knots_;      // of the last lattice
  std::set<int> uneven_;  // steps of its answer that are worth halving
  Found best_;
  double least_ = kUnreachable;    // cost of the rows of best_
  std::size_t level_of_best_ = 0;  // 0: first_
  std::vector<Searched> finer_;
  LatticeInfo::Knots told_;
};

/// Returns by what share at most a path is dearer than one whose redundancy changes by any slope:
/// an estimate, the mean of min(r² / 8 c², √2 - 1) over the drift of the path's steps. A step of
/// travel L moves the joints by c L across the self-motion, and along it by multiples of about r L,
/// as far as nodes lie apart (docs/theory.md "As the resolution goes to zero"). c and r are in
/// units of the metric for each metre. Nodes lie 1.5 `arc` apart, or, on a `grid`, as far as the
/// next arm angle is.
double bias_of_slopes(const Lattice& lattice, const std::vector<int>& path, double arc, bool grid) {
  constexpr double kMostApart = 1.5, kLeastWeight = 1e-2;  // of `arc`; of the largest weight
  const Eigen::Map<const Eigen::Vector<double, kDof>> weights(lattice.cost_scale().data());
  double drift = 0, excess = 0;
  for (int step = 0; step + 1 < lattice.layers(); ++step) {
    const auto k = static_cast<std::size_t>(step);
    const double length = lattice.path().layer(step + 1).travel - lattice.path().layer(step).travel;
    if (length <= 0) continue;
    const Config q = *lattice.node(step, path[k]);
    const Config move = lattice.delta(q, *lattice.node(step + 1, path[k + 1]));
    const Eigen::Vector<double, kDof> along =
        lattice.chain().jacobian(q).fullPivLu().kernel().col(0);
    Eigen::Vector<double, kDof> self, across;  // of the self-motion, and of the move
    double distance = 0;                       // that nodes are told apart by, squared
    for (Eigen::Index j = 0; j < kDof; ++j) {
      self[j] = weights[j] * along[j], across[j] = weights[j] * move[j];
      const double weight = std::max(weights[j], kLeastWeight * weights.maxCoeff());
      distance += weight * weight * along[j] * along[j];
    }
    if (const double squared = self.squaredNorm(); squared > 0)
      across -= self.dot(across) / squared * self;
    const double c = across.norm() / length;
    if (c == 0) continue;
    double r = kMostApart * arc / length * self.norm() / std::sqrt(distance);
    if (grid) {
      const int beside = lattice.neighbour_in_redundancy(step, path[k], 1);
      const auto next = beside < 0 ? std::nullopt : lattice.node(step, beside);
      if (!next) continue;
      r = lattice.edge_cost(lattice.delta(q, *next)) / length;
    }
    drift += c * length;
    excess += c * length * std::min(r * r / (8 * c * c), std::numbers::sqrt2 - 1);
  }
  return drift > 0 ? excess / drift : 0;
}

}  // namespace

bool can_halve(const Lattice& lattice) {
  for (int step = 0; step + 1 < lattice.layers(); ++step)
    if (lattice.can_halve(step)) return true;
  return false;
}

std::set<int> uneven_steps(const Lattice& lattice, const SlotPath& path,
                           std::vector<TrajectoryRow> rows) {
  constexpr double kUneven = 1.05, kWorthIt = 1.01;
  if (path.empty() || rows.empty()) return {};
  count_from_path(lattice.chain(), lattice.path_of_rows(), rows);
  std::set<int> uneven;
  double of_chords = 0, of_rows = 0;
  for (int step = 0; step + 1 < static_cast<int>(path.size()); ++step) {
    const auto k = static_cast<std::size_t>(step);
    const double chord = lattice.edge_cost(
        lattice.delta(*lattice.node(step, path[k]), *lattice.node(step + 1, path[k + 1])));
    double along = 0;
    for (int i = lattice.layer_of_rows(step); i < lattice.layer_of_rows(step + 1); ++i)
      along += lattice.edge_cost(lattice.delta(rows[static_cast<std::size_t>(i)].q,
                                               rows[static_cast<std::size_t>(i) + 1].q));
    of_chords += chord;
    of_rows += along;
    if (along > kUneven * chord && lattice.can_halve(step)) uneven.insert(step);
  }
  return of_rows > kWorthIt * of_chords ? uneven : std::set<int>();
}

void take_verdicts(CostToGo& coarser, CostToGo& finer) {
  finer.verdicts().take(coarser.verdicts(), layers_in(coarser.lattice(), finer.lattice()));
}

void take_from_coarser(const Searched& coarser, Searched& finer, bool bounds) {
  if (!coarser.cost_to_go) return;
  take_verdicts(*coarser.cost_to_go, *finer.cost_to_go);
  if (bounds)
    finer.cost_to_go->bound_by_coarser(*coarser.cost_to_go,
                                       layers_in(*coarser.lattice, *finer.lattice));
}

Budget most_of(const Budget& budget, const PlanOptions& options) {
  constexpr double kShare = 0.8;
  std::optional<double> seconds = budget.seconds_left();
  if (seconds) *seconds *= kShare;
  return Budget(seconds, options.cancel, options.stop, &options.progress);
}

void describe_knots(double cost, const Lattice& lattice, const std::vector<int>& path, double arc,
                    LatticeInfo& info) {
  auto& knots = info.knots;
  if (!knots) return;
  if (knots->bound) knots->gap = *knots->bound > 0 ? std::max(0.0, cost / *knots->bound - 1) : 0;
  if (lattice.cost().metric == CostMetric::kL2 && !lattice.chain().free_roll)
    knots->bias = bias_of_slopes(lattice, path, arc, info.grid.has_value());
}

FoundOnKnots search_on_knots(Searched& first, const SearchLattice& search, const HalveSteps& halve,
                             const PlanOptions& options, const Budget& budget) {
  if (can_halve(*first.lattice)) return Levels(first, search, halve, options, budget).run();
  return {search(first, nullptr, budget, nullptr), std::nullopt, std::nullopt};
}

}  // namespace swivel
