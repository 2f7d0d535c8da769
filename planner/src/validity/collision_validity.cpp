// SPDX-License-Identifier: BSD-3-Clause
#include "validity/collision_validity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "swivel/core/base/timeline.hpp"

namespace swivel {

namespace {

constexpr std::size_t kMostRows = 8192, kRowsOfLayer = 8, kSlotsApart = 67;

/// The failure of nodes below the least manipulability; failures that are pairs of bodies are not
/// negative.
constexpr FailureId kManipulability = -2;

}  // namespace

CollisionValidity::CollisionValidity(const Lattice& lattice, const World& world,
                                     const EdgeRule& rule, EdgeMode edge_mode,
                                     DistanceProofs distance_proofs, Executor& executor, int chunks,
                                     const Budget& budget, ClearanceMemory* memory,
                                     const World* changed)
    : lattice_(&lattice),
      world_(&world),
      clearance_error_(lattice, world),
      rule_(rule),
      changed_rule_(changed ? changed->edge_rule(rule.radii) : EdgeRule{rule.radii, rule.h, {}}),
      edge_mode_(edge_mode),
      distance_proofs_(distance_proofs),
      executor_(&executor),
      budget_(budget),
      memory_(memory),
      changed_(changed) {
  chunks_.reserve(static_cast<std::size_t>(chunks));
  for (int chunk = 0; chunk < chunks; ++chunk) chunks_.push_back(make_queries());
  workers_.reserve(static_cast<std::size_t>(executor.threads()));
  for (int worker = 0; worker < executor.threads(); ++worker) workers_.push_back(make_queries());
  if (lattice.is_approximate())
    rows_.assign(static_cast<std::size_t>(executor.threads()),
                 std::vector<Row>(std::min(
                     kMostRows, kRowsOfLayer * static_cast<std::size_t>(lattice.layers()))));
}

std::optional<Config> CollisionValidity::exact_config(int layer, int slot, const Config& q,
                                                      int worker) {
  if (!lattice_->is_approximate()) return q;
  auto& rows = rows_[static_cast<std::size_t>(worker)];
  // Neighbours along the path and along the coordinate must not share a place in the cache.
  const auto place =
      (static_cast<std::size_t>(layer) * kSlotsApart + static_cast<std::size_t>(slot)) %
      rows.size();
  Row& row = rows[place];
  if (row.layer != layer || row.slot != slot)
    row = {layer, slot, lattice_->exact_config(layer, slot, q)};
  return row.q;
}

CollisionValidity::Queries CollisionValidity::make_queries() const {
  Queries queries{World::Query(*world_, distance_proofs_), std::nullopt};
  if (changed_) queries.changed.emplace(*changed_, distance_proofs_);
  return queries;
}

template <class Ask>
void CollisionValidity::ask_open(const Ask& ask, const std::function<void()>* work) {
  const int count = static_cast<int>(open_.size()),
            runs = std::min(count, static_cast<int>(chunks_.size()));
  const auto at = [&](int index, int worker, Queries& queries) {
    ask(open_[static_cast<std::size_t>(index)], worker, queries);
  };
  if (chunks_.empty()) {
    if (work) (*work)();
    return executor_->for_each(count, [&](int index, int worker) {
      at(index, worker, workers_[static_cast<std::size_t>(worker)]);
    });
  }
  const auto ask_run = [&](int chunk, int worker) {
    for (int index = count * chunk / runs; index < count * (chunk + 1) / runs; ++index)
      at(index, worker, chunks_[static_cast<std::size_t>(chunk)]);
  };
  if (work)
    executor_->for_each_overlapped(runs, ask_run, *work);
  else
    executor_->for_each_short(runs, ask_run);
}

void CollisionValidity::nodes(std::span<const NodeQuestion> questions,
                              std::span<NodeAnswer> answers) {
  ask_nodes(questions, answers, nullptr);
}

void CollisionValidity::nodes_overlapped(std::span<const NodeQuestion> questions,
                                         std::span<NodeAnswer> answers,
                                         const std::function<void()>& work) {
  ask_nodes(questions, answers, &work);
}

void CollisionValidity::ask_nodes(std::span<const NodeQuestion> questions,
                                  std::span<NodeAnswer> answers,
                                  const std::function<void()>* work) {
  TraceSpan batch("nodes asked");
  open_.clear();
  for (std::size_t k = 0; k < questions.size(); ++k) {
    const NodeQuestion& x = questions[k];
    Open open{k};
    if (x.suspected >= 0) open.pair = pair_of(x.suspected);
    if (const auto* known = memory_ ? memory_->node(x.layer, x.slot) : nullptr) {
      const auto holds = memory_->holds(*known);
      if (holds == ClearanceMemory::Holds::kAll) {
        answers[k] = known->answer;
        continue;
      }
      open.only_changed = holds == ClearanceMemory::Holds::kUnlessChanged && !x.only_scene;
      if (!known->valid && !x.only_scene) open.pair = known->pair;
    }
    open_.push_back(open);
  }
  batch.count("nodes", static_cast<std::int64_t>(open_.size()));
  nodes_checked_ += static_cast<std::int64_t>(open_.size());
  ask_open(
      [&](Open& open, int worker, Queries& queries) {
        answers[open.index] = node(questions[open.index], open, worker, queries);
      },
      work);
  if (memory_)
    for (const Open& open : open_)
      if (const NodeQuestion& x = questions[open.index];
          !x.only_scene || !answers[open.index].valid)
        memory_->note_node(x, answers[open.index], open.pair, open.slack);
}

NodeAnswer CollisionValidity::node(const NodeQuestion& question, Open& open, int worker,
                                   Queries& queries) {
  const TraceSpan span("node");
  budget_.poll();
  const auto suspected =
      open.pair == ClearanceMemory::kNoPair ? std::nullopt : std::optional(open.pair);
  open.pair = ClearanceMemory::kNoPair;
  const auto failure = [&](const BodyPair& pair, bool shared) {
    open.pair = pair;
    return NodeAnswer{false, shared, groups_of(*world_, pair), failure_of(pair)};
  };
  if (suspected && !open.only_changed && lattice_->is_approximate() &&
      fails_before_exact_config(question, *suspected, queries.whole))
    return failure(*suspected, lattice_->shares_body_poses(groups_of(*world_, *suspected)));
  const auto unmanipulable = [&](bool shared) {
    return NodeAnswer{false, shared, lattice_->manipulability_groups(), kManipulability};
  };
  const bool suspects_manipulability = question.suspected == kManipulability && !open.only_changed;
  if (suspects_manipulability && lattice_->all_below_manipulability(question.layer, question.q))
    return unmanipulable(true);
  const auto q = exact_config(question.layer, question.slot, question.q, worker);
  if (!q) return {};
  if (!open.only_changed && !lattice_->manipulable(*q))
    return unmanipulable(!suspects_manipulability &&
                         lattice_->all_below_manipulability(question.layer, question.q));
  World::Query& query = open.only_changed ? *queries.changed : queries.whole;
  const auto shared = [&](const BodyPair& pair) {
    return is_shared(*lattice_, *world_, clearance_error_, query, question.layer, question.q, *q,
                     pair);
  };
  if (question.only_scene && suspected && query.violation_proof_is_cheap(*suspected)) {
    if (!query.proves_violation(*q, *suspected, ClearanceRule::kNode)) return {.valid = true};
    return failure(*suspected, shared(*suspected));
  }
  const auto pair =
      question.only_scene
          ? query.find_violating_pair_with_scene(*q, ClearanceRule::kNode, suspected)
          : query.find_violating_pair_incremental(*q, ClearanceRule::kNode,
                                                  open.only_changed ? std::nullopt : suspected);
  if (!pair) {
    if (open.only_changed) open.slack = query.slack(ClearanceRule::kNode);
    return {.valid = true};
  }
  return failure(*pair, shared(*pair));
}

/// Computing the exact configuration means solving seven equations. If the bodies are too near by
/// more than it can move them, the node fails whether it has one or not, and so do the nodes at
/// which the bodies have the same poses.
bool CollisionValidity::fails_before_exact_config(const NodeQuestion& question,
                                                  const BodyPair& pair, World::Query& query) const {
  const double margin = clearance_error_.from_node(question.layer, question.q, pair);
  return std::isfinite(margin) &&
         query.proves_violation(question.q, pair, Threshold(ClearanceRule::kNode, -margin));
}

unsigned groups_of(const World& world, const BodyPair& pair) {
  unsigned groups = 0;
  for (const int body : {pair.a, pair.b})
    if (body < static_cast<int>(world.bodies().size())) {
      const int group = world.bodies()[static_cast<std::size_t>(body)].group;
      groups |= group > static_cast<int>(kDof) ? Lattice::kFollowers : 1u << group;
    }
  return groups & ~1u;  // group 0 does not move
}

/// At other nodes the bodies have these poses only up to rounding, or to the difference of exact
/// configurations. The verdict is therefore shared only if the pair is too near by more than that
/// and than FCL can err: then every planner that asks FCL about one of those nodes gets the same
/// verdict.
bool is_shared(const Lattice& lattice, const World& world, const ClearanceError& clearance_error,
               World::Query& query, int layer, const Config& node, const Config& row,
               const BodyPair& pair) {
  if (!lattice.shares_body_poses(groups_of(world, pair))) return false;
  const double apart = clearance_error.between_exact_configs(layer, node, pair);
  if (apart > 0)
    return std::isfinite(apart) &&
           query.proves_violation(row, pair, Threshold(ClearanceRule::kNode, -apart));
  return query.violation_is_proved() ||
         query.pair_violates(row, pair, Threshold(ClearanceRule::kNode, -kVerdictBand));
}

void CollisionValidity::edges(std::span<const EdgeQuestion> questions,
                              std::span<std::uint8_t> answers) {
  TraceSpan batch("edges asked");
  open_.clear();
  for (std::size_t k = 0; k < questions.size(); ++k) {
    const EdgeQuestion& x = questions[k];
    Open open{k};
    if (const auto* known = memory_ ? memory_->edge(x.layer, x.a, x.b) : nullptr) {
      const auto holds = memory_->holds(*known);
      if (holds == ClearanceMemory::Holds::kAll) {
        answers[k] = known->valid;
        continue;
      }
      open.only_changed = holds == ClearanceMemory::Holds::kUnlessChanged;
      open.rows = known->rows;
    }
    open_.push_back(open);
  }
  batch.count("edges", static_cast<std::int64_t>(open_.size()));
  edges_checked_ += static_cast<std::int64_t>(open_.size());
  ask_open([&](Open& open, int worker, Queries& queries) {
    answers[open.index] = edge(questions[open.index], open, worker, queries);
  });
  if (memory_)
    for (const Open& open : open_)
      memory_->note_edge(questions[open.index], answers[open.index] != 0, open.pair, open.slack,
                         open.rows);
}

bool CollisionValidity::edge(const EdgeQuestion& x, Open& open, int worker, Queries& queries) {
  const TraceSpan span("edge");
  budget_.poll();
  const auto qa = exact_config(x.layer, x.a, x.qa, worker),
             qb = exact_config(x.layer + 1, x.b, x.qb, worker);
  if (!qa || !qb) return false;
  if (lattice_->has_layers_between()) return edge_of_layers(x, *qa, *qb, open, queries);
  const Config move = lattice_->delta(*qa, *qb);
  if (!open.only_changed &&
      ((lattice_->is_approximate() && !lattice_->row_step_allowed(x.layer, move)) ||
       !lattice_->follows_path(x.layer, x.a, *qa, x.b, *qb)))
    return false;
  if (edge_mode_ == EdgeMode::kNodes) return true;
  const auto blocked =
      open.only_changed
          ? edge_blocked(*queries.changed, changed_rule_, *qa, *qa + move, budget_, &open.slack)
          : edge_blocked(queries.whole, rule_, *qa, *qa + move, budget_);
  if (blocked) open.pair = *blocked;
  return !blocked;
}

/// Tests every configuration between the layers as a node, and every move from one to the next as
/// an edge. The slack of a valid edge is the least of theirs.
bool CollisionValidity::edge_of_layers(const EdgeQuestion& x, const Config& qa, const Config& qb,
                                       Open& open, Queries& queries) {
  World::Query& query = open.only_changed ? *queries.changed : queries.whole;
  const EdgeRule& rule = open.only_changed ? changed_rule_ : rule_;
  double slack = std::numeric_limits<double>::infinity(), slack_of_move = -1;
  if (!open.rows) {
    auto interpolated = lattice_->interpolate_edge(x.layer, x.a, qa, x.b, qb);
    if (interpolated.fault != Lattice::InterpolatedEdge::Fault::kNone) return false;
    interpolated.rows.push_back(qb);
    open.rows = std::make_shared<const std::vector<Config>>(std::move(interpolated.rows));
  }
  const std::span<const Config> rows(*open.rows);
  for (const Config& q : rows.first(rows.size() - 1)) {
    if (const auto pair = query.find_violating_pair_incremental(q, ClearanceRule::kNode)) {
      open.pair = *pair;
      return false;
    }
    if (open.only_changed) slack = std::min(slack, query.slack(ClearanceRule::kNode));
  }
  Config from = qa;
  for (std::size_t k = 0; edge_mode_ == EdgeMode::kContinuous && k < rows.size(); ++k) {
    const Config to = from + lattice_->delta(from, rows[k]);
    if (const auto pair = edge_blocked(query, rule, from, to, budget_,
                                       open.only_changed ? &slack_of_move : nullptr)) {
      open.pair = *pair;
      return false;
    }
    if (open.only_changed) slack = std::min(slack, slack_of_move);
    from = to;
  }
  if (open.only_changed && std::isfinite(slack)) open.slack = slack;
  return true;
}

bool CollisionValidity::asks_edges() const {
  return lattice_->is_approximate() || lattice_->has_layers_between() ||
         lattice_->asks_path_error() ||
         (edge_mode_ == EdgeMode::kContinuous && !world_->pairs().empty());
}

CollisionCounters CollisionValidity::counters() const {
  CollisionCounters sum;
  for (const auto* all : {&workers_, &chunks_})
    for (const Queries& queries : *all) {
      sum += queries.whole.counters();
      if (queries.changed) sum += queries.changed->counters();
    }
  return sum;
}

}  // namespace swivel
