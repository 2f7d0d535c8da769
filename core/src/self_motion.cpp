// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/self_motion.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>

#include "swivel/core/angle.hpp"

namespace swivel {

namespace {

constexpr int kSeeds = 32;           // lock values, evenly over a turn
constexpr double kStep = 0.1;        // rad, Euclidean
constexpr double kLeastStep = 1e-4;  // rad: below this a curve is singular
constexpr double kReached = 1e-11;   // m, rad
constexpr double kOnCurve = 0.02;    // rad from a chord: a seed there is known
constexpr double kFarSlack = 1;      // relative discriminant of complex roots that give seeds
constexpr int kMostPoints = 20000;

Config difference(const Config& a, const Config& b) {
  Config d;
  for (int j = 0; j < kDof; ++j) d[j] = wrap_angle(a[j] - b[j]);
  return d;
}

using Jacobian = Eigen::Matrix<double, 6, kDof>;

Config6 error_of(const Pose& tool, const Pose& reached) {
  const Matrix3d left = tool.linear() * reached.linear().transpose();
  Config6 error;
  error << tool.translation() - reached.translation(), (left(2, 1) - left(1, 2)) / 2, (left(0, 2) - left(2, 0)) / 2,
      (left(1, 0) - left(0, 1)) / 2;
  return error;
}

/// Minimum-norm Newton onto the curve; joint `held` stays (-1: none).
std::optional<Config> on_curve(const Chain& chain, const Pose& tool, Config q, int held = -1) {
  for (int step = 0; step < 8; ++step) {
    const Config6 error = error_of(tool, chain.tool(q));
    if (error.lpNorm<Eigen::Infinity>() < kReached) return q;
    Jacobian J = chain.jacobian(q);
    if (held >= 0) J.col(held).setZero();
    Matrix6 JJt = J * J.transpose();
    JJt.diagonal().array() += 1e-2 * error.squaredNorm() + 1e-18;
    const Config move = J.transpose() * JJt.partialPivLu().solve(error);
    if (!(move.norm() < 1)) return std::nullopt;
    q += move;
  }
  return std::nullopt;
}

/// Unit null vector of the Jacobian.
Config tangent(const Chain& chain, const Config& q) {
  const Eigen::Matrix<double, kDof, 6> Jt = chain.jacobian(q).transpose();
  const Eigen::HouseholderQR<Eigen::Matrix<double, kDof, 6>> qr(Jt);
  return qr.householderQ() * Config::Unit(kDof - 1);
}

struct Point {
  Config q, t;  // on the curve, and its tangent
};

/// One step of at most kStep along p.t, shorter where the curve bends.
std::optional<Point> advance(const Chain& chain, const Pose& tool, const Point& p, double& step) {
  for (step = std::min(kStep, 2 * step); step >= kLeastStep; step /= 2) {
    const auto q = on_curve(chain, tool, p.q + step * p.t);
    if (!q || (*q - p.q).norm() > kStep || (*q - p.q - step * p.t).norm() > 0.25 * step) continue;
    Config t = tangent(chain, *q);
    if (t.dot(p.t) < 0) t = -t;
    if (t.dot(p.t) < 0.95) continue;
    return Point{*q, t};
  }
  return std::nullopt;
}

/// Whether the chord from a to b, both on the torus, passes near q.
bool near_chord(const Config& a, const Config& b, const Config& q) {
  const Config d = difference(q, a);
  if (d.lpNorm<Eigen::Infinity>() > 2 * kStep) return false;
  const Config c = difference(b, a);
  const double along = std::clamp(d.dot(c) / std::max(c.squaredNorm(), 1e-30), 0.0, 1.0);
  return (d - along * c).norm() < kOnCurve;
}

struct Curve {
  std::vector<Point> points;
  bool closed = false;
  [[nodiscard]] bool passes(const Point& p) const {
    for (std::size_t k = 0; k + (closed ? 0 : 1) < points.size(); ++k) {
      const Point& a = points[k];
      if (near_chord(a.q, points[(k + 1) % points.size()].q, p.q) && std::abs(a.t.dot(p.t)) > 0.9) return true;
    }
    return false;
  }
};

Curve trace(const Chain& chain, const Pose& tool, const Point& seed) {
  Curve curve;
  curve.points.push_back(seed);
  double step = kStep;
  const auto follow = [&](Point p) {
    while (static_cast<int>(curve.points.size()) < kMostPoints) {
      const auto next = advance(chain, tool, p, step);
      if (!next) return;
      // Closed where this step passes the seed.
      const Config to_seed = difference(seed.q, p.q), way = next->q - p.q;
      const double along = to_seed.dot(way) / way.squaredNorm();
      if (curve.points.size() > 3 && along > 0 && along <= 1 && (to_seed - along * way).norm() < 0.1 * way.norm() &&
          next->t.dot(seed.t) > 0.9) {
        curve.closed = true;
        return;
      }
      curve.points.push_back(*next);
      p = *next;
    }
  };
  follow(seed);
  if (curve.closed) return curve;
  std::reverse(curve.points.begin(), curve.points.end());
  for (Point& p : curve.points) p.t = -p.t;
  step = kStep;
  follow({seed.q, -seed.t});
  return curve;
}

std::vector<Curve> trace_all(const Chain& chain, const Pose& tool, int lock,
                             const std::vector<std::pair<double, ClosedForm>>& forms) {
  std::vector<Curve> curves;
  const auto add_seed = [&](const Config& q) {
    const Point seed{q, tangent(chain, q)};
    if (std::none_of(curves.begin(), curves.end(), [&](const Curve& curve) { return curve.passes(seed); }))
      curves.push_back(trace(chain, tool, seed));
  };
  const auto add = [&](const ClosedForm::Solutions& solutions, double value) {
    for (const Config6& six : solutions) add_seed(with_joint(six, lock, value));
  };
  std::vector<ClosedForm::Solutions> solutions;
  for (const auto& [value, form] : forms) {
    solutions.push_back(form.solve(tool));
    add(solutions.back(), value);
  }
  // Curves whose lock stays between two values: complex roots lie near them, and Newton on all seven joints leads there.
  for (std::size_t k = 0; k < forms.size(); ++k) {
    if (solutions[k].count >= 8) continue;
    for (const Config6& six : forms[k].second.starts(tool, kFarSlack)) {
      const Config start = with_joint(six, lock, forms[k].first);
      const auto q = on_curve(chain, tool, start);
      if (q) add_seed(*q);
    }
  }
  // Curves that turn round between two lock values: where the number of roots changes, and half-way there.
  for (std::size_t k = 0; k < forms.size(); ++k) {
    const std::size_t next = (k + 1) % forms.size();
    if (solutions[k].count == solutions[next].count) continue;
    double low = forms[k].first, high = low + kTwoPi / kSeeds;
    for (int halving = 0; halving < 6; ++halving) {
      const double middle = (low + high) / 2;
      const auto form = ClosedForm::of(lock_joint(chain, lock, middle));
      if (!form) break;
      const auto found = form->solve(tool);
      add(found, middle);
      (found.count == solutions[k].count ? low : high) = middle;
    }
  }
  return curves;
}

}  // namespace

SelfMotion::SelfMotion(const Chain& chain, const LockMethod& method, double margin) : chain_(chain), lock_(method.best) {
  for (std::size_t j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[j];
    lower_[j] = limit.lower + margin;
    upper_[j] = limit.upper - margin;
    bounded_[j] = !limit.continuous && limit.upper - limit.lower < kTwoPi;
  }
  // Half a cell from 0, so that no value is a multiple of 90 degrees.
  for (int k = 0; k < kSeeds; ++k) {
    const double value = kTwoPi * (k + 0.5) / kSeeds - kPi;
    if (auto form = ClosedForm::of(lock_joint(chain, lock_, value))) forms_.emplace_back(value, *form);
  }
}

std::vector<SelfMotionArc> SelfMotion::curves(const Pose& tool) const {
  std::vector<SelfMotionArc> result;
  for (const Curve& curve : trace_all(chain_, tool, lock_, forms_)) {
    SelfMotionArc arc;
    arc.closed = curve.closed;
    for (const Point& p : curve.points) arc.q.push_back(p.q);
    result.push_back(std::move(arc));
  }
  return result;
}

std::vector<SelfMotionArc> SelfMotion::arcs(const Pose& tool) const {
  // Value of a joint in the turn about the middle of its range; a joint of a turn or more is a circle.
  const auto image = [&](double angle, std::size_t j) {
    if (!bounded_[j]) return wrap_angle(angle);
    const double middle = (lower_[j] + upper_[j]) / 2;
    return middle + wrap_angle(angle - middle);
  };
  // How far outside, and which joint is worst.
  const auto outside = [&](const Config& q, int& worst) {
    double most = -1e9;
    for (int j = 0; j < kDof; ++j) {
      const auto at = static_cast<std::size_t>(j);
      if (!bounded_[at]) continue;
      const double value = image(q[j], at), excess = std::max(lower_[at] - value, value - upper_[at]);
      if (excess > most) {
        most = excess;
        worst = j;
      }
    }
    return most;
  };
  std::vector<SelfMotionArc> result;
  for (Curve& curve : trace_all(chain_, tool, lock_, forms_)) {
    // Extrema of bounded joints near their limits become points, so that no short piece hides between two points.
    std::vector<Point> points;
    const std::size_t count = curve.points.size(), chords = curve.closed ? count : count - 1;
    for (std::size_t k = 0; k < count; ++k) {
      points.push_back(curve.points[k]);
      if (k >= chords) break;
      const Point &a = curve.points[k], &b = curve.points[(k + 1) % count];
      const Config way = difference(b.q, a.q);
      std::vector<std::pair<double, Point>> extrema;
      for (int j = 0; j < kDof; ++j) {
        const auto at = static_cast<std::size_t>(j);
        if (!bounded_[at] || (a.t[j] > 0) == (b.t[j] > 0)) continue;
        const double value = image(a.q[j], at);
        if (std::min(std::abs(value - lower_[at]), std::abs(value - upper_[at])) > kStep) continue;
        double low = 0, high = 1;
        std::optional<Point> extremum;
        for (int halving = 0; halving < 20; ++halving) {
          const double middle = (low + high) / 2;
          const auto q = on_curve(chain_, tool, a.q + middle * way);
          if (!q) break;
          Point p{*q, tangent(chain_, *q)};
          if (p.t.dot(way) < 0) p.t = -p.t;
          extremum = p;
          ((p.t[j] > 0) == (a.t[j] > 0) ? low : high) = middle;
        }
        if (extremum) extrema.emplace_back(low, *extremum);
      }
      // One joint may come inside its limit just before another leaves: the least excess on a chord between two outside points.
      int worst = -1;
      const double at_a = outside(a.q, worst), at_b = outside(b.q, worst);
      if (at_a > 0 && at_b > 0 && std::max(at_a, at_b) < kStep) {
        double low = 0, high = 1;
        for (int third = 0; third < 12; ++third) {
          const double left = low + (high - low) / 3, right = high - (high - low) / 3;
          const auto p = on_curve(chain_, tool, a.q + left * way), q = on_curve(chain_, tool, a.q + right * way);
          if (!p || !q) break;
          const double at_p = outside(*p, worst), at_q = outside(*q, worst);
          if (at_p <= 0 || at_q <= 0) {
            extrema.emplace_back(at_p <= 0 ? left : right, Point{at_p <= 0 ? *p : *q, way.normalized()});
            break;
          }
          (at_p < at_q ? high : low) = at_p < at_q ? right : left;
        }
      }
      std::stable_sort(extrema.begin(), extrema.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
      for (const auto& [along, p] : extrema) points.push_back(p);
    }
    const auto inside = [&](const Config& q) {
      int worst = -1;
      return outside(q, worst) <= 0;
    };
    std::vector<char> in;
    for (const Point& p : points) in.push_back(inside(p.q));
    const std::size_t size = points.size();
    // From an inside point to an outside one: where the limit is met, with its joint exactly on it.
    const auto cut = [&](const Config& from, const Config& to, int& joint) {
      Config low = from, high = low + difference(to, from);
      for (int halving = 0; halving < 30; ++halving) {
        const auto middle = on_curve(chain_, tool, (low + high) / 2);
        if (!middle) break;
        (inside(*middle) ? low : high) = *middle;
      }
      outside(high, joint);
      const auto at = static_cast<std::size_t>(joint);
      const double value = image(high[joint], at);
      Config end = low;
      end[joint] = std::abs(value - lower_[at]) < std::abs(value - upper_[at]) ? lower_[at] : upper_[at];
      if (const auto exact = on_curve(chain_, tool, end, joint)) return *exact;
      joint = -1;
      return low;
    };
    const auto finish = [&](SelfMotionArc arc) {
      for (Config& q : arc.q)
        for (int j = 0; j < kDof; ++j) {
          const auto at = static_cast<std::size_t>(j);
          // Not through the image: ends stand on limits bit for bit.
          if (!bounded_[at] || q[j] < lower_[at] || q[j] > upper_[at]) q[j] = image(q[j], at);
        }
      const auto less = [](const Config& a, const Config& b) {
        return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
      };
      if (arc.closed) {
        std::rotate(arc.q.begin(), std::min_element(arc.q.begin(), arc.q.end(), less), arc.q.end());
        if (less(arc.q.back(), arc.q[1])) std::reverse(arc.q.begin() + 1, arc.q.end());
      } else if (less(arc.q.back(), arc.q.front())) {
        std::reverse(arc.q.begin(), arc.q.end());
        std::swap(arc.first_limit, arc.last_limit);
      }
      result.push_back(std::move(arc));
    };
    const auto first_out = static_cast<std::size_t>(std::find(in.begin(), in.end(), 0) - in.begin());
    if (first_out == size) {
      SelfMotionArc arc;
      arc.closed = curve.closed;
      for (const Point& p : points) arc.q.push_back(p.q);
      finish(std::move(arc));
      continue;
    }
    // Pieces, from an outside point round a closed curve, or from end to end of an open one.
    const std::size_t origin = curve.closed ? first_out : 0;
    for (std::size_t k = 0; k < size;) {
      const auto at = [&](std::size_t n) { return (origin + n) % size; };
      if (!in[at(k)]) {
        ++k;
        continue;
      }
      SelfMotionArc arc;
      if (k > 0) arc.q.push_back(cut(points[at(k)].q, points[at(k - 1)].q, arc.first_limit));
      for (; k < size && in[at(k)]; ++k) arc.q.push_back(points[at(k)].q);
      if (k < size || curve.closed) arc.q.push_back(cut(arc.q.back(), points[at(k)].q, arc.last_limit));
      finish(std::move(arc));
    }
  }
  std::stable_sort(result.begin(), result.end(), [](const SelfMotionArc& a, const SelfMotionArc& b) {
    return std::lexicographical_compare(a.q[0].begin(), a.q[0].end(), b.q[0].begin(), b.q[0].end());
  });
  return result;
}

}  // namespace swivel
