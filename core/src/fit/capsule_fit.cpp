// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/fit/capsule_fit.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace swivel {

namespace {

using Vector2d = Eigen::Vector2d;
using Points = std::vector<Vector3d>;

constexpr double kGrain = 1e-6;      // m, of what files say
constexpr double kLeastGain = 0.05;  // of the volume, that one capsule more must take away
/// How thoroughly the axis of a capsule is sought.
struct Effort {
  int directions;  // that are looked at
  int refined;     // the best of these are refined
  int supports;    // directions in which the points that reach farthest are kept
};
constexpr Effort kThorough{64, 4, 400}, kQuick{24, 0, 100};
constexpr double kFinest = 1e-3;  // rad, of an axis

/// Returns directions spread evenly over the sphere (Fibonacci's spiral).
Vector3d spiral(int k, int count) {
  const double z = 1 - (2 * k + 1.0) / count, turn = k * kPi * (3 - std::sqrt(5.0)),
               r = std::sqrt(1 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

double volume_of(double radius, double length) {
  return kPi * radius * radius * (length + 4.0 / 3 * radius);
}

/// The segment of a capsule and its radius.
struct Bar {
  Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();
  double radius = 0;
  [[nodiscard]] double volume() const { return volume_of(radius, (b - a).norm()); }
  [[nodiscard]] double distance(const Vector3d& p) const {
    const Vector3d way = b - a;
    const double length2 = way.squaredNorm(),
                 along = length2 > 0 ? std::clamp((p - a).dot(way) / length2, 0.0, 1.0) : 0;
    return (p - (a + along * way)).norm();
  }
};

struct Circle {
  Vector2d centre = Vector2d::Zero();
  double radius = 0;
  [[nodiscard]] bool holds(const Vector2d& p) const {
    return (p - centre).norm() <= radius * (1 + 1e-12) + 1e-15;
  }
};

Circle about(const Vector2d& a, const Vector2d& b) {
  return {(a + b) / 2, (a - b).norm() / 2};
}

Circle about(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const Vector2d u = b - a, v = c - a;
  const double twice = 2 * (u.x() * v.y() - u.y() * v.x());
  if (std::abs(twice) < 1e-300) {  // on a line: the two that are farthest apart
    Circle circle = about(a, b);
    for (const Circle& other : {about(b, c), about(a, c)})
      if (other.radius > circle.radius) circle = other;
    return circle;
  }
  const Vector2d off = Vector2d(v.y() * u.squaredNorm() - u.y() * v.squaredNorm(),
                                u.x() * v.squaredNorm() - v.x() * u.squaredNorm()) /
                       twice;
  return {a + off, off.norm()};
}

/// Returns the smallest circle around points, in any order (Welzl 1991, without recursion).
Circle least_circle(const std::vector<Vector2d>& points) {
  Circle circle{points[0], 0};
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (circle.holds(points[i])) continue;
    circle = {points[i], 0};
    for (std::size_t j = 0; j < i; ++j) {
      if (circle.holds(points[j])) continue;
      circle = about(points[i], points[j]);
      for (std::size_t k = 0; k < j; ++k)
        if (!circle.holds(points[k])) circle = about(points[i], points[j], points[k]);
    }
  }
  return circle;
}

/// Returns the capsule of least volume along a direction, of several radii from the least one on: a
/// thicker one may be shorter.
Bar bar_along(const Vector3d& direction, const Points& points) {
  const Vector3d x = direction.unitOrthogonal(), y = direction.cross(x);
  std::vector<Vector2d> seen;
  seen.reserve(points.size());
  for (const Vector3d& p : points) seen.emplace_back(x.dot(p), y.dot(p));
  const Circle circle = least_circle(seen);
  Bar best;
  for (const double thicker : {1.0, 1.002, 1.005, 1.01, 1.02, 1.05, 1.1, 1.2}) {
    Bar bar;
    bar.radius = thicker * circle.radius;
    // Between them the segment may begin and end.
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double off2 = (seen[k] - circle.centre).squaredNorm(),
                   cap = std::sqrt(std::max(0.0, bar.radius * bar.radius - off2));
      low = std::min(low, direction.dot(points[k]) + cap);
      high = std::max(high, direction.dot(points[k]) - cap);
    }
    if (low > high) low = high = (low + high) / 2;  // a sphere
    const Vector3d foot = circle.centre.x() * x + circle.centre.y() * y;
    bar.a = foot + low * direction;
    bar.b = foot + high * direction;
    if (thicker == 1.0 || bar.volume() < best.volume()) best = bar;
  }
  return best;
}

/// Returns the points that reach farthest in some direction: few points, and nearly all that decide
/// a capsule around them.
Points outermost(const Points& points, int supports) {
  if (points.size() <= static_cast<std::size_t>(supports)) return points;
  std::vector<std::size_t> kept;
  for (int k = 0; k < supports; ++k) {
    const Vector3d u = spiral(k, supports);
    std::size_t farthest = 0;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points.size(); ++i)
      if (const double reach = u.dot(points[i]); reach > most) most = reach, farthest = i;
    kept.push_back(farthest);
  }
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  Points result;
  for (const std::size_t i : kept) result.push_back(points[i]);
  return result;
}

/// Returns the axes of the points' covariance.
Matrix3d principal_axes(const Points& points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Matrix3d spread = Matrix3d::Zero();
  for (const Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(spread).eigenvectors();
}

/// Returns a capsule around all points whose numbers a file can state exactly.
Bar bar_about(const Points& all, const Effort& effort) {
  const Points points = outermost(all, effort.supports);
  struct Tried {
    Vector3d direction;
    Bar bar;
  };
  std::vector<Tried> tried;
  const auto add = [&](const Vector3d& direction) {
    tried.push_back({direction, bar_along(direction, points)});
  };
  const Matrix3d axes = principal_axes(points);
  for (int k = 0; k < 3; ++k) {
    add(axes.col(k).normalized());
    add(Vector3d::Unit(k));
  }
  // a half sphere: an axis has no sign
  for (int k = 0; k < effort.directions; ++k) add(spiral(k, 2 * effort.directions));
  const auto smaller = [](const Tried& a, const Tried& b) {
    return a.bar.volume() < b.bar.volume();
  };
  std::stable_sort(tried.begin(), tried.end(), smaller);
  for (int n = 0; n < effort.refined; ++n) {
    Tried& best = tried[static_cast<std::size_t>(n)];
    for (double step = 0.15; step > kFinest;) {
      const Vector3d x = best.direction.unitOrthogonal(), y = best.direction.cross(x),
                     before = best.direction;
      for (int k = 0; k < 6; ++k) {
        const Vector3d other =
            (before + step * (std::cos(k * kPi / 3) * x + std::sin(k * kPi / 3) * y)).normalized();
        if (const Bar bar = bar_along(other, points); bar.volume() < best.bar.volume())
          best = {other, bar};
      }
      if (best.direction == before) step /= 2;
    }
  }
  Bar bar = std::min_element(tried.begin(), tried.end(), smaller)->bar;
  const auto rounded = [](double value) { return kGrain * std::round(value / kGrain); };
  bar.a = bar.a.unaryExpr(rounded);
  bar.b = bar.b.unaryExpr(rounded);
  if ((bar.b - bar.a).norm() < 10 * kGrain) bar.b = bar.a;
  bar.radius = 0;
  for (const Vector3d& p : all) bar.radius = std::max(bar.radius, bar.distance(p));
  bar.radius = kGrain * (std::floor(bar.radius / kGrain) + 1);
  return bar;
}

/// A part of the mesh, as convex polygons.
using Part = std::vector<Points>;

Points corners_of(const Part& part) {
  Points corners;
  for (const Points& polygon : part) corners.insert(corners.end(), polygon.begin(), polygon.end());
  return corners;
}

/// Returns what lies of the part where normal . p <= height; the cut belongs to both sides.
Part below(const Part& part, const Vector3d& normal, double height) {
  Part kept;
  for (const Points& polygon : part) {
    Points inside;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vector3d &p = polygon[k], &next = polygon[(k + 1) % polygon.size()];
      const double at = normal.dot(p) - height, then = normal.dot(next) - height;
      if (at <= 0) inside.push_back(p);
      if ((at < 0 && then > 0) || (at > 0 && then < 0))
        inside.push_back(p + (at / (at - then)) * (next - p));
    }
    if (!inside.empty()) kept.push_back(std::move(inside));
  }
  return kept;
}

struct Piece {
  Part part;
  Bar bar;
};

/// Returns the two pieces of least volume into which one of some planes cuts a piece; none where it
/// cannot be cut.
std::optional<std::array<Piece, 2>> cut_in_two(const Piece& piece) {
  const Points corners = outermost(corners_of(piece.part), kThorough.supports);
  const Matrix3d axes = principal_axes(corners);
  std::array<Vector3d, 4> normals{axes.col(2), axes.col(1), axes.col(0), piece.bar.b - piece.bar.a};
  if (normals[3].norm() > 0) normals[3].normalize();
  // Fit all cuts quickly, then the best again.
  double least = std::numeric_limits<double>::infinity(), best_height = 0;
  Vector3d best_normal;
  for (const Vector3d& normal : normals) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vector3d& p : corners) {
      low = std::min(low, normal.dot(p));
      high = std::max(high, normal.dot(p));
    }
    if (!(high - low > 100 * kGrain)) continue;
    for (int k = 1; k < 8; ++k) {
      const double height = low + k * (high - low) / 8;
      const Points one = corners_of(below(piece.part, normal, height)),
                   other = corners_of(below(piece.part, -normal, -height));
      if (one.empty() || other.empty()) continue;
      const double volume = bar_about(one, kQuick).volume() + bar_about(other, kQuick).volume();
      if (volume < least) least = volume, best_normal = normal, best_height = height;
    }
  }
  if (least == std::numeric_limits<double>::infinity()) return std::nullopt;
  std::array<Piece, 2> pieces;
  pieces[0].part = below(piece.part, best_normal, best_height);
  pieces[1].part = below(piece.part, -best_normal, -best_height);
  for (Piece& half : pieces) half.bar = bar_about(corners_of(half.part), kThorough);
  return pieces;
}

}  // namespace

CapsuleFit fit_capsules(const TriangleMesh& mesh, int most) {
  Piece whole;
  for (const auto& triangle : mesh.triangles) {
    Points& polygon = whole.part.emplace_back();
    for (const int vertex : triangle)
      polygon.push_back(mesh.vertices[static_cast<std::size_t>(vertex)]);
  }
  const Points all = corners_of(whole.part);
  whole.bar = bar_about(all, kThorough);
  std::vector<Piece> pieces{std::move(whole)};
  const auto volume = [&] {
    double sum = 0;
    for (const Piece& piece : pieces) sum += piece.bar.volume();
    return sum;
  };
  while (static_cast<int>(pieces.size()) < most) {
    double most_gained = kLeastGain * volume();
    std::size_t at = pieces.size();
    std::array<Piece, 2> halves;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      auto cut = cut_in_two(pieces[k]);
      if (!cut) continue;
      const double gained =
          pieces[k].bar.volume() - (*cut)[0].bar.volume() - (*cut)[1].bar.volume();
      if (gained > most_gained) most_gained = gained, at = k, halves = std::move(*cut);
    }
    if (at == pieces.size()) break;
    pieces[at] = std::move(halves[0]);
    pieces.push_back(std::move(halves[1]));
  }
  CapsuleFit fit;
  fit.volume = volume();
  for (const Piece& piece : pieces) {
    const Bar& bar = piece.bar;
    const Vector3d way = bar.b - bar.a;
    PlacedShape& placed = fit.capsules.emplace_back();
    if (way.norm() > 0)
      placed.shape = Capsule{bar.radius, way.norm()};
    else
      placed.shape = Sphere{bar.radius};
    placed.pose.translation() = (bar.a + bar.b) / 2;
    if (way.norm() > 0)
      placed.pose.linear() = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), way).toRotationMatrix();
  }
  for (int k = 0; k < kThorough.supports; ++k) {
    const Vector3d u = spiral(k, kThorough.supports);
    double its = -std::numeric_limits<double>::infinity(), theirs = its;
    for (const Vector3d& p : all) its = std::max(its, u.dot(p));
    for (const Piece& piece : pieces)
      theirs =
          std::max(theirs, std::max(u.dot(piece.bar.a), u.dot(piece.bar.b)) + piece.bar.radius);
    fit.excess = std::max(fit.excess, theirs - its);
  }
  return fit;
}

}  // namespace swivel
