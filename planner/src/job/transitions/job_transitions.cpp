// SPDX-License-Identifier: BSD-3-Clause
#include "job/transitions/job_transitions.hpp"

#include <algorithm>
#include <cmath>

#include "job/transitions/rrt_connect.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"

namespace swivel {

namespace {

constexpr int kParts = 8;  // of a batch

/// Returns the box of joint limits about the two ends of a transition: joints without limits may
/// come half a turn beyond the ends, joints that do not move rest.
SearchBox search_box(const Lattice& metric, const Limits& limits, const Config& from,
                     const Config& to) {
  SearchBox box;
  for (std::size_t j = 0; j < kDof; ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    const JointLimit& limit = metric.chain().limit[j];
    const double low = std::min(from[i], to[i]), high = std::max(from[i], to[i]);
    if (metric.chain().roll && j + 1 == kDof) {
      box.lower[i] = box.upper[i] = from[i];
    } else if (limit.continuous || limit.wide()) {
      box.lower[i] = low - kPi;
      box.upper[i] = high + kPi;
    } else {
      // a joint that is treated as a circle may end beyond its limits, the short way round
      box.lower[i] = std::min(low, limit.lower + limits.joint_margin);
      box.upper[i] = std::max(high, limit.upper - limits.joint_margin);
    }
    constexpr double kLeastScale =
        0.05;  // of joints that cost little, so that they are not ignored
    box.scale[i] = std::max(kLeastScale, metric.cost_scale()[j] / metric.cost_unit());
  }
  return box;
}

std::uint64_t seed_of(int transition, std::size_t search) {
  return 0x5377697665ull * 1'000'003 + static_cast<std::uint64_t>(transition) * 10'007 + search;
}

}  // namespace

double transition_distance(const Lattice& metric, const Config& from, const Config& to) {
  Config delta = metric.delta(from, to);
  if (metric.chain().roll) delta[kDof - 1] = 0;
  return metric.edge_cost(delta);
}

double least_transition_distance(const Lattice& metric, const Config& from, const Config& lower,
                                 const Config& upper) {
  Config delta = metric.least_delta(from, lower, upper);
  if (metric.chain().roll) delta[kDof - 1] = 0;
  return metric.edge_cost(delta);
}

JobTransitions::JobTransitions(const PreparedRobot& robot, const World& world, const Limits& limits,
                               const Lattice& metric, DistanceProofs proofs, Executor& executor,
                               std::shared_ptr<StateCheck> check, const Budget& budget)
    : world_(&world),
      limits_(&limits),
      metric_(&metric),
      executor_(&executor),
      budget_(budget),
      check_(std::move(check), budget),
      rule_(world.edge_rule(robot.radii())) {
  for (int k = 0; k < kParts; ++k) queries_.emplace_back(world, proofs);
}

JobTransitions::Key JobTransitions::key(int transition, const Config& from, const Config& to) {
  Key key{transition, {}};
  std::copy_n(from.data(), kDof, key.second.begin());
  std::copy_n(to.data(), kDof, key.second.begin() + kDof);
  return key;
}

bool JobTransitions::is_free(World::Query& query, const Config& from, const Config& to) {
  return !edge_blocked(query, rule_, from, to, budget_) && allows(from, to);
}

bool JobTransitions::allows(const Config& from, const Config& to) {
  if (!check_) return true;
  constexpr double kStep = 0.05;  // rad or m
  const Config move = to - from;
  double most = 0;
  for (const double part : move.coordinates()) most = std::max(most, std::abs(part));
  const int steps = std::max(1, static_cast<int>(std::ceil(most / kStep)));
  std::vector<Config> states;
  for (int k = 0; k <= steps; ++k)
    states.push_back(from + (static_cast<double>(k) / static_cast<double>(steps)) * move);
  const auto allowed = check_.states(states);
  if (!std::all_of(allowed.begin(), allowed.end(), [](bool one) { return one; })) return false;
  if (!check_.checks_motions()) return true;
  std::vector<StateCheck::Motion> moves;
  for (std::size_t k = 1; k < states.size(); ++k) moves.push_back({states[k - 1], states[k]});
  const auto free = check_.motions(moves);
  return std::all_of(free.begin(), free.end(), [](bool one) { return one; });
}

double JobTransitions::cost_through(const Chain& chain, const TransitionQuestion& question) const {
  return distance(question.from, chain.corners.front()) + chain.cost +
         distance(chain.corners.back(), question.to);
}

std::optional<JobTransitions::Way> JobTransitions::known_way(World::Query& query,
                                                             const TransitionQuestion& question) {
  if (free(query, question.from, question.to))
    return Way{distance(question.from, question.to), nullptr};
  const auto known = chains_.find(question.transition);
  if (known == chains_.end()) return std::nullopt;
  std::vector<Way> ways;
  for (const Chain& chain : known->second) ways.push_back({cost_through(chain, question), &chain});
  std::stable_sort(ways.begin(), ways.end(),
                   [](const Way& a, const Way& b) { return a.cost < b.cost; });
  for (const Way& way : ways)
    if (free(query, question.from, way.chain->corners.front()) &&
        free(query, way.chain->corners.back(), question.to))
      return way;
  return std::nullopt;
}

std::optional<JobTransitions::Chain> JobTransitions::search(World::Query& query,
                                                            const TransitionQuestion& question) {
  const Config to = question.from + metric_->delta(question.from, question.to);
  const auto known = chains_.find(question.transition);
  const std::size_t searched = known == chains_.end() ? 0 : known->second.size();
  // Rows go the short way round from corner to corner, where joints are treated as circles.
  const auto is_short = [this](const Config& a, const Config& b) {
    return (metric_->delta(a, b) - (b - a)).cwiseAbs().maxCoeff() < 1;
  };
  auto corners = rrt_connect(
      question.from, to, search_box(*metric_, *limits_, question.from, to),
      [&](const Config& a, const Config& b) { return is_short(a, b) && is_free(query, a, b); },
      seed_of(question.transition, searched), budget_);
  if (!corners || corners->empty()) return std::nullopt;
  Chain chain{std::move(*corners), 0};
  for (std::size_t k = 1; k < chain.corners.size(); ++k)
    chain.cost += distance(chain.corners[k - 1], chain.corners[k]);
  return chain;
}

template <class Body>
void JobTransitions::for_each(std::size_t count, const Body& body) {
  executor_->for_each(kParts, [&](int part, int) {
    const std::size_t p = static_cast<std::size_t>(part);
    for (std::size_t k = count * p / kParts; k < count * (p + 1) / kParts; ++k)
      body(k, queries_[p]);
  });
}

void JobTransitions::find_barred(std::span<const Config> configurations,
                                 std::span<std::uint8_t> barred) {
  for_each(configurations.size(), [&](std::size_t k, World::Query& query) {
    barred[k] = !free(query, configurations[k], configurations[k]);
  });
}

void JobTransitions::find(std::span<const TransitionQuestion> questions,
                          std::span<TransitionAnswer> answers) {
  std::vector<std::optional<Way>> ways(questions.size());
  std::vector<std::optional<Chain>> found(questions.size());
  for_each(questions.size(),
           [&](std::size_t k, World::Query& query) { ways[k] = known_way(query, questions[k]); });
  const auto searched = [&](std::size_t k) { return !ways[k] && questions[k].thorough; };
  bool any = false;
  for (std::size_t k = 0; k < questions.size(); ++k) any = any || searched(k);
  if (any)
    for_each(questions.size(), [&](std::size_t k, World::Query& query) {
      if (searched(k)) found[k] = search(query, questions[k]);
    });
  for (std::size_t k = 0; k < questions.size(); ++k) {
    const TransitionQuestion& x = questions[k];
    if (found[k]) {
      const Chain& chain = chains_[x.transition].emplace_back(std::move(*found[k]));
      ways[k] = Way{cost_through(chain, x), &chain};
    }
    if (!ways[k]) {
      answers[k] = {x.thorough ? Verdict::kRemoved : Verdict::kUnknown, 0};
      continue;
    }
    answers[k] = {Verdict::kValid, ways[k]->cost};
    ways_[key(x.transition, x.from, x.to)] = ways[k]->chain;
  }
}

std::vector<Config> JobTransitions::way(int transition, const Config& from,
                                        const Config& to) const {
  std::vector<Config> corners{from};
  if (const Chain* chain = ways_.at(key(transition, from, to)))
    corners.insert(corners.end(), chain->corners.begin(), chain->corners.end());
  corners.push_back(to);
  return corners;
}

std::optional<std::array<std::string, 2>> JobTransitions::barred(const Config& q) {
  return barred(q, q);
}

std::optional<std::array<std::string, 2>> JobTransitions::barred(const Config& from,
                                                                 const Config& to) {
  const auto pair =
      edge_blocked(queries_.front(), rule_, from, from + metric_->delta(from, to), budget_);
  if (!pair) return std::nullopt;
  return world_->names(*pair);
}

CollisionCounters JobTransitions::counters() const {
  CollisionCounters sum;
  for (const World::Query& query : queries_) {
    const CollisionCounters more = query.counters();
    sum.fcl_calls += more.fcl_calls;
    sum.proved_free += more.proved_free;
    sum.proved_colliding += more.proved_colliding;
  }
  return sum;
}

}  // namespace swivel
