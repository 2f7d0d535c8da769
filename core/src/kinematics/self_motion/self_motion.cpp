// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/self_motion/self_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kinematics/self_motion/self_motion_arcs.hpp"
#include "kinematics/self_motion/self_motion_curves.hpp"

namespace swivel {

using namespace self_motion;

namespace {

constexpr int kSeeds = 32;  // lock values, evenly spread over a turn
// m: lock values of a slide, evenly spread over its range, are at most this far apart
constexpr double kSeedStep = 0.0625;
// rad by which a range must exceed a turn, so that the joint is a circle
constexpr double kSliver = 1e-3;
constexpr double kLeastWeight = 1e-2;  // of the largest
constexpr int kStarts = 96;            // starts of Newton, where there is no closed form
constexpr int kImageSteps = 6;         // Newton steps from a node to its image
constexpr double kSymmetric = 1e-11;   // rad by which a limit may miss the twin of the other
// rad of self-motion by which an image may leave the nearest one
constexpr double kMostDrift = 0.2;

/// Returns the flip of the three axes that meet in every closed form, none where those are not the
/// chain's own.
Flip flip_of(const Chain& chain, int lock, const std::vector<Alignment>& alignments,
             const std::vector<std::pair<double, ClosedForm>>& forms) {
  constexpr double kPerpendicular = 1e-12;  // cosine
  if (forms.empty()) return {};
  const ClosedFormFit& fit = forms.front().second.fit();
  const bool one = std::all_of(forms.begin(), forms.end(), [&](const auto& form) {
    return form.second.fit().exact && form.second.fit().structure == fit.structure &&
           form.second.fit().first == fit.first;
  });
  if (!one || fit.structure == Structure::kParallel) return {};
  const int first = fit.first < lock ? fit.first : fit.first + 1;
  if (first < lock && lock <= first + 2) return {};  // the lock is among the three
  const auto axis = [&](int joint) { return chain.axis[static_cast<std::size_t>(joint)]; };
  if (std::abs(axis(first).dot(axis(first + 1))) > kPerpendicular ||
      std::abs(axis(first + 1).dot(axis(first + 2))) > kPerpendicular)
    return {};
  const auto at = std::find_if(alignments.begin(), alignments.end(),
                               [&](const Alignment& a) { return a.joint == first + 1; });
  return at == alignments.end() ? Flip() : Flip(first, at->angle);
}

/// Returns true if the flip of every configuration within the limits is within them too.
bool keeps_limits(const Chain& chain, const SelfMotionData& data) {
  const Flip& flip = data.flip;
  if (flip.none()) return false;
  const auto first = static_cast<std::size_t>(flip.first());
  if (chain.roll && first + 2 == kDof - 1) return false;  // it turns the tool
  return data.circle[first] && data.circle[first + 2] &&
         (data.circle[first + 1] ||
          std::abs(wrap_angle(data.lower[first + 1] + data.upper[first + 1] - 2 * flip.aligned())) <
              kSymmetric);
}

/// Returns the values at which a joint is locked: all round, or, of a slide, from end to end, both
/// included, so that no curve passes an end unseen.
std::vector<double> lock_values(const Chain& chain, int lock) {
  std::vector<double> values;
  const JointLimit& limit = chain.limit[static_cast<std::size_t>(lock)];
  if (limit.slides) {
    const double range = limit.upper - limit.lower;
    const int parts = std::max(kSeeds - 1, static_cast<int>(std::ceil(range / kSeedStep)));
    for (int k = 0; k < parts; ++k) values.push_back(limit.lower + k * (range / parts));
    values.push_back(limit.upper);
    return values;
  }
  // Half a cell from 0, so that no value is a multiple of 90 degrees.
  for (int k = 0; k < kSeeds; ++k) values.push_back(kTwoPi * (k + 0.5) / kSeeds - kPi);
  return values;
}

}  // namespace

SelfMotion::SelfMotion(const Chain& chain, const LockMethod& method, double margin,
                       const std::array<double, kDof>& weights) {
  auto data = std::make_unique<SelfMotionData>(chain);
  // Without a lock any joint serves: it decides where closed arcs begin.
  data->lock = method.best >= 0 ? method.best : 2;
  data->other = data->lock == 0 ? 1 : 0;
  data->slide = chain.slide();
  const double largest = *std::max_element(weights.begin(), weights.end());
  for (std::size_t j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[j];
    data->lower[j] = limit.lower + margin;
    data->upper[j] = limit.upper - margin;
    const double range = data->upper[j] - data->lower[j];
    data->circle[j] = limit.continuous || (!limit.slides && range > kTwoPi + kSliver);
    if (!limit.slides && range > kTwoPi) data->upper[j] = data->lower[j] + kTwoPi;
    const double weight = largest > 0 ? std::max(kLeastWeight, weights[j] / largest) : 1;
    data->scale[static_cast<Eigen::Index>(j)] = weight;
    data->scale2[static_cast<Eigen::Index>(j)] = weight * weight;
  }
  data->alignments = alignments_of(chain);
  for (int k = 1; method.best < 0 && k <= kStarts; ++k) {
    // Kronecker points: multiples of square roots
    constexpr std::array<double, kDof> kPrime = {2, 3, 5, 7, 11, 13, 17};
    Config& start = data->starts.emplace_back();
    for (std::size_t j = 0; j < kDof; ++j) {
      const double turns = k * std::sqrt(kPrime[j]), part = turns - std::floor(turns);
      const double low = data->circle[j] ? -kPi : data->lower[j],
                   high = data->circle[j] ? kPi : data->upper[j];
      start[static_cast<Eigen::Index>(j)] = low + part * (high - low);
    }
  }
  if (method.best >= 0) {
    for (const double value : lock_values(chain, data->lock))
      if (auto form = ClosedForm::of(lock_joint(chain, data->lock, value)))
        data->forms.emplace_back(value, *form);
  }
  data->flip = flip_of(chain, data->lock, data->alignments, data->forms);
  data->flip_keeps_limits = keeps_limits(chain, *data);
  data_ = std::move(data);
}

SelfMotion::~SelfMotion() = default;

std::vector<SelfMotionArc> SelfMotion::curves(const Pose& tool) const {
  std::vector<SelfMotionArc> result;
  find_curves(*data_, tool, {}, [&](std::vector<Point>& points, bool closed) {
    for (int side = 0; side < (data_->flip.none() ? 1 : 2); ++side) {
      SelfMotionArc& arc = result.emplace_back();
      arc.closed = closed;
      arc.slide = data_->slide;
      for (Point& p : points) {
        if (side == 1) data_->flip.apply(p);
        arc.q.push_back(p.q);
        arc.tangent.push_back(p.tangent);
      }
    }
  });
  return result;
}

std::vector<SelfMotionArc> SelfMotion::arcs(const Pose& tool, std::span<const Config> known,
                                            Flipped flipped) const {
  const bool both = !data_->flip.none() && !(data_->flip_keeps_limits && flipped == Flipped::kOne);
  std::vector<SelfMotionArc> result;
  find_curves(*data_, tool, known, [&](std::vector<Point>& points, bool closed) {
    cut_at_limits(*data_, tool, points, closed, result);
    if (!both) return;
    for (Point& p : points) data_->flip.apply(p);
    cut_at_limits(*data_, tool, points, closed, result);
  });
  std::stable_sort(
      result.begin(), result.end(),
      [](const SelfMotionArc& a, const SelfMotionArc& b) { return less(a.q[0], b.q[0]); });
  return result;
}

bool SelfMotion::has_flipped_arcs() const {
  return data_->flip_keeps_limits;
}

bool SelfMotion::is_flipped(const Config& q) const {
  return data_->flip_keeps_limits && !data_->flip.kept(q);
}

Config SelfMotion::flipped(Config q) const {
  data_->flip.apply(q);
  for (std::size_t j = 0; j < kDof; ++j) {
    double& value = q[static_cast<Eigen::Index>(j)];
    value = data_->image(value, j);
    // The twin of a limit is a limit, but for rounding.
    const double limit = std::clamp(value, data_->lower[j], data_->upper[j]);
    if (!data_->circle[j] && std::abs(value - limit) < kSymmetric) value = limit;
  }
  return q;
}

std::optional<Config> SelfMotion::image(const Config& q, const Pose& tool) const {
  const auto p = data_->newton.nearest(q, tool, data_->scale2, kImageSteps);
  return p ? p->q : data_->image_past_alignment(q, tool);
}

namespace {

/// Returns the x, |x| <= most, at which the largest weighted joint of the move  move + x along  is
/// least; of several the one nearest 0. That maximum of fourteen lines is convex: the search goes
/// downhill from 0, from corner to corner.
double least_largest(const Config& move, const Config& along, const Config& weight, double most) {
  std::array<double, 2 * kDof> value, slope;
  for (int j = 0; j < kDof; ++j)
    for (const int sign : {1, -1}) {
      const auto line = static_cast<std::size_t>(2 * j + (sign < 0 ? 1 : 0));
      value[line] = sign * weight[j] * move[j];
      slope[line] = sign * weight[j] * along[j];
    }
  double top = *std::max_element(value.begin(), value.end());
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  double right = kNone, left = kNone;  // steepest of the topmost lines, to either side
  for (std::size_t k = 0; k < value.size(); ++k) {
    if (value[k] < top) continue;
    right = std::max(right, slope[k]);
    left = std::max(left, -slope[k]);
  }
  if (right >= 0 && left >= 0) return 0;
  const double way = right < 0 ? 1 : -1;
  double x = 0, steep = right < 0 ? right : left;
  while (steep < 0 && x < most) {
    double until = most - x, next = steep;
    for (std::size_t k = 0; k < value.size(); ++k) {
      const double rise = way * slope[k];
      if (rise <= steep) continue;
      const double corner = std::max(0.0, (top - (value[k] + x * rise)) / (rise - steep));
      if (corner >= until) continue;
      until = corner;
      next = rise;
    }
    x += until;
    top += steep * until;
    if (next == steep) break;
    steep = next;
  }
  return way * x;
}

/// Returns the x, |x| <= most, at which the sum of the weighted joints' moves in  move + x along is
/// least; of several the one nearest 0. The sum is convex and bends where a joint stands still.
double least_sum(const Config& move, const Config& along, const Config& weight, double most) {
  const auto sum = [&](double x) {
    double moves = 0;
    for (int j = 0; j < kDof; ++j) moves += weight[j] * std::abs(move[j] + x * along[j]);
    return moves;
  };
  double best = 0, least = sum(0);
  for (int j = 0; j < kDof; ++j) {
    if (along[j] == 0) continue;
    const double x = std::clamp(-move[j] / along[j], -most, most), moves = sum(x);
    if (moves < least || (moves == least && std::abs(x) < std::abs(best))) best = x, least = moves;
  }
  return best;
}

}  // namespace

std::vector<std::optional<Config>> SelfMotion::images(std::span<const Config> q, const Pose& tool,
                                                      Least least) const {
  PoseNewton::Points found;
  data_->newton.nearest(q, tool, data_->scale2, kImageSteps, found);
  if (least != Least::kNorm) {
    const auto drift = least == Least::kSum ? least_sum : least_largest;
    std::vector<Config> guesses = found.q;
    for (std::size_t k = 0; k < q.size(); ++k)
      if (found.found[k] != 0)
        guesses[k] +=
            drift(found.q[k] - q[k], found.tangent[k], data_->scale, kMostDrift) * found.tangent[k];
    PoseNewton::Points drifted;
    data_->newton.nearest(guesses, tool, data_->scale2, kImageSteps, drifted);
    for (std::size_t k = 0; k < q.size(); ++k)
      if (found.found[k] != 0 && drifted.found[k] != 0) found.q[k] = drifted.q[k];
  }
  std::vector<std::optional<Config>> result(q.size());
  for (std::size_t k = 0; k < q.size(); ++k)
    result[k] = found.found[k] != 0 ? found.q[k] : data_->image_past_alignment(q[k], tool);
  return result;
}

std::optional<Config> SelfMotion::point(const SelfMotionArc& arc, int chord, double u,
                                        const Pose& tool) const {
  const auto p = data_->newton.nearest(arc.at(chord, u), tool, kPlain, kImageSteps);
  if (!p) return std::nullopt;
  Config q = p->q;
  if (!canonical(q)) return std::nullopt;
  return q;
}

std::optional<Config> SelfMotion::with_joint_at(const Config& q, const Pose& tool, int joint,
                                                double value) const {
  const auto p = data_->newton.with_joint_at(q, tool, joint, value);
  if (!p) return std::nullopt;
  Config found = p->q;
  if (!canonical(found)) return std::nullopt;
  return found;
}

bool SelfMotion::is_aligned(const Config& q) const {
  return data_->aligned(q);
}

bool SelfMotion::canonical(Config& q) const {
  bool inside = true;
  for (std::size_t j = 0; j < kDof; ++j) {
    double& value = q[static_cast<Eigen::Index>(j)];
    value = data_->image(value, j);
    inside = inside && (data_->circle[j] || (value >= data_->lower[j] && value <= data_->upper[j]));
  }
  return inside;
}

const std::array<bool, kDof>& SelfMotion::circles() const {
  return data_->circle;
}

Config SelfMotionArc::at(int chord, double u) const {
  const auto k = static_cast<std::size_t>(chord), next = (k + 1) % q.size();
  return q[k] + Cubic({q[k], tangent[k]}, {q[next], tangent[next]}, 1, slide).at(u);
}

}  // namespace swivel
