// SPDX-License-Identifier: BSD-3-Clause
#include "validity/clearance_memory.hpp"

#include <algorithm>
#include <utility>

namespace swivel {

namespace {

constexpr FailureId kBodies = FailureId{1} << 31;

}  // namespace

FailureId failure_of(const BodyPair& pair) {
  return pair.a * kBodies + pair.b;
}
BodyPair pair_of(FailureId failure) {
  return {static_cast<int>(failure / kBodies), static_cast<int>(failure % kBodies)};
}

void ClearanceMemory::begin(std::uint64_t plan, std::vector<std::uint64_t> met, const World& world,
                            const std::vector<SceneObject>& scene) {
  // This is far more than a search tests. It bounds the memory of a planner that runs for days in a
  // changing scene.
  constexpr std::size_t kMost = 1'000'000;
  if (nodes_.size() + edges_.size() + rows_ > kMost) {
    rows_ = 0;
    nodes_.clear();
    edges_.clear();
    failed_nodes_.clear();
    failed_edges_.clear();
  }
  learn();
  const std::uint64_t before = std::exchange(plan_, plan);
  met_ = std::move(met);
  world_ = &world;
  robot_bodies_ = static_cast<int>(world.bodies().size());
  unchanged_since_ = 0;
  const auto changed_before = std::exchange(changed_, {});
  for (std::size_t k = 0; k < met_.size(); ++k)
    if (before > 0 && met_[k] > before)
      changed_.push_back(static_cast<int>(k));
    else
      unchanged_since_ = std::max(unchanged_since_, met_[k]);
  constexpr std::size_t kLongestRun = 10'000;
  if (changed_ != changed_before || stood_.size() == kLongestRun) {
    run_.clear();
    stood_.clear();
  }
  run_.push_back(plan);
  auto& poses = stood_.emplace_back();
  for (const int k : changed_) poses.push_back(scene[static_cast<std::size_t>(k)].pose);
  moved_since_.assign(stood_.size(), -1);
}

double ClearanceMemory::moved_since(std::uint64_t plan) {
  const auto then =
      static_cast<std::size_t>(std::lower_bound(run_.begin(), run_.end(), plan) - run_.begin());
  double& most = moved_since_[then];
  if (most >= 0) return most;
  most = 0;
  for (std::size_t k = 0; k < changed_.size(); ++k)
    most = std::max(most, world_->displacement(changed_[k], stood_[then][k], stood_.back()[k]));
  return most;
}

void ClearanceMemory::object_removed(int object) {
  learn();
  changed_.clear();  // their numbers have changed
  run_.clear();
  stood_.clear();
  const int body = robot_bodies_ + object;
  const auto renumber = [&](auto& findings) {
    for (auto& [key, finding] : findings) {
      if (finding.valid || finding.pair.b < body) continue;
      // Nothing is known about the other pairs: as if no plan had found anything.
      if (finding.pair.b == body)
        finding = {{0, true, kNoPair, finding.listed}};
      else
        --finding.pair.b;
      if constexpr (requires { finding.answer; })
        if (!finding.valid) finding.answer.failure = failure_of(finding.pair);
    }
  };
  renumber(nodes_);
  renumber(edges_);
}

ClearanceMemory::Holds ClearanceMemory::holds(const Finding& finding) {
  if (!finding.valid) {
    const int object = finding.pair.b - robot_bodies_;
    return object < 0 || met_[static_cast<std::size_t>(object)] <= finding.plan ? Holds::kAll
                                                                                : Holds::kNothing;
  }
  if (finding.plan == 0 || finding.plan < unchanged_since_) return Holds::kNothing;
  if (changed_.empty() || finding.plan == plan_) return Holds::kAll;
  const bool kept = finding.slack > 0 && finding.plan >= run_.front() &&
                    moved_since(finding.plan) < finding.slack;
  return kept ? Holds::kAll : Holds::kUnlessChanged;
}

const ClearanceMemory::NodeFinding* ClearanceMemory::node(int layer, int slot) const {
  const auto found = nodes_.find(key(layer, slot));
  return found == nodes_.end() ? nullptr : &found->second;
}

const ClearanceMemory::EdgeFinding* ClearanceMemory::edge(int layer, int a, int b) const {
  const auto found = edges_.find({key(layer, a), b});
  return found == edges_.end() ? nullptr : &found->second;
}

void ClearanceMemory::note_node(const NodeQuestion& question, const NodeAnswer& answer,
                                const BodyPair& pair, double slack) {
  noted_nodes_.push_back({key(question.layer, question.slot),
                          {{plan_, answer.valid, pair, false, slack}, question.q, answer}});
}

void ClearanceMemory::note_edge(const EdgeQuestion& question, bool valid, const BodyPair& pair,
                                double slack, Rows rows) {
  noted_edges_.push_back(
      {{key(question.layer, question.a), question.b},
       {{plan_, valid, pair, false, slack}, question.qa, question.qb, std::move(rows)}});
}

void ClearanceMemory::learn() {
  const auto take = [this](auto& noted, auto& findings, auto& failed) {
    for (auto& [key, finding] : noted) {
      auto& known = findings[key];
      if constexpr (requires { finding.rows; })
        if (!known.rows && finding.rows) rows_ += finding.rows->size();
      finding.listed = known.listed || !finding.valid;
      if (finding.listed && !known.listed) failed.push_back(key);
      known = finding;
    }
    noted.clear();
  };
  take(noted_nodes_, nodes_, failed_nodes_);
  take(noted_edges_, edges_, failed_edges_);
}

std::vector<FailureHint> ClearanceMemory::failure_hints() {
  learn();
  std::vector<FailureHint> failure_hints;
  for (const std::uint64_t node : failed_nodes_)
    if (const NodeFinding& finding = nodes_.at(node); !finding.valid && finding.pair != kNoPair)
      failure_hints.push_back({static_cast<int>(node >> 32),
                               static_cast<int>(static_cast<std::uint32_t>(node)),
                               failure_of(finding.pair)});
  return failure_hints;
}

PriorFailures ClearanceMemory::failures() const {
  PriorFailures failures;
  for (const std::uint64_t node : failed_nodes_)
    if (const NodeFinding& finding = nodes_.at(node); !finding.valid)
      failures.nodes.push_back({static_cast<int>(node >> 32),
                                static_cast<int>(static_cast<std::uint32_t>(node)), finding.q});
  for (const EdgeKey& edge : failed_edges_)
    if (const EdgeFinding& finding = edges_.at(edge); !finding.valid)
      failures.edges.push_back({static_cast<int>(edge.tail >> 32),
                                static_cast<int>(static_cast<std::uint32_t>(edge.tail)), edge.b,
                                finding.qa, finding.qb});
  return failures;
}

}  // namespace swivel
