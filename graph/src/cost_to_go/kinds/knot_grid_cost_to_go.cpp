// SPDX-License-Identifier: BSD-3-Clause
#include "cost_to_go/kinds/knot_grid_cost_to_go.hpp"

#include <algorithm>
#include <cmath>

#include "cost_to_go/kernels/relax_task.hpp"
#include "swivel/core/base/angle.hpp"
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

bool KnotGridCostToGo::exists(int layer, int slot) {
  if (lattice_->is_given(layer)) return lattice_->node(layer, slot).has_value();
  const int inner = lattice_->inner(layer, slot);
  return nodes(layer, lattice_->rank_of(layer, slot))
      .valid(inner / angles_, pad_ + inner % angles_);
}

void KnotGridCostToGo::describe_row(const LayerNodes& theirs, const RelaxTask<double>& task,
                                    Around& around, int row) {
  const int length = angles_ + 2 * pad_, blocks = (length + kTile - 1) / kTile;
  const double* const values = around.value.data() + static_cast<std::ptrdiff_t>(row) * length;
  auto& [low, high] = around.finite[static_cast<std::size_t>(row)];
  low = high = 0;
  for (int k = 0; k < length; ++k) {
    if (values[k] == kUnreachable) continue;
    if (high == 0) low = k;
    high = k + 1;
    const auto block = static_cast<std::size_t>(row * blocks + k / kTile);
    around.boxes[block].add([&](int j) { return theirs.q(row % solutions_, j)[k]; }, task.turn);
    around.least[block] = std::min(around.least[block], values[k]);
  }
}

void KnotGridCostToGo::take_around(int layer, const RelaxTask<double>& task, const Values& values) {
  const int length = angles_ + 2 * pad_, rows = lattice_->rolls() * solutions_;
  const auto blocks = static_cast<std::size_t>(rows * ((length + kTile - 1) / kTile));
  around_layer_ = layer;
  for (Around& around : around_) {
    around.value.assign(static_cast<std::size_t>(rows) * static_cast<std::size_t>(length),
                        kUnreachable);
    around.finite.assign(static_cast<std::size_t>(rows), {});
    around.boxes.assign(blocks, {});
    around.least.assign(blocks, kUnreachable);
  }
  for (int row = 0; row < rows; ++row) {
    const double* from = values.data() + static_cast<std::ptrdiff_t>(row) * angles_;
    const auto is_finite = [](double value) { return value != kUnreachable; };
    if (std::none_of(from, from + angles_, is_finite)) continue;
    const auto at = static_cast<std::ptrdiff_t>(row) * length;
    double* const to = around_[0].value.data() + at;
    std::copy_n(from, angles_, to + pad_);
    std::copy_n(from + angles_ - pad_, pad_, to);
    std::copy_n(from, pad_, to + pad_ + angles_);
    const LayerNodes& own = nodes(layer, row / solutions_);
    describe_row(own, task, around_[0], row);
    const auto [low, high] = around_[0].finite[static_cast<std::size_t>(row)];
    for (std::size_t flip = 1; flip < kFlips.size(); ++flip) {
      double* const flipping = around_[flip].value.data() + at;
      bool any = false;
      for (int k = low; k < high; ++k)
        if (may_flip(kFlips[flip], own, row % solutions_, k)) flipping[k] = to[k], any = true;
      if (any) describe_row(own, task, around_[flip], row);
    }
  }
}

/// Short gaps of nodes that do not exist are included, since a call takes as long as some eight
/// nodes.
void KnotGridCostToGo::runs_of(const LayerNodes& nodes, int solution, int bit) {
  constexpr int kGap = 8;
  const int gap = bit == 0 ? kGap : 1;
  runs_.clear();
  for (int j = 0; j < angles_; ++j) {
    if (!nodes.valid(solution, pad_ + j) || !may_flip(bit, nodes, solution, pad_ + j)) continue;
    if (!runs_.empty() && j - runs_.back().second < gap)
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
  RelaxTask<double> task = relax_task(*lattice_, step);
  take_around(other, task, others);
  const int window = std::min(lattice_->phi_window(step), angles_ / 2),
            windings = lattice_->at_roll(0).windings();
  for (int rank = 0; rank < lattice_->rolls(); ++rank) {
    budget_.poll();
    const LayerNodes& own = nodes(layer, rank);
    const std::vector<int>& rolls = nearest_first(step, rank, other > layer);
    for (int solution = 0; solution < solutions_; ++solution) {
      if (!own.alive(solution)) continue;
      double* const best = out.data() + lattice_->slot_of(rank, solution * angles_);
      for (std::size_t flip = 0; flip < kFlips.size(); ++flip) {
        runs_of(own, solution, kFlips[flip]);
        // first IK solution of the branch
        const int first = (solution / windings ^ kFlips[flip]) * windings;
        for (const auto& [begin, end] : runs_)
          for (int at = begin; at < end; at += kTile) {
            const std::pair<int, int> tile{at, std::min(at + kTile, end)};
            JointBox box;
            for (int j = tile.first; j < tile.second; ++j)
              if (own.valid(solution, pad_ + j))
                box.add([&](int k) { return own.q(solution, k)[pad_ + j]; }, task.turn);
            if (box.empty()) continue;
            for (const int near : rolls)
              for (int partner = first; partner < first + windings; ++partner)
                relax_tile(own, solution, tile, box, around_[flip], near * solutions_ + partner,
                           window, task, best);
          }
      }
      const double *one = own.mask(solution, 0) + pad_, *two = own.mask(solution, 1) + pad_;
      for (int j = 0; j < angles_; ++j) best[j] += one[j] + two[j];
    }
  }
}

const std::vector<int>& KnotGridCostToGo::nearest_first(int step, int rank, bool forward) {
  const int own = step + (forward ? 0 : 1), other = step + (forward ? 1 : 0);
  const double roll = lattice_->roll_of_rank(own, rank);
  const auto away = [&](int near) {
    return std::abs(wrap_angle(lattice_->roll_of_rank(other, near) - roll));
  };
  near_ = lattice_->near(step, rank, forward);
  std::sort(near_.begin(), near_.end(), [&](int a, int b) { return away(a) < away(b); });
  return near_;
}

void KnotGridCostToGo::relax_tile(const LayerNodes& own, int solution,
                                  const std::pair<int, int>& tile, const JointBox& box,
                                  const Around& around, int row, int window,
                                  RelaxTask<double>& task, double* best) {
  const auto [begin, end] = tile;
  const auto [low, high] = around.finite[static_cast<std::size_t>(row)];
  int first = std::max(low, pad_ + begin - window), last = std::min(high, pad_ + end + window);
  if (first >= last) return;
  double most = 0;  // the largest of the nodes' values so far
  for (int j = begin; j < end; ++j)
    if (own.valid(solution, pad_ + j)) most = std::max(most, best[j]);
  const int length = angles_ + 2 * pad_, blocks = (length + kTile - 1) / kTile;
  const auto of_block = [&](int k) { return static_cast<std::size_t>(row * blocks + k / kTile); };
  const auto may_lower = [&](int k) {
    const std::size_t block = of_block(k);
    return around.least[block] < most && !around.boxes[block].empty() &&
           box.may_cost_less(around.boxes[block], task, most - around.least[block]);
  };
  while (first < last && !may_lower(first)) first = (first / kTile + 1) * kTile;
  if (first >= last) return;
  while (!may_lower(last - 1)) last = (last - 1) / kTile * kTile;
  // The offsets of these partners from the nodes, within the window.
  const int least = std::max(-window, first - (pad_ + end - 1)),
            greatest = std::min(window, last - 1 - (pad_ + begin));
  const LayerNodes& theirs = nodes(around_layer_, row / solutions_);
  for (std::size_t k = 0; k < kDof; ++k) {
    task.from[k] = own.q(solution, static_cast<int>(k)) + pad_ + begin;
    task.to[k] = theirs.q(row % solutions_, static_cast<int>(k)) + pad_ + begin + least;
  }
  task.n = end - begin;
  task.offsets = greatest - least + 1;
  task.value =
      around.value.data() + static_cast<std::ptrdiff_t>(row) * length + pad_ + begin + least;
  task.best = best + begin;
  edges_ += static_cast<std::int64_t>(task.n) * task.offsets;
  relax_kernels().relax(task);
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
            branch = inner / angles_ / windings, rank = lattice_->rank_of(layer, slot);
  const int count = std::min(2 * window + 1, angles_);
  for (const int near : lattice_->near(step, rank, other > layer))
    for (const int bit : kFlips) {
      if (!may_flip(bit, nodes(layer, rank), inner / angles_, pad_ + angle)) continue;
      const LayerNodes& theirs = nodes(other, near);
      const int first = (branch ^ bit) * windings;
      for (int solution = first; solution < first + windings; ++solution) {
        if (!theirs.alive(solution)) continue;
        const int zero = lattice_->slot_of(near, solution * angles_);
        for (int k = 0; k < count; ++k) {
          const int j = (angle - window + k + angles_) % angles_;
          if (worth(zero + j) && may_flip(bit, theirs, solution, pad_ + j))
            visit(zero + j, theirs.config(solution, pad_ + j));
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
  constexpr std::size_t kMany = 256, kPart = 16;
  return std::min(kMany, static_cast<std::size_t>(lattice_->slots(layer)) / kPart);
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
          const double value = values[static_cast<std::size_t>(a)];
          if (value == kUnreachable) return lowers_ && exists(layer, a);
          return value >= change.before;
        },
        [&](int a, const Config& from) {
          const double rest = lattice_->edge_cost(lattice_->delta(from, to)) + change.before;
          if (values[static_cast<std::size_t>(a)] >= (own ? rest + own[a] : rest))
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
