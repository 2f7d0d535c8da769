// SPDX-License-Identifier: BSD-3-Clause
#include "segment.hpp"

#include <algorithm>
#include <cmath>

namespace swivel {

namespace {

double on_unit(double t) {
  return std::clamp(t, 0.0, 1.0);
}

/// Whether x, relative to corner a and in the triangle's plane, lies in the triangle.
bool holds(const Triangle& t, const Vector3d& x) {
  return t.normal.dot(t.ab.cross(x)) >= 0 && t.normal.dot(x.cross(t.ac)) >= 0 && t.normal.dot((t.ac - t.ab).cross(x - t.ab)) >= 0;
}

}  // namespace

Triangle::Triangle(const Vector3d& corner, const Vector3d& b, const Vector3d& c)
    : a(corner), ab(b - corner), ac(c - corner), normal(ab.cross(ac).normalized()) {}

Segment Triangle::edge(int k) const {
  if (k == 0) return {a, ab};
  if (k == 1) return {a, ac};
  return {a + ab, ac - ab};
}

double squared_distance(const Segment& s, const Segment& t) {
  const Vector3d between = s.start - t.start;
  const double ss = s.along.squaredNorm(), tt = t.along.squaredNorm(), st = s.along.dot(t.along);
  const double s_between = s.along.dot(between), t_between = t.along.dot(between);
  const auto nearest_on_s = [&](double y) { return ss > 0 ? on_unit((y * st - s_between) / ss) : 0; };
  const double determinant = ss * tt - st * st;
  double x = determinant > 0 ? on_unit((st * t_between - s_between * tt) / determinant) : 0;
  double y = tt > 0 ? (st * x + t_between) / tt : 0;
  if (y <= 0 || y >= 1) {
    y = on_unit(y);
    x = nearest_on_s(y);
  }
  return (between + x * s.along - y * t.along).squaredNorm();
}

double squared_distance(const Segment& s, const Triangle& t, double limit) {
  const Vector3d from = s.start - t.a;
  const double height = t.normal.dot(from), end_height = height + t.normal.dot(s.along);
  if (height * end_height <= 0) {  // meets the plane
    const Vector3d x = height == end_height ? from : Vector3d(from + height / (height - end_height) * s.along);
    if (holds(t, x)) return 0;
  } else {
    const bool start_nearer = std::abs(height) <= std::abs(end_height);
    const double least = std::min(std::abs(height), std::abs(end_height));
    if (least * least >= limit) return least * least;
    const Vector3d foot = (start_nearer ? from : Vector3d(from + s.along)) - (start_nearer ? height : end_height) * t.normal;
    if (holds(t, foot)) return least * least;
  }
  // Where else the segment is above the inside, it comes nearer until it is above an edge.
  return std::min({squared_distance(s, t.edge(0)), squared_distance(s, t.edge(1)), squared_distance(s, t.edge(2))});
}

double squared_distance(const Triangle& s, const Triangle& t, double limit) {
  for (int k = 0; k < 3; ++k) {
    limit = std::min(limit, squared_distance(s.edge(k), t, limit));
    limit = std::min(limit, squared_distance(t.edge(k), s, limit));
  }
  return limit;
}

}  // namespace swivel
