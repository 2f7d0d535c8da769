// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "swivel/collision/world/world.hpp"

namespace swivel {

double EdgeRule::motion(const Config& q0, const Config& q1, int first, int last) const {
  double bound = 0;
  for (int j = first; j < last; ++j) bound += std::abs(q1[j] - q0[j]) * radii[j];
  return bound;
}

double EdgeRule::tangent_deviation(const Config& dq) const {
  double sum = 0, before = 0;             // of joints before j
  double followers_move = 0, in_all = 0;  // m, rad
  for (int j = 0; j < kDof; ++j) {
    const double turn = std::abs(dq[j]);
    sum += turn * (2 * before + turn) * radii[j];
    before += turn;
    followers_move += turn * followers.reach[j];
    in_all += turn * (1 + followers.turns[j]);
  }
  return sum / 2 + followers_move * in_all;
}

std::int64_t EdgeRule::midpoints(const Config& q0, const Config& q1, double tolerance) const {
  const double bound = motion(q0, q1);
  std::int64_t n = 1;
  while (bound / (2.0 * static_cast<double>(n)) > tolerance) n *= 2;
  return n;
}

namespace {

/// Searches the motion from q0 to q1 for a pair that is too near, by bisection down to `leaves`
/// midpoints. below(q, threshold, suspected, segment) returns a pair that is too near at q, or
/// none; if `segment` is not null, what it asks of a pair is limited to how much nearer the pair
/// can come on that segment about q. No pair comes nearer by more than `bound`, m, on the whole
/// motion, and no point's path leaves its tangent by more than `tangent_deviation`, m, on half of
/// it. Throws Stopped.
template <class Below>
std::optional<BodyPair> bisect(const Config& q0, const Config& q1, std::int64_t leaves,
                               double bound, double tangent_deviation, const Budget& budget,
                               const Below& below) {
  const double step = bound / static_cast<double>(leaves);
  const Config delta = q1 - q0;

  // first leaves of the intervals of this size that are not decided yet
  std::vector<std::int64_t> open{0}, next;
  for (std::int64_t size = leaves; !open.empty(); size /= 2) {
    const double half_bound = step * static_cast<double>(size) / 2;
    const double share = static_cast<double>(size) / static_cast<double>(leaves);
    // The bounds hold up to the ends of the interval, half a leaf beyond its outermost midpoints.
    // This half leaf must cover FCL's error.
    const MotionSegment segment{share / 2 * delta, share * share * tangent_deviation, step / 2};
    next.clear();
    for (const std::int64_t first : open) {
      budget.poll();
      const double middle = (static_cast<double>(first) + static_cast<double>(size) / 2) /
                            static_cast<double>(leaves);
      const Config q = q0 + middle * delta;
      if (size == 1) {
        if (const auto pair = below(q, ClearanceRule::kMidpoint, std::nullopt, nullptr))
          return pair;
        continue;
      }
      const auto suspected =
          below(q, Threshold(ClearanceRule::kMidpoint, half_bound), std::nullopt, &segment);
      if (!suspected) continue;
      if (const auto pair = below(q, ClearanceRule::kMotion, suspected, nullptr)) return pair;
      next.push_back(first);
      next.push_back(first + size / 2);
    }
    open.swap(next);
  }
  return std::nullopt;
}

/// Returns the distance, m, that a level requires of a pair that has a rule of its own.
double distance_of(const Threshold& threshold, const EdgeRule::Near& pair) {
  return pair.d_edge + (threshold.rule == ClearanceRule::kMidpoint ? pair.h : 0) + threshold.more;
}

bool blocked_by(const EdgeRule::Near& near, World::Query& query, const EdgeRule& rule,
                const Config& q0, const Config& q1, const Budget& budget) {
  const auto this_one = [&](const Config& q, const Threshold& threshold,
                            const std::optional<BodyPair>&, const MotionSegment*) {
    return query.pair_violates(q, near.pair, distance_of(threshold, near))
               ? std::optional(near.pair)
               : std::nullopt;
  };
  const double bound = rule.motion(q0, q1, near.first_joint, near.last);
  return bisect(q0, q1, rule.midpoints(q0, q1, near.h), bound, 0, budget, this_one).has_value();
}

}  // namespace

std::optional<BodyPair> edge_blocked(World::Query& query, const EdgeRule& rule, const Config& q0,
                                     const Config& q1, const Budget& budget, double* slack) {
  if (slack) *slack = std::numeric_limits<double>::infinity();
  const auto any = [&](const Config& q, const Threshold& threshold,
                       const std::optional<BodyPair>& suspected, const MotionSegment* segment) {
    const auto pair = segment ? query.find_violating_pair_over_motion(*segment, q, threshold)
                              : query.find_violating_pair_incremental(q, threshold, suspected);
    // The test at ClearanceRule::kMotion only decides whether to bisect further; it proves nothing
    // about the slack.
    if (slack && !pair && threshold.rule == ClearanceRule::kMidpoint)
      *slack = std::min(*slack, query.slack(threshold));
    return pair;
  };
  if (const auto pair = bisect(q0, q1, rule.midpoints(q0, q1), rule.motion(q0, q1),
                               rule.tangent_deviation((q1 - q0) / 2), budget, any))
    return pair;
  for (const EdgeRule::Near& near : rule.near)
    if (blocked_by(near, query, rule, q0, q1, budget)) return near.pair;
  if (slack && !rule.near.empty()) *slack = 0;  // the slack of these pairs is unknown
  return std::nullopt;
}

bool edge_blocked_by(const BodyPair& pair, World::Query& query, const EdgeRule& rule,
                     const Config& q0, const Config& q1, const Budget& budget) {
  for (const EdgeRule::Near& near : rule.near)
    if (near.pair == pair) return blocked_by(near, query, rule, q0, q1, budget);
  const auto this_one = [&](const Config& q, const Threshold& threshold,
                            const std::optional<BodyPair>&, const MotionSegment*) {
    return query.pair_violates(q, pair, threshold) ? std::optional(pair) : std::nullopt;
  };
  return bisect(q0, q1, rule.midpoints(q0, q1), rule.motion(q0, q1), 0, budget, this_one)
      .has_value();
}

}  // namespace swivel
