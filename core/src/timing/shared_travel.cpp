// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/timing/shared_travel.hpp"

#include <algorithm>
#include <cmath>

#include "timing/derivative_weights.hpp"

namespace swivel {

namespace {

/// Returns a slope, between those on both sides of a knot, with which quintic polynomials whose
/// second derivatives are 0 ascend: the harmonic mean, at most twice either.
double mean_slope(double before, double after) {
  return before > 0 && after > 0 ? 2 * before * after / (before + after) : 0;
}

/// Makes the knots' slopes such that the travel ascends: where it does not, they become harmonic
/// means of those of the straight lines on both sides, and second derivatives 0.
SharedTravel ascending(std::vector<SharedTravel::Knot> knots) {
  std::vector<bool> flat(knots.size(), false);
  for (;;) {
    const SharedTravel travel(knots);
    bool all = true;
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
      if ((flat[k] && flat[k + 1]) || travel.ascends(k)) continue;
      all = false;
      flat[k] = flat[k + 1] = true;
    }
    if (all) return travel;
    const auto line = [&](std::size_t k) {
      return (knots[k + 1].travel - knots[k].travel) / (knots[k + 1].x - knots[k].x);
    };
    for (std::size_t k = 0; k < knots.size(); ++k) {
      if (!flat[k]) continue;
      const double before = line(k > 0 ? k - 1 : 0), after = line(std::min(k, knots.size() - 2));
      knots[k].slope.fill(mean_slope(before, after));
      knots[k].bend.fill(0);
    }
  }
}

/// Layers from one waypoint to the next, and the parameter along them.
struct Segment {
  int from = 0, to = 0;  // layers
  double x = 0, length = 0;
  [[nodiscard]] double at(int layer) const {
    return layer == to ? x + length : x + length * (layer - from) / (to - from);
  }
};

/// Returns the segments between layers that are waypoints of a path; of both, unless one follows.
std::vector<Segment> segments_of(const std::array<const ToolPath*, 2>& paths, int follower) {
  const int last = paths[0]->size() - 1;
  std::vector<Segment> segments;
  int from = 0;
  for (int i = 1; i <= last; ++i) {
    bool waypoint = i == last;
    for (int k = 0; k < 2; ++k)
      waypoint =
          waypoint || (k != follower && paths[static_cast<std::size_t>(k)]->layer(i).waypoint >= 0);
    if (!waypoint) continue;
    double length = 0;
    for (const ToolPath* path : paths)
      length = std::max(length, path->layer(i).travel - path->layer(from).travel);
    const double x = segments.empty() ? 0 : segments.back().x + segments.back().length;
    segments.push_back({from, i, x, length});
    from = i;
  }
  return segments;
}

/// Returns the travel along a segment, through its ends alone where it is even, else through all
/// its layers.
SharedTravel along(const ToolPath& path, const Segment& segment, bool even) {
  const auto travel = [&](int layer) { return path.layer(layer).travel; };
  if (even || segment.to - segment.from == 1) {
    const double slope = (travel(segment.to) - travel(segment.from)) / segment.length;
    return SharedTravel({{segment.x, travel(segment.from), {slope, slope}, {}},
                         {segment.at(segment.to), travel(segment.to), {slope, slope}, {}}});
  }
  std::vector<SharedTravel::Knot> knots;
  std::vector<double> xs;
  for (int i = segment.from; i <= segment.to; ++i) xs.push_back(segment.at(i));
  const auto n = static_cast<int>(xs.size());
  for (int i = 0; i < n; ++i) {
    const double x = xs[static_cast<std::size_t>(i)];
    SharedTravel::Knot knot{x, travel(segment.from + i), {}, {}};
    double slope = 0, bend = 0;
    if (n >= 5) {
      const int first = std::clamp(i - 2, 0, n - 5);
      const auto weights = derivative_weights(xs.data() + first, x);
      for (int k = 0; k < 5; ++k) {
        slope += weights(k, 1) * travel(segment.from + first + k);
        bend += weights(k, 2) * travel(segment.from + first + k);
      }
    } else {
      const int a = std::max(i - 1, 0), b = std::min(i + 1, n - 1);
      slope = (travel(segment.from + b) - travel(segment.from + a)) /
              (xs[static_cast<std::size_t>(b)] - xs[static_cast<std::size_t>(a)]);
    }
    knot.slope.fill(std::max(slope, 0.0));
    knot.bend.fill(bend);
    knots.push_back(knot);
  }
  return ascending(std::move(knots));
}

/// The travel of both arms along the segments, and how it goes on from one to the next.
class Joining {
 public:
  Joining(const std::array<const ToolPath*, 2>& paths, int follower)
      : paths_(paths), follower_(follower), segments_(segments_of(paths, follower)) {
    for (std::size_t k = 0; k < 2; ++k)
      for (const Segment& segment : segments_)
        along_[k].push_back(along(*paths[k], segment, static_cast<int>(k) != follower));
  }

  CommonParameter join(double most_reach) {
    CommonParameter common;
    reach_.assign(segments_.size(), 0);  // at the end of each segment; 0: rest
    smooth_.assign(segments_.size(), false);
    for (std::size_t j = 0; j + 1 < segments_.size(); ++j) {
      const int layer = segments_[j].to;
      smooth_[j] = change_at(j) <= kSame;
      if (rests_at(layer)) {
        smooth_[j] = false;
      } else if (!smooth_[j]) {
        reach_[j] = reach_at(j, most_reach);
        if (reach_[j] > 0) common.blended.push_back(layer);
      }
      if (!smooth_[j] && reach_[j] == 0) common.rests.push_back(layer);
    }
    for (std::size_t k = 0; k < 2; ++k) common.travel[k] = joined(k);
    return common;
  }

 private:
  static constexpr double kSame = 1e-6;  // m/m

  /// Returns the slopes of an arm's travel before and after the end of segment j.
  [[nodiscard]] std::array<double, 2> slopes(std::size_t arm, std::size_t j) const {
    return {along_[arm][j].knots().back().slope[0], along_[arm][j + 1].knots().front().slope[1]};
  }
  /// Returns by how much a slope differs from the one at the end of segment j.
  [[nodiscard]] double change_at(std::size_t j) const {
    double change = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto [before, after] = slopes(k, j);
      const double mean = mean_slope(before, after);
      change = std::max({change, std::abs(before - mean), std::abs(after - mean)});
    }
    return change;
  }
  /// Returns whether an arm must rest at a layer, since a corner is not rounded there.
  [[nodiscard]] bool rests_at(int layer) const {
    for (const ToolPath* path : paths_)
      for (const ToolPath::Corner& corner : path->corners())
        if (corner.layer == layer && !(corner.reach > 0)) return true;
    return false;
  }
  /// Returns over how much of the parameter slopes change on both sides of the end of segment j.
  [[nodiscard]] double reach_at(std::size_t j, double most_reach) const {
    constexpr double kOff = 0.05e-3;  // m: how far a follower or its leader may be off its place
    constexpr double kShortest = 0.05e-3;  // m; both arms rest where a blend would be shorter
    double reach = std::min({most_reach, segments_[j].length / 2, segments_[j + 1].length / 2});
    while (follower_ >= 0 && reach >= kShortest && off_in_blend(j, reach) > kOff) reach *= 0.8;
    return reach < kShortest ? 0 : reach;
  }
  /// Returns the most by which a blend at the end of segment j takes a tool off its place, m.
  [[nodiscard]] double off_in_blend(std::size_t j, double reach) const {
    constexpr int kSamples = 16;
    double most = 0;
    for (std::size_t arm = 0; arm < 2; ++arm)
      for (const int side : {0, 1}) {
        const SharedTravel& own = along_[arm][j + static_cast<std::size_t>(side)];
        const SharedTravel::Knot outer =
            knot_of(own, segments_[j + 1].x + (side == 0 ? -reach : reach));
        SharedTravel::Knot middle = own.knots()[side == 0 ? own.knots().size() - 1 : 0];
        const auto [before, after] = slopes(arm, j);
        middle.slope.fill(mean_slope(before, after));
        middle.bend.fill(0);
        const SharedTravel blend(side == 0 ? std::vector{outer, middle}
                                           : std::vector{middle, outer});
        for (int k = 1; k < kSamples; ++k) {
          const double x = outer.x + (middle.x - outer.x) * k / kSamples;
          most = std::max(most, std::abs(blend.travel(x) - own.travel(x)));
        }
      }
    return most;
  }
  /// Returns the knot of a travel at a parameter.
  [[nodiscard]] static SharedTravel::Knot knot_of(const SharedTravel& own, double x) {
    const auto [slope, bend] = own.derivatives(x);
    return {x, own.travel(x), {slope, slope}, {bend, bend}};
  }

  /// Returns the travel of an arm over the whole parameter.
  [[nodiscard]] SharedTravel joined(std::size_t arm) const {
    std::vector<SharedTravel::Knot> knots;
    std::vector<SharedTravel::Blend> blends;
    for (std::size_t j = 0; j < segments_.size(); ++j) {
      const Segment& segment = segments_[j];
      const SharedTravel& own = along_[arm][j];
      const double begin = segment.x + (j > 0 ? reach_[j - 1] : 0),
                   end = segment.x + segment.length - reach_[j];
      if (j == 0) knots.push_back(own.knots().front());
      if (begin > segment.x) knots.push_back(knot_of(own, begin));
      for (const SharedTravel::Knot& knot : own.knots())
        if (knot.x > begin + kNear && knot.x < end - kNear) knots.push_back(knot);
      if (j + 1 == segments_.size()) {
        knots.push_back(own.knots().back());
        continue;
      }
      if (reach_[j] > 0 && end > begin + kNear) knots.push_back(knot_of(own, end));
      knots.push_back(at_end(arm, j));
      if (reach_[j] > 0) blends.push_back({segment.x + segment.length, reach_[j]});
    }
    return SharedTravel(std::move(knots), std::move(blends));
  }
  /// Returns the knot of an arm at the end of segment j, where another one begins.
  [[nodiscard]] SharedTravel::Knot at_end(std::size_t arm, std::size_t j) const {
    const SharedTravel::Knot &before = along_[arm][j].knots().back(),
                             &after = along_[arm][j + 1].knots().front();
    SharedTravel::Knot knot = before;
    const auto [slope_before, slope_after] = slopes(arm, j);
    if (smooth_[j]) {
      knot.slope.fill((slope_before + slope_after) / 2);
      knot.bend.fill((before.bend[0] + after.bend[1]) / 2);
    } else if (reach_[j] > 0) {
      knot.slope.fill(mean_slope(slope_before, slope_after));
      knot.bend.fill(0);
    } else {
      knot.slope = {slope_before, slope_after};
      knot.bend = {before.bend[0], after.bend[1]};
    }
    return knot;
  }

  static constexpr double kNear = 1e-9;  // m

  std::array<const ToolPath*, 2> paths_;
  int follower_;
  std::vector<Segment> segments_;
  std::array<std::vector<SharedTravel>, 2> along_;  // of arms and segments
  std::vector<double> reach_;
  std::vector<bool> smooth_;
};

}  // namespace

SharedTravel::SharedTravel(std::vector<Knot> knots, std::vector<Blend> blends)
    : knots_(std::move(knots)), blends_(std::move(blends)) {
  for (std::size_t k = 0; k + 1 < knots_.size(); ++k) {
    const Knot &a = knots_[k], &b = knots_[k + 1];
    Piece piece;
    const double h = piece.length = b.x - a.x;
    const double first = h * a.slope[1], second = h * h * a.bend[1] / 2;
    // What is left of value, slope and second derivative at the end.
    const double d0 = b.travel - a.travel - first - second,
                 d1 = h * b.slope[0] - first - 2 * second, d2 = h * h * b.bend[0] - 2 * second;
    piece.c = {a.travel,
               first,
               second,
               10 * d0 - 4 * d1 + d2 / 2,
               -15 * d0 + 7 * d1 - d2,
               6 * d0 - 3 * d1 + d2 / 2};
    pieces_.push_back(piece);
  }
}

SharedTravel::At SharedTravel::at(double x) const {
  const auto after =
      std::upper_bound(knots_.begin() + 1, knots_.end() - 1, x,
                       [](double value, const Knot& knot) { return value < knot.x; });
  const auto k = static_cast<std::size_t>(after - knots_.begin()) - 1;
  return {k, std::clamp((x - knots_[k].x) / pieces_[k].length, 0.0, 1.0)};
}

double SharedTravel::travel(double x) const {
  const auto [k, u] = at(x);
  if (u == 1) return knots_[k + 1].travel;
  const auto& c = pieces_[k].c;
  const double value = c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * (c[4] + u * c[5]))));
  return std::clamp(value, knots_[k].travel, knots_[k + 1].travel);
}

std::array<double, 2> SharedTravel::derivatives(double x) const {
  const auto [k, u] = at(x);
  const auto& c = pieces_[k].c;
  const double h = pieces_[k].length;
  return {(c[1] + u * (2 * c[2] + u * (3 * c[3] + u * (4 * c[4] + u * 5 * c[5])))) / h,
          (2 * c[2] + u * (6 * c[3] + u * (12 * c[4] + u * 20 * c[5]))) / (h * h)};
}

double SharedTravel::parameter(double travel) const {
  const auto after =
      std::lower_bound(knots_.begin() + 1, knots_.end() - 1, travel,
                       [](const Knot& knot, double value) { return knot.travel < value; });
  const auto k = static_cast<std::size_t>(after - knots_.begin()) - 1;
  if (travel <= knots_[k].travel) return knots_[k].x;
  if (travel >= knots_[k + 1].travel) return knots_[k + 1].x;
  double low = knots_[k].x, high = knots_[k + 1].x;
  constexpr int kHalvings = 60;
  for (int n = 0; n < kHalvings; ++n) {
    const double middle = low + (high - low) / 2;
    (this->travel(middle) < travel ? low : high) = middle;
  }
  return high;
}

bool SharedTravel::ascends(std::size_t k) const {
  constexpr int kSamples = 16;
  const Piece& piece = pieces_[k];
  for (int n = 0; n <= kSamples; ++n) {
    const double u = static_cast<double>(n) / kSamples;
    const auto& c = piece.c;
    if (c[1] + u * (2 * c[2] + u * (3 * c[3] + u * (4 * c[4] + u * 5 * c[5]))) < 0) return false;
  }
  return true;
}

CommonParameter common_parameter(const std::array<const ToolPath*, 2>& paths, int follower,
                                 double most_reach) {
  return Joining(paths, follower).join(most_reach);
}

}  // namespace swivel
