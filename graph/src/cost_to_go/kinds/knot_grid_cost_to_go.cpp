// SPDX-License-Identifier: BSD-3-Clause
#include "cost_to_go/kinds/knot_grid_cost_to_go.hpp"

#include <algorithm>

#include "cost_to_go/kernels/relax_task.hpp"
#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 30;  // joints that are kept, at most

}  // namespace

KnotGridCostToGo::KnotGridCostToGo(const KnotGrid& lattice, const Budget& budget)
    : LayerValues(lattice, budget),
      lattice_(&lattice),
      angles_(lattice.at_roll(0).angles()),
      solutions_(lattice.at_roll(0).solutions()),
      pad_(lattice.widest_phi_window()),
      solved_(static_cast<std::size_t>(lattice.layers())) {}

const LayerNodes& KnotGridCostToGo::nodes(int layer, int rank) {
  Solved& solved = solved_[static_cast<std::size_t>(layer)];
  if (!solved.kept) {
    // The oldest layers make room, except the two that are being joined.
    while (bytes_ > kMostBytes && kept_.size() > 2) forget(kept_.front());
    solved.of_roll.swap(recycled_);
    solved.of_roll.resize(static_cast<std::size_t>(lattice_->rolls()));
    solved.done.assign(solved.of_roll.size(), 0);
    solved.kept = true;
    kept_.push_back(layer);
  }
  const auto r = static_cast<std::size_t>(rank);
  LayerNodes& nodes = solved.of_roll[r];
  if (!solved.done[r]) {
    lattice_->at_roll(rank).solve(layer, (angles_ - pad_) % angles_, angles_ + 2 * pad_, nodes);
    solved.done[r] = 1;
    bytes_ += nodes.bytes();
    ik_nodes_ += lattice_->width();
  }
  return nodes;
}

void KnotGridCostToGo::forget(int layer) {
  Solved& solved = solved_[static_cast<std::size_t>(layer)];
  if (!solved.kept) return;
  for (std::size_t r = 0; r < solved.done.size(); ++r)
    if (solved.done[r]) bytes_ -= solved.of_roll[r].bytes();
  recycled_.swap(solved.of_roll);
  solved = {};
  std::erase(kept_, layer);
}

Config KnotGridCostToGo::config(int layer, int slot) {
  if (lattice_->is_given(layer)) return *lattice_->node(layer, 0);
  const int inner = lattice_->inner(layer, slot);
  return nodes(layer, lattice_->rank_of(layer, slot))
      .config(inner / angles_, pad_ + inner % angles_);
}

void KnotGridCostToGo::take_around(const Values& values) {
  const int length = angles_ + 2 * pad_, rows = lattice_->rolls() * solutions_;
  around_.value.assign(static_cast<std::size_t>(rows) * static_cast<std::size_t>(length),
                       kUnreachable);
  around_.finite.assign(static_cast<std::size_t>(rows), {});
  for (int row = 0; row < rows; ++row) {
    const double* from = values.data() + static_cast<std::ptrdiff_t>(row) * angles_;
    const auto is_finite = [](double value) { return value != kUnreachable; };
    if (std::none_of(from, from + angles_, is_finite)) continue;
    double* const to = around_.value.data() + static_cast<std::ptrdiff_t>(row) * length;
    std::copy_n(from, angles_, to + pad_);
    std::copy_n(from + angles_ - pad_, pad_, to);
    std::copy_n(from, pad_, to + pad_ + angles_);
    int low = 0, high = length;
    while (!is_finite(to[low])) ++low;
    while (!is_finite(to[high - 1])) --high;
    around_.finite[static_cast<std::size_t>(row)] = {low, high};
  }
}

/// Finds runs of nodes that exist; short gaps are included, since a call takes as long as some
/// eight nodes.
void KnotGridCostToGo::runs_of(const LayerNodes& nodes, int solution) {
  constexpr int kGap = 8;
  runs_.clear();
  for (int j = 0; j < angles_; ++j) {
    if (!nodes.valid(solution, pad_ + j)) continue;
    if (!runs_.empty() && j - runs_.back().second < kGap)
      runs_.back().second = j + 1;
    else
      runs_.push_back({j, j + 1});
  }
}

template <class Visit>
void KnotGridCostToGo::each_beside_given(int step, int layer, int other, const Visit& visit) {
  if (other < layer) {
    std::vector<Lattice::SlotRun> runs;
    lattice_->successors(step, 0, runs);
    for (const Lattice::SlotRun& run : runs)
      for (int b = run.first; b < run.last; ++b) visit(b);
    return;
  }
  for (const int rank : lattice_->near(step, 0, false))
    for (int inner = 0; inner < lattice_->width(); ++inner)
      if (const int a = lattice_->slot_of(rank, inner); lattice_->in_window(step, a, 0)) visit(a);
}

void KnotGridCostToGo::relax(int step, int layer, int other, const Values& others, Values& out) {
  out.assign(static_cast<std::size_t>(lattice_->slots(layer)), kUnreachable);
  const auto relax_alone = [&](int slot) {
    if (lattice_->node(layer, slot))
      out[static_cast<std::size_t>(slot)] =
          other > layer ? relax_one(layer, slot) : relax_one_forward(layer, slot, others);
  };
  if (lattice_->is_given(layer)) return relax_alone(0);
  if (lattice_->is_given(other)) {
    if (others[0] != kUnreachable) each_beside_given(step, layer, other, relax_alone);
    return;
  }
  take_around(others);
  const int window = lattice_->phi_window(step), length = angles_ + 2 * pad_;
  const int windings = lattice_->at_roll(0).windings();
  RelaxTask<double> task = relax_task(*lattice_, step);
  task.offsets = std::min(2 * window + 1, angles_);
  for (int rank = 0; rank < lattice_->rolls(); ++rank) {
    budget_.poll();
    const LayerNodes& own = nodes(layer, rank);
    for (int solution = 0; solution < solutions_; ++solution) {
      if (!own.alive(solution)) continue;
      double* const best = out.data() + lattice_->slot_of(rank, solution * angles_);
      runs_of(own, solution);
      const int first = solution / windings * windings;  // first IK solution of the branch
      for (const int near : lattice_->near(step, rank, other > layer))
        for (int partner = first; partner < first + windings; ++partner) {
          const auto row = static_cast<std::size_t>(near * solutions_ + partner);
          const auto& [low, high] = around_.finite[row];
          if (low >= high || runs_.empty()) continue;
          const LayerNodes& theirs = nodes(other, near);
          for (const auto& [begin, end] : runs_) {
            const int from = pad_ - window + begin;  // first of the partners
            if (from >= high || from + (end - begin) - 1 + task.offsets <= low) continue;
            for (std::size_t k = 0; k < kDof; ++k) {
              task.from[k] = own.q(solution, static_cast<int>(k)) + pad_ + begin;
              task.to[k] = theirs.q(partner, static_cast<int>(k)) + from;
            }
            task.n = end - begin;
            task.value = around_.value.data() + row * static_cast<std::size_t>(length) + from;
            task.best = best + begin;
            edges_ += static_cast<std::int64_t>(task.n) * task.offsets;
            relax_kernels().relax(task);
          }
        }
      const double *one = own.mask(solution, 0) + pad_, *two = own.mask(solution, 1) + pad_;
      for (int j = 0; j < angles_; ++j) best[j] += one[j] + two[j];
    }
  }
}

template <class Worth, class Visit>
void KnotGridCostToGo::each_near(int step, int layer, int slot, int other, const Worth& worth,
                             const Visit& visit) {
  if (lattice_->is_given(other)) {
    const bool joined =
        other > layer ? lattice_->in_window(step, slot, 0) : lattice_->in_window(step, 0, slot);
    if (joined && worth(0)) visit(0, config(other, 0));
    return;
  }
  if (lattice_->is_given(layer)) {
    each_beside_given(step, other, layer, [&](int b) {
      if (worth(b)) visit(b, config(other, b));
    });
    return;
  }
  const int window = lattice_->phi_window(step), windings = lattice_->at_roll(0).windings();
  const int inner = lattice_->inner(layer, slot), angle = inner % angles_,
            first = inner / angles_ / windings * windings;
  const int count = std::min(2 * window + 1, angles_);
  for (const int near : lattice_->near(step, lattice_->rank_of(layer, slot), other > layer)) {
    const LayerNodes& theirs = nodes(other, near);
    for (int solution = first; solution < first + windings; ++solution) {
      if (!theirs.alive(solution)) continue;
      const int zero = lattice_->slot_of(near, solution * angles_);
      for (int k = 0; k < count; ++k) {
        const int j = (angle - window + k + angles_) % angles_;
        if (worth(zero + j)) visit(zero + j, theirs.config(solution, pad_ + j));
      }
    }
  }
}

double KnotGridCostToGo::relax_one(int layer, int slot) {
  if (removed(layer, slot)) return kUnreachable;
  const Config q = config(layer, slot);
  double best = kUnreachable;
  each_near(
      layer, layer, slot, layer + 1, [&](int b) { return at(layer + 1, b) < best; },
      [&](int b, const Config& other) {
        const Config delta = lattice_->delta(q, other);
        const double value = lattice_->edge_cost(delta) + at(layer + 1, b);
        if (value < best && lattice_->step_allowed(layer, delta) &&
            verdicts_.edge(layer, slot, b) != Verdict::kRemoved)
          best = value;
      });
  return best;
}

double KnotGridCostToGo::relax_one_forward(int layer, int slot, const Values& before) {
  const Config q = config(layer, slot);
  double best = kUnreachable;
  each_near(
      layer - 1, layer, slot, layer - 1,
      [&](int a) { return before[static_cast<std::size_t>(a)] < best; },
      [&](int a, const Config& other) {
        const Config delta = lattice_->delta(other, q);
        const double value = lattice_->edge_cost(delta) + before[static_cast<std::size_t>(a)];
        if (value < best && lattice_->step_allowed(layer - 1, delta) &&
            verdicts_.edge(layer - 1, a, slot) != Verdict::kRemoved)
          best = value;
      });
  return best;
}

void KnotGridCostToGo::begin(int layer, Values& out) {
  out.assign(static_cast<std::size_t>(lattice_->slots(layer)), kUnreachable);
  if (lattice_->is_given(layer)) {
    if (lattice_->node(layer, 0)) out[0] = 0;
    return;
  }
  for (int rank = 0; rank < lattice_->rolls(); ++rank) {
    const LayerNodes& own = nodes(layer, rank);
    for (int solution = 0; solution < solutions_; ++solution)
      for (int j = 0; own.alive(solution) && j < angles_; ++j)
        if (own.valid(solution, pad_ + j))
          out[static_cast<std::size_t>(lattice_->slot_of(rank, solution * angles_ + j))] = 0;
  }
}

std::size_t KnotGridCostToGo::many(int layer) const {
  static_cast<void>(layer);
  constexpr std::size_t kMany = 256;
  return kMany;
}

void KnotGridCostToGo::find_stale(int layer, const std::vector<Change>& ahead,
                              std::vector<int>& stale) {
  const Values& values = value_[static_cast<std::size_t>(layer)];
  const double* own = verdicts_.costs(layer);
  for (const Change& change : ahead) {
    if (change.before == kUnreachable) continue;
    const Config to = config(layer + 1, change.slot);
    each_near(
        layer, layer + 1, change.slot, layer,
        [&](int a) {
          return values[static_cast<std::size_t>(a)] != kUnreachable &&
                 values[static_cast<std::size_t>(a)] >= change.before;
        },
        [&](int a, const Config& from) {
          const double rest = lattice_->edge_cost(lattice_->delta(from, to)) + change.before;
          if (values[static_cast<std::size_t>(a)] == (own ? rest + own[a] : rest))
            stale.push_back(a);
        });
  }
}

void KnotGridCostToGo::steps(int layer, int slot, double bound, std::vector<Step>& out) {
  const Config q = config(layer, slot);
  const double own = verdicts_.cost(layer, slot);
  out.clear();
  each_near(
      layer, layer, slot, layer + 1,
      [&](int b) { return at(layer + 1, b) != kUnreachable && at(layer + 1, b) <= bound; },
      [&](int b, const Config& other) {
        const Config delta = lattice_->delta(q, other);
        if (!lattice_->step_allowed(layer, delta)) return;
        const double cost = lattice_->edge_cost(delta) + own;
        if (cost + at(layer + 1, b) <= bound && verdicts_.edge(layer, slot, b) != Verdict::kRemoved)
          out.push_back({b, cost});
      });
  std::sort(out.begin(), out.end(), [](const Step& a, const Step& b) { return a.slot < b.slot; });
}

}  // namespace swivel
