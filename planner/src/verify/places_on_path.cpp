// SPDX-License-Identifier: BSD-3-Clause
#include "verify/places_on_path.hpp"

#include <algorithm>
#include <cmath>

#include "verify/path_following.hpp"

namespace swivel {

namespace {

constexpr double kSameS = 1e-9;    // m
constexpr std::size_t kLeaf = 16;  // steps of a box

}  // namespace

PlacesOnPath::PlacesOnPath(const ToolPath& path, bool curved, double rounding, bool any_turn)
    : path_(&path), curved_(curved), any_turn_(any_turn), aside_(2 * rounding + 1e-9) {
  const auto steps = static_cast<std::size_t>(path.size() - 1);
  while (leaves_ * kLeaf < steps) leaves_ *= 2;
  const double infinity = std::numeric_limits<double>::infinity();
  boxes_.assign(2 * leaves_, {Vector3d::Constant(infinity), Vector3d::Constant(-infinity)});
  // Layers lie on the curve, which leaves the polyline by up to `rounding`, and so does the curve
  // between them.
  for (std::size_t i = 0; i < steps; ++i) {
    const Vector3d aside = Vector3d::Constant(aside_of(static_cast<int>(i)));
    for (const std::size_t layer : {i, i + 1}) {
      Box& box = boxes_[leaves_ + i / kLeaf];
      const Vector3d point = path.layer(static_cast<int>(layer)).tool.translation();
      box.low = box.low.cwiseMin(point - aside);
      box.high = box.high.cwiseMax(point + aside);
    }
  }
  for (std::size_t node = leaves_; --node > 0;)
    boxes_[node] = {boxes_[2 * node].low.cwiseMin(boxes_[2 * node + 1].low),
                    boxes_[2 * node].high.cwiseMax(boxes_[2 * node + 1].high)};
}

/// Returns by how much a step of the path may leave the straight line between its ends, m. The
/// first may lead in a bend to the path from a start beside it.
double PlacesOnPath::aside_of(int step) const {
  return aside_ + (curved_ && step == 0 ? path_->layer(0).step_length : 0);
}

/// Returns a lower bound of the distance of a point from a step of the path, m.
double PlacesOnPath::least_distance(int step, const Vector3d& point) const {
  const Vector3d from = path_->layer(step).tool.translation(),
                 along = path_->layer(step + 1).tool.translation() - from;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp((point - from).dot(along) / length2, 0.0, 1.0) : 0;
  return (point - from - t * along).norm() - aside_of(step);
}

/// Returns the displacement from a pose to the tool: translation, m, and rotation vector, rad.
PlacesOnPath::Vector6 PlacesOnPath::off(const Pose& there, const Pose& tool) const {
  const Eigen::AngleAxisd turn(
      there.linear().transpose() *
      (any_turn_ ? rolled(tool, -roll_between(there, tool)) : tool).linear());
  Vector6 d;
  d << tool.translation() - there.translation(), turn.angle() * turn.axis();
  return d;
}

bool PlacesOnPath::fits_at(const Pose& tool, double place) const {
  const Vector6 d = off(pose_at(*path_, place), tool);
  return d.head<3>().norm() <= kOnPath && d.tail<3>().norm() <= kOnPath;
}

/// Returns the share of a step, between `low` and `high`, at which the path is nearest to the tool,
/// by Gauss-Newton from the answer for a straight step.
double PlacesOnPath::share_of(int step, const Pose& tool, double low, double high) const {
  const PathLayer& from = path_->layer(step);
  const Vector3d along = path_->layer(step + 1).tool.translation() - from.tool.translation();
  const Vector6 start = off(from.tool, tool);
  const double length2 = along.squaredNorm() + from.step_rotation.squaredNorm();
  double t = length2 > 0
                 ? (start.head<3>().dot(along) + start.tail<3>().dot(from.step_rotation)) / length2
                 : 0;
  t = std::clamp(t, low, high);
  if (!curved_ && !any_turn_ && (from.step_angle == 0 || from.step_length == 0)) return t;
  constexpr double kStep = 1e-4;
  constexpr int kMost = 40;  // a bend into the path ends at rest across it
  for (int round = 0; round < kMost; ++round) {
    const Vector6 here = off(path_->at(step, t), tool);
    const Vector6 slope =
        (off(path_->at(step, t + kStep), tool) - off(path_->at(step, t - kStep), tool)) /
        (2 * kStep);
    if (!(slope.squaredNorm() > 1e-24)) break;
    const double next = std::clamp(t - here.dot(slope) / slope.squaredNorm(), low, high);
    const bool done = std::abs(next - t) < 1e-12;
    t = next;
    if (done) break;
  }
  return t;
}

template <class Reaches, class Visit>
void PlacesOnPath::search(std::size_t node, const Vector3d& point, const Reaches& reaches,
                          const Visit& visit) const {
  if (!reaches(boxes_[node].distance(point))) return;
  if (node >= leaves_) {
    const auto first = static_cast<int>((node - leaves_) * kLeaf);
    for (int i = first; i < first + static_cast<int>(kLeaf) && i + 1 < path_->size(); ++i) visit(i);
    return;
  }
  // The nearer half comes first.
  const bool swapped = boxes_[2 * node + 1].distance(point) < boxes_[2 * node].distance(point);
  search(2 * node + (swapped ? 1 : 0), point, reaches, visit);
  search(2 * node + (swapped ? 0 : 1), point, reaches, visit);
}

std::vector<double> PlacesOnPath::fits(const Pose& tool, double s) const {
  std::vector<double> found;
  const bool given = !std::isnan(s);
  const auto visit = [&](int step) {
    if (least_distance(step, tool.translation()) > kOnPath) return;
    const PathLayer& layer = path_->layer(step);
    double low = 0, high = 1;
    if (given) {
      const double end = path_->layer(step + 1).s;
      if (layer.s > s + kSameS || end < s - kSameS) return;
      if (const double length = end - layer.s; length > 0) {
        low = std::clamp((s - kSameS - layer.s) / length, 0.0, 1.0);
        high = std::clamp((s + kSameS - layer.s) / length, 0.0, 1.0);
      }
    }
    const double t = share_of(step, tool, low, high), place = t == 1 ? step + 1 : step + t;
    if (fits_at(tool, place)) found.push_back(place);
  };
  if (given)
    for (int i = std::max(0, static_cast<int>(std::floor(place_at(s - kSameS))) - 1);
         i + 1 < path_->size() && path_->layer(i).s <= s + kSameS; ++i)
      visit(i);
  else
    search(
        1, tool.translation(), [](double distance) { return distance <= kOnPath; }, visit);
  // A place at a layer is found from both sides.
  std::sort(found.begin(), found.end());
  found.erase(
      std::unique(found.begin(), found.end(), [](double a, double b) { return b - a < 1e-9; }),
      found.end());
  return found;
}

double PlacesOnPath::nearest(const Pose& tool, double from, double to) const {
  double best = from, least = off(pose_at(*path_, from), tool).norm();
  search(
      1, tool.translation(), [&](double distance) { return distance < least; },
      [&](int step) {
        const double low = std::max(0.0, from - step), high = std::min(1.0, to - step);
        if (!(low <= high) || least_distance(step, tool.translation()) >= least) return;
        const double t = share_of(step, tool, low, high), place = t == 1 ? step + 1 : step + t;
        const double distance = off(pose_at(*path_, place), tool).norm();
        if (distance < least) best = place, least = distance;
      });
  return best;
}

double PlacesOnPath::s_at(double place) const {
  const int i = std::min(static_cast<int>(std::floor(place)), path_->size() - 2);
  const PathLayer &from = path_->layer(i), &to = path_->layer(i + 1);
  if (place == i + 1) return to.s;
  return from.s + (place - i) * (to.s - from.s);
}

double PlacesOnPath::place_at(double s) const {
  int low = 0, high = path_->size() - 2;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (path_->layer(middle + 1).s >= s)
      high = middle;
    else
      low = middle + 1;
  }
  const double begin = path_->layer(low).s, length = path_->layer(low + 1).s - begin;
  return length > 0 ? low + std::clamp((s - begin) / length, 0.0, 1.0) : low;
}

}  // namespace swivel
