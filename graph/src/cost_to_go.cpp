// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/graph/cost_to_go.hpp"

#include <algorithm>

#include "kernels/relax.hpp"
#include "swivel/graph/validity.hpp"

namespace swivel {

CostToGo::Range CostToGo::range(const double* q, int begin, int end) {
  Range result{kUnreachable, -kUnreachable};
  for (int k = begin; k < end; ++k) {
    result.low = q[k] < result.low ? q[k] : result.low;
    result.high = q[k] > result.high ? q[k] : result.high;
  }
  return result;
}

CostToGo::CostToGo(const Lattice& lattice)
    : lattice_(&lattice),
      g_(static_cast<std::size_t>(lattice.nodes()), kUnreachable),
      verdict_(static_cast<std::size_t>(lattice.nodes()), Verdict::kUnknown) {
  constexpr std::int64_t kMostKept = 1'000'000;  // nodes; about 25 bytes each
  if (!lattice.arm().exact || lattice.nodes() <= kMostKept) cache_.resize(static_cast<std::size_t>(lattice.layers()));
  // A branch flips only through the zero of a middle angle, so those three joints tell branches apart; joints with several images
  // tell windings apart. Continuous joints have no plain interval.
  const auto& limit = lattice.chain().limit;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& l = limit[static_cast<std::size_t>(j)];
    if (!l.continuous && (j == 1 || j == 3 || j == 5 || l.upper - l.lower > kTwoPi)) separating_.push_back(j);
  }
}

CostToGo::~CostToGo() = default;

CostToGo::Nodes CostToGo::nodes(int layer, int first, int count, LayerNodes& scratch) {
  if (cache_.empty()) {
    ik_nodes_ += static_cast<std::int64_t>(count) * lattice_->labels();
    lattice_->solve(layer, first, count, scratch);
    return {&scratch, 0};
  }
  return {&kept(layer).nodes, (first + lattice_->window()) % lattice_->angles()};
}

const CostToGo::Joints& CostToGo::kept(int layer) {
  auto& joints = cache_[static_cast<std::size_t>(layer)];
  if (!joints) {
    joints = std::make_unique<Joints>();
    solve(layer, *joints);
  }
  return *joints;
}

void CostToGo::solve(int layer, Joints& joints) {
  const int n = lattice_->angles(), window = lattice_->window(), length = n + 2 * window, labels = lattice_->labels();
  joints.layer = layer;
  ik_nodes_ += static_cast<std::int64_t>(length) * labels;
  lattice_->solve(layer, (n - window % n) % n, length, joints.nodes);
  joints.ranges.resize(range_row(labels, 0));
  joints.alive.resize(static_cast<std::size_t>(labels));
  for (int label = 0; label < labels; ++label) {
    const std::uint8_t* valid = joints.nodes.valid(label);
    const bool alive = std::find(valid, valid + length, 1) != valid + length;
    joints.alive[static_cast<std::size_t>(label)] = alive;
    for (std::size_t s = 0; alive && s < separating_.size(); ++s) {
      const double* q = joints.nodes.q(label, separating_[s]);
      ChunkRange* ranges = &joints.ranges[range_row(label, s)];
      int twin = label - 1;  // branches share what they have in common
      while (twin >= 0 && !(joints.alive[static_cast<std::size_t>(twin)] && joints.nodes.q(twin, separating_[s]) == q)) --twin;
      if (twin >= 0) {
        std::copy_n(&joints.ranges[range_row(twin, s)], chunks(), ranges);
        continue;
      }
      for (int chunk = 0; chunk < chunks(); ++chunk) {
        const int first = chunk * kChunk, last = std::min(n, first + kChunk);
        ranges[chunk] = {range(q, window + first, window + last), range(q, first, last + 2 * window)};
      }
    }
  }
}

void CostToGo::load(int layer, Block& block) {
  block.layer = layer;
  if (cache_.empty()) {
    if (block.own.layer != layer) solve(layer, block.own);
    block.joints = &block.own;
  } else {
    block.joints = &kept(layer);
  }
  load_values(&g_[index(layer, 0)], block);
}

void CostToGo::load_values(const double* row, Block& block) const {
  const int n = lattice_->angles(), window = lattice_->window(), length = n + 2 * window, labels = lattice_->labels();
  block.value.resize(static_cast<std::size_t>(labels * length));
  for (int label = 0; label < labels; ++label) {
    const double* from = row + static_cast<std::ptrdiff_t>(label) * n;
    double* to = block.value.data() + static_cast<std::ptrdiff_t>(label) * length;
    std::copy(from + n - window, from + n, to);
    std::copy(from, from + n, to + window);
    std::copy(from, from + window, to + window + n);
  }
}

bool CostToGo::may_connect(int layer, const Block& from, int label, int chunk, const Block& to, int other) const {
  if (!from.joints->alive[static_cast<std::size_t>(label)] || !to.joints->alive[static_cast<std::size_t>(other)]) return false;
  const Config& bound = lattice_->step_bound(layer);
  for (std::size_t s = 0; s < separating_.size(); ++s) {
    const Range& own = from.joints->ranges[range_row(label, s) + static_cast<std::size_t>(chunk)].own;
    const Range& near = to.joints->ranges[range_row(other, s) + static_cast<std::size_t>(chunk)].near;
    if (own.gap(near) > bound[separating_[s]]) return false;
  }
  // Few pairs come this far: near a singular pose the outer joints of the triple must meet as well, which a look at them tells.
  const int window = lattice_->window(), first = chunk * kChunk, last = std::min(lattice_->angles(), first + kChunk);
  for (const int joint : {0, 2, 4, 6}) {
    if (lattice_->continuous()[static_cast<std::size_t>(joint)]) continue;
    const Range own = range(from.nodes().q(label, joint), window + first, window + last);
    if (own.gap(range(to.nodes().q(other, joint), first, last + 2 * window)) > bound[joint]) return false;
  }
  return true;
}

void CostToGo::relax_run(int step_layer, const Block& from, int label, int first, int count, const Block& to, int other,
                         double* best) {
  const int window = lattice_->window(), length = lattice_->angles() + 2 * window;
  RelaxTask task;
  task.n = count;
  task.metric = lattice_->cost().metric == CostMetric::kL2 ? RelaxMetric::kL2 : RelaxMetric::kMax;
  task.wraps = false;
  const Config& bound = lattice_->step_bound(step_layer);
  const double* to_q[kDof];
  for (int j = 0; j < kDof; ++j) {
    const bool turns = lattice_->continuous()[static_cast<std::size_t>(j)];
    task.wraps |= turns;
    task.turn[j] = turns ? kTwoPi : 0;
    task.scale[j] = lattice_->cost_scale()[static_cast<std::size_t>(j)];
    task.bound[j] = bound[j];
    task.from[j] = from.nodes().q(label, j) + window + first;
    to_q[j] = to.nodes().q(other, j) + first;
  }
  task.best = best;
  const double* value = to.value.data() + static_cast<std::ptrdiff_t>(other) * length + first;
  edges_ += static_cast<std::int64_t>(count) * (2 * window + 1);
  for (int offset = 0; offset <= 2 * window; ++offset) {
    for (int j = 0; j < kDof; ++j) task.to[j] = to_q[j] + offset;
    task.value = value + offset;
    relax_kernels().relax(task);
  }
}

void CostToGo::relax_chunk(int step_layer, const Block& from, int label, int chunk, const Block& to, double* row) {
  const int n = lattice_->angles(), first = chunk * kChunk, count = std::min(kChunk, n - first);
  double* best = row + static_cast<std::ptrdiff_t>(label) * n + first;
  std::fill(best, best + count, kUnreachable);
  if (!from.joints->alive[static_cast<std::size_t>(label)]) return;
  if (to.joints->alive[static_cast<std::size_t>(label)]) relax_run(step_layer, from, label, first, count, to, label, best);
  for (int other = 0; other < lattice_->labels(); ++other)
    if (other != label && may_connect(step_layer, from, label, chunk, to, other))
      relax_run(step_layer, from, label, first, count, to, other, best);
}

void CostToGo::relax_layer(int step_layer, const Block& from, const Block& to, double* row) {
  const int n = lattice_->angles(), labels = lattice_->labels();
  std::fill(row, row + lattice_->width(), kUnreachable);
  for (int label = 0; label < labels; ++label) {
    if (!from.joints->alive[static_cast<std::size_t>(label)]) continue;
    if (to.joints->alive[static_cast<std::size_t>(label)])
      relax_run(step_layer, from, label, 0, n, to, label, row + static_cast<std::ptrdiff_t>(label) * n);
    for (int other = 0; other < labels; ++other)
      for (int chunk = 0; other != label && to.joints->alive[static_cast<std::size_t>(other)] && chunk < chunks(); ++chunk)
        if (may_connect(step_layer, from, label, chunk, to, other))
          relax_run(step_layer, from, label, chunk * kChunk, std::min(kChunk, n - chunk * kChunk), to, other,
                    row + static_cast<std::ptrdiff_t>(label) * n + chunk * kChunk);
  }
  drop_invalid(from, row);
}

void CostToGo::drop_invalid(const Block& block, double* row) const {
  const int n = lattice_->angles(), window = lattice_->window();
  const Verdict* verdict = &verdict_[index(block.layer, 0)];
  for (int label = 0; label < lattice_->labels(); ++label) {
    const std::uint8_t* valid = block.nodes().valid(label) + window;
    for (int j = 0; j < n; ++j) {
      const int slot = label * n + j;
      if (!valid[j] || verdict[slot] == Verdict::kRemoved) row[slot] = kUnreachable;
    }
  }
}

double CostToGo::relax_one(int layer, int slot) {
  LayerNodes here_nodes, next_nodes;
  const int n = lattice_->angles();
  const Nodes here = nodes(layer, lattice_->angle_of(slot), 1, here_nodes);
  const int label = lattice_->label_of(slot);
  if (!here.nodes->valid(label)[here.shift] || node_verdict(layer, slot) == Verdict::kRemoved) return kUnreachable;
  const Config q = here.nodes->config(label, here.shift);
  const Lattice::Run run = lattice_->successors(layer, slot);
  const Nodes next = nodes(layer + 1, run.first, run.count, next_nodes);
  double best = kUnreachable;
  for (int k = 0; k < run.count; ++k)
    for (int other = 0; other < lattice_->labels(); ++other) {
      const int b = other * n + (run.first + k) % n;
      const double rest = at(layer + 1, b);
      if (rest == kUnreachable || edge_verdict(layer, slot, b) == Verdict::kRemoved) continue;
      const Config delta = lattice_->delta(q, next.nodes->config(other, next.shift + k));
      ++edges_;
      if (lattice_->step_allowed(layer, delta)) best = std::min(best, lattice_->edge_cost(delta) + rest);
    }
  return best;
}

bool CostToGo::sweep(int goal_layer, const std::function<bool()>& stop) {
  goal_ = goal_layer;
  pending_.clear();
  const bool start = lattice_->has_start();
  const auto row = [&](int layer) { return &g_[index(layer, 0)]; };
  Block* next = &block_[0];
  Block* here = &block_[1];
  std::fill(row(goal_layer), row(goal_layer) + lattice_->width(), 0.0);
  load(goal_layer, *next);
  drop_invalid(*next, row(goal_layer));
  load_values(row(goal_layer), *next);
  for (int layer = goal_layer - 1; layer >= 0; --layer) {
    if (stop && stop()) return false;
    if (layer == 0 && start) {
      std::fill(row(0), row(0) + lattice_->width(), kUnreachable);
      g_[index(0, lattice_->start_slot())] = relax_one(0, lattice_->start_slot());
      break;
    }
    load(layer, *here);
    relax_layer(layer, *here, *next, row(layer));
    const auto removed = removed_edges_.find(layer);
    if (removed != removed_edges_.end())
      for (const auto& [a, b] : removed->second) g_[index(layer, a)] = relax_one(layer, a);
    load_values(row(layer), *here);
    std::swap(here, next);
  }
  return true;
}

double CostToGo::best() const {
  return *std::min_element(g_.begin(), g_.begin() + lattice_->width());
}

void CostToGo::remove_node(int layer, int slot) {
  verdict_[index(layer, slot)] = Verdict::kRemoved;
  pending_[layer].nodes.push_back(slot);
}

void CostToGo::remove_alike(int layer, int slot, std::uint8_t depends) {
  if (depends == kOnNodeAlone) return remove_node(layer, slot);
  const int n = lattice_->angles(), branch = lattice_->branch_of(slot), angle = lattice_->angle_of(slot);
  for (int label = 0; label < lattice_->labels(); ++label) {
    const int other = label / lattice_->windings();
    if ((other ^ branch) & depends & (kShoulderBit | kWristBit | kElbowBit)) continue;
    const int first = depends & kOnArmAngle ? angle : 0, last = depends & kOnArmAngle ? angle : n - 1;
    for (int j = first; j <= last; ++j)
      if (node_verdict(layer, label * n + j) != Verdict::kRemoved) remove_node(layer, label * n + j);
  }
}

Verdict CostToGo::edge_verdict(int layer, int a, int b) const {
  const auto found = edge_verdict_.find({static_cast<std::int64_t>(index(layer, a)), b});
  return found == edge_verdict_.end() ? Verdict::kUnknown : found->second;
}

void CostToGo::keep_edge(int layer, int a, int b) {
  edge_verdict_[{static_cast<std::int64_t>(index(layer, a)), b}] = Verdict::kValid;
}

void CostToGo::remove_edge(int layer, int a, int b) {
  edge_verdict_[{static_cast<std::int64_t>(index(layer, a)), b}] = Verdict::kRemoved;
  removed_edges_[layer].emplace_back(a, b);
  pending_[layer].tails.push_back(a);
}

CostToGo::Marks CostToGo::reached_by(const Marks& changed, int layer, const Block& from, const Block& to) const {
  const int n = lattice_->angles(), window = lattice_->window(), labels = lattice_->labels(), count = chunks();
  Marks widened(changed.size(), 0);  // chunks whose window overlaps a changed chunk
  for (int label = 0; label < labels; ++label)
    for (int c = 0; c < count; ++c) {
      if (!changed[static_cast<std::size_t>(label * count + c)]) continue;
      const int first = c * kChunk - window, last = std::min(n, (c + 1) * kChunk) - 1 + window;
      if (last - first + 1 >= n) {
        std::fill_n(widened.begin() + label * count, count, std::uint8_t{1});
        continue;
      }
      for (int j = first; j <= last; ++j) widened[static_cast<std::size_t>(label * count + ((j + n) % n) / kChunk)] = 1;
    }
  Marks result = widened;
  for (int label = 0; label < labels; ++label)
    for (int c = 0; c < count; ++c)
      for (int other = 0; other < labels && !result[static_cast<std::size_t>(label * count + c)]; ++other)
        if (other != label && widened[static_cast<std::size_t>(other * count + c)] && may_connect(layer, from, label, c, to, other))
          result[static_cast<std::size_t>(label * count + c)] = 1;
  return result;
}

void CostToGo::repair() {
  const int labels = lattice_->labels(), count = chunks();
  Marks changed(static_cast<std::size_t>(labels * count), 0);
  std::vector<double> fresh(static_cast<std::size_t>(lattice_->width()));
  bool any = false;
  Block* next = &block_[0];
  Block* here = &block_[1];
  while (!pending_.empty() && pending_.rbegin()->first > goal_) pending_.erase(std::prev(pending_.end()));
  for (int layer = pending_.empty() ? -1 : pending_.rbegin()->first; layer >= 0; --layer) {
    Marks here_changed(changed.size(), 0);
    bool here_any = false;
    double* row = &g_[index(layer, 0)];
    const auto mark = [&](int slot) {
      here_changed[static_cast<std::size_t>(lattice_->label_of(slot) * count + lattice_->angle_of(slot) / kChunk)] = 1;
      here_any = true;
    };
    if (any) {
      if (layer == 0 && lattice_->has_start()) {
        row[lattice_->start_slot()] = relax_one(0, lattice_->start_slot());
      } else {
        if (next->layer != layer + 1) load(layer + 1, *next);
        load_values(&g_[index(layer + 1, 0)], *next);
        load(layer, *here);
        const Marks todo = reached_by(changed, layer, *here, *next);
        std::copy(row, row + lattice_->width(), fresh.begin());
        for (int label = 0; label < labels; ++label)
          for (int c = 0; c < count; ++c)
            if (todo[static_cast<std::size_t>(label * count + c)]) relax_chunk(layer, *here, label, c, *next, fresh.data());
        drop_invalid(*here, fresh.data());
        const auto removed = removed_edges_.find(layer);
        if (removed != removed_edges_.end())
          for (const auto& [a, b] : removed->second)
            if (todo[static_cast<std::size_t>(lattice_->label_of(a) * count + lattice_->angle_of(a) / kChunk)])
              fresh[static_cast<std::size_t>(a)] = relax_one(layer, a);
        for (int slot = 0; slot < lattice_->width(); ++slot)
          if (fresh[static_cast<std::size_t>(slot)] != row[slot]) {
            row[slot] = fresh[static_cast<std::size_t>(slot)];
            mark(slot);
          }
        std::swap(here, next);
      }
    }
    const auto pending = pending_.find(layer);
    if (pending != pending_.end()) {
      for (const int slot : pending->second.nodes)
        if (row[slot] != kUnreachable) {
          row[slot] = kUnreachable;
          mark(slot);
        }
      for (const int slot : pending->second.tails) {
        const double value = layer < goal_ ? relax_one(layer, slot) : row[slot];
        if (value != row[slot]) {
          row[slot] = value;
          mark(slot);
        }
      }
      pending_.erase(pending);
    }
    changed.swap(here_changed);
    any = here_any;
    if (!any) {
      if (pending_.empty()) break;
      layer = pending_.rbegin()->first + 1;  // nothing to do until there
    }
  }
}

double CostToGo::relax_one_forward(int layer, int slot, const std::vector<double>& value) {
  LayerNodes here_nodes, before_nodes;
  const int n = lattice_->angles(), label = lattice_->label_of(slot);
  const Nodes here = nodes(layer, lattice_->angle_of(slot), 1, here_nodes);
  if (!here.nodes->valid(label)[here.shift] || node_verdict(layer, slot) == Verdict::kRemoved) return kUnreachable;
  const Config q = here.nodes->config(label, here.shift);
  const Lattice::Run run = lattice_->predecessors(layer - 1, slot);
  if (run.count == 0) return kUnreachable;
  const Nodes before = nodes(layer - 1, run.first, run.count, before_nodes);
  double best = kUnreachable;
  for (int k = 0; k < run.count; ++k)
    for (int other = 0; other < lattice_->labels(); ++other) {
      const int a = other * n + (run.first + k) % n;
      const double done = value[static_cast<std::size_t>(a)];
      if (done == kUnreachable || edge_verdict(layer - 1, a, slot) == Verdict::kRemoved) continue;
      const Config delta = lattice_->delta(before.nodes->config(other, before.shift + k), q);
      if (lattice_->step_allowed(layer - 1, delta)) best = std::min(best, lattice_->edge_cost(delta) + done);
    }
  return best;
}

int CostToGo::deepest_reachable() {
  const auto width = static_cast<std::size_t>(lattice_->width());
  std::vector<double> value(width, 0.0), ahead(width);
  Block* before = &block_[0];
  Block* here = &block_[1];
  load(0, *before);
  drop_invalid(*before, value.data());
  const auto any = [](const std::vector<double>& v) {
    return std::any_of(v.begin(), v.end(), [](double x) { return x != kUnreachable; });
  };
  if (!any(value)) return -1;
  load_values(value.data(), *before);
  int layer = 1;
  for (; layer < lattice_->layers(); ++layer) {
    load(layer, *here);
    if (layer == 1 && lattice_->has_start()) {
      for (std::size_t slot = 0; slot < width; ++slot) ahead[slot] = relax_one_forward(1, static_cast<int>(slot), value);
    } else {
      relax_layer(layer - 1, *here, *before, ahead.data());
      const auto removed = removed_edges_.find(layer - 1);
      if (removed != removed_edges_.end())
        for (const auto& [a, b] : removed->second) ahead[static_cast<std::size_t>(b)] = relax_one_forward(layer, b, value);
    }
    if (!any(ahead)) break;
    value.swap(ahead);
    load_values(value.data(), *here);
    std::swap(before, here);
  }
  block_[0].layer = block_[1].layer = -1;  // their values are not cost-to-go
  return layer - 1;
}

}  // namespace swivel
