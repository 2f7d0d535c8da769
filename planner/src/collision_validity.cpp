// SPDX-License-Identifier: BSD-3-Clause
#include "collision_validity.hpp"

#include "swivel/core/timeline.hpp"
namespace swivel {

CollisionValidity::CollisionValidity(const Lattice& lattice, const World& world, const EdgeRule& rule, Certificates certificates,
                                     Executor& executor, int lanes, const Budget& budget, const Progress& progress)
    : lattice_(&lattice), world_(&world), rule_(rule), executor_(&executor), budget_(budget), progress_(progress) {
  for (int lane = 0; lane < lanes; ++lane) lanes_.emplace_back(world, certificates);
  queries_.reserve(static_cast<std::size_t>(executor.threads()));
  for (int worker = 0; worker < executor.threads(); ++worker) queries_.emplace_back(world, certificates);
}

void CollisionValidity::report() const {
  if (progress_) progress_(std::to_string(nodes_checked_) + " nodes and " + std::to_string(edges_checked_) + " edges checked");
}

void CollisionValidity::nodes(std::span<const NodeQuestion> questions, std::span<NodeAnswer> answers) {
  Span batch("nodes asked");
  batch.count("nodes", static_cast<std::int64_t>(questions.size()));
  nodes_checked_ += static_cast<std::int64_t>(questions.size());
  report();
  const int count = static_cast<int>(questions.size()), lanes = static_cast<int>(lanes_.size());
  if (lanes == 0) {
    executor_->for_each(count, [&](int index, int worker) {
      const auto k = static_cast<std::size_t>(index);
      answers[k] = node(questions[k], queries_[static_cast<std::size_t>(worker)]);
    });
    return;
  }
  executor_->for_each(std::min(count, lanes), [&](int lane, int) {
    const int runs = std::min(count, lanes);
    for (int index = count * lane / runs; index < count * (lane + 1) / runs; ++index) {
      const auto k = static_cast<std::size_t>(index);
      answers[k] = node(questions[k], lanes_[static_cast<std::size_t>(lane)]);
    }
  });
}

NodeAnswer CollisionValidity::node(const NodeQuestion& question, World::Query& query) const {
  const Span span("node");
  budget_.poll();
  if (!lattice_->manipulable(question.q)) return {};
  const int bodies = static_cast<int>(world_->body_names().size());
  std::optional<BodyPair> suspect;
  if (question.suspect != kNoFault) suspect = {question.suspect / bodies, question.suspect % bodies};
  const auto pair = query.next_below(question.q, Keep::kNode, suspect);
  if (!pair) return {.valid = true};
  const Sharing sharing = sharing_of(*lattice_, *world_, query, question.q, *pair);
  return {false, sharing.shared, sharing.groups, pair->a * bodies + pair->b};
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
  batch.count("edges", static_cast<std::int64_t>(questions.size()));
  edges_checked_ += static_cast<std::int64_t>(questions.size());
  report();
  executor_->for_each(static_cast<int>(questions.size()), [&](int index, int worker) {
    const Span span("edge");
    budget_.poll();
    const EdgeQuestion& x = questions[static_cast<std::size_t>(index)];
    const Config unwrapped = x.qa + lattice_->delta(x.qa, x.qb);
    answers[static_cast<std::size_t>(index)] =
        lattice_->follows_path(x.layer, x.a, x.qa, x.b, x.qb) &&
        (lattice_->limits().edges == EdgeMode::kNodes ||
         !edge_blocked(queries_[static_cast<std::size_t>(worker)], rule_, x.qa, unwrapped, budget_));
  });
}

bool CollisionValidity::asks_edges() const {
  return lattice_->asks_path_error() || (lattice_->limits().edges == EdgeMode::kContinuous && !world_->pairs().empty());
}

CollisionCounters CollisionValidity::counters() const {
  CollisionCounters sum;
  for (const auto* queries : {&queries_, &lanes_})
    for (const World::Query& query : *queries) sum += query.counters();
  return sum;
}

}  // namespace swivel
