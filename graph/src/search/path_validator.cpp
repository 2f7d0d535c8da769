// SPDX-License-Identifier: BSD-3-Clause
#include "search/path_validator.hpp"

#include <optional>
#include <type_traits>
#include <unordered_set>
#include <utility>

#include "swivel/core/base/timeline.hpp"

namespace swivel {

void PathValidator::check_failure_hints(std::span<const FailureHint> failure_hints) {
  constexpr std::size_t kAtOnce = 64;
  std::vector<NodeQuestion> questions;
  for (std::size_t first = 0; first < failure_hints.size(); first += kAtOnce) {
    cost_to_go_.budget().poll();
    questions.clear();
    for (const FailureHint& x :
         failure_hints.subspan(first, std::min(kAtOnce, failure_hints.size() - first)))
      if (x.layer < lattice_.layers() && x.slot < lattice_.slots(x.layer) &&
          verdicts_.node(x.layer, x.slot) == Verdict::kUnknown)
        if (const auto q = cost_to_go_.node(x.layer, x.slot))
          questions.push_back({x.layer, x.slot, *q, x.suspected});
    if (2 * ask(std::span<const NodeQuestion>(questions)).size() < questions.size()) return;
  }
}

bool PathValidator::costs_more(const SlotPath& path) {
  const TraceSpan span("costs");
  std::vector<NodeQuestion> questions;
  std::unordered_set<std::int64_t> asked;
  const auto ask_about = [&](int layer, int slot) {
    if (verdicts_.knows_cost(layer, slot) || cost_to_go_.at(layer, slot) == kUnreachable) return;
    if (!asked.insert(key(layer, slot)).second) return;
    if (questions.size() % 256 == 0) cost_to_go_.budget().poll();
    questions.push_back({layer, slot, cost_to_go_.config(layer, slot)});
  };
  for (int layer = 0; layer < static_cast<int>(path.size()); ++layer) {
    const int slot = path[static_cast<std::size_t>(layer)];
    if (verdicts_.knows_cost(layer, slot)) continue;
    ask_about(layer, slot);
    for (const int by : {-1, 1})
      for (int beside = slot, k = 0; k < cost_reach_; ++k) {
        beside = lattice_.neighbour_in_redundancy(layer, beside, by);
        if (beside < 0 || beside == slot) break;
        ask_about(layer, beside);
      }
  }
  bool more = false;
  std::vector<double> costs;
  constexpr std::size_t kMost = 4096;  // at once, so that the budget is polled
  for (std::size_t first = 0; first < questions.size(); first += kMost) {
    const auto some = std::span<const NodeQuestion>(questions).subspan(
        first, std::min(kMost, questions.size() - first));
    costs.assign(some.size(), 0.0);
    validity_.costs(some, costs);
    for (std::size_t k = 0; k < some.size(); ++k) {
      more = more || (costs[k] > own_cost(some[k]) &&
                      path[static_cast<std::size_t>(some[k].layer)] == some[k].slot);
      verdicts_.set_cost(some[k].layer, some[k].slot, costs[k]);
    }
  }
  if (more) cost_reach_ = std::max(1, std::min(2 * cost_reach_, kMostReach));
  return more;
}

bool PathValidator::valid(const SlotPath& path) {
  const TraceSpan span("candidate path");
  fail_first_.next_round();
  const int layers = static_cast<int>(path.size());
  // joints at the layers that are asked about
  std::vector<std::optional<Config>> solved(path.size());
  const auto joints = [&](int layer) -> const Config& {
    auto& q = solved[static_cast<std::size_t>(layer)];
    if (!q) q = cost_to_go_.config(layer, path[static_cast<std::size_t>(layer)]);
    return *q;
  };
  const auto at = [](int layer) { return static_cast<std::size_t>(layer); };
  asked_ = 0;
  failed_on_path_.clear();
  region_questions_left_ = most_region_questions();
  // Where paths cost so much more than the first, obstacles block most of them, and each path
  // would find a little more of the same region.
  if (!deferred_.empty() && cost_to_go_.best() > kMuchDearer * first_cost_) {
    expand_reached_regions();
    for (int i = 0; i < layers; ++i)
      if (verdicts_.node(i, path[at(i)]) == Verdict::kRemoved) return false;
  }
  const auto node_unknown = [&](int i) {
    return verdicts_.node(i, path[at(i)]) == Verdict::kUnknown;
  };
  const auto node = [&](int i) { return NodeQuestion{i, path[at(i)], joints(i)}; };
  if (!all_valid<NodeQuestion>(layers, layers, node_unknown, node)) return false;
  if (!validity_.asks_edges()) return true;
  const auto edge_unknown = [&](int i) {
    return !is_long(i) && verdicts_.edge(i, path[at(i)], path[at(i + 1)]) == Verdict::kUnknown;
  };
  const auto edge = [&](int i) {
    return EdgeQuestion{i, path[at(i)], path[at(i + 1)], joints(i), joints(i + 1)};
  };
  return all_valid<EdgeQuestion>(layers - 1, layers, edge_unknown, edge) &&
         (!options_.knots || long_edges_valid(path, joints));
}

template <class Question, class Unknown, class Make>
bool PathValidator::all_valid(int count, int layers, const Unknown& unknown, const Make& question) {
  std::vector<int> open;
  for (int i = 0; i < count; ++i)
    if (unknown(i)) open.push_back(i);
  fail_first_.order(open);
  const auto known = layers - static_cast<std::int64_t>(open.size());
  bool all = true;
  std::vector<Question> some;
  for (std::size_t next = 0;
       next < open.size() && (all || asked_ < options_.min_questions_per_iteration);) {
    cost_to_go_.budget().poll(Stage::kSearch, known + static_cast<std::int64_t>(next), layers);
    some.clear();
    for (; next < open.size() && some.size() < batch(); ++next)
      if (unknown(open[next])) some.push_back(question(open[next]));
    const auto failed = ask(std::span<const Question>(some));
    for (const auto& x : failed) fail_first_.failed(x.layer);
    if (failed.empty()) continue;
    all = false;
    if constexpr (std::is_same_v<Question, NodeQuestion>)
      failed_on_path_.insert(failed_on_path_.end(), failed.begin(), failed.end());
    expand_failed_region(failed);
  }
  return all;
}

template <class Joints>
bool PathValidator::long_edges_valid(const SlotPath& path, const Joints& joints) {
  KnotSearch& noted = *options_.knots;
  if (noted.bound == kUnreachable) noted.bound = cost_to_go_.best();
  const int last = static_cast<int>(path.size()) - 1;
  bool all = true;
  const std::size_t narrow_before = noted.narrow.size();
  std::vector<EdgeQuestion> some;
  for (int layer = 0; layer < last;) {
    cost_to_go_.budget().poll(Stage::kSearch, layer, last);
    some.clear();
    for (; layer < last && some.size() < batch(); ++layer) {
      const int a = path[static_cast<std::size_t>(layer)],
                b = path[static_cast<std::size_t>(layer) + 1];
      if (is_long(layer) && verdicts_.edge(layer, a, b) == Verdict::kUnknown)
        some.push_back({layer, a, b, joints(layer), joints(layer + 1)});
    }
    for (const EdgeQuestion& failed : ask(std::span<const EdgeQuestion>(some))) {
      noted.narrow.insert(failed.layer);
      all = false;
    }
  }
  if (all) return true;
  if (noted.from == kUnreachable) noted.from = cost_to_go_.at(0, path.front());
  noted.idle = noted.narrow.size() > narrow_before ? 0 : noted.idle + 1;
  return false;
}

bool PathValidator::bars_a_layer() {
  std::sort(failed_on_path_.begin(), failed_on_path_.end(),
            [](const Failure& a, const Failure& b) { return a.layer < b.layer; });
  int slots_left = 100'000;  // so that looking through wide layers takes no longer than a round
  for (int last = -1; const Failure& x : failed_on_path_)
    if (std::exchange(last, x.layer) != x.layer && slots_left > 0 &&
        !any_left(x.layer, slots_left) && all_fail(x))
      return true;
  return false;
}

bool PathValidator::any_left(int layer, int& slots_left) const {
  for (int slot = 0; slot < lattice_.slots(layer); ++slot, --slots_left)
    if (cost_to_go_.at(layer, slot) != kUnreachable &&
        verdicts_.node(layer, slot) != Verdict::kRemoved)
      return true;
  return false;
}

bool PathValidator::all_fail(const Failure& like) {
  constexpr int kApart = 16;
  const int slots = lattice_.slots(like.layer);
  std::vector<NodeQuestion> questions;
  const auto ask_from = [&](int first, int step) {
    for (int slot = first; slot < slots;) {
      questions.clear();
      for (; slot < slots && questions.size() < kRegionQuestionsAtOnce; slot += step) {
        const Verdict known = verdicts_.node(like.layer, slot);
        if (known == Verdict::kValid) return false;
        if (known == Verdict::kRemoved) continue;
        if (const auto q = cost_to_go_.node(like.layer, slot))
          questions.push_back({like.layer, slot, *q, like.failure});
      }
      if (ask(std::span<const NodeQuestion>(questions)).size() < questions.size()) return false;
    }
    return true;
  };
  const int step = std::max(1, slots / kApart);
  return ask_from(step / 2, step) && ask_from(0, 1);
}

void PathValidator::expand_failed_region(const std::vector<Failure>& failed) {
  std::deque<Failure> frontier;
  expand_failed_region(failed, frontier);
}

void PathValidator::expand_reached_regions() {
  std::deque<Failure> frontier;
  std::erase_if(deferred_, [&](const Failure& x) {
    const bool known = verdicts_.node(x.layer, x.slot) != Verdict::kUnknown;
    if (!known && cost_to_go_.at(x.layer, x.slot) == kUnreachable) return false;
    if (!known) frontier.push_back(x);
    return true;
  });
  expand_failed_region({}, frontier);
}

void PathValidator::add_neighbours(const Failure& x, std::deque<Failure>& frontier) const {
  const auto add = [&](int layer, int slot) {
    if (slot >= 0 && verdicts_.node(layer, slot) == Verdict::kUnknown)
      frontier.push_back({layer, slot, x.failure});
  };
  for (const int by : {-1, 1})
    if (x.layer + by <= cost_to_go_.goal_layer())
      add(x.layer + by, lattice_.neighbour_along_path(x.layer, x.slot, by));
  for (const int by : {1, -1})
    for (const int slot : {lattice_.neighbour_in_redundancy(x.layer, x.slot, by),
                           lattice_.neighbour_in_roll(x.layer, x.slot, by)})
      add(x.layer, slot);
}

std::size_t PathValidator::most_in_wave(const std::deque<Failure>& frontier) const {
  constexpr std::size_t kFewest = 16;
  const std::size_t at_once = options_.overlap_region_questions
                                  ? std::max(kFewest, frontier.size() / 2)
                                  : kRegionQuestionsAtOnce;
  return std::min(
      {at_once, kRegionQuestionsAtOnce, static_cast<std::size_t>(region_questions_left_)});
}

void PathValidator::fill(Wave& wave, const Wave& asked, std::deque<Failure>& frontier) {
  for (const std::size_t enough = most_in_wave(frontier);
       !frontier.empty() && wave.questions.size() < enough;) {
    const auto [layer, slot, failure] = frontier.front();
    frontier.pop_front();
    if (verdicts_.node(layer, slot) != Verdict::kUnknown) continue;
    if (wave.has(key(layer, slot)) || asked.has(key(layer, slot))) continue;
    if (cost_to_go_.at(layer, slot) == kUnreachable) {
      deferred_.push_back({layer, slot, failure});
      continue;
    }
    if (const auto known = clear_of_scene_.find(key(layer, slot));
        known != clear_of_scene_.end() && known->second == failure)
      continue;
    wave.questions.push_back(
        {layer, slot, cost_to_go_.config(layer, slot), failure, failure != kNoFailure});
    wave.keys.push_back(key(layer, slot));
  }
  region_questions_left_ -= static_cast<int>(wave.questions.size());
  wave.answers.assign(wave.questions.size(), {});
}

void PathValidator::take_wave(Wave& wave, std::deque<Failure>& frontier) {
  for (const Failure& node : take(wave.questions, wave.answers)) add_neighbours(node, frontier);
  wave.clear();
}

void PathValidator::expand_failed_region(const std::vector<Failure>& failed,
                                         std::deque<Failure>& frontier) {
  for (const Failure& node : failed) add_neighbours(node, frontier);
  Wave before, now, next;
  for (fill(now, before, frontier); !now.questions.empty();) {
    if (options_.overlap_region_questions)
      validity_.nodes_overlapped(now.questions, now.answers, [&] {
        const TraceSpan span("neighbours");
        take_wave(before, frontier);
        fill(next, now, frontier);
      });
    else
      validity_.nodes(now.questions, now.answers);
    std::swap(before, now);
    std::swap(now, next);  // which leaves it empty
    if (!now.questions.empty()) continue;
    take_wave(before, frontier);
    fill(now, before, frontier);
  }
}

void PathValidator::expand_failed_region(const std::vector<EdgeQuestion>& failed) {
  struct Edge {
    int layer, a, b;
    bool operator==(const Edge&) const = default;
  };
  std::deque<Edge> frontier;
  const auto add = [&](int layer, int a, int b) {
    if (a >= 0 && b >= 0 && !is_long(layer)) frontier.push_back({layer, a, b});
  };
  const auto add_neighbours = [&](const EdgeQuestion& x) {
    const auto shifted = [&](int layer, int slot, int by) {
      return by == 0 ? slot : lattice_.neighbour_in_redundancy(layer, slot, by);
    };
    constexpr std::pair<int, int> kShifts[] = {{0, 1}, {0, -1}, {1, 0}, {-1, 0}, {1, 1}, {-1, -1}};
    for (const auto& [da, db] : kShifts)
      add(x.layer, shifted(x.layer, x.a, da), shifted(x.layer + 1, x.b, db));
    for (const int by : {-1, 1})
      if (x.layer + by >= 0 && x.layer + by < cost_to_go_.goal_layer())
        add(x.layer + by, lattice_.neighbour_along_path(x.layer, x.a, by),
            lattice_.neighbour_along_path(x.layer + 1, x.b, by));
  };
  for (const EdgeQuestion& edge : failed) add_neighbours(edge);
  std::vector<Edge> asked;
  std::vector<EdgeQuestion> questions;
  for (int& left = region_questions_left_; left > 0 && !frontier.empty();) {
    asked.clear();
    questions.clear();
    while (!frontier.empty() &&
           questions.size() < std::min(kRegionQuestionsAtOnce, static_cast<std::size_t>(left))) {
      const Edge x = frontier.front();
      frontier.pop_front();
      if (cost_to_go_.at(x.layer, x.a) == kUnreachable ||
          cost_to_go_.at(x.layer + 1, x.b) == kUnreachable ||
          verdicts_.node(x.layer, x.a) == Verdict::kRemoved ||
          verdicts_.node(x.layer + 1, x.b) == Verdict::kRemoved ||
          verdicts_.edge(x.layer, x.a, x.b) != Verdict::kUnknown ||
          !lattice_.in_window(x.layer, x.a, x.b) ||
          std::find(asked.begin(), asked.end(), x) != asked.end())
        continue;
      const EdgeQuestion edge{x.layer, x.a, x.b, cost_to_go_.config(x.layer, x.a),
                              cost_to_go_.config(x.layer + 1, x.b)};
      if (!lattice_.step_allowed(x.layer, lattice_.delta(edge.qa, edge.qb))) continue;
      asked.push_back(x);
      questions.push_back(edge);
    }
    left -= static_cast<int>(questions.size());
    for (const EdgeQuestion& edge : ask(std::span<const EdgeQuestion>(questions)))
      add_neighbours(edge);
  }
}

int PathValidator::most_region_questions() const {
  return options_.region_questions +
         static_cast<int>(std::min<std::int64_t>(
             lattice_.nodes() / options_.nodes_per_region_question, 1'000'000));
}

std::vector<PathValidator::Failure> PathValidator::take(std::span<const NodeQuestion> questions,
                                                        std::span<const NodeAnswer> answers) {
  asked_ += static_cast<std::int64_t>(questions.size());
  std::vector<Failure> failed;
  failed.reserve(questions.size());
  for (std::size_t k = 0; k < questions.size(); ++k) {
    const NodeQuestion& x = questions[k];
    if (answers[k].valid) {
      if (x.only_scene)
        clear_of_scene_[key(x.layer, x.slot)] = x.suspected;
      else
        verdicts_.keep_node(x.layer, x.slot);
    } else {
      if (answers[k].shared)
        lattice_.slots_with_same_body_poses(x.layer, x.slot, answers[k].groups, same_poses_);
      else
        same_poses_.assign(1, x.slot);
      verdicts_.remove_nodes(x.layer, same_poses_);
      failed.push_back({x.layer, x.slot, answers[k].failure});
    }
  }
  return failed;
}

std::vector<PathValidator::Failure> PathValidator::ask(std::span<const NodeQuestion> questions) {
  answers_.assign(questions.size(), {});
  validity_.nodes(questions, answers_);
  return take(questions, answers_);
}

std::vector<EdgeQuestion> PathValidator::ask(std::span<const EdgeQuestion> questions) {
  asked_ += static_cast<std::int64_t>(questions.size());
  std::vector<EdgeQuestion> failed;
  edge_answers_.assign(questions.size(), 0);
  validity_.edges(questions, edge_answers_);
  for (std::size_t k = 0; k < questions.size(); ++k) {
    const EdgeQuestion& x = questions[k];
    if (edge_answers_[k]) {
      verdicts_.keep_edge(x.layer, x.a, x.b);
    } else {
      cost_to_go_.remove_edge(x.layer, x.a, x.b);
      failed.push_back(x);
    }
  }
  return failed;
}

}  // namespace swivel
