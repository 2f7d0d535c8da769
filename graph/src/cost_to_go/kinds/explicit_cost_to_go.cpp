// SPDX-License-Identifier: BSD-3-Clause
#include "cost_to_go/kinds/explicit_cost_to_go.hpp"

#include <algorithm>

#include "cost_to_go/kernels/relax_task.hpp"
#include "swivel/core/base/timeline.hpp"

namespace swivel {

ExplicitCostToGo::ExplicitCostToGo(const Lattice& lattice, const Budget& budget)
    : LayerValues(lattice, budget), lattice_(&lattice) {
  const auto layers = static_cast<std::size_t>(lattice.layers());
  joints_.resize(layers);
  std::vector<Lattice::Node> nodes;
  for (int layer = 0; layer < lattice.layers(); ++layer) {
    budget_.poll();
    lattice.layer_nodes(layer, nodes);
    const auto count = static_cast<std::size_t>(lattice.slots(layer));
    for (std::size_t k = 0; k < kDof; ++k) {
      Values& joint = joints_[static_cast<std::size_t>(layer)][k];
      joint.resize(count);
      for (const Lattice::Node& node : nodes)
        joint[static_cast<std::size_t>(node.slot)] = node.q[static_cast<Eigen::Index>(k)];
    }
    ik_nodes_ += static_cast<std::int64_t>(count);
  }
}

void ExplicitCostToGo::relax(int step, int layer, int other_layer, const Values& others,
                             Values& out) {
  const auto& from = joints_[static_cast<std::size_t>(layer)];
  const auto& to = joints_[static_cast<std::size_t>(other_layer)];
  const std::size_t count = from[0].size(), partners = others.size();
  out.assign(count, kUnreachable);
  if (partners == 0 || count == 0) return;
  RelaxTask<double> task = relax_task(*lattice_, step);
  task.n = static_cast<int>(count);
  task.offsets = static_cast<int>(partners);
  for (std::size_t k = 0; k < kDof; ++k) {
    task.from[k] = from[k].data();
    task.to[k] = to[k].data();
  }
  task.value = others.data();
  task.best = out.data();
  edges_ += static_cast<std::int64_t>(count * partners);
  relax_kernels().relax_all(task);
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

void ExplicitCostToGo::compute_removals() {
  const TraceSpan span("repair");
  bool changed = false;  // in the layer after
  Values settled;
  for (int layer = goal_; layer >= 0 && (changed || !verdicts_.pending.empty()); --layer) {
    budget_.poll();
    if (!changed && verdicts_.pending.rbegin()->first < layer) continue;
    if (!verdicts_.pending.empty() && verdicts_.pending.rbegin()->first >= layer)
      verdicts_.pending.erase(verdicts_.pending.lower_bound(layer), verdicts_.pending.end());
    solve_layer(layer, settled);
    Values& values = value_[static_cast<std::size_t>(layer)];
    changed = settled != values;
    values.swap(settled);
  }
}

Config ExplicitCostToGo::config(int layer, int slot) {
  Config q;
  for (std::size_t k = 0; k < kDof; ++k)
    q[static_cast<Eigen::Index>(k)] =
        joints_[static_cast<std::size_t>(layer)][k][static_cast<std::size_t>(slot)];
  return q;
}

void ExplicitCostToGo::steps(int layer, int slot, double bound, std::vector<Step>& out) {
  const Config q = config(layer, slot);
  const double own = verdicts_.cost(layer, slot);
  out.clear();
  for (int b = 0; b < lattice_->slots(layer + 1); ++b) {
    const double rest = at(layer + 1, b);
    if (rest == kUnreachable || rest > bound) continue;
    const Config delta = lattice_->delta(q, config(layer + 1, b));
    if (!lattice_->step_allowed(layer, delta)) continue;
    const double cost = lattice_->edge_cost(delta);
    if (own + (cost + rest) <= bound && verdicts_.edge(layer, slot, b) != Verdict::kRemoved)
      out.push_back({b, own + cost});
  }
}

}  // namespace swivel
