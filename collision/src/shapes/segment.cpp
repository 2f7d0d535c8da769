// SPDX-License-Identifier: BSD-3-Clause
#include "shapes/segment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace swivel::detail {

namespace {

double on_unit(double t) {
  return std::clamp(t, 0.0, 1.0);
}

/// Returns true if x, relative to corner a and in the triangle's plane, lies in the triangle.
bool holds(const Triangle& t, const Vector3d& x) {
  return t.normal.dot(t.ab.cross(x)) >= 0 && t.normal.dot(x.cross(t.ac)) >= 0 &&
         t.normal.dot((t.ac - t.ab).cross(x - t.ab)) >= 0;
}

constexpr double kNotInside = std::numeric_limits<double>::max();

/// Returns the squared distance of the segment and the triangle, m^2, if the nearest point of the
/// triangle lies in its inside; a value of at least `limit` if the plane proves the distance to be
/// no less; else kNotInside. In that last case the segment comes nearest at an edge: if it passes
/// over the inside elsewhere, it comes nearer until it is over an edge.
double squared_distance_over_inside(const Segment& s, const Triangle& t, double limit) {
  const Vector3d from = s.start - t.a;
  const double height = t.normal.dot(from), end_height = height + t.normal.dot(s.along);
  if (height * end_height <= 0) {  // meets the plane
    const Vector3d x =
        height == end_height ? from : Vector3d(from + height / (height - end_height) * s.along);
    return holds(t, x) ? 0 : kNotInside;
  }
  const bool start_nearer = std::abs(height) <= std::abs(end_height);
  const double nearer = start_nearer ? height : end_height;
  if (nearer * nearer >= limit) return nearer * nearer;
  const Vector3d foot = (start_nearer ? from : Vector3d(from + s.along)) - nearer * t.normal;
  return holds(t, foot) ? nearer * nearer : kNotInside;
}

/// Returns true if the triangles are proved to be apart by at least sqrt(limit): along either
/// normal, by their boxes, or along the line that joins their middles.
bool surely_further(const Triangle& s, const Triangle& t, double limit) {
  const auto above = [limit](const Triangle& below, const Triangle& other) {
    const double h = below.normal.dot(other.a - below.a), hb = h + below.normal.dot(other.ab),
                 hc = h + below.normal.dot(other.ac);
    const double least = std::max(std::min({h, hb, hc}), -std::max({h, hb, hc}));
    return least > 0 && least * least >= limit;
  };
  const auto low = [](const Triangle& x) {
    return Vector3d(x.a + x.ab.cwiseMin(x.ac).cwiseMin(0));
  };
  const auto high = [](const Triangle& x) {
    return Vector3d(x.a + x.ab.cwiseMax(x.ac).cwiseMax(0));
  };
  const Vector3d gap = (low(s) - high(t)).cwiseMax(low(t) - high(s)).cwiseMax(0);
  if (gap.squaredNorm() >= limit) return true;
  if (above(s, t) || above(t, s)) return true;
  const Vector3d between = 3 * (t.a - s.a) + (t.ab + t.ac) - (s.ab + s.ac);
  const double from = std::max({0.0, between.dot(s.ab), between.dot(s.ac)});
  const double to = between.dot(t.a - s.a) + std::min({0.0, between.dot(t.ab), between.dot(t.ac)});
  return to > from && (to - from) * (to - from) >= limit * between.squaredNorm();
}

/// Returns the vector from the nearest point of t to the nearest point of s.
Vector3d shortest(const Segment& s, const Segment& t) {
  const Vector3d between = s.start - t.start;
  const double ss = s.along.squaredNorm(), tt = t.along.squaredNorm(), st = s.along.dot(t.along);
  const double s_between = s.along.dot(between), t_between = t.along.dot(between);
  const auto nearest_on_s = [&](double y) {
    return ss > 0 ? on_unit((y * st - s_between) / ss) : 0;
  };
  const double determinant = ss * tt - st * st;
  double x = determinant > 0 ? on_unit((st * t_between - s_between * tt) / determinant) : 0;
  double y = tt > 0 ? (st * x + t_between) / tt : 0;
  if (y <= 0 || y >= 1) {
    y = on_unit(y);
    x = nearest_on_s(y);
  }
  return between + x * s.along - y * t.along;
}

/// Returns true if the triangles are apart by at least sqrt(limit) along the direction `way`, with
/// s ahead.
bool apart_along(const Vector3d& way, const Triangle& s, const Triangle& t, double limit) {
  const double from = way.dot(s.a - t.a) + std::min({0.0, way.dot(s.ab), way.dot(s.ac)});
  const double to = std::max({0.0, way.dot(t.ab), way.dot(t.ac)});
  return from > to && (from - to) * (from - to) >= limit * way.squaredNorm();
}

}  // namespace

Triangle::Triangle(const Vector3d& corner, const Vector3d& b, const Vector3d& c)
    : a(corner), ab(b - corner), ac(c - corner), normal(ab.cross(ac).normalized()) {}

Segment Triangle::edge(int k) const {
  if (k == 0) return {a, ab};
  if (k == 1) return {a, ac};
  return {a + ab, ac - ab};
}

Triangle Triangle::moved(const Pose& pose) const {
  Triangle triangle = *this;
  triangle.a = pose * a;
  for (Vector3d* v : {&triangle.ab, &triangle.ac, &triangle.normal}) *v = pose.linear() * *v;
  return triangle;
}

double squared_distance(const Segment& s, const Segment& t) {
  return shortest(s, t).squaredNorm();
}

double squared_distance(const Segment& s, const Triangle& t, double limit) {
  const double over_inside = squared_distance_over_inside(s, t, limit);
  if (over_inside < kNotInside) return over_inside;
  return std::min({squared_distance(s, t.edge(0)), squared_distance(s, t.edge(1)),
                   squared_distance(s, t.edge(2))});
}

double squared_distance(const Triangle& s, const Triangle& t, double limit) {
  if (surely_further(s, t, limit)) return limit;
  double least = limit;
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) {
      const Vector3d way = shortest(s.edge(k), t.edge(l));
      least = std::min(least, way.squaredNorm());
      if (apart_along(way, s, t, least)) return least;
    }
  for (int k = 0; k < 3; ++k) {
    least = std::min(least, squared_distance_over_inside(s.edge(k), t, least));
    least = std::min(least, squared_distance_over_inside(t.edge(k), s, least));
  }
  return least;
}

}  // namespace swivel::detail
