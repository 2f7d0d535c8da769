// SPDX-License-Identifier: BSD-3-Clause
#include "cost_to_go/kinds/explicit_cost_to_go.hpp"

#include <algorithm>
#include <cmath>

#include "cost_to_go/kernels/relax_task.hpp"
#include "swivel/core/base/angle.hpp"

namespace swivel {

ExplicitCostToGo::ExplicitCostToGo(const Lattice& lattice, Pruning pruning, const Budget& budget)
    : LayerValues(lattice, budget, pruning),
      lattice_(&lattice),
      nodes_(static_cast<std::size_t>(lattice.layers())) {
  for (int layer = 0; layer < lattice.layers(); ++layer) ik_nodes_ += lattice.slots(layer);
}

const ExplicitCostToGo::Nodes& ExplicitCostToGo::nodes_of(int layer) {
  std::shared_ptr<const Nodes>& known = nodes_[static_cast<std::size_t>(layer)];
  if (known) return *known;
  auto nodes = std::make_shared<Nodes>();
  lattice_->layer_nodes(layer, listed_);
  for (std::size_t k = 0; k < kDof; ++k) {
    Values& joint = nodes->joints[k];
    joint.resize(static_cast<std::size_t>(lattice_->slots(layer)));
    for (const Lattice::Node& node : listed_)
      joint[static_cast<std::size_t>(node.slot)] = node.q[static_cast<Eigen::Index>(k)];
  }
  nodes->blocks = relax_blocks(*lattice_, nodes->joints);
  known = std::move(nodes);
  return *known;
}

void ExplicitCostToGo::share_nodes(LayerValues& coarser, std::span<const int> layer_here) {
  const auto& others = static_cast<ExplicitCostToGo&>(coarser).nodes_;
  for (std::size_t layer = 0; layer < layer_here.size(); ++layer)
    nodes_[static_cast<std::size_t>(layer_here[layer])] = others[layer];
}

void ExplicitCostToGo::relax_between(int step, const Joints& from, const Joints& to,
                                     const RelaxBlocks* blocks, const Values& others, Values& out) {
  edges_ += static_cast<std::int64_t>(from[0].size() * others.size());
  relax_all_pairs(relax_task(*lattice_, step), from, to, blocks, others, least_of_blocks_, out);
}

void ExplicitCostToGo::relax(int step, int layer, int other_layer, const Values& others,
                             Values& out) {
  const Joints& from = joints_of(layer);
  const Nodes& to = nodes_of(other_layer);
  out.assign(from[0].size(), kUnreachable);
  relax_between(step, from, to.joints, &to.blocks, others, out);
}

void ExplicitCostToGo::gather(int layer, const std::vector<int>& slots, Joints& out) {
  const Joints& joints = joints_of(layer);
  for (std::size_t k = 0; k < kDof; ++k) {
    out[k].clear();
    for (const int slot : slots) out[k].push_back(joints[k][static_cast<std::size_t>(slot)]);
  }
}

void ExplicitCostToGo::relax_some(int layer, const std::vector<int>& slots, Values& out) {
  const Nodes& next = nodes_of(layer + 1);
  gather(layer, slots, some_);
  out.assign(slots.size(), kUnreachable);
  relax_between(layer, some_, next.joints, &next.blocks,
                value_[static_cast<std::size_t>(layer) + 1], out);
  for (std::size_t k = 0; k < slots.size(); ++k)
    if (lost_best_edge(layer, slots[k], out[k])) out[k] = relax_one(layer, slots[k]);
}

double ExplicitCostToGo::relax_one(int layer, int slot) {
  if (removed(layer, slot)) return kUnreachable;
  const Config q = config(layer, slot);
  double best = kUnreachable;
  for (int b = 0; b < lattice_->slots(layer + 1); ++b) {
    const double rest = at(layer + 1, b);
    if (rest >= best) continue;
    const Config delta = lattice_->delta(q, config(layer + 1, b));
    const double value = lattice_->edge_cost(delta) + rest;
    if (value < best && lattice_->step_allowed(layer, delta) &&
        verdicts_.edge(layer, slot, b) != Verdict::kRemoved)
      best = value;
  }
  return best;
}

double ExplicitCostToGo::relax_one_forward(int layer, int slot, const Values& before) {
  const Config q = config(layer, slot);
  double best = kUnreachable;
  for (int a = 0; a < lattice_->slots(layer - 1); ++a) {
    const double done = before[static_cast<std::size_t>(a)];
    if (done >= best) continue;
    const Config delta = lattice_->delta(config(layer - 1, a), q);
    const double value = lattice_->edge_cost(delta) + done;
    if (value < best && lattice_->step_allowed(layer - 1, delta) &&
        verdicts_.edge(layer - 1, a, slot) != Verdict::kRemoved)
      best = value;
  }
  return best;
}

std::size_t ExplicitCostToGo::many(int layer) const {
  constexpr std::size_t kPart = 2;
  return static_cast<std::size_t>(lattice_->slots(layer)) / kPart;
}

void ExplicitCostToGo::find_stale(int layer, const std::vector<Change>& ahead,
                                  std::vector<int>& stale) {
  if (ahead.empty()) return;
  slots_.clear();
  changed_from_.clear();
  for (const Change& change : ahead) {
    slots_.push_back(change.slot);
    changed_from_.push_back(change.before);
  }
  gather(layer + 1, slots_, some_);
  // A value came from `ahead` if it is reached from there: that is, if the values, raised a little,
  // are lowered.
  const Values& values = value_[static_cast<std::size_t>(layer)];
  const double* own = verdicts_.costs(layer);
  const double little = 1e-9 * lattice_->cost_unit();  // far above the rounding
  // Where few nodes are reached, these alone are looked at.
  const auto reached = static_cast<std::size_t>(std::count_if(
      values.begin(), values.end(), [](double value) { return value != kUnreachable; }));
  const bool all = lowers_ || 2 * reached > values.size();
  least_ = values;
  if (!all) {
    slots_.clear();
    least_.clear();
    for (std::size_t a = 0; a < values.size(); ++a) {
      if (values[a] == kUnreachable) continue;
      slots_.push_back(static_cast<int>(a));
      least_.push_back(values[a]);
    }
    gather(layer, slots_, reached_);
  }
  const auto slot = [&](std::size_t k) { return all ? k : static_cast<std::size_t>(slots_[k]); };
  for (std::size_t k = 0; k < least_.size(); ++k) least_[k] += little - (own ? own[slot(k)] : 0.0);
  raised_ = least_;
  relax_between(layer, all ? joints_of(layer) : reached_, some_, nullptr, changed_from_, least_);
  for (std::size_t k = 0; k < least_.size(); ++k)
    if (least_[k] < raised_[k]) stale.push_back(static_cast<int>(slot(k)));
}

Config ExplicitCostToGo::config(int layer, int slot) {
  const Joints& joints = joints_of(layer);
  Config q;
  for (std::size_t k = 0; k < kDof; ++k)
    q[static_cast<Eigen::Index>(k)] = joints[k][static_cast<std::size_t>(slot)];
  return q;
}

void ExplicitCostToGo::steps(int layer, int slot, double bound, std::vector<Step>& out) {
  const Config q = config(layer, slot);
  const double own = verdicts_.cost(layer, slot);
  const Joints& next = joints_of(layer + 1);
  const Config& most = lattice_->step_bound(layer);
  // most nodes are too far off in one joint
  const auto too_far = [&](std::size_t b) {
    for (std::size_t k = 0; k < kDof; ++k) {
      const auto joint = static_cast<Eigen::Index>(k);
      if (!lattice_->continuous()[k] && !(std::abs(next[k][b] - q[joint]) <= most[joint]))
        return true;
    }
    return false;
  };
  out.clear();
  for (int b = 0; b < lattice_->slots(layer + 1); ++b) {
    const double rest = at(layer + 1, b);
    if (rest == kUnreachable || rest > bound || too_far(static_cast<std::size_t>(b))) continue;
    const Config delta = lattice_->delta(q, config(layer + 1, b));
    if (!lattice_->step_allowed(layer, delta)) continue;
    const double cost = lattice_->edge_cost(delta);
    if (own + (cost + rest) <= bound && verdicts_.edge(layer, slot, b) != Verdict::kRemoved)
      out.push_back({b, own + cost});
  }
}

}  // namespace swivel
