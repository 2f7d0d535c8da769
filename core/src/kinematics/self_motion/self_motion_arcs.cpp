// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/self_motion/self_motion_arcs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace swivel {

bool less(const Config& a, const Config& b) {
  return std::lexicographical_compare(a.data(), a.data() + kMaxDof, b.data(), b.data() + kMaxDof);
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
/// `end` is the value at u = 1 where it is known exactly: the chords that meet in a point which
/// stands on a limit, as points at the first and last lock value of a slide do, then agree that it
/// does.
template <class Add>
void cubic_crossings(const Cubic& cubic, int j, double start, std::optional<double> end,
                     double value, const Add& add) {
  const double b = cubic.m0[j], c = 3 * cubic.d[j] - 2 * cubic.m0[j] - cubic.m1[j],
               d = cubic.m0[j] + cubic.m1[j] - 2 * cubic.d[j];
  const auto f = [&](double u) {
    return u == 1 && end ? *end - value : start - value + u * (b + u * (c + u * d));
  };
  // f is monotone between the roots of b + 2 c u + 3 d u^2.
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
  /// Appends the arcs of a curve that are within the joint limits.
  void cut(const std::vector<Point>& points, bool closed);

 private:
  /// A piece of a curve between two neighbouring crossings; null where the curve itself ends. It
  /// has the points from `first` to `end` - 1, which are counted on over the end of a closed curve.
  struct Piece {
    const Crossing *from = nullptr, *to = nullptr;
    int first = 0, end = 0;
  };
  /// Returns a point of a curve, counted on over its end.
  static const Point& on(const std::vector<Point>& points, int k) {
    return points[static_cast<std::size_t>(k % static_cast<int>(points.size()))];
  }
  static void add(SelfMotionArc& arc, const Point& p) {
    arc.q.push_back(p.q);
    arc.tangent.push_back(p.tangent);
  }
  void find_crossings(const std::vector<Point>& points, int chords);
  /// Finds the point of a chord at which the crossing's joint stands exactly on its limit, or
  /// another joint on its own, `joint`, where that is passed first. Returns false where Newton
  /// fails.
  bool solve_end(const std::vector<Point>& points, const Crossing& crossing, Point& end,
                 int& joint) const;
  /// Appends a curve that crosses no limit, if it is within them.
  void keep_whole(const std::vector<Point>& points, bool closed);
  /// Returns true if a piece is within the joint limits.
  [[nodiscard]] bool within_limits(const std::vector<Point>& points, const Piece& piece) const;
  /// Appends the arc of a piece, unless Newton fails at one of its ends.
  void keep(const std::vector<Point>& points, const Piece& piece);
  /// Appends an arc with its joints, direction and first point in their normal form, and with the
  /// lengths up to its points.
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
    const double away = 1.6 * joint_norm(difference(b.q, a.q, data_.slide)) + 1e-9;
    for (int j = 0; j < kDof; ++j) {
      const auto at = static_cast<std::size_t>(j);
      if (data_.circle[at]) continue;
      if (a.q[j] - away > data_.lower[at] && a.q[j] + away < data_.upper[at]) continue;
      if (!cubic) cubic.emplace(a, b, 1.0, data_.slide);
      const double middle = (data_.lower[at] + data_.upper[at]) / 2,
                   start = j == data_.slide ? a.q[j] : middle + wrapped(a.q[j] - middle);
      const auto end = j == data_.slide ? std::optional<double>(b.q[j]) : std::nullopt;
      // A cubic leaves the range of its ends by 4/27 of the fit error of its tangents at most.
      const double bulge =
          0.15 * (std::abs(cubic->m0[j] - cubic->d[j]) + std::abs(cubic->m1[j] - cubic->d[j]));
      const double least = std::min(start, start + cubic->d[j]) - bulge,
                   most = std::max(start, start + cubic->d[j]) + bulge;
      // Limits plus or minus a turn lie beyond the range.
      if (least > data_.lower[at] && most < data_.upper[at]) continue;
      for (const bool upper : {true, false})
        for (const double turn : {-kTwoPi, 0.0, kTwoPi}) {
          if (j == data_.slide && turn != 0) continue;
          const double value = (upper ? data_.upper[at] : data_.lower[at]) + turn;
          if (value < least || value > most) continue;
          cubic_crossings(*cubic, j, start, end, value, [&](double u, bool rising) {
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
  const Cubic cubic(a, b, 1.0, data_.slide);
  Config guess = a.q + cubic.at(crossing.u);
  joint = crossing.joint;
  bool at_upper = crossing.at_upper;
  for (int attempt = 0; attempt < 3; ++attempt) {
    const auto at = static_cast<std::size_t>(joint);
    const double value = at_upper ? data_.upper[at] : data_.lower[at];
    Config start = guess;
    start[joint] = value;
    const auto found = data_.newton.with_joint_at(start, tool_, joint, value);
    if (!found || joint_norm(difference(found->q, guess, data_.slide)) > 0.1) return false;
    end = *found;
    for (int j = 0; j < kDof; ++j)
      if (j != joint) end.q[j] = data_.image(end.q[j], static_cast<std::size_t>(j));
    if (joint_dot(end.tangent, cubic.d) < 0) end.tangent = -end.tangent;
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
  // The lengths of the cubics, by Simpson's rule.
  double length = 0;
  arc.length.reserve(arc.q.size() + 1);
  arc.length.assign(1, 0);
  for (std::size_t k = 0; k < static_cast<std::size_t>(arc.chords()); ++k) {
    const std::size_t next = (k + 1) % arc.q.size();
    const Cubic cubic({arc.q[k], arc.tangent[k]}, {arc.q[next], arc.tangent[next]}, 1, data_.slide);
    const Config middle = 1.5 * cubic.d - 0.25 * (cubic.m0 + cubic.m1);
    length += (joint_norm(data_.scale.cwiseProduct(cubic.m0)) +
               4 * joint_norm(data_.scale.cwiseProduct(middle)) +
               joint_norm(data_.scale.cwiseProduct(cubic.m1))) /
              6;
    arc.length.push_back(length);
  }
  out_.push_back(std::move(arc));
}

void Cutter::keep_whole(const std::vector<Point>& points, bool closed) {
  if (!data_.inside(points[0].q)) return;
  SelfMotionArc arc;
  arc.slide = data_.slide;
  arc.closed = closed;
  arc.q.reserve(points.size());
  arc.tangent.reserve(points.size());
  for (const Point& p : points) add(arc, p);
  finish(std::move(arc));
}

bool Cutter::within_limits(const std::vector<Point>& points, const Piece& piece) const {
  if (piece.first < piece.end) return data_.inside(on(points, piece.first).q);
  // Both ends lie on one chord.
  const Crossing &from = *piece.from, &to = *piece.to;
  const Cubic cubic(on(points, from.chord), on(points, from.chord + 1), 1.0, data_.slide);
  return data_.inside(on(points, from.chord).q + cubic.at((from.u + to.u) / 2));
}

void Cutter::keep(const std::vector<Point>& points, const Piece& piece) {
  constexpr double kSame2 = 1e-16;  // rad^2: two points nearer than its root are one
  const auto coincide = [this](const Config& a, const Config& b) {
    return joint_squared_norm(difference(a, b, data_.slide)) < kSame2;
  };
  SelfMotionArc arc;
  arc.slide = data_.slide;
  arc.q.reserve(static_cast<std::size_t>(piece.end - piece.first + 2));
  arc.tangent.reserve(arc.q.capacity());
  Point p;
  if (piece.from != nullptr) {
    if (!solve_end(points, *piece.from, p, arc.limit[0])) return;
    add(arc, p);
  }
  for (int n = piece.first; n < piece.end; ++n) {
    // Leave out a point that coincides with the end on the limit.
    if (piece.from != nullptr && n == piece.first && coincide(on(points, n).q, arc.q[0])) continue;
    add(arc, on(points, n));
  }
  if (piece.to != nullptr) {
    if (!solve_end(points, *piece.to, p, arc.limit[1])) return;
    if (arc.q.size() > 1 && coincide(arc.q.back(), p.q)) {
      arc.q.pop_back();
      arc.tangent.pop_back();
    }
    add(arc, p);
  }
  if (arc.q.size() > 1) finish(std::move(arc));
}

void Cutter::cut(const std::vector<Point>& points, bool closed) {
  const int size = static_cast<int>(points.size()), chords = closed ? size : size - 1;
  if (chords < 1) return;
  find_crossings(points, chords);
  if (crossings_.empty()) return keep_whole(points, closed);
  // Take the pieces between two neighbouring crossings; an open curve has one before the first and
  // one after the last as well.
  const int count = static_cast<int>(crossings_.size());
  for (int k = closed ? 0 : -1; k < count; ++k) {
    const bool last = k + 1 == count;
    Piece piece;
    piece.from = k >= 0 ? &crossings_[static_cast<std::size_t>(k)] : nullptr;
    piece.to = !last    ? &crossings_[static_cast<std::size_t>(k + 1)]
               : closed ? &crossings_[0]
                        : nullptr;
    if (piece.from != nullptr && piece.from->leaves()) continue;
    if (piece.to != nullptr && !piece.to->leaves()) continue;
    piece.first = piece.from != nullptr ? piece.from->chord + 1 : 0;
    piece.end = (piece.to != nullptr ? piece.to->chord + 1 : size) + (closed && last ? size : 0);
    if (within_limits(points, piece)) keep(points, piece);
  }
}

}  // namespace

void cut_at_limits(const SelfMotionData& data, const Pose& tool, const std::vector<Point>& points,
                   bool closed, std::vector<SelfMotionArc>& arcs) {
  Cutter(data, tool, arcs).cut(points, closed);
}

}  // namespace swivel
