// SPDX-License-Identifier: BSD-3-Clause
#include "job/order/order_bounds.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "job/transitions/job_transitions.hpp"
#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

/// Divisions of the nodes at either end of a run before the first bounds: into eight groups.
constexpr int kFirstDivisions = 3;
/// Most sums of two costs that the program over all orders takes: a quarter of 2^strokes for each
/// group of ends and group of begins.
constexpr std::size_t kMostSums = 400'000'000;

}  // namespace

OrderBounds::OrderBounds(const std::vector<CostToGo*>& runs, const std::optional<Config>& home,
                         const Lattice& metric, ParallelFor work, const Budget& budget)
    : metric_(&metric), work_(std::move(work)), budget_(budget) {
  const TraceSpan span("bounds of orders");
  if (home) home_ = group_of({{0, *home}});
  for (CostToGo* const values : runs) runs_.emplace_back().values = values;
  graph_.strokes = runs.size() / 2;
  graph_.runs.resize(runs.size());
  graph_.follow.assign(runs.size(), std::vector<std::vector<double>>(runs.size()));
  for (Run& run : runs_) {
    if (run.values == nullptr) continue;
    run.begins = {nodes_of(*run.values, 0)};
    run.ends = {nodes_of(*run.values, run.values->lattice().layers() - 1)};
    for (int k = 0; k < kFirstDivisions; ++k) {
      run.begins = divided(run.begins);
      run.ends = divided(run.ends);
    }
    run.costs.resize(run.ends.size());
  }
  sweep_all();
  compute_distances();
}

OrderBounds::Group OrderBounds::group_of(std::vector<Node> nodes) {
  Group group;
  if (!nodes.empty()) group.lower = group.upper = nodes.front().q;
  for (const Node& node : nodes) {
    group.lower = group.lower.cwiseMin(node.q);
    group.upper = group.upper.cwiseMax(node.q);
  }
  group.nodes = std::move(nodes);
  return group;
}

OrderBounds::Group OrderBounds::nodes_of(CostToGo& values, int layer) {
  const Lattice& lattice = values.lattice();
  std::vector<Node> nodes;
  for (int slot = 0; slot < lattice.slots(layer); ++slot) {
    if (values.verdicts().node(layer, slot) == Verdict::kRemoved) continue;
    const auto q = values.node(layer, slot);
    if (const auto row = q ? lattice.exact_config(layer, slot, *q) : std::nullopt)
      nodes.push_back({slot, *row});
  }
  return group_of(std::move(nodes));
}

/// Returns two parts of a group, the nodes nearer to the one and to the other of two nodes that lie
/// far apart; the group itself where all its nodes are at one place.
std::vector<OrderBounds::Group> OrderBounds::divided(const Group& group) const {
  const auto apart = [&](const Node& a, const Node& b) {
    return transition_distance(*metric_, a.q, b.q);
  };
  const auto farthest = [&](const Node& from) {
    return *std::max_element(
        group.nodes.begin(), group.nodes.end(),
        [&](const Node& a, const Node& b) { return apart(from, a) < apart(from, b); });
  };
  if (group.nodes.size() < 2) return {group};
  const Node a = farthest(group.nodes.front()), b = farthest(a);
  std::vector<Node> near_a, near_b;
  for (const Node& node : group.nodes)
    (apart(node, b) < apart(node, a) ? near_b : near_a).push_back(node);
  if (near_b.empty()) return {group};
  return {group_of(std::move(near_a)), group_of(std::move(near_b))};
}

std::vector<OrderBounds::Group> OrderBounds::divided(const std::vector<Group>& groups) const {
  std::vector<Group> parts;
  for (const Group& group : groups)
    for (Group& part : divided(group)) parts.push_back(std::move(part));
  return parts;
}

/// Returns the least cost of a straight move from a node of one group to a node of another.
double OrderBounds::distance(const Group& from, const Group& to) const {
  double least = kUnreachable;
  for (const Node& a : from.nodes) {
    if (least_transition_distance(*metric_, a.q, to.lower, to.upper) >= least) continue;
    for (const Node& b : to.nodes) least = std::min(least, transition_distance(*metric_, a.q, b.q));
  }
  return least;
}

/// Finds what a run costs from its begins to its groups of ends, where that is not known or
/// something was removed since.
void OrderBounds::sweep(Run& run) const {
  const Lattice& lattice = run.values->lattice();
  Verdicts& verdicts = run.values->verdicts();
  if (std::exchange(run.removed, verdicts.removed()) != verdicts.removed())
    run.costs.assign(run.ends.size(), {});
  const int last = lattice.layers() - 1;
  std::vector<double> exits;
  for (std::size_t end = 0; end < run.ends.size(); ++end) {
    if (!run.costs[end].empty()) continue;
    budget_.poll();
    exits.assign(static_cast<std::size_t>(lattice.slots(last)), kUnreachable);
    for (const Node& node : run.ends[end].nodes) exits[static_cast<std::size_t>(node.slot)] = 0;
    verdicts.forget_exit_costs();
    verdicts.raise_exit_costs(exits);
    run.values->sweep(last);
    for (int slot = 0; slot < lattice.slots(0); ++slot)
      run.costs[end].push_back(run.values->at(0, slot));
  }
}

void OrderBounds::sweep_all() {
  work_.for_each(static_cast<int>(runs_.size()), [&](int k, int) {
    Run& run = runs_[static_cast<std::size_t>(k)];
    if (run.values == nullptr) return;
    sweep(run);
    OrderGraph::Run& bounds = graph_.runs[static_cast<std::size_t>(k)];
    bounds.begins = run.begins.size();
    bounds.ends = run.ends.size();
    bounds.through.clear();
    for (const Group& begins : run.begins)
      for (std::size_t end = 0; end < run.ends.size(); ++end) {
        double least = kUnreachable;
        // A closed run ends in the node in which it begins, so in the group of that node.
        const auto is_end = [&](const Node& node) {
          return std::any_of(run.ends[end].nodes.begin(), run.ends[end].nodes.end(),
                             [&](const Node& other) { return other.slot == node.slot; });
        };
        for (const Node& node : begins.nodes) {
          const double cost = run.costs[end][static_cast<std::size_t>(node.slot)];
          if (cost < least && (!run.is_closed() || is_end(node))) least = cost;
        }
        bounds.through.push_back(least);
      }
  });
}

void OrderBounds::compute_distances() {
  work_.for_each(static_cast<int>(runs_.size()),
                 [&](int k, int) { compute_distances(static_cast<std::size_t>(k)); });
}

/// Finds what it costs to begin and to end a job with a run, and to go on from it.
void OrderBounds::compute_distances(std::size_t run) {
  const Run& from = runs_[run];
  if (from.values == nullptr) return;
  OrderGraph::Run& bounds = graph_.runs[run];
  bounds.first.clear();
  bounds.last.clear();
  for (const Group& begins : from.begins)
    bounds.first.push_back(home_ ? distance(*home_, begins) : 0);
  for (const Group& ends : from.ends) bounds.last.push_back(home_ ? distance(ends, *home_) : 0);
  for (std::size_t next = 0; next < runs_.size(); ++next) {
    if (next / 2 == run / 2 || runs_[next].values == nullptr) continue;
    std::vector<double>& follow = graph_.follow[run][next];
    follow.clear();
    for (const Group& ends : from.ends) {
      budget_.poll();
      for (const Group& begins : runs_[next].begins) follow.push_back(distance(ends, begins));
    }
  }
}

void OrderBounds::take_removals() {
  sweep_all();
}

bool OrderBounds::divide(const OrderProgram::Uses& uses, double most) {
  const TraceSpan span("bounds of orders");
  std::vector<Run> parts(runs_.size());
  bool any = false;
  for (std::size_t k = 0; k < runs_.size(); ++k) {
    const Run& run = runs_[k];
    parts[k].values = run.values;
    parts[k].removed = run.removed;
    for (std::size_t g = 0; g < run.begins.size(); ++g) {
      if (!(uses.begins[k][g] < most)) continue;
      std::vector<Group> of_group = divided(run.begins[g]);
      any = any || of_group.size() > 1;
      std::move(of_group.begin(), of_group.end(), std::back_inserter(parts[k].begins));
    }
    for (std::size_t g = 0; g < run.ends.size(); ++g) {
      if (!(uses.ends[k][g] < most)) continue;
      std::vector<Group> of_group = divided(run.ends[g]);
      any = any || of_group.size() > 1;
      for (Group& part : of_group) {
        parts[k].ends.push_back(std::move(part));
        parts[k].costs.push_back(of_group.size() == 1 ? run.costs[g] : std::vector<double>());
      }
    }
  }
  std::size_t sums = 0;
  for (std::size_t run = 0; run < parts.size(); ++run)
    for (std::size_t next = 0; next < parts.size(); ++next)
      if (run / 2 != next / 2) sums += parts[run].ends.size() * parts[next].begins.size();
  if (!any || sums > kMostSums >> graph_.strokes) return false;
  runs_ = std::move(parts);
  sweep_all();
  compute_distances();
  return true;
}

}  // namespace swivel
