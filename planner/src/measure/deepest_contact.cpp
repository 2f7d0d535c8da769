// SPDX-License-Identifier: BSD-3-Clause
#include "measure/deepest_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swivel {

namespace {

// m, how much deeper a contact between postures may be than the one found
constexpr double kBetween = 0.5e-3;
constexpr double kTouching = 1e-6;       // m
constexpr double kShortest = 1. / 1024;  // of a move

class Search {
 public:
  Search(const World& world, const EdgeRule& rule, const std::vector<Config>& rows,
         const Budget& budget)
      : world_(world),
        rule_(rule),
        rows_(rows),
        budget_(budget),
        query_(world, DistanceProofs::kOn) {}

  std::optional<DeepestContact> run() {
    double at_most = 0;
    for (const AllowedPair& allowed : world_.allowed()) {
      at_rows(allowed);
      if (!is_bounded_) continue;
      for (std::size_t k = 1; k < rows_.size(); ++k) settle(allowed, k - 1, 0, 1);
      at_most = std::max(at_most, to_prove(allowed));
    }
    if (!found_) return std::nullopt;
    if (is_complete_) found_->at_most = std::max(at_most, beyond_);
    return found_;
  }

 private:
  void at_rows(const AllowedPair& allowed) {
    is_bounded_ = true;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      budget_.poll(Stage::kMeasuring, static_cast<std::int64_t>(k),
                   static_cast<std::int64_t>(rows_.size()));
      if (!std::isfinite(look(allowed, k, rows_[k], deepest_).at_most))
        is_bounded_ = is_complete_ = false;
    }
  }

  /// Returns the depth that contacts are to be proved not to exceed, m: the allowed one, if what
  /// was found leaves room for that.
  [[nodiscard]] double to_prove(const AllowedPair& allowed) const {
    const double most = deepest_ + kBetween;
    return allowed.depth ? std::max(deepest_ + kVerdictBand, std::min(most, *allowed.depth)) : most;
  }

  Depth look(const AllowedPair& allowed, std::size_t row, const Config& q, double from) {
    const Depth depth = query_.depth(q, allowed.pair, from);
    if (depth.at_least > deepest_) {
      deepest_ = depth.at_least;
      found_ = {deepest_, std::nullopt, world_.names(allowed.pair), allowed.depth,
                static_cast<int>(row)};
    }
    return depth;
  }

  /// Bounds how deep two bodies come on the move from a row to the next, between two shares of that
  /// move.
  void settle(const AllowedPair& allowed, std::size_t row, double from, double to) {
    budget_.poll();
    const Config &first = rows_[row], &next = rows_[row + 1];
    const double reach = (to - from) / 2 * rule_.motion(first, next), middle = (from + to) / 2;
    const Depth depth =
        look(allowed, row, first + middle * (next - first), to_prove(allowed) - reach);
    if (depth.at_most + reach <= to_prove(allowed)) return;
    if (!std::isfinite(depth.at_most)) {
      is_complete_ = false;
      return;
    }
    if (to - from <= kShortest) {
      beyond_ = std::max(beyond_, depth.at_most + reach);
      return;
    }
    settle(allowed, row, from, middle);
    settle(allowed, row, middle, to);
  }

  const World& world_;
  const EdgeRule& rule_;
  const std::vector<Config>& rows_;
  const Budget& budget_;
  World::Query query_;
  bool is_bounded_ = true;   // for the present pair
  bool is_complete_ = true;  // for all pairs so far
  double deepest_ = kTouching, beyond_ = 0;
  std::optional<DeepestContact> found_;
};

}  // namespace

std::optional<DeepestContact> deepest_contact(const World& world, const EdgeRule& rule,
                                              const std::vector<Config>& rows,
                                              const Budget& budget) {
  if (world.allowed().empty()) return std::nullopt;
  return Search(world, rule, rows, budget).run();
}

}  // namespace swivel
