// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/motion/arc_lengths.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/newton/pose_newton.hpp"

namespace swivel {

namespace {

constexpr int kNewtonSteps = 6;

}  // namespace

ArcLengths::ArcLengths(const Chain& chain, const ToolPath& path, std::vector<Config> origins)
    : newton_(std::make_unique<PoseNewton>(chain)), path_(&path) {
  for (std::size_t i = 0; i < origins.size(); ++i) {
    Curve& curve = curves_.emplace_back();
    PoseNewton::Linear at;
    const Pose& tool = path.layer(static_cast<int>(i)).tool;
    if (chain.roll_fixed || !newton_->linear(origins[i], tool, at)) {
      curve.ended = {true, true};
      for (auto& side : curve.side) side.push_back({origins[i], Config::Zero(), 0});
      continue;
    }
    const Config tangent = at.null / joint_norm(at.null);
    curve.side[0].push_back({origins[i], tangent, 0});
    curve.side[1].push_back({origins[i], -tangent, 0});
  }
}

ArcLengths::~ArcLengths() = default;

/// Adds a point to the end of one side of a curve. Returns false where the curve ends.
bool ArcLengths::follow(Curve& curve, std::size_t side, const Pose& tool) const {
  constexpr double kLongest = 0.1, kShortest = 1e-3;  // rad
  // cosine of the turn of the tangent; of the step
  constexpr double kStraight = 0.97, kAside = 0.2;
  if (curve.ended[side]) return false;
  const Point& last = curve.side[side].back();
  for (double step = kLongest; step >= kShortest; step /= 2) {
    const Config guess = last.q + step * last.tangent;
    const auto found = newton_->nearest(guess, tool, Config::Ones(), kNewtonSteps);
    if (!found || joint_norm(found->q - guess) > kAside * step) continue;
    const double turn = joint_dot(found->tangent, last.tangent);
    if (std::abs(turn) < kStraight) continue;
    // The length of the circle arc through both points with these tangents.
    const double half = std::acos(std::min(1.0, std::abs(turn))) / 2,
                 chord = joint_norm(found->q - last.q);
    const double length = half > 1e-6 ? chord * half / std::sin(half) : chord;
    curve.side[side].push_back(
        {found->q, turn < 0 ? Config(-found->tangent) : found->tangent, last.length + length});
    return true;
  }
  curve.ended[side] = true;
  return false;
}

std::optional<ArcLengths::Point> ArcLengths::point(int layer, double length) const {
  Curve& curve = curves_[static_cast<std::size_t>(layer)];
  const std::size_t side = length < 0 ? 1 : 0;
  const std::vector<Point>& points = curve.side[side];
  const Point& origin = points.front();
  if (origin.tangent.isZero()) return origin;
  const Pose& tool = path_->layer(layer).tool;
  const double away = std::abs(length);
  while (points.back().length < away || points.size() < 2)
    if (!follow(curve, side, tool)) return std::nullopt;
  const auto after =
      std::upper_bound(points.begin() + 1, points.end() - 1, away,
                       [](double value, const Point& point) { return value < point.length; });
  const Point &a = *(after - 1), &b = *after;
  const double h = b.length - a.length, u = (away - a.length) / h;
  const Config chord = b.q - a.q, m0 = h * a.tangent, m1 = h * b.tangent;
  const Config guess =
      a.q + u * m0 + (u * u) * (3 * chord - 2 * m0 - m1) + (u * u * u) * (m0 + m1 - 2 * chord);
  const auto near = newton_->nearest(guess, tool, Config::Ones(), kNewtonSteps);
  if (!near) return std::nullopt;
  // One step more: second derivatives are differences of these digits.
  const auto exact = newton_->nearest(near->q, tool, Config::Ones(), 1);
  const PoseNewton::Point& found = exact ? *exact : *near;
  const bool turned = joint_dot(found.tangent, a.tangent) < 0;
  return Point{found.q, turned ? Config(-found.tangent) : found.tangent, length};
}

std::optional<Config> ArcLengths::joints(int layer, double length) const {
  const auto found = point(layer, length);
  if (!found) return std::nullopt;
  return found->q;
}

double ArcLengths::between(int layer, int before, double x, int after, double y) const {
  constexpr int kSteps = 60;
  constexpr double kLongest = 0.2, kSettled = 1e-7, kOnCurve = 1e-5;  // rad
  const auto from = joints(before, x), to = joints(after, y);
  if (!from || !to) return 0;
  const double t = (travel(layer) - travel(before)) / (travel(after) - travel(before));
  const auto goal = newton_->nearest(*from + t * (*to - *from), path_->layer(layer).tool,
                                     Config::Ones(), kNewtonSteps);
  double length = 0;
  for (int step = 0; goal && step < kSteps; ++step) {
    const auto here = point(layer, length);
    if (!here) break;
    const Config off = goal->q - here->q;
    const double move = std::clamp(
        joint_dot(off, length < 0 ? Config(-here->tangent) : here->tangent), -kLongest, kLongest);
    if (std::abs(move) < kSettled) return joint_norm(off) < kOnCurve ? length : 0;
    length += move;
  }
  return 0;
}

}  // namespace swivel
