// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <vector>

#include "swivel/collision/world.hpp"

namespace swivel {

double EdgeRule::motion(const Config& q0, const Config& q1) const {
  double bound = 0;
  for (int j = 0; j < kDof; ++j) bound += std::abs(q1[j] - q0[j]) * radii[static_cast<std::size_t>(j)];
  return bound;
}

std::int64_t EdgeRule::midpoints(const Config& q0, const Config& q1) const {
  const double bound = motion(q0, q1);
  std::int64_t n = 1;
  while (bound / (2.0 * static_cast<double>(n)) > h) n *= 2;
  return n;
}

std::optional<BodyPair> edge_blocked(World::Query& query, const EdgeRule& rule, const Config& q0, const Config& q1,
                                     const Budget& budget) {
  const std::int64_t leaves = rule.midpoints(q0, q1);
  const double step = rule.motion(q0, q1) / static_cast<double>(leaves);
  const Config delta = q1 - q0;

  query.forget();
  std::vector<std::int64_t> open{0}, next;  // first leaves of the intervals of this size that are not decided yet
  for (std::int64_t size = leaves; !open.empty(); size /= 2) {
    const double half_bound = step * static_cast<double>(size) / 2;
    next.clear();
    for (const std::int64_t first : open) {
      budget.poll();
      const double middle = (static_cast<double>(first) + static_cast<double>(size) / 2) / static_cast<double>(leaves);
      const Config q = q0 + middle * delta;
      if (size == 1) {
        if (const auto pair = query.next_below(q, rule.d_edge + rule.h)) return pair;
        continue;
      }
      const auto near = query.next_below(q, rule.d_edge + rule.h + half_bound);
      if (!near) continue;
      if (const auto pair = query.next_below(q, rule.d_edge, near)) return pair;
      next.push_back(first);
      next.push_back(first + size / 2);
    }
    open.swap(next);
  }
  return std::nullopt;
}

std::optional<BodyPair> edge_blocked_plain(World::Query& query, const EdgeRule& rule, const Config& q0, const Config& q1) {
  const std::int64_t leaves = rule.midpoints(q0, q1);
  const Config delta = q1 - q0;
  for (std::int64_t m = 0; m < leaves; ++m) {
    const double t = (static_cast<double>(m) + 0.5) / static_cast<double>(leaves);
    if (const auto pair = query.first_below(q0 + t * delta, rule.d_edge + rule.h)) return pair;
  }
  return std::nullopt;
}

}  // namespace swivel
