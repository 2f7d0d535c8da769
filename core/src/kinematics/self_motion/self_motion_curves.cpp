// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/self_motion/self_motion_curves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

namespace swivel {

namespace {

using namespace self_motion;

constexpr double kStep = 0.2;        // rad, Euclidean: longest step of tracing
constexpr double kLeastStep = 1e-7;  // rad: below this a curve is singular
constexpr double kLongChord = 0.7;   // rad: joined directly; longer ones are traced
constexpr double kNear = 0.02;       // rad: a seed this near a chord is on a known curve
constexpr double kSeed = 5e-3;       // rad: a start this near a seed is the seed
constexpr double kFar = 1;           // rad: more than a chord and what is near it
// relative discriminant of complex roots that give seeds: of a spherical triple,
constexpr double kFarTriple = 0.25;
constexpr double kFarParallel = 1;  // and of three parallel axes
constexpr int kMostPoints = 4000;   // of one curve
constexpr int kFollowed = 64;       // most points of a curve that is followed ahead of time
constexpr int kAround = 40;         // after so many it may have come round to a known curve
constexpr int kApproachSteps = 30;  // of Newton, from a start far away
constexpr int kCloseSteps = 4;      // and from a guess on a curve
constexpr int kDepth = 3;           // how often a chord may be halved

/// Returns false only if a and b are further apart than `within` in this one joint: a cheap test
/// that few pass. Of a slide it may pass some more.
bool maybe_near(const Config& a, const Config& b, int joint, double within) {
  const double apart = std::abs(a[joint] - b[joint]);
  return apart < within || apart > kTwoPi - within;
}

/// Returns false only if a and b are further apart than `within` in some joint.
bool maybe_near(const Config& a, const Config& b, double within) {
  for (int j = 0; j < kDof; ++j)
    if (!maybe_near(a, b, j, within)) return false;
  return true;
}

/// A point of a curve, with its neighbours. Side 0 of a point lies behind it along its tangent,
/// side 1 ahead; "half" numbers below are 2 * point + side, the half-edge that leaves the point on
/// that side.
struct Vertex : Point {
  int group = -1;                   // number of its lock value; -1: it was traced
  std::array<int, 2> next{-1, -1};  // 2 * neighbour + the neighbour's side; -1: open
};

double turned_away(const Config& direction, const Config& chord, double length) {
  return 1 - joint_dot(direction, chord) / length;
}

/// All curves of one pose.
class Curves {
 public:
  Curves(const SelfMotionData& data, const Pose& tool) : data_(data), tool_(tool) {}
  void find(std::span<const Config> known);
  /// Visits every curve: its points in order, tangents along it.
  void visit(const VisitCurve& visit) const;

 private:
  [[nodiscard]] Config difference(const Config& a, const Config& b) const {
    return self_motion::difference(a, b, data_.slide);
  }
  /// Returns how far the locked joint is from another of its values, less whole turns.
  [[nodiscard]] double beyond(double lock, double from) const {
    return data_.slide >= 0 ? lock - from : self_motion::difference(lock, from);
  }
  /// Returns the lock value that follows the k-th, k itself where none does: those of a slide have
  /// a last one.
  [[nodiscard]] std::size_t after(std::size_t k) const {
    const std::size_t count = data_.forms.size();
    return data_.slide >= 0 ? std::min(k + 1, count - 1) : (k + 1) % count;
  }
  [[nodiscard]] Config outward(int half) const {
    const Vertex& v = vertices_[static_cast<std::size_t>(half / 2)];
    return half % 2 == 1 ? v.tangent : Config(-v.tangent);
  }
  Vertex& at(int half) { return vertices_[static_cast<std::size_t>(half / 2)]; }
  [[nodiscard]] const Vertex& at(int half) const {
    return vertices_[static_cast<std::size_t>(half / 2)];
  }
  [[nodiscard]] bool open(int half) const {
    return at(half).next[static_cast<std::size_t>(half % 2)] < 0;
  }
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
  /// Of the pairs that a flip makes one is computed.
  [[nodiscard]] ClosedForm::Flips flips() const {
    return data_.flip.none() ? ClosedForm::Flips::kBoth : ClosedForm::Flips::kOne;
  }
  [[nodiscard]] Config kept(Config q) const {
    if (!data_.flip.kept(q)) data_.flip.apply(q);
    return q;
  }
  void add_seeds();
  void join_neighbours();
  /// Returns how badly a smooth curve fits the move from a half-edge to another, rad; none where it
  /// does not fit.
  [[nodiscard]] std::optional<double> fit_error(int half, int other) const;
  [[nodiscard]] bool straight(int half, int other, const Config& chord) const;
  [[nodiscard]] Config middle(int half, int other) const;
  /// A gap between two half-edges, to be closed over the point to which Newton leads from `guess`.
  struct Gap {
    int half, other;
    Config guess;
    double within;  // rad: how far from the guess that point may lie
  };
  /// A gap over which the curve turns more than a chord may, as at a fold.
  struct Turn {
    double miss;  // part of the chord by which it is off the bisector of the tangents
    Gap gap;
  };
  [[nodiscard]] std::optional<Turn> turning(int half, int other) const;
  /// Links two half-edges, or adds the gap between them to `gaps`; does neither where no curve
  /// seems to join them.
  void join(int half, int other, int depth, std::vector<Gap>& gaps);
  /// Closes all gaps at once, then the gaps that are left on either side of the points found, and
  /// so on.
  void close(std::vector<Gap> gaps);
  void bridge_ends();

  /// A point that moves along a curve.
  struct Walk {
    Point here;
    Config bend = Config::Zero();  // curvature from the point before
    bool bent = false;
    [[nodiscard]] Config guess(double step) const {
      const Config ahead = here.q + step * here.tangent;
      return bent ? Config(ahead + (step * step / 2) * bend) : ahead;
    }
    void go(const Point& next) {
      bend = (next.tangent - here.tangent) / std::sqrt(joint_squared_norm(next.q - here.q));
      bent = true;
      here = next;
    }
  };
  /// The points that tracing from an open half-edge comes to, and the steps that led there.
  struct Trail {
    int half;
    std::vector<Point> points{};
    std::vector<double> steps{};
    int met = -1;        // the open half-edge that the last step passes
    bool ended = false;  // the curve cannot be followed further
  };
  [[nodiscard]] double first_step(const Point& p, double step) const;
  /// Returns `next` with its tangent turned along the curve; none where it is no acceptable step
  /// from p.
  [[nodiscard]] std::optional<Point> accepted(const Point& p, const Config& guess, double step,
                                              std::optional<Point> next) const;
  [[nodiscard]] std::optional<Point> advance(const Walk& walk, double& step) const;
  /// Returns the first open half-edge that a move from p passes, `count` points after the half-edge
  /// `from`; -1: none.
  [[nodiscard]] int met(int from, int count, const Point& p, const Config& move) const;
  void trace(int half, const Trail* trail);
  /// Follows all trails at once, without linking points.
  void follow(std::vector<Trail>& trails) const;
  void trace_all();
  /// Returns true if a chord that is linked runs by q, no further off than `near` plus a part of
  /// its length.
  [[nodiscard]] bool known(const Config& q, const Config& tangent, double near, double part) const;
  void add_hidden(std::vector<Config> points);

  const SelfMotionData& data_;
  const Pose& tool_;
  std::vector<Vertex> vertices_;
  std::vector<int> first_;  // vertex of each lock value, and the end
  std::vector<char> few_;   // lock values with fewer solutions than the arm has at most
  struct End {
    int half;
    Config q;  // a copy, so that ends lie side by side in memory
  };
  std::vector<End> open_;  // half-edges that tracing may meet
};

void Curves::add_seeds() {
  vertices_.reserve(1024);
  // An exact closed form gives solutions, another one starts of Newton on the exact chain.
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
    for (const Config6& six :
         exact ? form.solve(tool_, flips()) : form.starts(tool_, 1e-2, flips())) {
      const Config q = kept(with_joint(six, data_.lock, value));
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
        for (std::size_t other = static_cast<std::size_t>(first_.back()); other < vertices_.size();
             ++other)
          twice = twice || joint_squared_norm(difference(vertices_[other].q, p->q)) < 1e-12;
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

std::optional<double> Curves::fit_error(int half, int other) const {
  constexpr double kBend = 0.06;  // 1 - cosine of tangent and chord: 0.35 rad
  // part of the chord by which a parabola with the tangents may miss it
  constexpr double kUneven = 0.02;
  if (!maybe_near(at(other).q, at(half).q, kLongChord)) return std::nullopt;
  const Config chord = difference(at(other).q, at(half).q);
  const double length2 = joint_squared_norm(chord);
  if (!(length2 > 0 && length2 < kLongChord * kLongChord)) return std::nullopt;
  const double length = std::sqrt(length2);
  const Config t0 = outward(half), t1 = -outward(other);
  if (turned_away(t0, chord, length) > kBend || turned_away(t1, chord, length) > kBend)
    return std::nullopt;
  const double miss = joint_norm(chord - (length / 2) * (t0 + t1));
  if (miss > kUneven * length || data_.passes_alignment(at(half).q, chord)) return std::nullopt;
  return miss;
}

bool Curves::straight(int half, int other, const Config& chord) const {
  constexpr double kStraight = 0.02;  // 1 - cosine between the ends: 0.2 rad
  constexpr double kLong = 0.3;       // rad
  return joint_norm(chord) < kLong && joint_dot(outward(half), -outward(other)) > 1 - kStraight;
}

Config Curves::middle(int half, int other) const {
  const Cubic cubic({at(half).q, outward(half)}, {at(other).q, -outward(other)}, 1, data_.slide);
  return at(half).q + cubic.at(0.5);
}

std::optional<Curves::Turn> Curves::turning(int half, int other) const {
  constexpr double kLong = 1.2;          // rad
  constexpr double kLeastCosine = -0.6;  // of the whole turn
  constexpr double kOff = 0.25;          // part of the chord
  constexpr double kWithin = 0.2;        // likewise
  if (!maybe_near(at(other).q, at(half).q, kLong)) return std::nullopt;
  const Config chord = difference(at(other).q, at(half).q), t0 = outward(half),
               t1 = -outward(other);
  const double length = joint_norm(chord);
  if (!(length > 0 && length < kLong) || joint_dot(t0, t1) < kLeastCosine) return std::nullopt;
  // An arc of a circle has its chord along the bisector of its tangents.
  const Config sum = t0 + t1;
  const double both = joint_norm(sum), along = joint_dot(chord, sum) / both;
  const double miss = joint_norm(chord - (along / both) * sum) / length;
  if (!(along > 0 && miss < kOff) || data_.passes_alignment(at(half).q, chord)) return std::nullopt;
  // With tangents of this length a cubic passes the middle of the circle's arc.
  const double tangent = length / (0.5 + 0.25 * both);
  return Turn{miss,
              {half, other, at(half).q + chord / 2 + (tangent / 8) * (t0 - t1), kWithin * length}};
}

void Curves::join(int half, int other, int depth, std::vector<Gap>& gaps) {
  if (fit_error(half, other)) {
    const Config chord = difference(at(other).q, at(half).q);
    if (depth == 0 || straight(half, other, chord))
      link(half, other);
    else
      gaps.push_back({half, other, middle(half, other), 0.1 * joint_norm(chord)});
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
      if (!p || joint_norm(p->q - gap.guess) > gap.within || data_.aligned(p->q)) continue;
      if (joint_dot(p->tangent, difference(at(gap.other).q, at(gap.half).q)) < 0)
        p->tangent = -p->tangent;
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
      const std::size_t next = after(k);
      if (next == k) continue;
      int best = -1;
      double least = 0;
      for (int b = first_[next]; b < first_[next + 1]; ++b) {
        if (taken[static_cast<std::size_t>(b)] != 0) continue;
        const auto miss = fit_error(2 * a + 1, 2 * b);
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
    const std::size_t next = after(k);
    ends.clear();
    for (int v = first_[k]; v < first_[k + 1]; ++v)
      if (open(2 * v + 1)) ends.push_back(2 * v + 1);
    for (int v = first_[next]; next != k && v < first_[next + 1]; ++v)
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
    const double apart = std::abs(wrap_angle(p.q[a.joint] - a.angle)),
                 rate = std::abs(p.tangent[a.joint]);
    if (rate * step > 0.7 * apart) step = std::max(kLeastStep, 0.7 * apart / rate);
  }
  return step;
}

std::optional<Point> Curves::accepted(const Point& p, const Config& guess, double step,
                                      std::optional<Point> next) const {
  if (!next) return std::nullopt;
  const Config move = next->q - p.q;
  const double length = joint_norm(move);
  if (length > 1.3 * step || joint_norm(next->q - guess) > 0.1 * step) return std::nullopt;
  if (joint_dot(next->tangent, p.tangent) < 0) next->tangent = -next->tangent;
  if (joint_dot(next->tangent, p.tangent) < 0.965 || turned_away(p.tangent, move, length) > 0.03)
    return std::nullopt;
  if (joint_norm(move - (length / 2) * (p.tangent + next->tangent)) > 0.02 * length)
    return std::nullopt;
  if (data_.passes_alignment(p.q, move)) return std::nullopt;
  return next;
}

std::optional<Point> Curves::advance(const Walk& walk, double& step) const {
  for (step = first_step(walk.here, step); step >= kLeastStep; step /= 2) {
    const Config guess = walk.guess(step);
    if (const auto next = accepted(walk.here, guess, step,
                                   data_.newton.nearest(guess, tool_, kPlain, kCloseSteps)))
      return next;
  }
  return std::nullopt;
}

int Curves::met(int from, int count, const Point& p, const Config& move) const {
  // of what may lie that far along and that near
  const double length2 = joint_squared_norm(move), within = 1.1 * std::sqrt(length2);
  int result = -1;
  double first = 2;
  for (const auto& [other, q] : open_) {
    if (!maybe_near(q, p.q, within)) continue;
    if (!open(other) || (other == from && count < 4)) continue;
    const Config way = difference(q, p.q);
    const double along = joint_dot(way, move) / length2;
    if (!(along > 1e-6 && along <= 1.05) || along >= first) continue;
    const Config inward = -outward(other);
    if (joint_dot(inward, p.tangent) < 0.9) continue;
    // Off the chord by its sagitta at most, and some.
    if (joint_squared_norm(way - along * move) > 0.01 * length2) continue;
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
    // no open half-edge was there when the trail was followed: there are fewer now
    bool alone = false;
    if (const auto at = static_cast<std::size_t>(count);
        trail != nullptr && at < trail->points.size()) {
      next = trail->points[at];
      step = trail->steps[at];
      alone = trail->met < 0 || at + 1 < trail->points.size();
    } else if (trail == nullptr || !trail->ended) {
      next = advance(walk, step);
    }
    if (!next) return;
    // An open half-edge that this step passes is the continuation.
    if (const int other = alone ? -1 : met(half, count, walk.here, next->q - walk.here.q);
        other >= 0) {
      link(here, other);
      return;
    }
    // Where curves nearly cross, a chord may have led from one to the other: the end that is left
    // over then has no continuation.
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
  // An end that is open ahead is met from behind by one of the next lock value, or at a fold by
  // another of its own. So a quarter of the ends is followed at once, then the ends of the next
  // quarter that were not met, and so on. Following in vain changes nothing: curves are linked one
  // after the other, in the order of the ends.
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
      if (PoseNewton::sooner_at_once() && reached[static_cast<std::size_t>(half)] == 0)
        followed.push_back({half});
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
  // rad: more than what is near a chord lies beside it
  constexpr double kBeside = 0.2;
  // rad: what is near a chord is not further from its ends
  constexpr double kAway = 1.2 * kLongChord + kNear;
  for (const Vertex& v : vertices_) {
    if (!maybe_near(v.q, q, data_.lock, kAway) || !maybe_near(v.q, q, kAway)) continue;
    const double before = beyond(v.q[data_.lock], q[data_.lock]);
    if (std::abs(before) > kFar) continue;
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
      const int next = v.next[side];
      if (next < 0) continue;
      // Each chord once, from the point with the smaller number.
      const Vertex& w = at(next);
      if (&w < &v) continue;
      const double after = beyond(w.q[data_.lock], q[data_.lock]);
      if (std::min(before, after) > kBeside || std::max(before, after) < -kBeside) continue;
      const Config chord = difference(w.q, v.q);
      const double length = joint_norm(chord);
      const Config way = difference(q, v.q);
      const double along = joint_dot(way, chord) / (length * length);
      if (!(along > -0.1 && along < 1.1)) continue;
      if (std::abs(joint_dot(tangent, chord)) < 0.8 * length) continue;
      if (joint_norm(way - along * chord) < near + part * length) return true;
    }
  }
  return false;
}

void Curves::add_hidden(std::vector<Config> points) {
  for (Config& q : points) q = kept(q);
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
  // Curves whose lock stays between two values: complex roots lie near them, and Newton on all
  // seven joints leads there.
  std::vector<Config> starts, hidden;
  for (std::size_t k = 0; k < data_.forms.size(); ++k) {
    if (few_[k] == 0) continue;
    const auto& [value, form] = data_.forms[k];
    const bool parallel = form.fit().structure == Structure::kParallel;
    for (const Config6& six : form.starts(tool_, parallel ? kFarParallel : kFarTriple, flips())) {
      const Config start = kept(with_joint(six, data_.lock, value));
      const auto seed = [&](const Vertex& v) {
        return maybe_near(v.q, start, data_.other, kSeed) &&
               joint_squared_norm(difference(v.q, start)) < kSeed * kSeed;
      };
      if (std::any_of(vertices_.begin() + first_[k], vertices_.begin() + first_[k + 1], seed))
        continue;
      starts.push_back(start);
    }
  }
  PoseNewton::Points found;
  data_.newton.nearest(starts, tool_, kPlain, 8, found);
  for (std::size_t k = 0; k < starts.size(); ++k)
    if (found.found[k] != 0) hidden.push_back(found.q[k]);
  add_hidden(std::move(hidden));
}

void Curves::visit(const VisitCurve& visit) const {
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
  };
  for (int v = 0; v < static_cast<int>(vertices_.size()); ++v) {
    const auto& vertex = vertices_[static_cast<std::size_t>(v)];
    if (seen[static_cast<std::size_t>(v)] || (vertex.next[0] >= 0 && vertex.next[1] >= 0)) continue;
    if (vertex.next[0] < 0 && vertex.next[1] < 0) continue;
    walk(v, vertex.next[0] < 0 ? 1 : 0);
  }
  for (int v = 0; v < static_cast<int>(vertices_.size()); ++v) {
    const auto& vertex = vertices_[static_cast<std::size_t>(v)];
    if (!seen[static_cast<std::size_t>(v)] && vertex.next[0] >= 0 && vertex.next[1] >= 0)
      walk(v, 1);
  }
}

}  // namespace

void find_curves(const SelfMotionData& data, const Pose& tool, std::span<const Config> known,
                 const VisitCurve& visit) {
  Curves curves(data, tool);
  curves.find(known);
  curves.visit(visit);
}

}  // namespace swivel
