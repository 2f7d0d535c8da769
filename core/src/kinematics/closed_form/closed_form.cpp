// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/closed_form/closed_form.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

constexpr double kMissTolerance = 1e-3;    // m
constexpr double kAngleTolerance = 10e-3;  // rad
// m, rad: below this the fitted chain is the chain, to rounding
constexpr double kExact = 1e-11;
constexpr double kSnap = 1e-5;           // m, rad: shorter normals, smaller twists are zero
constexpr double kResidual = 1e-9;       // m, rad: pose error of every solution, at most
constexpr double kGoal = 1e-11;          // m, rad: where Newton ends
constexpr double kSame = 1e-7;           // rad: two solutions nearer than this are one
constexpr double kAligned = 1e-7;        // sine below which two axes are aligned
constexpr double kNearlyAligned = 1e-4;  // below it they may be aligned, so near a double root
constexpr double kFarthest = 0.5;        // rad: farthest from a fold for its other solution

using Candidate = std::array<Angle, kSix>;
struct Candidates {
  std::array<Candidate, 24> at;  // four roots, each with at most six starts for the rest
  int count = 0;
  ClosedForm::Flips flips;
  void add(const Candidate& candidate) { at[static_cast<std::size_t>(count++)] = candidate; }
};

/// Returns the rotation about the unit axis a.
Matrix3d rotation(const Vector3d& a, const Angle& x) {
  const Vector3d v = (1 - x.cosine) * a, s = x.sine * a;
  const double xy = v.x() * a.y(), xz = v.x() * a.z(), yz = v.y() * a.z();
  Matrix3d R;
  R << v.x() * a.x() + x.cosine, xy - s.z(), xz + s.y(),  //
      xy + s.z(), v.y() * a.y() + x.cosine, yz - s.x(),   //
      xz - s.y(), yz + s.x(), v.z() * a.z() + x.cosine;
  return R;
}

/// Returns v turned about the unit axis a.
Vector3d turned(const Vector3d& a, const Angle& x, const Vector3d& v) {
  return x.cosine * v + x.sine * a.cross(v) + ((1 - x.cosine) * a.dot(v)) * a;
}

/// Returns the part of v that is perpendicular to the unit axis a.
Vector3d across_part(const Vector3d& a, const Vector3d& v) {
  return v - a.dot(v) * a;
}

/// Returns the turn about the unit axis a that brings `from` as near to `to` as such a turn can; 0
/// where either is along a.
Angle turn_between(const Vector3d& a, const Vector3d& from, const Vector3d& to) {
  return Angle::of(across_part(a, from).dot(to), a.dot(from.cross(to)));
}

Vector3d some_perpendicular(const Vector3d& a) {
  int least = 0;
  a.cwiseAbs().minCoeff(&least);
  return across_part(a, Vector3d::Unit(least)).normalized();
}

/// Replaces G by G exp([S] x), the turn by x about a line.
void append(Pose& G, const Vector3d& axis, const Vector3d& point, const Angle& x) {
  const Matrix3d R = G.linear() * rotation(axis, x);
  G.translation() += G.linear() * point - R * point;
  G.linear() = R;
}

/// Returns the common normal of the axis a through p and the axis b through q, both unit vectors.
CommonNormal common_normal(const Vector3d& p, const Vector3d& a, const Vector3d& q,
                           const Vector3d& b) {
  CommonNormal normal;
  const Vector3d cross = a.cross(b), d = q - p;
  const double sine = cross.norm();
  normal.cosine = std::copysign(1.0, a.dot(b));
  if (sine < kSnap) {
    normal.first = p;
    normal.second = p + across_part(a, d);
    normal.sine = 0;
  } else {
    normal.cosine = a.dot(b);
    normal.sine = sine;
    normal.first = p + (d.cross(b).dot(cross) / (sine * sine)) * a;
    normal.second = q + (d.cross(a).dot(cross) / (sine * sine)) * b;
  }
  const Vector3d way = normal.second - normal.first;
  normal.distance = way.norm();
  if (normal.sine > 0) {
    normal.n = cross / sine;
    if (normal.n.dot(way) < 0) normal.n = -normal.n;
  } else {
    normal.n = normal.distance > 0 ? Vector3d(way / normal.distance) : some_perpendicular(a);
  }
  if (normal.distance < kSnap) {
    normal.distance = 0;
    normal.second = normal.first;
  }
  normal.m = a.cross(normal.n);
  if (normal.sine > 0) normal.sine = b.dot(normal.m);
  return normal;
}

/// A solution q, y1, y2 of meet().
struct Meeting {
  Angle q;
  double y1, y2;
};
struct Meetings {
  std::array<Meeting, 4> at;
  int count = 0;
};
/// Solves f1(q) = distance y1, f2(q) = sine y2, y1^2 + y2^2 = radius2 for q, y1 and y2, with the
/// distance and sine of a common normal. `scale2` is the square of the size of the y.
Meetings meet(const CommonNormal& normal, const Wave& f1, const Wave& f2, double radius2,
              double scale2, double slack) {
  Meetings result;
  const double d = normal.distance, s = normal.sine;
  const auto add = [&](const Angle& q, double y1, double y2) {
    result.at[static_cast<std::size_t>(result.count++)] = {q, y1, y2};
  };
  // Returns the other coordinate, up to its sign, also where its square is negative by up to the
  // slack; -1 where there is none.
  const auto other = [&](double y) {
    const double square = radius2 - y * y;
    return square >= -slack * scale2 ? std::sqrt(std::abs(square)) : -1.0;
  };
  if (d == 0) {
    for (const Angle& q : roots(f1, slack)) {
      const double y2 = f2(q) / s, y1 = other(y2);
      if (y1 < 0) continue;
      add(q, y1, y2);
      add(q, -y1, y2);
    }
  } else if (s == 0) {
    for (const Angle& q : roots(f2, slack)) {
      const double y1 = f1(q) / d, y2 = other(y1);
      if (y2 < 0) continue;
      add(q, y1, y2);
      add(q, y1, -y2);
    }
  } else {
    Wave2 sum;
    sum.add_square(s * s, f1);
    sum.add_square(d * d, f2);
    sum.constant -= d * d * s * s * radius2;
    for (const Angle& q : roots(sum, slack)) add(q, f1(q) / d, f2(q) / s);
  }
  return result;
}

/// Adds the candidates whose joints 4-6 make the rotation R, given joints 1-3.
void add_wrist(const SphericalWrist& wrist, const Matrix3d& R, Candidate& candidate, double slack,
               double aligned, Candidates& result) {
  const Vector3d& a = wrist.axis[3];
  const Vector3d& b = wrist.axis[4];
  const Vector3d& c = wrist.axis[5];
  // cosine cos(q_5) + sine sin(q_5) = R c . a less its constant part; the discriminant by the cross
  // product, since near the singular pose the cosine has lost half its digits.
  const Vector3d target = R * c, e = R * wrist.across;
  const double P = wrist.middle_cosine, Q = wrist.middle_sine, square = P * P + Q * Q,
               cosine = a.dot(target);
  const double K = cosine - wrist.first_cosine * wrist.last_cosine;
  const double discriminant =
      a.cross(target).squaredNorm() - wrist.first_cosine * wrist.first_cosine -
      wrist.last_cosine * wrist.last_cosine + 2 * wrist.first_cosine * wrist.last_cosine * cosine;
  if (discriminant < -slack * square) return;
  const double half = std::sqrt(std::abs(discriminant)), apart = a.cross(target).norm();
  const auto add = [&](const Angle& q4) {
    candidate[3] = q4;
    // The last joint makes the turn that is left over.
    candidate[5] = turn_between(c, wrist.across, turned(b, -candidate[4], turned(a, -q4, e)));
    result.add(candidate);
  };
  for (const double root : {half, -half}) {
    candidate[4] = Angle::of(P * K - Q * root, Q * K + P * root);
    if (apart > kAligned) add(turn_between(a, turned(b, candidate[4], c), target));
    if (result.flips == ClosedForm::Flips::kOne) break;
  }
  // Axes 4 and 6 are one line, or may be on the exact chain, so joint 4 may have any angle.
  if (apart <= std::max(kAligned, aligned)) {
    candidate[4] = Angle::of(P * K, Q * K);
    add({1, 0});
    if (aligned > kAligned) {
      add({0, 1});
      add({-1, 0});
      add({0, -1});
    }
  }
}

void solve(const SphericalWrist& wrist, const Pose& D, double slack, double aligned,
           Candidates& result) {
  const CommonNormal& normal = wrist.normal;
  const Vector3d& a = wrist.axis[0];
  const Vector3d& b = wrist.axis[1];
  // The place that W must come to, in the frame of axis 1.
  const Vector3d v = D * wrist.centre - normal.first;
  const double height = a.dot(v), vn = normal.n.dot(v), vm = normal.m.dot(v),
               radius2 = vn * vn + vm * vm;
  Wave f1 = wrist.reach, f2 = wrist.height;
  f1.constant += (radius2 + height * height + normal.distance * normal.distance) / 2;
  f2.constant -= normal.cosine * height;
  const Meetings meetings = meet(normal, f1, f2, radius2, wrist.scale2, slack);
  for (int k = 0; k < meetings.count; ++k) {
    const Meeting& m = meetings.at[static_cast<std::size_t>(k)];
    Candidate candidate;
    candidate[0] = Angle::of(m.y1 * vn + m.y2 * vm, m.y1 * vm - m.y2 * vn);
    // W as joint 3 turns it, and as joint 1 needs it, about axis 2.
    const Vector3d from =
        wrist.foot + m.q.cosine * wrist.cosine + m.q.sine * wrist.sine - normal.second;
    const Vector3d to =
        normal.first + m.y1 * normal.n + m.y2 * normal.m + height * a - normal.second;
    candidate[1] = turn_between(b, from, to);
    candidate[2] = m.q;
    const Matrix3d R = rotation(a, candidate[0]) * rotation(b, candidate[1]) *
                       rotation(wrist.axis[2], candidate[2]);
    add_wrist(wrist, R.transpose() * D.linear(), candidate, slack, aligned, result);
  }
}

/// The links of the planar arm of joints 2 to 4: the squares of their lengths, m^2, and the fore
/// link turned by a quarter turn about the joints' axes.
struct PlanarLinks {
  double upper2, fore2;
  Vector3d cross;
  explicit PlanarLinks(const ThreeParallel& arm)
      : upper2(arm.upper.squaredNorm()),
        fore2(arm.fore.squaredNorm()),
        cross(arm.axis[1].cross(arm.fore)) {}
};

/// Adds the solutions of the planar arm for one angle of joint 6, given joints 1 and 5 in
/// `candidate`. `left` is the displacement that joints 2 to 6 make.
void add_planar(const ThreeParallel& arm, const PlanarLinks& links, const Pose& left,
                const Angle& q6, double slack, Candidate& candidate, Candidates& result) {
  const Vector3d& z = arm.axis[1];
  candidate[5] = q6;
  Pose planar = left;
  append(planar, arm.axis[5], arm.normal.second, -q6);
  append(planar, arm.axis[4], arm.normal.first, -candidate[4]);
  // |upper + Rot(z, q_3) fore| is known.
  const Vector3d reach = across_part(z, planar * arm.point[3] - arm.point[1]);
  const Wave elbow{(links.upper2 + links.fore2 - reach.squaredNorm()) / 2, arm.upper.dot(arm.fore),
                   arm.upper.dot(links.cross)};
  const Angle total = turn_between(z, arm.across, planar.linear() * arm.across);
  for (const Angle& q3 : roots(elbow, slack)) {
    const Angle q2 =
        turn_between(z, arm.upper + q3.cosine * arm.fore + q3.sine * links.cross, reach);
    const std::array<Angle, 3> turns = {q2, q3, total + -(q2 + q3)};
    for (std::size_t j = 0; j < 3; ++j)
      candidate[j + 1] = arm.sign[j + 1] < 0 ? -turns[j] : turns[j];
    result.add(candidate);
  }
}

/// Returns the angle of joint 6 that makes the elbow as near to a right angle as it can, where axis
/// 6 is parallel to axes 2-4 and turns freely. `wrist` is a point of axis 4 with joint 5 undone.
Angle squaring_elbow(const ThreeParallel& arm, const PlanarLinks& links, const Pose& left,
                     const Vector3d& wrist) {
  const Vector3d &z = arm.axis[1], &a6 = arm.axis[5];
  const Vector3d arm6 = across_part(a6, wrist - arm.normal.second);
  const auto planar = [&](const Vector3d& v) { return across_part(z, left.linear() * v); };
  const Vector3d f = across_part(z, left * Vector3d(wrist - arm6) - arm.point[1]), c = planar(arm6),
                 s = -planar(a6.cross(arm6));
  const Wave bend{f.squaredNorm() + c.squaredNorm() - links.upper2 - links.fore2, 2 * f.dot(c),
                  2 * f.dot(s)};
  const Roots square = roots(bend, 0);
  return square.count > 0 ? square.angle[0]
                          : Angle::of(-bend.constant * bend.cosine, -bend.constant * bend.sine);
}

void solve(const ThreeParallel& arm, const Pose& D, double slack, double aligned,
           Candidates& result) {
  const CommonNormal& normal = arm.normal;
  const Vector3d &a1 = arm.axis[0], &z = arm.axis[1], &a5 = arm.axis[4], &a6 = arm.axis[5];
  // u = Rot(axis 1, q_1) z keeps D a_6 . u = z . R_5 a_6 and the height of a point of axis 6 along
  // u.
  const double along = a1.dot(z);
  const Vector3d still = along * a1, cosine = z - still, sine = a1.cross(z);
  const auto wave = [&](const Vector3d& v, double less) {
    return Wave{still.dot(v) - less, cosine.dot(v), sine.dot(v)};
  };
  const Wave f1 = wave(D * normal.second - arm.point[0], z.dot(normal.first - arm.point[0]));
  const Wave f2 = wave(D.linear() * a6, normal.cosine * arm.along_a);
  const double radius2 = arm.along_n * arm.along_n + arm.along_m * arm.along_m;
  const Meetings meetings = meet(normal, f1, f2, radius2, 1.0, slack);
  const PlanarLinks links(arm);
  for (int k = 0; k < meetings.count; ++k) {
    const Meeting& m = meetings.at[static_cast<std::size_t>(k)];
    Candidate candidate;
    candidate[0] = m.q;
    candidate[4] =
        Angle::of(m.y1 * arm.along_n + m.y2 * arm.along_m, m.y1 * arm.along_m - m.y2 * arm.along_n);
    // D' = exp(-[S_1] q_1) D must be a planar motion times joints 5 and 6.
    Pose left = Pose::Identity();
    append(left, a1, arm.point[0], -candidate[0]);
    left = product(left, D);
    const Vector3d to = turned(a5, -candidate[4], z), from = left.linear().transpose() * z;
    // axis 4, with joint 5 undone
    const Vector3d wrist = normal.first + turned(a5, -candidate[4], arm.point[3] - normal.first);
    const double apart = across_part(a6, to).norm();
    if (apart > kAligned)
      add_planar(arm, links, left, turn_between(a6, from, to), slack, candidate, result);
    if (apart < std::max(kNearlyAligned, aligned))
      add_planar(arm, links, left, squaring_elbow(arm, links, left, wrist), slack, candidate,
                 result);
  }
}

double miss_of(const Pose& reached, const Pose& tool) {
  const double turn = (reached.linear() - tool.linear()).norm() / std::sqrt(2.0);  // the chord
  return std::max((reached.translation() - tool.translation()).norm(), turn);
}

/// Runs Newton on the exact chain from q, damped where it is singular, moving no joint by more than
/// kLargest in a step. Returns false where it does not reach the pose.
bool newton(const SixChain& chain, const Pose& tool, Config6& q) {
  constexpr int kSteps = 30;
  constexpr double kLargest = 0.1;
  double last = 0;
  for (int step = 0;; ++step) {
    Matrix6 J;
    const Pose reached = chain.tool(q, J);
    const double miss = miss_of(reached, tool);
    if (!(miss > kGoal)) return true;
    // as near as rounding allows
    if (step > 0 && miss <= kResidual && miss > 0.5 * last) return true;
    if (step == kSteps || !std::isfinite(miss)) return miss <= kResidual;
    last = miss;
    Config6 error;
    const Matrix3d left = tool.linear() * reached.linear().transpose();
    error << tool.translation() - reached.translation(), (left(2, 1) - left(1, 2)) / 2,
        (left(0, 2) - left(2, 0)) / 2, (left(1, 0) - left(0, 1)) / 2;
    Matrix6 normal = J.transpose() * J;
    normal.diagonal().array() += 1e-2 * error.squaredNorm() + 1e-18;
    const Config6 move = normal.llt().solve(J.transpose() * error);
    q += move * std::min(1.0, kLargest / move.lpNorm<Eigen::Infinity>());
  }
}

/// Brings every angle into (-pi, pi].
void wrap(Config6& q) {
  for (double& angle : q)
    angle = std::remainder(angle, kTwoPi) > -kPi ? std::remainder(angle, kTwoPi) : kPi;
}

void add_distinct(const Config6& q, ClosedForm::Solutions& result) {
  const bool known = std::any_of(result.begin(), result.end(), [&](const Config6& other) {
    return std::equal(q.begin(), q.end(), other.begin(), [](double x, double y) {
      const double apart = std::abs(x - y);
      return apart < kSame || apart > kTwoPi - kSame;
    });
  });
  if (!known && result.count < ClosedForm::kMaxSolutions)
    result.q[static_cast<std::size_t>(result.count++)] = q;
}

/// Adds solutions beside q that Newton did not reach from the starts of a nearly fitted chain. Near
/// a fold the two solutions that meet there may have drawn both starts to one; where two axes are
/// nearly aligned, the exact chain has isolated solutions where the fitted one has infinitely many.
/// Both lie along the right singular vector v of the least singular value s. The further the chain
/// is from the fitted one, the larger |det J| still is where that happens: up to a third of `fold`,
/// the deviation in m or rad, was measured.
void add_beside_fold(const SixChain& chain, const Pose& tool, const Config6 q, double fold,
                     ClosedForm::Solutions& result) {
  const Matrix6 J = chain.jacobian(q);
  if (std::abs(J.determinant()) > fold) return;
  const Eigen::JacobiSVD<Matrix6> svd(J, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Config6 u = svd.matrixU().col(kSix - 1), v = svd.matrixV().col(kSix - 1);
  const auto add_from = [&](double t) {
    Config6 x = q + t * v;
    if (!newton(chain, tool, x)) return;
    wrap(x);
    add_distinct(x, result);
  };
  // Along v the pose misses by s t + bend t^2 / 2 (along u), which vanishes once more.
  constexpr double kDelta = 1e-4;  // rad
  const double bend =
      u.dot((chain.jacobian(q + kDelta * v) - chain.jacobian(q - kDelta * v)) * v) / (2 * kDelta);
  const double other = -2 * svd.singularValues()[kSix - 1] / bend;
  if (std::abs(other) < kFarthest) add_from(other);
  for (const double t : {0.1, 0.4, 1.2}) {
    add_from(t);
    add_from(-t);
  }
}

/// Returns the point nearest to three lines, and its largest distance from one; NaN where they are
/// parallel.
std::pair<Vector3d, double> centre_of(const SixChain& chain, std::size_t first) {
  Matrix3d A = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  for (std::size_t k = first; k < first + 3; ++k) {
    const Matrix3d across = Matrix3d::Identity() - chain.axis[k] * chain.axis[k].transpose();
    A += across;
    b += across * chain.point[k];
  }
  const Vector3d centre = A.partialPivLu().solve(b);
  double miss = 0;
  for (std::size_t k = first; k < first + 3; ++k)
    miss = std::max(miss, across_part(chain.axis[k], centre - chain.point[k]).norm());
  return {centre, miss};
}

/// Returns the chain of the inverse displacement: joints in the opposite order, axes turned round.
SixChain reversed(const SixChain& chain) {
  SixChain result;
  for (std::size_t k = 0; k < kSix; ++k) {
    result.axis[k] = -chain.axis[kSix - 1 - k];
    result.point[k] = chain.point[kSix - 1 - k];
  }
  return result;
}

bool aligned(const Vector3d& a, const Vector3d& b) {
  return a.cross(b).norm() < kSnap;
}

std::optional<SphericalWrist> spherical_wrist(const SixChain& chain, FitDeviation& deviation) {
  if (aligned(chain.axis[3], chain.axis[4]) || aligned(chain.axis[4], chain.axis[5]))
    return std::nullopt;
  SphericalWrist wrist;
  wrist.axis = chain.axis;
  std::tie(wrist.centre, deviation.offset) = centre_of(chain, 3);
  if (!(deviation.offset <= kMissTolerance)) return std::nullopt;
  const auto& a = chain.axis;
  const CommonNormal normal = wrist.normal =
      common_normal(chain.point[0], a[0], chain.point[1], a[1]);
  if (normal.distance == 0 && normal.sine == 0) return std::nullopt;
  wrist.foot = chain.point[2] + a[2].dot(wrist.centre - chain.point[2]) * a[2];
  wrist.cosine = wrist.centre - wrist.foot;
  wrist.sine = a[2].cross(wrist.cosine);
  const Vector3d F = wrist.foot - normal.second;
  wrist.reach = {-(F.squaredNorm() + wrist.cosine.squaredNorm()) / 2, -F.dot(wrist.cosine),
                 -F.dot(wrist.sine)};
  wrist.scale2 = F.squaredNorm() + wrist.cosine.squaredNorm();
  wrist.height = {a[1].dot(F), a[1].dot(wrist.cosine), a[1].dot(wrist.sine)};
  wrist.first_cosine = a[3].dot(a[4]);
  wrist.last_cosine = a[4].dot(a[5]);
  wrist.middle_cosine = a[3].dot(a[5]) - wrist.first_cosine * wrist.last_cosine;
  wrist.middle_sine = a[3].dot(a[4].cross(a[5]));
  wrist.across = some_perpendicular(a[5]);
  return wrist;
}

std::optional<ThreeParallel> three_parallel(const SixChain& chain, FitDeviation& deviation) {
  ThreeParallel arm;
  arm.axis = chain.axis;
  arm.point = chain.point;
  Vector3d z = Vector3d::Zero();
  for (std::size_t k = 1; k < 4; ++k) {
    arm.sign[k] = std::copysign(1.0, chain.axis[1].dot(chain.axis[k]));
    z += arm.sign[k] * chain.axis[k];
  }
  z.normalize();
  for (std::size_t k = 1; k < 4; ++k)
    deviation.angle = std::max(deviation.angle, z.cross(chain.axis[k]).norm());
  if (!(deviation.angle <= kAngleTolerance) || aligned(z, chain.axis[0]) ||
      aligned(z, chain.axis[4]))
    return std::nullopt;
  for (std::size_t k = 1; k < 4; ++k) arm.axis[k] = arm.sign[k] * z;
  arm.axis[1] = z;
  arm.upper = across_part(z, chain.point[2] - chain.point[1]);
  arm.fore = across_part(z, chain.point[3] - chain.point[2]);
  if (arm.upper.norm() < kMissTolerance || arm.fore.norm() < kMissTolerance) return std::nullopt;
  arm.normal = common_normal(chain.point[4], chain.axis[4], chain.point[5], chain.axis[5]);
  if (arm.normal.distance == 0 && arm.normal.sine == 0) return std::nullopt;
  arm.along_n = z.dot(arm.normal.n);
  arm.along_m = z.dot(arm.normal.m);
  arm.along_a = z.dot(chain.axis[4]);
  arm.across = some_perpendicular(z);
  return arm;
}

}  // namespace

Pose SixChain::tool(const Config6& q) const {
  Pose G = Pose::Identity();
  for (std::size_t k = 0; k < kSix; ++k)
    append(G, axis[k], point[k], Angle::of(q[static_cast<Eigen::Index>(k)]));
  return product(G, home);
}

Pose SixChain::tool(const Config6& q, Matrix6& J) const {
  Pose G = Pose::Identity();
  for (std::size_t k = 0; k < kSix; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    J.block<3, 1>(0, column) = G * point[k];
    J.block<3, 1>(3, column) = G.linear() * axis[k];
    append(G, axis[k], point[k], Angle::of(q[column]));
  }
  const Pose tool = product(G, home);
  for (int k = 0; k < kSix; ++k) {
    const Vector3d a = J.block<3, 1>(3, k), arm = tool.translation() - J.block<3, 1>(0, k);
    J.block<3, 1>(0, k) = a.cross(arm);
  }
  return tool;
}

Matrix6 SixChain::jacobian(const Config6& q) const {
  Matrix6 J;
  tool(q, J);
  return J;
}

SixChain lock_joint(const Chain& chain, int joint, double value) {
  SixChain result;
  Pose turn = Pose::Identity();
  const auto locked = static_cast<std::size_t>(joint);
  for (std::size_t k = 0, to = 0; k < kDof; ++k) {
    if (k == locked && chain.limit[k].slides) {
      turn.translate(value * chain.axis[k]);
      continue;
    }
    if (k == locked) {
      append(turn, chain.axis[k], chain.point[k], Angle::of(value));
      continue;
    }
    result.axis[to] = turn.linear() * chain.axis[k];
    result.point[to++] = turn * chain.point[k];
  }
  result.home = product(turn, chain.home);
  return result;
}

Config6 without_joint(const Config& q, int joint) {
  Config6 result;
  result << q.head(joint), q.segment(joint + 1, kSix - joint);
  return result;
}

Config with_joint(const Config6& q, int joint, double value) {
  Eigen::Matrix<double, kDof, 1> result;
  result << q.head(joint), value, q.tail(kSix - joint);
  return result;
}

std::optional<ClosedForm> ClosedForm::of(const SixChain& chain) {
  std::optional<ClosedForm> best;
  const auto better = [&](const FitDeviation& deviation) {
    const double miss = std::max(deviation.offset, deviation.angle);
    return !best || (!best->fit_.exact &&
                     miss < std::max(best->fit_.deviation.offset, best->fit_.deviation.angle));
  };
  for (const bool parallel : {false, true}) {
    for (const bool reverse : {false, true}) {
      const SixChain seen = reverse ? reversed(chain) : chain;
      FitDeviation deviation;
      ClosedForm form{};
      if (parallel) {
        const auto method = three_parallel(seen, deviation);
        if (!method || !better(deviation)) continue;
        form.method_ = *method;
        form.fit_ = {Structure::kParallel, reverse ? 2 : 1, deviation, false};
      } else {
        const auto method = spherical_wrist(seen, deviation);
        if (!method || !better(deviation)) continue;
        form.method_ = *method;
        form.fit_ = {reverse ? Structure::kSphericalShoulder : Structure::kSphericalWrist,
                     reverse ? 0 : 3, deviation, false};
      }
      const double miss = std::max(deviation.offset, deviation.angle);
      form.fit_.exact = miss < kExact;
      // Roots of a quadratic that misses by e are off by its square root; lengths are of the order
      // of a metre.
      form.slack_ = std::clamp(100 * miss, 1e-6, 1e-2);
      form.aligned_ = 100 * miss;
      form.chain_ = chain;
      form.home_inverse_ = chain.home.inverse(Eigen::Isometry);
      form.reversed_ = reverse;
      best = form;
    }
  }
  return best;
}

ClosedForm::Solutions ClosedForm::solve(const Pose& tool, Flips flips) const {
  Pose D = product(tool, home_inverse_);
  if (reversed_) D = D.inverse(Eigen::Isometry);
  Candidates candidates;
  candidates.flips = flips;
  std::visit([&](const auto& method) { swivel::solve(method, D, slack_, aligned_, candidates); },
             method_);
  Solutions result;
  Candidate last;
  Config6 angles;
  std::array<Pose, kSix + 1> G;
  G[0].setIdentity();
  for (int k = 0; k < candidates.count; ++k) {
    Candidate& candidate = candidates.at[static_cast<std::size_t>(k)];
    if (reversed_) std::reverse(candidate.begin(), candidate.end());
    // Neighbours share angles: only what changes is computed.
    bool same = k > 0;
    for (std::size_t j = 0; j < kSix; ++j) {
      const bool repeated = k > 0 && candidate[j] == last[j];
      if (!repeated) angles[static_cast<Eigen::Index>(j)] = candidate[j].radians();
      same = same && repeated;
      if (same) continue;
      G[j + 1] = G[j];
      append(G[j + 1], chain_.axis[j], chain_.point[j], candidate[j]);
    }
    last = candidate;
    Config6 q = angles;
    const double miss = miss_of(product(G[kSix], chain_.home), tool);
    if (!(miss <= kGoal)) {
      if (!newton(chain_, tool, q)) continue;
      wrap(q);
    }
    add_distinct(q, result);
  }
  if (!fit_.exact) {
    const double fold = std::max(fit_.deviation.offset, fit_.deviation.angle);
    for (int k = 0; k < result.count; ++k)
      add_beside_fold(chain_, tool, result.q[static_cast<std::size_t>(k)], fold, result);
  }
  return result;
}

ClosedForm::Solutions ClosedForm::starts(const Pose& tool, double slack, Flips flips) const {
  Pose D = product(tool, home_inverse_);
  if (reversed_) D = D.inverse(Eigen::Isometry);
  Candidates candidates;
  candidates.flips = flips;
  std::visit([&](const auto& method) { swivel::solve(method, D, slack, aligned_, candidates); },
             method_);
  Solutions result;
  for (; result.count < std::min<int>(candidates.count, kMaxSolutions); ++result.count) {
    const auto k = static_cast<std::size_t>(result.count);
    for (std::size_t j = 0; j < kSix; ++j)
      result.q[k][static_cast<Eigen::Index>(reversed_ ? kSix - 1 - j : j)] =
          candidates.at[k][j].radians();
  }
  return result;
}

LockMethod lock_method(const Chain& chain) {
  // What holds at three values of the lock holds at all but a few.
  constexpr std::array<double, 3> kValues = {0.7, 1.9, -1.1};
  // A joint's share of self-motion is the mean of |det J| without its column; below this part of
  // the largest share it hardly moves.
  constexpr double kLeastShare = 1e-3;
  constexpr int kSamples = 64;
  LockMethod result;
  result.roll = chain.roll;
  result.roll_fixed = chain.roll_fixed;
  std::array<double, kDof> share{};
  for (int sample = 1; sample <= kSamples; ++sample) {
    Config q;
    for (int j = 0; j < kDof; ++j) {
      // Kronecker points: multiples of square roots
      constexpr std::array<double, kDof> kPrime = {2, 3, 5, 7, 11, 13, 17};
      const double turns = sample * std::sqrt(kPrime[static_cast<std::size_t>(j)]);
      q[j] = kTwoPi * (turns - std::floor(turns));
    }
    const auto J = chain.jacobian(q);
    for (int j = 0; j < kDof; ++j) {
      Eigen::Matrix<double, kSix, kSix> rest;
      rest << J.leftCols(j), J.rightCols(kSix - j);
      share[static_cast<std::size_t>(j)] += std::abs(rest.determinant()) / kSamples;
    }
  }
  const double largest = *std::max_element(share.begin(), share.end());
  const int slide = chain.slide();
  for (int j = 0; j < kDof; ++j) {
    const double mine = share[static_cast<std::size_t>(j)];
    // Shares of m and rad cannot be compared, and the closed forms know turns alone.
    if (slide >= 0 ? j != slide : !(mine > kLeastShare * largest)) continue;
    std::optional<ClosedFormFit> fit;
    for (const double value : kValues) {
      const auto form = ClosedForm::of(lock_joint(chain, j, value));
      if (!form) {
        fit.reset();
        break;
      }
      if (!fit) fit = form->fit();
      fit->deviation.offset = std::max(fit->deviation.offset, form->fit().deviation.offset);
      fit->deviation.angle = std::max(fit->deviation.angle, form->fit().deviation.angle);
      fit->exact = fit->exact && form->fit().exact;
    }
    if (!fit) continue;
    result.by_joint[static_cast<std::size_t>(j)] = fit;
    if (result.best < 0 || mine > share[static_cast<std::size_t>(result.best)]) result.best = j;
  }
  return result;
}

std::string LockMethod::words() const {
  if (best < 0)
    return std::string(
               "no closed form: no three neighbouring axes meet in a point or are parallel") +
           (roll_fixed ? " in a place that serves, or solutions lie too near to each other"
                       : " where one joint is locked");
  const ClosedFormFit& fit = *by_joint[static_cast<std::size_t>(best)];
  const auto is_roll = [&](int j) { return roll && j + 1 == static_cast<int>(kDof); };
  std::string text = "closed form: axes ";
  for (int k = fit.first; k < fit.first + 3; ++k) {
    const int j = k < best ? k : k + 1;
    text += is_roll(j) ? "that of the roll" : std::to_string(j + 1);
    text += k < fit.first + 1 ? ", " : k < fit.first + 2 ? " and " : "";
  }
  text += fit.structure == Structure::kParallel ? " are parallel" : " meet in a point";
  if (!fit.exact) {
    text += fit.structure == Structure::kParallel
                ? formatted(" within %.2g mrad", 1e3 * fit.deviation.angle)
                : formatted(" within %.2g mm", 1e3 * fit.deviation.offset);
  }
  if (roll_fixed) return text;
  text += is_roll(best) ? "; locks the roll" : "; locks joint " + std::to_string(best + 1);
  std::string others;
  for (int j = 0; j < kDof; ++j)
    if (j != best && by_joint[static_cast<std::size_t>(j)])
      others += (others.empty() ? is_roll(best) ? "joint " : "" : ", ") +
                (is_roll(j) ? "the roll" : std::to_string(j + 1));
  if (!others.empty()) text += " (or " + others + ")";
  return text;
}

}  // namespace swivel
