// SPDX-License-Identifier: BSD-3-Clause
#include "first_too_near.hpp"

#include <algorithm>

namespace swivel {

namespace {

class Rows {
 public:
  Rows(const World& world, const EdgeRule& rule, const Limits& limits, const std::vector<Config>& rows, const Budget& budget)
      : rows_(&rows),
        rule_(&rule),
        query_(world, Certificates::kOn),
        budget_(&budget),
        asks_motions_(limits.edges == EdgeMode::kContinuous),
        rows_tell_motions_(!asks_motions_ || (limits.d_edge() <= limits.clearance && limits.d_self_edge() <= limits.d_self())) {
    for (std::size_t k = 0; k < rows.size(); ++k) moved_.push_back(k == 0 ? 0 : moved_.back() + rule.motion(rows[k - 1], rows[k]));
  }

  /// From row `first` to row `last`, in order; `first` itself only where it is the first of all.
  std::optional<TooNear> find(std::size_t first, std::size_t last) {
    budget_->poll();
    const std::size_t middle = (first + last) / 2;
    if (rows_tell_motions_ && last > first) {
      const double most = std::max(moved_[middle] - moved_[first], moved_[last] - moved_[middle]);
      if (!query_.next_below((*rows_)[middle], Level(Keep::kNode, most))) return std::nullopt;
    }
    if (last > first + 1) {
      auto found = find(first, middle);
      return found ? found : find(middle, last);
    }
    if (first == 0)
      if (const auto pair = query_.next_below((*rows_)[0], Keep::kNode)) return TooNear{0, *pair};
    if (last == first) return std::nullopt;
    if (const auto pair = query_.next_below((*rows_)[last], Keep::kNode)) return TooNear{last, *pair};
    if (asks_motions_)
      if (const auto pair = edge_blocked(query_, *rule_, (*rows_)[first], (*rows_)[last], *budget_))
        return TooNear{last, *pair, true};
    return std::nullopt;
  }

 private:
  const std::vector<Config>* rows_;
  const EdgeRule* rule_;
  World::Query query_;
  const Budget* budget_;
  bool asks_motions_, rows_tell_motions_;
  std::vector<double> moved_;  // up to each row: a bound on the way of any point, m
};

}  // namespace

std::optional<TooNear> first_too_near(const World& world, const EdgeRule& rule, const Limits& limits,
                                      const std::vector<Config>& rows, const Budget& budget) {
  if (rows.empty()) return std::nullopt;
  return Rows(world, rule, limits, rows, budget).find(0, rows.size() - 1);
}

}  // namespace swivel
