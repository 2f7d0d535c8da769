// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/self_motion/self_motion_arcs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace swivel {

bool less(const Config& a, const Config& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

namespace {

using namespace self_motion;

/// A place on a curve where a joint comes to a limit.
struct Crossing {
  int chord;
  double u;
  int joint;
  bool at_upper, rising;
  [[nodiscard]] bool leaves() const { return at_upper == rising; }
};

/// Calls add(u, whether it rises) for every u in [0, 1) at which start + cubic equals `value`.
template <class Add>
void cubic_crossings(const Cubic& cubic, int j, double start, double value, const Add& add) {
  const double b = cubic.m0[j], c = 3 * cubic.d[j] - 2 * cubic.m0[j] - cubic.m1[j],
               d = cubic.m0[j] + cubic.m1[j] - 2 * cubic.d[j];
  const auto f = [&](double u) { return start - value + u * (b + u * (c + u * d)); };
  // Monotone between the roots of b + 2 c u + 3 d u^2.
  std::array<double, 4> knots{0, 1, 1, 1};
  std::size_t count = 1;
  const double square = c * c - 3 * d * b;
  if (square > 0) {
    const double far = -(c + std::copysign(std::sqrt(square), c));
    std::array<double, 2> turning{far == 0 ? -1 : b / far, d == 0 ? -1 : far / (3 * d)};
    if (turning[1] < turning[0]) std::swap(turning[0], turning[1]);
    for (const double u : turning)
      if (u > 0 && u < 1) knots[count++] = u;
  }
  knots[count] = 1;
  for (std::size_t k = 0; k < count; ++k) {
    double low = knots[k], high = knots[k + 1];
    const double at_low = f(low), at_high = f(high);
    if ((at_low <= 0) == (at_high <= 0)) continue;
    for (int step = 0; step < 40 && high - low > 1e-12; ++step) {
      const double middle = (low + high) / 2;
      ((f(middle) <= 0) == (at_low <= 0) ? low : high) = middle;
    }
    add(high, at_low <= 0);
  }
}

/// Cuts one curve at the joint limits.
class Cutter {
 public:
  Cutter(const SelfMotionData& data, const Pose& tool, std::vector<SelfMotionArc>& out)
      : data_(data), tool_(tool), out_(out) {}
  void cut(const std::vector<Point>& points, bool closed);

 private:
  void find_crossings(const std::vector<Point>& points, int chords);
  /// Finds the point of a chord at which the crossing's joint stands exactly on its limit, or
  /// another joint on its own, `joint`, where that is passed first. Returns false where Newton
  /// fails.
  bool solve_end(const std::vector<Point>& points, const Crossing& crossing, Point& end,
                 int& joint) const;
  void finish(SelfMotionArc&& arc);

  const SelfMotionData& data_;
  const Pose& tool_;
  std::vector<SelfMotionArc>& out_;
  std::vector<Crossing> crossings_;
};

void Cutter::find_crossings(const std::vector<Point>& points, int chords) {
  crossings_.clear();
  const auto size = points.size();
  for (int k = 0; k < chords; ++k) {
    const Point &a = points[static_cast<std::size_t>(k)],
                &b = points[(static_cast<std::size_t>(k) + 1) % size];
    std::optional<Cubic> cubic;
    const std::size_t before = crossings_.size();
    // A cubic leaves its first point by 1.6 chords at most (below).
    const double away = 1.6 * difference(b.q, a.q).norm() + 1e-9;
    for (int j = 0; j < kDof; ++j) {
      const auto at = static_cast<std::size_t>(j);
      if (data_.circle[at]) continue;
      if (a.q[j] - away > data_.lower[at] && a.q[j] + away < data_.upper[at]) continue;
      if (!cubic) cubic.emplace(a, b, 1.0);
      const double middle = (data_.lower[at] + data_.upper[at]) / 2,
                   start = middle + wrapped(a.q[j] - middle);
      // A cubic leaves the range of its ends by 4/27 of the fit error of its tangents at most.
      const double bulge =
          0.15 * (std::abs(cubic->m0[j] - cubic->d[j]) + std::abs(cubic->m1[j] - cubic->d[j]));
      const double least = std::min(start, start + cubic->d[j]) - bulge,
                   most = std::max(start, start + cubic->d[j]) + bulge;
      // Limits plus or minus a turn lie beyond the range.
      if (least > data_.lower[at] && most < data_.upper[at]) continue;
      for (const bool upper : {true, false})
        for (const double turn : {-kTwoPi, 0.0, kTwoPi}) {
          const double value = (upper ? data_.upper[at] : data_.lower[at]) + turn;
          if (value < least || value > most) continue;
          cubic_crossings(*cubic, j, start, value, [&](double u, bool rising) {
            crossings_.push_back({k, u, j, upper, rising});
          });
        }
    }
    const auto here = crossings_.begin() + static_cast<std::ptrdiff_t>(before);
    std::stable_sort(here, crossings_.end(),
                     [](const Crossing& x, const Crossing& y) { return x.u < y.u; });
    // A joint with a range of a whole turn meets both limits at once: it leaves by one, then enters
    // by the other.
    for (auto next = here; next != crossings_.end() && next + 1 != crossings_.end(); ++next)
      if (next[0].joint == next[1].joint && next[1].u - next[0].u < 1e-9 && next[1].leaves() &&
          !next[0].leaves())
        std::swap(next[0], next[1]);
  }
}

bool Cutter::solve_end(const std::vector<Point>& points, const Crossing& crossing, Point& end,
                       int& joint) const {
  const Point &a = points[static_cast<std::size_t>(crossing.chord)],
              &b = points[(static_cast<std::size_t>(crossing.chord) + 1) % points.size()];
  const Cubic cubic(a, b, 1.0);
  Config guess = a.q + cubic.at(crossing.u);
  joint = crossing.joint;
  bool at_upper = crossing.at_upper;
  for (int attempt = 0; attempt < 3; ++attempt) {
    const auto at = static_cast<std::size_t>(joint);
    const double value = at_upper ? data_.upper[at] : data_.lower[at];
    Config start = guess;
    start[joint] = value;
    const auto found = data_.newton.with_joint_at(start, tool_, joint, value);
    if (!found || difference(found->q, guess).norm() > 0.1) return false;
    end = *found;
    for (int j = 0; j < kDof; ++j)
      if (j != joint) end.q[j] = data_.image(end.q[j], static_cast<std::size_t>(j));
    if (end.tangent.dot(cubic.d) < 0) end.tangent = -end.tangent;
    // Where another joint has just passed its own limit, that one ends the arc.
    int worst = -1;
    double most = 0;
    for (int j = 0; j < kDof; ++j) {
      const auto other = static_cast<std::size_t>(j);
      if (data_.circle[other] || j == joint) continue;
      const double excess = std::max(data_.lower[other] - end.q[j], end.q[j] - data_.upper[other]);
      if (excess > most) {
        most = excess;
        worst = j;
      }
    }
    if (worst < 0) return true;
    at_upper = end.q[worst] > data_.upper[static_cast<std::size_t>(worst)];
    joint = worst;
    guess = end.q;
  }
  return false;
}

void Cutter::finish(SelfMotionArc&& arc) {
  const auto reverse = [&] {
    std::reverse(arc.q.begin(), arc.q.end());
    std::reverse(arc.tangent.begin(), arc.tangent.end());
    for (Config& t : arc.tangent) t = -t;
    std::swap(arc.limit[0], arc.limit[1]);
  };
  for (Config& q : arc.q)
    for (int j = 0; j < kDof; ++j) q[j] = data_.image(q[j], static_cast<std::size_t>(j));
  if (arc.closed) {
    const auto by_lock = [&](const Config& a, const Config& b) {
      return a[data_.lock] != b[data_.lock] ? a[data_.lock] < b[data_.lock] : less(a, b);
    };
    const auto first = std::min_element(arc.q.begin(), arc.q.end(), by_lock) - arc.q.begin();
    std::rotate(arc.q.begin(), arc.q.begin() + first, arc.q.end());
    std::rotate(arc.tangent.begin(), arc.tangent.begin() + first, arc.tangent.end());
    if (arc.tangent[0][data_.lock] < 0) {
      reverse();
      std::rotate(arc.q.begin(), arc.q.end() - 1, arc.q.end());
      std::rotate(arc.tangent.begin(), arc.tangent.end() - 1, arc.tangent.end());
    }
  } else if (less(arc.q.back(), arc.q.front())) {
    reverse();
  }
  // Simpson's rule on the cubics.
  double length = 0;
  arc.length.reserve(arc.q.size() + 1);
  arc.length.assign(1, 0);
  for (std::size_t k = 0; k < static_cast<std::size_t>(arc.chords()); ++k) {
    const std::size_t next = (k + 1) % arc.q.size();
    const Cubic cubic({arc.q[k], arc.tangent[k]}, {arc.q[next], arc.tangent[next]}, 1);
    const Config middle = 1.5 * cubic.d - 0.25 * (cubic.m0 + cubic.m1);
    length +=
        (data_.scale.cwiseProduct(cubic.m0).norm() + 4 * data_.scale.cwiseProduct(middle).norm() +
         data_.scale.cwiseProduct(cubic.m1).norm()) /
        6;
    arc.length.push_back(length);
  }
  out_.push_back(std::move(arc));
}

void Cutter::cut(const std::vector<Point>& points, bool closed) {
  const int size = static_cast<int>(points.size()), chords = closed ? size : size - 1;
  if (chords < 1) return;
  find_crossings(points, chords);
  const auto at = [&](int k) -> const Point& { return points[static_cast<std::size_t>(k % size)]; };
  if (crossings_.empty()) {
    if (!data_.inside(points[0].q)) return;
    SelfMotionArc arc;
    arc.closed = closed;
    arc.q.reserve(points.size());
    arc.tangent.reserve(points.size());
    for (const Point& p : points) {
      arc.q.push_back(p.q);
      arc.tangent.push_back(p.tangent);
    }
    finish(std::move(arc));
    return;
  }
  // Take the pieces between two neighbouring crossings; an open curve has one before the first and
  // one after the last as well.
  const int count = static_cast<int>(crossings_.size());
  for (int k = closed ? 0 : -1; k < count; ++k) {
    const Crossing* from = k >= 0 ? &crossings_[static_cast<std::size_t>(k)] : nullptr;
    const bool last = k + 1 == count;
    const Crossing* to = !last    ? &crossings_[static_cast<std::size_t>(k + 1)]
                         : closed ? &crossings_[0]
                                  : nullptr;
    if (from != nullptr && from->leaves()) continue;
    if (to != nullptr && !to->leaves()) continue;
    // Points from `first` to `end` - 1, counted on over the wrap.
    const int first = from != nullptr ? from->chord + 1 : 0;
    const int end = (to != nullptr ? to->chord + 1 : size) + (closed && last ? size : 0);
    bool within = false;
    if (first < end) {
      within = data_.inside(at(first).q);
    } else {
      const Cubic cubic(at(from->chord), at(from->chord + 1), 1.0);
      within = data_.inside(at(from->chord).q + cubic.at((from->u + to->u) / 2));
    }
    if (!within) continue;
    SelfMotionArc arc;
    arc.q.reserve(static_cast<std::size_t>(end - first + 2));
    arc.tangent.reserve(arc.q.capacity());
    Point p;
    if (from != nullptr) {
      if (!solve_end(points, *from, p, arc.limit[0])) continue;
      arc.q.push_back(p.q);
      arc.tangent.push_back(p.tangent);
    }
    for (int n = first; n < end; ++n) {
      // Leave out a point that coincides with the end on the limit.
      if (from != nullptr && n == first && difference(at(n).q, arc.q[0]).squaredNorm() < 1e-16)
        continue;
      arc.q.push_back(at(n).q);
      arc.tangent.push_back(at(n).tangent);
    }
    if (to != nullptr) {
      if (!solve_end(points, *to, p, arc.limit[1])) continue;
      if (arc.q.size() > 1 && difference(arc.q.back(), p.q).squaredNorm() < 1e-16) {
        arc.q.pop_back();
        arc.tangent.pop_back();
      }
      arc.q.push_back(p.q);
      arc.tangent.push_back(p.tangent);
    }
    if (arc.q.size() > 1) finish(std::move(arc));
  }
}

}  // namespace

void cut_at_limits(const SelfMotionData& data, const Pose& tool, const std::vector<Point>& points,
                   bool closed, std::vector<SelfMotionArc>& arcs) {
  Cutter(data, tool, arcs).cut(points, closed);
}

}  // namespace swivel
