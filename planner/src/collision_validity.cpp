// SPDX-License-Identifier: BSD-3-Clause
#include "collision_validity.hpp"

#include <algorithm>

#include "swivel/core/timeline.hpp"

namespace swivel {

namespace {

constexpr std::size_t kRows = 8192, kSlotsApart = 67;
constexpr Fault kFaultBodies = Fault{1} << 31;
Fault fault_of(const BodyPair& pair) {
  return pair.a * kFaultBodies + pair.b;
}
BodyPair pair_of(Fault fault) {
  return {static_cast<int>(fault / kFaultBodies), static_cast<int>(fault % kFaultBodies)};
}

}  // namespace

CollisionValidity::CollisionValidity(const Lattice& lattice, const World& world, const EdgeRule& rule, EdgeMode edge_mode,
                                     Certificates certificates, Executor& executor, int lanes, const Budget& budget,
                                     ClearanceMemory* memory, const World* changed)
    : lattice_(&lattice),
      world_(&world),
      rule_(rule),
      changed_rule_{rule.radii, rule.h, {}},
      edge_mode_(edge_mode),
      certificates_(certificates),
      executor_(&executor),
      budget_(budget),
      memory_(memory),
      changed_(changed) {
  lanes_.reserve(static_cast<std::size_t>(lanes));
  for (int lane = 0; lane < lanes; ++lane) lanes_.push_back(make_queries());
  workers_.reserve(static_cast<std::size_t>(executor.threads()));
  for (int worker = 0; worker < executor.threads(); ++worker) workers_.push_back(make_queries());
  if (lattice.has_own_rows()) rows_.assign(static_cast<std::size_t>(executor.threads()), std::vector<Row>(kRows));
}

std::optional<Config> CollisionValidity::row(int layer, int slot, const Config& q, int worker) {
  if (!lattice_->has_own_rows()) return q;
  auto& rows = rows_[static_cast<std::size_t>(worker)];
  // Neighbours along the path and along the arm angle must not share a place.
  const auto place = (static_cast<std::size_t>(layer) * kSlotsApart + static_cast<std::size_t>(slot)) % rows.size();
  Row& row = rows[place];
  if (row.layer != layer || row.slot != slot) row = {layer, slot, lattice_->row(layer, slot, q)};
  return row.q;
}

CollisionValidity::Queries CollisionValidity::make_queries() const {
  Queries queries{World::Query(*world_, certificates_), std::nullopt};
  if (changed_) queries.changed.emplace(*changed_, certificates_);
  return queries;
}

void CollisionValidity::nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) {
  Span batch("nodes asked");
  open_.clear();
  for (std::size_t k = 0; k < questions.size(); ++k) {
    const NodeQuestion& x = questions[k];
    Open open{k};
    if (x.suspect != kNoFault) open.pair = pair_of(x.suspect);
    if (const auto* known = memory_ ? memory_->node(x.layer, x.slot) : nullptr) {
      const auto holds = memory_->holds(*known);
      if (holds == ClearanceMemory::Holds::kAll) {
        answers[k] = known->answer;
        continue;
      }
      open.only_changed = holds == ClearanceMemory::Holds::kUnlessChanged;
      if (!known->valid) open.pair = known->pair;
    }
    open_.push_back(open);
  }
  batch.count("nodes", static_cast<std::int64_t>(open_.size()));
  nodes_checked_ += static_cast<std::int64_t>(open_.size());
  const int count = static_cast<int>(open_.size()), runs = std::min(count, static_cast<int>(lanes_.size()));
  const auto ask = [&](int index, int worker, Queries& queries) {
    Open& open = open_[static_cast<std::size_t>(index)];
    answers[open.index] = node(questions[open.index], open, worker, queries);
  };
  if (lanes_.empty())
    executor_->for_each(count, [&](int index, int worker) { ask(index, worker, workers_[static_cast<std::size_t>(worker)]); });
  else
    executor_->for_each(runs, [&](int lane, int worker) {
      for (int index = count * lane / runs; index < count * (lane + 1) / runs; ++index)
        ask(index, worker, lanes_[static_cast<std::size_t>(lane)]);
    });
  if (memory_)
    for (const Open& open : open_) memory_->note_node(questions[open.index], answers[open.index], open.pair);
}

NodeAnswer CollisionValidity::node(const NodeQuestion& question, Open& open, int worker, Queries& queries) {
  const Span span("node");
  budget_.poll();
  const auto suspect = open.pair == ClearanceMemory::kNoPair ? std::nullopt : std::optional(open.pair);
  open.pair = ClearanceMemory::kNoPair;
  const auto q = row(question.layer, question.slot, question.q, worker);
  if (!q || (!open.only_changed && !lattice_->manipulable(*q))) return {};
  World::Query& query = open.only_changed ? *queries.changed : queries.whole;
  const auto pair = query.next_below(*q, Keep::kNode, open.only_changed ? std::nullopt : suspect);
  if (!pair) return {.valid = true};
  open.pair = *pair;
  const Sharing sharing = sharing_of(*lattice_, *world_, query, *q, *pair);
  return {false, sharing.shared, sharing.groups, fault_of(*pair)};
}

/// Other nodes' bodies stand where these do only up to rounding, so the verdict is shared only where the pair is too near by more
/// than FCL can err: then every planner, asking FCL about each of those nodes, hears the same.
Sharing sharing_of(const Lattice& lattice, const World& world, World::Query& query, const Config& q, const BodyPair& pair) {
  Sharing sharing;
  for (const int body : {pair.a, pair.b})
    if (body < static_cast<int>(world.bodies().size()))
      sharing.groups |= 1u << world.bodies()[static_cast<std::size_t>(body)].group;
  sharing.groups &= ~1u;  // group 0 stands still
  sharing.shared =
      lattice.stand_alike(sharing.groups) && (query.surely_below() || query.pair_below(q, pair, Level(Keep::kNode, -kVerdictBand)));
  return sharing;
}

void CollisionValidity::edges(std::span<const EdgeQuestion> questions, std::span<std::uint8_t> answers) {
  Span batch("edges asked");
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
    }
    open_.push_back(open);
  }
  batch.count("edges", static_cast<std::int64_t>(open_.size()));
  edges_checked_ += static_cast<std::int64_t>(open_.size());
  executor_->for_each(static_cast<int>(open_.size()), [&](int index, int worker) {
    Open& open = open_[static_cast<std::size_t>(index)];
    answers[open.index] = edge(questions[open.index], open, worker, workers_[static_cast<std::size_t>(worker)]);
  });
  if (memory_)
    for (const Open& open : open_) memory_->note_edge(questions[open.index], answers[open.index] != 0, open.pair);
}

bool CollisionValidity::edge(const EdgeQuestion& x, Open& open, int worker, Queries& queries) {
  const Span span("edge");
  budget_.poll();
  const auto qa = row(x.layer, x.a, x.qa, worker), qb = row(x.layer + 1, x.b, x.qb, worker);
  if (!qa || !qb) return false;
  const Config move = lattice_->delta(*qa, *qb);
  if (!open.only_changed && ((lattice_->has_own_rows() && !lattice_->row_step_allowed(x.layer, move)) ||
                             !lattice_->follows_path(x.layer, x.a, *qa, x.b, *qb)))
    return false;
  if (edge_mode_ == EdgeMode::kNodes) return true;
  const auto blocked = open.only_changed ? edge_blocked(*queries.changed, changed_rule_, *qa, *qa + move, budget_)
                                         : edge_blocked(queries.whole, rule_, *qa, *qa + move, budget_);
  if (blocked) open.pair = *blocked;
  return !blocked;
}

bool CollisionValidity::asks_edges() const {
  return lattice_->has_own_rows() || lattice_->asks_path_error() ||
         (edge_mode_ == EdgeMode::kContinuous && !world_->pairs().empty());
}

CollisionCounters CollisionValidity::counters() const {
  CollisionCounters sum;
  for (const auto* all : {&workers_, &lanes_})
    for (const Queries& queries : *all) {
      sum += queries.whole.counters();
      if (queries.changed) sum += queries.changed->counters();
    }
  return sum;
}

}  // namespace swivel
