// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/self_motion.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pose_newton.hpp"
#include "swivel/core/alignment.hpp"
#include "swivel/core/angle.hpp"

namespace swivel {

namespace {

using Point = PoseNewton::Point;

constexpr int kSeeds = 32;             // lock values, evenly over a turn
constexpr double kStep = 0.2;          // rad, Euclidean: longest step of tracing
constexpr double kLeastStep = 1e-7;    // rad: below this a curve is singular
constexpr double kLongChord = 0.7;     // rad: joined directly; longer ones are traced
constexpr double kNear = 0.02;         // rad from a chord: a seed there is known
constexpr double kSeed = 5e-3;         // rad: a start this near a seed is the seed
constexpr double kFar = 1;             // rad: more than a chord and what is near it
constexpr double kFarTriple = 0.25;    // relative discriminant of complex roots that give seeds: of a spherical triple,
constexpr double kFarParallel = 1;     // and of three parallel axes
constexpr int kMostPoints = 4000;      // of one curve
constexpr int kFollowed = 64;          // of those that are followed ahead of time
constexpr int kAround = 40;            // after as many, tracing may have come round to what is known
constexpr double kSingular = 1e-6;     // rad from alignment of a triple
constexpr double kSliver = 1e-3;       // rad by which a range must exceed a turn, so that the joint is a circle
constexpr double kLeastWeight = 1e-2;  // of the largest
constexpr int kStarts = 96;            // of Newton, where there is no closed form
constexpr int kApproachSteps = 30;     // from such a start
constexpr int kDepth = 3;              // as often a chord is halved
constexpr int kImageSteps = 6;         // Newton steps from a node to its image
constexpr double kMostDrift = 0.2;     // rad of self-motion by which an image may leave the nearest one
constexpr int kCloseSteps = 4;         // and from a guess on a curve
const Config kPlain = Config::Ones();

double difference(double a, double b) {
  constexpr double kRound = 0x1.8p52;  // added and taken away again, it rounds to an integer
  const double d = a - b;
  return d - kTwoPi * ((d * (1 / kTwoPi) + kRound) - kRound);
}

Config difference(const Config& a, const Config& b) {
  Config d;
  for (int j = 0; j < kDof; ++j) d[j] = difference(a[j], b[j]);
  return d;
}

/// wrap_angle() without its division where there is nothing to wrap.
double wrapped(double angle) {
  return std::abs(angle) < 3 ? angle : wrap_angle(angle);
}

/// False only where they are further apart than `within` in this joint alone: cheap, and true of few.
bool maybe_near(const Config& a, const Config& b, int joint, double within) {
  const double apart = std::abs(a[joint] - b[joint]);
  return apart < within || apart > kTwoPi - within;
}

/// The same of any joint.
bool maybe_near(const Config& a, const Config& b, double within) {
  for (int j = 0; j < kDof; ++j)
    if (!maybe_near(a, b, j, within)) return false;
  return true;
}

/// The cubic with the tangents of its ends, as long as its chord: relative to its first point, at + u (b + u (c + u d)).
struct Cubic {
  Config d, m0, m1;  // chord, and tangents times its length
  Cubic(const Point& a, const Point& b, double sign_b) : d(difference(b.q, a.q)) {
    const double length = d.norm();
    m0 = length * a.tangent;
    m1 = (length * sign_b) * b.tangent;
  }
  [[nodiscard]] Config at(double u) const { return u * m0 + (u * u) * (3 * d - 2 * m0 - m1) + (u * u * u) * (m0 + m1 - 2 * d); }
  [[nodiscard]] double at(int j, double u) const {
    return u * (m0[j] + u * (3 * d[j] - 2 * m0[j] - m1[j] + u * (m0[j] + m1[j] - 2 * d[j])));
  }
};

/// Points of curves and their neighbours. Side 0 of a point lies behind it along its tangent, side 1 ahead.
struct Vertex : Point {
  int group = -1;                   // of the lock value, -1: traced
  std::array<int, 2> next{-1, -1};  // 2 * neighbour + the neighbour's side; -1: open
};

/// The other way to turn a rigid body as three axes do that meet in a point, each perpendicular to the next: a half turn about the
/// first, the second on the other side of alignment, a half turn back about the third. All else may stand, so curves come in pairs.
class Flip {
 public:
  Flip() = default;
  Flip(int first, double aligned) : first_(first), aligned_(aligned) {}
  [[nodiscard]] bool none() const { return first_ < 0; }
  /// Of a pair one is on this side; at the alignment, to rounding, both.
  [[nodiscard]] bool kept(const Config& q) const { return none() || std::sin(q[first_ + 1] - aligned_) > -1e-9; }
  void apply(Config& q) const {
    q[first_] += kPi;
    q[first_ + 1] = 2 * aligned_ - q[first_ + 1];
    q[first_ + 2] += kPi;
  }
  void apply(Point& p) const {
    apply(p.q);
    p.tangent[first_ + 1] = -p.tangent[first_ + 1];
  }

 private:
  int first_ = -1;  // joint, 0-based; -1: there is no such triple
  double aligned_ = 0;
};

double turned_away(const Config& direction, const Config& chord, double length) {
  return 1 - direction.dot(chord) / length;
}

}  // namespace

struct SelfMotionData {
  explicit SelfMotionData(const Chain& chain) : newton(chain) {}
  PoseNewton newton;
  int lock = -1, other = 0;  // a joint that is not the lock
  std::array<double, kDof> lower{}, upper{};
  std::array<bool, kDof> circle{};
  Config scale, scale2;
  std::vector<Alignment> alignments;
  Flip flip;                                         // of curves, one of two is sought
  std::vector<std::pair<double, ClosedForm>> forms;  // by lock value; none without a lock
  std::vector<Config> starts;                        // of Newton, without a lock

  [[nodiscard]] double image(double angle, std::size_t j) const {
    if (circle[j]) return wrapped(angle);
    if (angle >= lower[j] && angle <= upper[j]) return angle;  // ends stand on limits bit for bit
    const double middle = (lower[j] + upper[j]) / 2;
    return middle + wrapped(angle - middle);
  }
  [[nodiscard]] bool inside(const Config& q) const {
    for (std::size_t j = 0; j < kDof; ++j) {
      if (circle[j]) continue;
      const double value = image(q[static_cast<Eigen::Index>(j)], j);
      if (!(value >= lower[j] && value <= upper[j])) return false;
    }
    return true;
  }
  [[nodiscard]] bool aligned(const Config& q) const {
    return std::any_of(alignments.begin(), alignments.end(),
                       [&](const Alignment& a) { return std::abs(wrap_angle(q[a.joint] - a.angle)) < kSingular; });
  }
  /// Whether the move passes over an alignment.
  [[nodiscard]] bool passes_alignment(const Config& q, const Config& move) const {
    return std::any_of(alignments.begin(), alignments.end(), [&](const Alignment& a) {
      const double before = wrap_angle(q[a.joint] - a.angle), after = before + move[a.joint];
      return (before > 0) != (after > 0) || std::abs(after) < kSingular;
    });
  }
};

namespace {

/// All curves of one pose.
class Curves {
 public:
  Curves(const SelfMotionData& data, const Pose& tool) : data_(data), tool_(tool) {}
  void find(std::span<const Config> known);
  /// Visits curve by curve: the points in order, tangents along it.
  template <class Visit>
  void visit(const Visit& visit) const;

 private:
  [[nodiscard]] Config outward(int half) const {
    const Vertex& v = vertices_[static_cast<std::size_t>(half / 2)];
    return half % 2 == 1 ? v.tangent : Config(-v.tangent);
  }
  Vertex& at(int half) { return vertices_[static_cast<std::size_t>(half / 2)]; }
  [[nodiscard]] const Vertex& at(int half) const { return vertices_[static_cast<std::size_t>(half / 2)]; }
  [[nodiscard]] bool open(int half) const { return at(half).next[static_cast<std::size_t>(half % 2)] < 0; }
  void link(int half, int other) {
    at(half).next[static_cast<std::size_t>(half % 2)] = other;
    at(other).next[static_cast<std::size_t>(other % 2)] = half;
  }
  int add(const Point& p, int group) {
    Vertex v;
    v.q = p.q;
    v.tangent = p.tangent;
    v.group = group;
    vertices_.push_back(v);
    return static_cast<int>(vertices_.size()) - 1;
  }
  void add_end(int half) { open_.push_back({half, at(half).q}); }
  void add_seeds();
  void join_neighbours();
  /// How badly a smooth curve fits the move from a half-edge to another; none where it does not.
  [[nodiscard]] std::optional<double> misfit(int half, int other) const;
  [[nodiscard]] bool straight(int half, int other, const Config& chord) const;
  [[nodiscard]] Config middle(int half, int other) const;
  /// A way between two half-edges that is closed over the point to which Newton leads from `guess`.
  struct Gap {
    int half, other;
    Config guess;
    double within;  // rad: as far from the guess that point may lie
  };
  /// A way that turns more than a chord may, as a fold does.
  struct Turn {
    double miss;  // part of the chord by which it leaves the bisector of the tangents
    Gap gap;
  };
  [[nodiscard]] std::optional<Turn> turning(int half, int other) const;
  /// Links two half-edges, or adds the gap between them; neither where no curve is seen to join them.
  void join(int half, int other, int depth, std::vector<Gap>& gaps);
  /// Closes all gaps at once, then those that are left on either side of the points found.
  void close(std::vector<Gap> gaps);
  void bridge_ends();

  /// A point on its way along a curve.
  struct Walk {
    Point here;
    Config bend = Config::Zero();  // curvature from the point before
    bool bent = false;
    [[nodiscard]] Config guess(double step) const {
      const Config ahead = here.q + step * here.tangent;
      return bent ? Config(ahead + (step * step / 2) * bend) : ahead;
    }
    void go(const Point& next) {
      bend = (next.tangent - here.tangent) / std::sqrt((next.q - here.q).squaredNorm());
      bent = true;
      here = next;
    }
  };
  /// Points that tracing from an open half-edge comes to, and the steps that led there.
  struct Trail {
    int half;
    std::vector<Point> points{};
    std::vector<double> steps{};
    int met = -1;        // the open half-edge that the last step passes
    bool ended = false;  // the curve cannot be followed further
  };
  [[nodiscard]] double first_step(const Point& p, double step) const;
  /// `next` with its tangent turned along the curve; none where it is no good step from p.
  [[nodiscard]] std::optional<Point> accepted(const Point& p, const Config& guess, double step, std::optional<Point> next) const;
  [[nodiscard]] std::optional<Point> advance(const Walk& walk, double& step) const;
  /// The first open half-edge that a move from p passes, `count` points after the half-edge `from`; -1: none.
  [[nodiscard]] int met(int from, int count, const Point& p, const Config& move) const;
  void trace(int half, const Trail* trail);
  /// Follows all trails at once, links nothing.
  void follow(std::vector<Trail>& trails) const;
  void trace_all();
  /// Whether a chord that is linked runs by, no further off than `near` and a part of its length.
  [[nodiscard]] bool known(const Config& q, const Config& tangent, double near, double part) const;
  void add_hidden(std::vector<Config> points);

  const SelfMotionData& data_;
  const Pose& tool_;
  std::vector<Vertex> vertices_;
  std::vector<int> first_;  // vertex of each lock value, and the end
  std::vector<char> few_;   // lock values with fewer solutions than there may be
  struct End {
    int half;
    Config q;  // again, side by side
  };
  std::vector<End> open_;  // half-edges that tracing may meet
};

void Curves::add_seeds() {
  vertices_.reserve(1024);
  // Of a closed form that is the chain's own, solutions; else starts of Newton on the exact chain.
  struct {
    std::vector<Config> q;
    std::vector<double> lock;
    PoseNewton::Points found;
  } solved, started;
  std::vector<std::size_t> counts;  // by lock value
  for (const auto& [value, form] : data_.forms) {
    const bool exact = form.fit().exact;
    auto& list = exact ? solved : started;
    const std::size_t before = list.q.size();
    for (const Config6& six : exact ? form.solve(tool_) : form.starts(tool_, 1e-2)) {
      const Config q = with_joint(six, data_.lock, value);
      if (!data_.flip.kept(q)) continue;
      list.q.push_back(q);
      list.lock.push_back(value);
    }
    counts.push_back(list.q.size() - before);
  }
  data_.newton.tangents(solved.q, tool_, solved.found);
  data_.newton.with_joint_at(started.q, tool_, data_.lock, started.lock, started.found);
  std::array<std::size_t, 2> next{};
  for (std::size_t k = 0; k < data_.forms.size(); ++k) {
    const bool exact = data_.forms[k].second.fit().exact;
    const PoseNewton::Points& found = exact ? solved.found : started.found;
    std::size_t& at = next[exact ? 0 : 1];
    first_.push_back(static_cast<int>(vertices_.size()));
    int count = 0;
    for (const std::size_t end = at + counts[k]; at < end; ++at) {
      auto p = found.at(at);
      if (!p || data_.aligned(p->q)) continue;
      if (!exact) {
        bool twice = false;
        for (std::size_t other = static_cast<std::size_t>(first_.back()); other < vertices_.size(); ++other)
          twice = twice || difference(vertices_[other].q, p->q).squaredNorm() < 1e-12;
        if (twice) continue;
      }
      if (p->tangent[data_.lock] < 0) p->tangent = -p->tangent;
      add(*p, static_cast<int>(k));
      ++count;
    }
    few_.push_back(count < (data_.flip.none() ? 8 : 4));
  }
  first_.push_back(static_cast<int>(vertices_.size()));
}

std::optional<double> Curves::misfit(int half, int other) const {
  constexpr double kBend = 0.06;    // 1 - cosine of tangent and chord: 0.35 rad
  constexpr double kUneven = 0.02;  // part of the chord by which a parabola with the tangents may miss it
  if (!maybe_near(at(other).q, at(half).q, kLongChord)) return std::nullopt;
  const Config chord = difference(at(other).q, at(half).q);
  const double length2 = chord.squaredNorm();
  if (!(length2 > 0 && length2 < kLongChord * kLongChord)) return std::nullopt;
  const double length = std::sqrt(length2);
  const Config t0 = outward(half), t1 = -outward(other);
  if (turned_away(t0, chord, length) > kBend || turned_away(t1, chord, length) > kBend) return std::nullopt;
  const double miss = (chord - (length / 2) * (t0 + t1)).norm();
  if (miss > kUneven * length || data_.passes_alignment(at(half).q, chord)) return std::nullopt;
  return miss;
}

bool Curves::straight(int half, int other, const Config& chord) const {
  constexpr double kStraight = 0.02;  // 1 - cosine between the ends: 0.2 rad
  constexpr double kLong = 0.3;       // rad
  return chord.norm() < kLong && outward(half).dot(-outward(other)) > 1 - kStraight;
}

Config Curves::middle(int half, int other) const {
  const Cubic cubic({at(half).q, outward(half)}, {at(other).q, -outward(other)}, 1);
  return at(half).q + cubic.at(0.5);
}

std::optional<Curves::Turn> Curves::turning(int half, int other) const {
  constexpr double kLong = 1.2;          // rad
  constexpr double kLeastCosine = -0.6;  // of the whole turn
  constexpr double kOff = 0.25;          // part of the chord
  constexpr double kWithin = 0.2;        // likewise
  if (!maybe_near(at(other).q, at(half).q, kLong)) return std::nullopt;
  const Config chord = difference(at(other).q, at(half).q), t0 = outward(half), t1 = -outward(other);
  const double length = chord.norm();
  if (!(length > 0 && length < kLong) || t0.dot(t1) < kLeastCosine) return std::nullopt;
  // An arc of a circle has its chord along the bisector of its tangents.
  const Config sum = t0 + t1;
  const double both = sum.norm(), along = chord.dot(sum) / both;
  const double miss = (chord - (along / both) * sum).norm() / length;
  if (!(along > 0 && miss < kOff) || data_.passes_alignment(at(half).q, chord)) return std::nullopt;
  // With tangents of this length a cubic passes the middle of the circle's arc.
  const double tangent = length / (0.5 + 0.25 * both);
  return Turn{miss, {half, other, at(half).q + chord / 2 + (tangent / 8) * (t0 - t1), kWithin * length}};
}

void Curves::join(int half, int other, int depth, std::vector<Gap>& gaps) {
  if (misfit(half, other)) {
    const Config chord = difference(at(other).q, at(half).q);
    if (depth == 0 || straight(half, other, chord))
      link(half, other);
    else
      gaps.push_back({half, other, middle(half, other), 0.1 * chord.norm()});
  } else if (depth > 0) {
    if (const auto turn = turning(half, other)) gaps.push_back(turn->gap);
  }
}

void Curves::close(std::vector<Gap> gaps) {
  std::vector<Config> guesses;
  std::vector<Gap> left;
  PoseNewton::Points middles;
  for (int depth = kDepth; !gaps.empty(); --depth) {
    guesses.clear();
    for (const Gap& gap : gaps) guesses.push_back(gap.guess);
    data_.newton.nearest(guesses, tool_, kPlain, kCloseSteps, middles);
    left.clear();
    for (std::size_t k = 0; k < gaps.size(); ++k) {
      const Gap& gap = gaps[k];
      auto p = middles.at(k);
      if (!p || (p->q - gap.guess).norm() > gap.within || data_.aligned(p->q)) continue;
      if (p->tangent.dot(difference(at(gap.other).q, at(gap.half).q)) < 0) p->tangent = -p->tangent;
      const int v = add(*p, -1);
      join(gap.half, 2 * v, depth - 1, left);
      join(2 * v + 1, gap.other, depth - 1, left);
    }
    gaps.swap(left);
  }
}

void Curves::join_neighbours() {
  const std::size_t count = data_.forms.size();
  std::vector<Gap> gaps;
  std::vector<char> taken(vertices_.size(), 0);
  for (std::size_t k = 0; k < count; ++k)
    for (int a = first_[k]; a < first_[k + 1]; ++a) {
      const std::size_t next = (k + 1) % count;
      int best = -1;
      double least = 0;
      for (int b = first_[next]; b < first_[next + 1]; ++b) {
        if (taken[static_cast<std::size_t>(b)] != 0) continue;
        const auto miss = misfit(2 * a + 1, 2 * b);
        if (miss && (best < 0 || *miss < least)) {
          best = b;
          least = *miss;
        }
      }
      if (best < 0) continue;
      taken[static_cast<std::size_t>(best)] = 1;
      join(2 * a + 1, 2 * best, kDepth, gaps);
    }
  close(std::move(gaps));
}

void Curves::bridge_ends() {
  const std::size_t count = data_.forms.size();
  std::vector<Gap> gaps;
  std::vector<int> ends;  // that lie between two lock values
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t next = (k + 1) % count;
    ends.clear();
    for (int v = first_[k]; v < first_[k + 1]; ++v)
      if (open(2 * v + 1)) ends.push_back(2 * v + 1);
    for (int v = first_[next]; v < first_[next + 1]; ++v)
      if (open(2 * v)) ends.push_back(2 * v);
    while (!ends.empty()) {
      const int end = ends.front();
      ends.erase(ends.begin());
      std::optional<Turn> best;
      for (const int other : ends) {
        const auto turn = turning(end, other);
        if (turn && (!best || turn->miss < best->miss)) best = turn;
      }
      if (!best) continue;
      std::erase(ends, best->gap.other);
      gaps.push_back(best->gap);
    }
  }
  close(std::move(gaps));
}

double Curves::first_step(const Point& p, double step) const {
  step = std::min(kStep, 2 * step);
  for (const Alignment& a : data_.alignments) {
    const double apart = std::abs(wrap_angle(p.q[a.joint] - a.angle)), rate = std::abs(p.tangent[a.joint]);
    if (rate * step > 0.7 * apart) step = std::max(kLeastStep, 0.7 * apart / rate);
  }
  return step;
}

std::optional<Point> Curves::accepted(const Point& p, const Config& guess, double step, std::optional<Point> next) const {
  if (!next) return std::nullopt;
  const Config move = next->q - p.q;
  const double length = move.norm();
  if (length > 1.3 * step || (next->q - guess).norm() > 0.1 * step) return std::nullopt;
  if (next->tangent.dot(p.tangent) < 0) next->tangent = -next->tangent;
  if (next->tangent.dot(p.tangent) < 0.965 || turned_away(p.tangent, move, length) > 0.03) return std::nullopt;
  if ((move - (length / 2) * (p.tangent + next->tangent)).norm() > 0.02 * length) return std::nullopt;
  if (data_.passes_alignment(p.q, move)) return std::nullopt;
  return next;
}

std::optional<Point> Curves::advance(const Walk& walk, double& step) const {
  for (step = first_step(walk.here, step); step >= kLeastStep; step /= 2) {
    const Config guess = walk.guess(step);
    if (const auto next = accepted(walk.here, guess, step, data_.newton.nearest(guess, tool_, kPlain, kCloseSteps))) return next;
  }
  return std::nullopt;
}

int Curves::met(int from, int count, const Point& p, const Config& move) const {
  const double length2 = move.squaredNorm(), within = 1.1 * std::sqrt(length2);  // of what may lie that far along and that near
  int result = -1;
  double first = 2;
  for (const auto& [other, q] : open_) {
    if (!maybe_near(q, p.q, within)) continue;
    if (!open(other) || (other == from && count < 4)) continue;
    const Config way = difference(q, p.q);
    const double along = way.dot(move) / length2;
    if (!(along > 1e-6 && along <= 1.05) || along >= first) continue;
    const Config inward = -outward(other);
    if (inward.dot(p.tangent) < 0.9) continue;
    // Off the chord by its sagitta at most, and some.
    if ((way - along * move).squaredNorm() > 0.01 * length2) continue;
    result = other;
    first = along;
  }
  return result;
}

void Curves::trace(int half, const Trail* trail) {
  double step = kStep / 4;
  Walk walk{{at(half).q, outward(half)}};
  int here = half, again = 0;
  for (int count = 0; count < kMostPoints; ++count) {
    std::optional<Point> next;
    bool alone = false;  // no open half-edge was there when the trail was followed: there are fewer now
    if (const auto at = static_cast<std::size_t>(count); trail != nullptr && at < trail->points.size()) {
      next = trail->points[at];
      step = trail->steps[at];
      alone = trail->met < 0 || at + 1 < trail->points.size();
    } else if (trail == nullptr || !trail->ended) {
      next = advance(walk, step);
    }
    if (!next) return;
    // An open half-edge that this step passes is the continuation.
    if (const int other = alone ? -1 : met(half, count, walk.here, next->q - walk.here.q); other >= 0) {
      link(here, other);
      return;
    }
    // Where curves nearly cross, a chord may have led from one to the other: the end that it left out has no continuation.
    again = count >= kAround && known(next->q, next->tangent, 1e-3, 0.03) ? again + 1 : 0;
    if (again == 3) return;
    walk.go(*next);
    const int v = add(*next, -1);
    link(here, 2 * v);
    here = 2 * v + 1;
  }
}

void Curves::follow(std::vector<Trail>& trails) const {
  struct Walker {
    Trail* trail;
    Walk walk;
    double step;
  };
  std::vector<Walker> walkers;
  for (Trail& trail : trails) {
    const Point p{at(trail.half).q, outward(trail.half)};
    walkers.push_back({&trail, Walk{p}, first_step(p, kStep / 4)});
  }
  std::vector<Config> guesses;
  PoseNewton::Points found;
  while (!walkers.empty()) {
    guesses.clear();
    for (const Walker& walker : walkers) guesses.push_back(walker.walk.guess(walker.step));
    data_.newton.nearest(guesses, tool_, kPlain, kCloseSteps, found);
    for (std::size_t k = 0; k < walkers.size(); ++k) {
      Walker& walker = walkers[k];
      Trail& trail = *walker.trail;
      const auto next = accepted(walker.walk.here, guesses[k], walker.step, found.at(k));
      if (!next) {
        walker.step /= 2;
        trail.ended = walker.step < kLeastStep;
        if (trail.ended) walker.trail = nullptr;
        continue;
      }
      const int count = static_cast<int>(trail.points.size());
      trail.points.push_back(*next);
      trail.steps.push_back(walker.step);
      trail.met = met(trail.half, count, walker.walk.here, next->q - walker.walk.here.q);
      if (trail.met >= 0 || count + 1 == kFollowed) {
        walker.trail = nullptr;
        continue;
      }
      walker.walk.go(*next);
      walker.step = first_step(walker.walk.here, walker.step);
    }
    std::erase_if(walkers, [](const Walker& walker) { return walker.trail == nullptr; });
  }
}

void Curves::trace_all() {
  // What is open ahead is met from behind by the next lock value's, or at a fold by another of its own. So a quarter of the ends is
  // followed at once, then what was not met of the next. What is followed in vain changes nothing: curves are linked one after the
  // other, in the order of the ends.
  std::array<std::vector<int>, 4> quarters;
  std::map<std::pair<int, int>, std::size_t> rank;
  for (const auto& [half, q] : open_) {
    const int ahead = half % 2;
    quarters[(ahead == 1 ? 0u : 2u) + rank[{at(half).group, ahead}]++ % 2].push_back(half);
  }
  std::vector<char> reached(2 * vertices_.size(), 0);
  std::vector<std::vector<Trail>> trails;
  for (const auto& quarter : quarters) {
    auto& followed = trails.emplace_back();
    for (const int half : quarter)
      if (PoseNewton::sooner_at_once() && reached[static_cast<std::size_t>(half)] == 0) followed.push_back({half});
    follow(followed);
    for (const Trail& trail : followed)
      if (trail.met >= 0) reached[static_cast<std::size_t>(trail.met)] = 1;
  }
  std::vector<const Trail*> trail_of(2 * vertices_.size(), nullptr);
  for (const auto& followed : trails)
    for (const Trail& trail : followed) trail_of[static_cast<std::size_t>(trail.half)] = &trail;
  for (const auto& [half, q] : open_)
    if (open(half)) trace(half, trail_of[static_cast<std::size_t>(half)]);
}

bool Curves::known(const Config& q, const Config& tangent, double near, double part) const {
  constexpr double kBeside = 0.2;                     // rad: more than what is near a chord lies beside it
  constexpr double kAway = 1.2 * kLongChord + kNear;  // rad: what is near a chord is not further from its ends
  for (const Vertex& v : vertices_) {
    if (!maybe_near(v.q, q, data_.lock, kAway) || !maybe_near(v.q, q, kAway)) continue;
    const double before = difference(v.q[data_.lock], q[data_.lock]);
    if (std::abs(before) > kFar) continue;
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      const int next = v.next[side];
      if (next < 0) continue;
      // Each chord once, from the point with the smaller number.
      const Vertex& w = at(next);
      if (&w < &v) continue;
      const double after = difference(w.q[data_.lock], q[data_.lock]);
      if (std::min(before, after) > kBeside || std::max(before, after) < -kBeside) continue;
      const Config chord = difference(w.q, v.q);
      const double length = chord.norm();
      const Config way = difference(q, v.q);
      const double along = way.dot(chord) / (length * length);
      if (!(along > -0.1 && along < 1.1)) continue;
      if (std::abs(tangent.dot(chord)) < 0.8 * length) continue;
      if ((way - along * chord).norm() < near + part * length) return true;
    }
  }
  return false;
}

void Curves::add_hidden(std::vector<Config> points) {
  for (Config& q : points)
    if (!data_.flip.kept(q)) data_.flip.apply(q);
  PoseNewton::Points found;
  data_.newton.tangents(points, tool_, found);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto p = found.at(k);
    if (!p || data_.aligned(p->q) || known(p->q, p->tangent, kNear, 0.1)) continue;
    const int v = add(*p, -1);
    open_.clear();
    add_end(2 * v);
    add_end(2 * v + 1);
    trace(2 * v + 1, nullptr);
    if (open(2 * v)) trace(2 * v, nullptr);
  }
}

void Curves::find(std::span<const Config> known_points) {
  add_seeds();
  join_neighbours();
  bridge_ends();
  for (int v = 0; v < static_cast<int>(vertices_.size()); ++v)
    for (const int half : {2 * v, 2 * v + 1})
      if (open(half) && (at(half).group >= 0 || !open(half ^ 1))) add_end(half);
  trace_all();
  add_hidden({known_points.begin(), known_points.end()});
  if (data_.forms.empty()) {
    for (const Config& start : data_.starts)
      if (const auto p = data_.newton.approach(start, tool_, kApproachSteps)) add_hidden({p->q});
    return;
  }
  // Curves whose lock stays between two values: complex roots lie near them, and Newton on all seven joints leads there.
  std::vector<Config> starts, hidden;
  for (std::size_t k = 0; k < data_.forms.size(); ++k) {
    if (few_[k] == 0) continue;
    const auto& [value, form] = data_.forms[k];
    const bool parallel = form.fit().structure == Structure::kParallel;
    for (const Config6& six : form.starts(tool_, parallel ? kFarParallel : kFarTriple)) {
      const Config start = with_joint(six, data_.lock, value);
      if (!data_.flip.kept(start)) continue;
      const auto seed = [&](const Vertex& v) {
        return maybe_near(v.q, start, data_.other, kSeed) && difference(v.q, start).squaredNorm() < kSeed * kSeed;
      };
      if (std::any_of(vertices_.begin() + first_[k], vertices_.begin() + first_[k + 1], seed)) continue;
      starts.push_back(start);
    }
  }
  PoseNewton::Points found;
  data_.newton.nearest(starts, tool_, kPlain, 8, found);
  for (std::size_t k = 0; k < starts.size(); ++k)
    if (found.found[k] != 0) hidden.push_back(found.q[k]);
  add_hidden(std::move(hidden));
}

template <class Visit>
void Curves::visit(const Visit& visit) const {
  std::vector<char> seen(vertices_.size(), 0);
  std::vector<Point> points;
  const auto walk = [&](int v, int side) {
    points.clear();
    bool closed = false;
    for (int half = 2 * v + side;;) {
      const auto index = static_cast<std::size_t>(half / 2);
      seen[index] = 1;
      points.push_back({vertices_[index].q, outward(half)});
      const int next = vertices_[index].next[static_cast<std::size_t>(half % 2)];
      if (next < 0) break;
      if (next / 2 == v) {
        closed = true;
        break;
      }
      half = next ^ 1;  // in by one side, out by the other
    }
    visit(points, closed);
    if (data_.flip.none()) return;
    for (Point& p : points) data_.flip.apply(p);
    visit(points, closed);
  };
  for (int v = 0; v < static_cast<int>(vertices_.size()); ++v) {
    const auto& vertex = vertices_[static_cast<std::size_t>(v)];
    if (seen[static_cast<std::size_t>(v)] || (vertex.next[0] >= 0 && vertex.next[1] >= 0)) continue;
    if (vertex.next[0] < 0 && vertex.next[1] < 0) continue;
    walk(v, vertex.next[0] < 0 ? 1 : 0);
  }
  for (int v = 0; v < static_cast<int>(vertices_.size()); ++v) {
    const auto& vertex = vertices_[static_cast<std::size_t>(v)];
    if (!seen[static_cast<std::size_t>(v)] && vertex.next[0] >= 0 && vertex.next[1] >= 0) walk(v, 1);
  }
}

/// A joint comes to a limit.
struct Crossing {
  int chord;
  double u;
  int joint;
  bool at_upper, rising;
  [[nodiscard]] bool leaves() const { return at_upper == rising; }
};

/// Where start + cubic equals `value`, in [0, 1), appended with whether it rises there.
template <class Add>
void cubic_crossings(const Cubic& cubic, int j, double start, double value, const Add& add) {
  const double b = cubic.m0[j], c = 3 * cubic.d[j] - 2 * cubic.m0[j] - cubic.m1[j], d = cubic.m0[j] + cubic.m1[j] - 2 * cubic.d[j];
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

bool less(const Config& a, const Config& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

/// Cuts one curve at the limits.
class Cutter {
 public:
  Cutter(const SelfMotionData& data, const Pose& tool, std::vector<SelfMotionArc>& out) : data_(data), tool_(tool), out_(out) {}
  void cut(const std::vector<Point>& points, bool closed);

 private:
  void find_crossings(const std::vector<Point>& points, int chords);
  /// The point of a chord at which the crossing's joint stands on its limit, exactly; another joint's where that is passed first.
  bool solve_end(const std::vector<Point>& points, const Crossing& crossing, Point& end, int& joint) const;
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
    const Point &a = points[static_cast<std::size_t>(k)], &b = points[(static_cast<std::size_t>(k) + 1) % size];
    std::optional<Cubic> cubic;
    const std::size_t before = crossings_.size();
    // A cubic leaves its first point by 1.6 chords at most (below).
    const double away = 1.6 * difference(b.q, a.q).norm() + 1e-9;
    for (int j = 0; j < kDof; ++j) {
      const auto at = static_cast<std::size_t>(j);
      if (data_.circle[at]) continue;
      if (a.q[j] - away > data_.lower[at] && a.q[j] + away < data_.upper[at]) continue;
      if (!cubic) cubic.emplace(a, b, 1.0);
      const double middle = (data_.lower[at] + data_.upper[at]) / 2, start = middle + wrapped(a.q[j] - middle);
      // A cubic leaves the range of its ends by 4/27 of the misfit of its tangents at most.
      const double bulge = 0.15 * (std::abs(cubic->m0[j] - cubic->d[j]) + std::abs(cubic->m1[j] - cubic->d[j]));
      const double least = std::min(start, start + cubic->d[j]) - bulge, most = std::max(start, start + cubic->d[j]) + bulge;
      // Images by a turn of the limits lie beyond them.
      if (least > data_.lower[at] && most < data_.upper[at]) continue;
      for (const bool upper : {true, false})
        for (const double turn : {-kTwoPi, 0.0, kTwoPi}) {
          const double value = (upper ? data_.upper[at] : data_.lower[at]) + turn;
          if (value < least || value > most) continue;
          cubic_crossings(*cubic, j, start, value, [&](double u, bool rising) { crossings_.push_back({k, u, j, upper, rising}); });
        }
    }
    const auto here = crossings_.begin() + static_cast<std::ptrdiff_t>(before);
    std::stable_sort(here, crossings_.end(), [](const Crossing& x, const Crossing& y) { return x.u < y.u; });
    // Of a range of a whole turn both limits are met at once: out by one, then in by the other.
    for (auto next = here; next != crossings_.end() && next + 1 != crossings_.end(); ++next)
      if (next[0].joint == next[1].joint && next[1].u - next[0].u < 1e-9 && next[1].leaves() && !next[0].leaves())
        std::swap(next[0], next[1]);
  }
}

bool Cutter::solve_end(const std::vector<Point>& points, const Crossing& crossing, Point& end, int& joint) const {
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
    length += (data_.scale.cwiseProduct(cubic.m0).norm() + 4 * data_.scale.cwiseProduct(middle).norm() +
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
  // Between two crossings, one after the other; an open curve has a piece before the first and one after the last.
  const int count = static_cast<int>(crossings_.size());
  for (int k = closed ? 0 : -1; k < count; ++k) {
    const Crossing* from = k >= 0 ? &crossings_[static_cast<std::size_t>(k)] : nullptr;
    const bool last = k + 1 == count;
    const Crossing* to = !last ? &crossings_[static_cast<std::size_t>(k + 1)] : closed ? &crossings_[0] : nullptr;
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
      // A point that its neighbour on the limit has come to is that neighbour.
      if (from != nullptr && n == first && difference(at(n).q, arc.q[0]).squaredNorm() < 1e-16) continue;
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

namespace {

/// That of the triple of all closed forms, where they are the chain's own.
Flip flip_of(const Chain& chain, int lock, const std::vector<Alignment>& alignments,
             const std::vector<std::pair<double, ClosedForm>>& forms) {
  constexpr double kPerpendicular = 1e-12;  // cosine
  if (forms.empty()) return {};
  const ClosedFormFit& fit = forms.front().second.fit();
  const bool one = std::all_of(forms.begin(), forms.end(), [&](const auto& form) {
    return form.second.fit().exact && form.second.fit().structure == fit.structure && form.second.fit().first == fit.first;
  });
  if (!one || fit.structure == Structure::kParallel) return {};
  const int first = fit.first < lock ? fit.first : fit.first + 1;
  if (first < lock && lock <= first + 2) return {};  // the lock is among the three
  const auto axis = [&](int joint) { return chain.axis[static_cast<std::size_t>(joint)]; };
  if (std::abs(axis(first).dot(axis(first + 1))) > kPerpendicular ||
      std::abs(axis(first + 1).dot(axis(first + 2))) > kPerpendicular)
    return {};
  const auto at = std::find_if(alignments.begin(), alignments.end(), [&](const Alignment& a) { return a.joint == first + 1; });
  return at == alignments.end() ? Flip() : Flip(first, at->angle);
}

}  // namespace

SelfMotion::SelfMotion(const Chain& chain, const LockMethod& method, double margin, const std::array<double, kDof>& weights) {
  auto data = std::make_unique<SelfMotionData>(chain);
  // Without a lock any joint does: it settles where closed arcs begin.
  data->lock = method.best >= 0 ? method.best : 2;
  data->other = data->lock == 0 ? 1 : 0;
  const double largest = *std::max_element(weights.begin(), weights.end());
  for (std::size_t j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[j];
    data->lower[j] = limit.lower + margin;
    data->upper[j] = limit.upper - margin;
    const double range = data->upper[j] - data->lower[j];
    data->circle[j] = limit.continuous || range > kTwoPi + kSliver;
    if (range > kTwoPi) data->upper[j] = data->lower[j] + kTwoPi;
    const double weight = largest > 0 ? std::max(kLeastWeight, weights[j] / largest) : 1;
    data->scale[static_cast<Eigen::Index>(j)] = weight;
    data->scale2[static_cast<Eigen::Index>(j)] = weight * weight;
  }
  data->alignments = alignments_of(chain);
  for (int k = 1; method.best < 0 && k <= kStarts; ++k) {
    constexpr std::array<double, kDof> kPrime = {2, 3, 5, 7, 11, 13, 17};  // Kronecker points: multiples of square roots
    Config& start = data->starts.emplace_back();
    for (std::size_t j = 0; j < kDof; ++j) {
      const double turns = k * std::sqrt(kPrime[j]), part = turns - std::floor(turns);
      const double low = data->circle[j] ? -kPi : data->lower[j], high = data->circle[j] ? kPi : data->upper[j];
      start[static_cast<Eigen::Index>(j)] = low + part * (high - low);
    }
  }
  // Half a cell from 0, so that no value is a multiple of 90 degrees.
  for (int k = 0; method.best >= 0 && k < kSeeds; ++k) {
    const double value = kTwoPi * (k + 0.5) / kSeeds - kPi;
    if (auto form = ClosedForm::of(lock_joint(chain, data->lock, value))) data->forms.emplace_back(value, *form);
  }
  data->flip = flip_of(chain, data->lock, data->alignments, data->forms);
  data_ = std::move(data);
}

SelfMotion::~SelfMotion() = default;

std::vector<SelfMotionArc> SelfMotion::curves(const Pose& tool) const {
  std::vector<SelfMotionArc> result;
  Curves curves(*data_, tool);
  curves.find({});
  curves.visit([&](const std::vector<Point>& points, bool closed) {
    SelfMotionArc& arc = result.emplace_back();
    arc.closed = closed;
    for (const Point& p : points) {
      arc.q.push_back(p.q);
      arc.tangent.push_back(p.tangent);
    }
  });
  return result;
}

std::vector<SelfMotionArc> SelfMotion::arcs(const Pose& tool, std::span<const Config> known) const {
  std::vector<SelfMotionArc> result;
  Curves curves(*data_, tool);
  curves.find(known);
  Cutter cutter(*data_, tool, result);
  curves.visit([&](const std::vector<Point>& points, bool closed) { cutter.cut(points, closed); });
  std::stable_sort(result.begin(), result.end(),
                   [](const SelfMotionArc& a, const SelfMotionArc& b) { return less(a.q[0], b.q[0]); });
  return result;
}

std::optional<Config> SelfMotion::image(const Config& q, const Pose& tool) const {
  const auto p = data_->newton.nearest(q, tool, data_->scale2, kImageSteps);
  if (!p) return std::nullopt;
  return p->q;
}

namespace {

/// Of moves  move + x along  with |x| <= most, the x at which the largest weighted joint moves least; of several the one nearest 0.
/// That is the largest of fourteen lines, which is convex: downhill from 0, from corner to corner.
double least_largest(const Config& move, const Config& along, const Config& weight, double most) {
  std::array<double, 2 * kDof> value, slope;
  for (int j = 0; j < kDof; ++j)
    for (const int sign : {1, -1}) {
      const auto line = static_cast<std::size_t>(2 * j + (sign < 0 ? 1 : 0));
      value[line] = sign * weight[j] * move[j];
      slope[line] = sign * weight[j] * along[j];
    }
  double top = *std::max_element(value.begin(), value.end());
  double right = -kFar, left = -kFar;  // the steepest on top, to either side
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

}  // namespace

std::vector<std::optional<Config>> SelfMotion::images(std::span<const Config> q, const Pose& tool, Least least) const {
  PoseNewton::Points found;
  data_->newton.nearest(q, tool, data_->scale2, kImageSteps, found);
  if (least == Least::kLargest) {
    std::vector<Config> guesses = found.q;
    for (std::size_t k = 0; k < q.size(); ++k)
      if (found.found[k] != 0)
        guesses[k] += least_largest(found.q[k] - q[k], found.tangent[k], data_->scale, kMostDrift) * found.tangent[k];
    PoseNewton::Points drifted;
    data_->newton.nearest(guesses, tool, data_->scale2, kImageSteps, drifted);
    for (std::size_t k = 0; k < q.size(); ++k)
      if (found.found[k] != 0 && drifted.found[k] != 0) found.q[k] = drifted.q[k];
  }
  std::vector<std::optional<Config>> result(q.size());
  for (std::size_t k = 0; k < q.size(); ++k)
    if (found.found[k] != 0) result[k] = found.q[k];
  return result;
}

std::optional<Config> SelfMotion::point(const SelfMotionArc& arc, int chord, double u, const Pose& tool) const {
  const auto p = data_->newton.nearest(arc.at(chord, u), tool, kPlain, kImageSteps);
  if (!p) return std::nullopt;
  Config q = p->q;
  if (!canonical(q)) return std::nullopt;
  return q;
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
  return q[k] + Cubic({q[k], tangent[k]}, {q[next], tangent[next]}, 1).at(u);
}

}  // namespace swivel
