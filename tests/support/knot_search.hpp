// SPDX-License-Identifier: BSD-3-Clause
// Plans on lattices whose nodes lie at knots by plain searches, as docs/model.md "Nodes" defines
// them, halvings included.
#pragma once
#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "answer_order.hpp"
#include "brute_force.hpp"
#include "knot_problems.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel::test {

/// What a search of one lattice says, by the definition.
struct PlainSearch {
  std::vector<int> path;  ///< empty: none
  double cost = kNone, bound = kNone;
  std::set<int> narrow;
};

/// Searches a lattice by the definition of KnotSearch: takes the first path of valid nodes and
/// valid short edges to layer `goal`, drops its other invalid edges, and so on until all are valid.
class PlainKnotSearch {
 public:
  PlainKnotSearch(PlainLattice& plain, int goal, double most)
      : plain_(plain), goal_(static_cast<std::size_t>(goal)), most_(most) {}
  [[nodiscard]] PlainSearch run() {
    constexpr int kPatience = 8;
    PlainSearch found;
    for (int idle = 0; idle < kPatience;) {
      solve();
      const int first = first_of_answer(plain_.lattice(), least_[0], [&](int k) {
        return *plain_.nodes()[0][static_cast<std::size_t>(k)];
      });
      if (first < 0) return found;
      const double best = *std::min_element(least_[0].begin(), least_[0].end());
      if (best >= most_) return found;
      if (found.bound == kNone) found.bound = best;
      const std::vector<int> path = path_from(first);
      const std::size_t narrow = found.narrow.size();
      if (drop_invalid(path, found.narrow)) {
        found.path = path;
        found.cost = least_[0][static_cast<std::size_t>(first)];
        return found;
      }
      idle = found.narrow.size() > narrow ? 0 : idle + 1;
    }
    return found;
  }

 private:
  /// Computes the least cost from each node to the goal, and the node that follows.
  void solve() {
    const auto& nodes = plain_.nodes();
    least_.assign(goal_ + 1, {});
    next_.assign(goal_ + 1, {});
    for (std::size_t i = goal_ + 1; i-- > 0;) {
      least_[i].assign(nodes[i].size(), kNone);
      next_[i].assign(nodes[i].size(), 0);
      for (std::size_t a = 0; a < nodes[i].size(); ++a) {
        if (!nodes[i][a]) continue;
        const double own = plain_.own_cost(i, a);
        if (i == goal_) least_[i][a] = own;
        for (std::size_t b = 0; i < goal_ && b < nodes[i + 1].size(); ++b) {
          if (!nodes[i + 1][b] || least_[i + 1][b] == kNone || dropped_.contains({i, a, b}))
            continue;
          const auto cost = plain_.chord(i, a, b);
          if (!cost || !(own + (*cost + least_[i + 1][b]) < least_[i][a])) continue;
          if (!plain_.lattice().can_halve(static_cast<int>(i)) && !is_valid(i, a, b)) continue;
          least_[i][a] = own + (*cost + least_[i + 1][b]), next_[i][a] = b;
        }
      }
    }
  }
  [[nodiscard]] bool is_valid(std::size_t i, std::size_t a, std::size_t b) {
    const auto known = valid_.find({i, a, b});
    if (known != valid_.end()) return known->second;
    return valid_[{i, a, b}] = plain_.edge(i, a, b).has_value();
  }
  [[nodiscard]] std::vector<int> path_from(int first) const {
    std::vector<int> path{first};
    for (std::size_t i = 0; i < goal_; ++i)
      path.push_back(static_cast<int>(next_[i][static_cast<std::size_t>(path[i])]));
    return path;
  }
  /// Returns whether all edges of a path are valid; else drops those that are not.
  [[nodiscard]] bool drop_invalid(const std::vector<int>& path, std::set<int>& narrow) {
    bool valid = true;
    for (std::size_t i = 0; i < goal_; ++i) {
      const auto a = static_cast<std::size_t>(path[i]), b = static_cast<std::size_t>(path[i + 1]);
      if (is_valid(i, a, b)) continue;
      valid = false;
      dropped_.insert({i, a, b});
      narrow.insert(static_cast<int>(i));
    }
    return valid;
  }

  PlainLattice& plain_;
  std::size_t goal_;
  double most_;
  std::set<std::array<std::size_t, 3>> dropped_;
  std::map<std::array<std::size_t, 3>, bool> valid_;
  std::vector<std::vector<double>> least_;
  std::vector<std::vector<std::size_t>> next_;
};

/// Says whether slots a and b of neighbouring layers of a lattice may be joined.
using MayJoin = std::function<bool(const Lattice& lattice, int layer, int a, int b)>;

/// The answer by the definition, and the lattice searched last.
struct PlainAnswer {
  std::vector<TrajectoryRow> rows;  ///< empty: no path
  double cost = kNone, chords = kNone, bound = kNone;
  int halvings = 0, deepest = -1;
  std::unique_ptr<Lattice> last;
};

[[nodiscard]] inline bool has_long_step(const Lattice& lattice) {
  for (int step = 0; step + 1 < lattice.layers(); ++step)
    if (lattice.can_halve(step)) return true;
  return false;
}

/// Returns a lattice with nodes at all layers from the knot before a layer to the one after it.
inline std::unique_ptr<Lattice> split_about(const Lattice& lattice, int layer) {
  const int first = lattice.layer_of_rows(std::max(0, layer - 1)),
            last = lattice.layer_of_rows(std::min(layer + 1, lattice.layers() - 1));
  std::unique_ptr<Lattice> finer;
  for (;;) {
    const Lattice& now = finer ? *finer : lattice;
    std::set<int> steps;
    for (int step = 0; step + 1 < now.layers(); ++step)
      if (now.layer_of_rows(step) >= first && now.layer_of_rows(step) < last) steps.insert(step);
    std::unique_ptr<Lattice> next = now.with_knots(steps, {});
    if (!next) return finer;
    finer = std::move(next);
  }
}

/// Returns the steps of a path whose rows cost much more than their chord, by the definition.
inline std::set<int> uneven_by_definition(const Lattice& lattice, const std::vector<int>& path,
                                          std::vector<TrajectoryRow> rows) {
  count_from_path(lattice.chain(), lattice.path_of_rows(), rows);
  std::set<int> steps;
  double chords = 0, whole = 0;
  for (int k = 0; k + 1 < lattice.layers(); ++k) {
    const double chord = lattice.edge_cost(
        lattice.delta(*lattice.node(k, path[static_cast<std::size_t>(k)]),
                      *lattice.node(k + 1, path[static_cast<std::size_t>(k) + 1])));
    double along = 0;
    for (int i = lattice.layer_of_rows(k) + 1; i <= lattice.layer_of_rows(k + 1); ++i) {
      const auto row = static_cast<std::size_t>(i);
      along += lattice.edge_cost(lattice.delta(rows[row - 1].q, rows[row].q));
    }
    if (lattice.can_halve(k) && along > 1.05 * chord) steps.insert(k);
    chords += chord, whole += along;
  }
  return whole > 1.01 * chords ? steps : std::set<int>();
}

/// Searches a lattice, and halves its steps as long as the definition says so.
inline PlainAnswer plan_plainly(const PreparedRobot& robot, const PathProblem& problem,
                                std::unique_ptr<Lattice> first, const MayJoin& may_join) {
  const EdgeRule rule = robot.world().edge_rule(robot.radii());
  PlainAnswer answer;
  answer.last = std::move(first);
  for (;; ++answer.halvings) {
    const Lattice& lattice = *answer.last;
    PlainLattice plain(lattice, robot.world(), rule,
                       [&](int layer, int a, int b) { return may_join(lattice, layer, a, b); });
    const double most = has_long_step(lattice) ? answer.cost : kNone;
    const PlainSearch found = PlainKnotSearch(plain, lattice.layers() - 1, most).run();
    if (const double bound =
            has_long_step(lattice) || found.path.empty() ? found.bound : found.cost;
        bound < kNone)
      answer.bound = bound;
    std::set<int> uneven;
    if (!found.path.empty()) {
      std::vector<TrajectoryRow> rows = lattice.path_rows(found.path);
      uneven = uneven_by_definition(lattice, found.path, rows);
      const double cost = check_trajectory(robot, problem, rows).cost;
      if (cost < answer.cost) {
        answer.cost = cost;
        answer.chords = found.cost;
        answer.rows = std::move(rows);
      }
    }
    if (!found.narrow.empty() || !uneven.empty()) {
      if (uneven.empty() && answer.chords <= 1.01 * found.bound) return answer;
      uneven.insert(found.narrow.begin(), found.narrow.end());
      answer.last = lattice.with_knots(uneven, {});
      continue;
    }
    if (!answer.rows.empty()) return answer;
    // The furthest layer to which paths of valid nodes and valid short edges lead.
    PlainSearch reach;
    int deepest = lattice.layers() - 2;
    for (; deepest >= 0; --deepest)
      if (reach = PlainKnotSearch(plain, deepest, kNone).run(); reach.bound < kNone) break;
    answer.deepest = deepest;
    if (!reach.narrow.empty()) {
      answer.last = lattice.with_knots(reach.narrow, {});
    } else {
      if (deepest < 0) return answer;
      auto finer = split_about(lattice, deepest);
      if (!finer) return answer;
      answer.last = std::move(finer);
    }
  }
}

}  // namespace swivel::test
