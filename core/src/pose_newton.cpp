// SPDX-License-Identifier: BSD-3-Clause
#include "pose_newton.hpp"

#include <cmath>

namespace swivel {

namespace {

constexpr double kRank = 1e-9;      // pivot below which the Jacobian has lost rank
constexpr double kSettled = 4e-6;   // rad: after so small a step the error is its square
constexpr double kParallel = 1e-9;  // sine below which neighbouring axes have no common normal of their own
constexpr double kLongest = 1;      // rad, of one step
constexpr std::size_t kLanes = 8;   // joints and one more, for vector units

/// Sines and cosines of angles of some turns, to about 1 ulp: a loop without branches, which compilers turn into vector code.
/// Reduction to an eighth of a turn in two parts (Cody & Waite 1980), polynomials of fdlibm's k_sin and k_cos.
void sines_cosines(const std::array<double, kLanes>& angle, std::array<double, kLanes>& sine, std::array<double, kLanes>& cosine) {
  constexpr double kRound = 0x1.8p52;  // added and taken away again, it rounds to an integer
  constexpr double kHigh = 0x1.921fb544p0,
                   kLow = 0x1.0b4611a626331p-34;  // of half pi; times a small integer the high part is exact
  for (std::size_t k = 0; k < kLanes; ++k) {
    const double x = angle[k], quarters = (x * (2 / kPi) + kRound) - kRound;
    const double r = (x - quarters * kHigh) - quarters * kLow, z = r * r;
    const double s =
        r + r * z *
                (-1.66666666666666324348e-01 +
                 z * (8.33333333332248946124e-03 +
                      z * (-1.98412698298579493134e-04 +
                           z * (2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
    const double c = 1 - (0.5 * z - z * z *
                                        (4.16666666666666019037e-02 +
                                         z * (-1.38888888888741095749e-03 +
                                              z * (2.48015872894767294178e-05 +
                                                   z * (-2.75573143513906633035e-07 +
                                                        z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))))));
    const double m = quarters - 4 * ((quarters * 0.25 + kRound) - kRound);  // -2 ... 2
    const bool odd = m * m == 1;
    const double a = odd ? c : s, b = odd ? s : c;
    sine[k] = m == -1 || m * m == 4 ? -a : a;
    cosine[k] = m > 0 || m == -2 ? -b : b;
  }
}

}  // namespace

PoseNewton::PoseNewton(const Chain& chain) {
  Vector3d origin = chain.point[0], z = chain.axis[0];
  Vector3d x = z.unitOrthogonal();
  first_.linear() << x, z.cross(x), z;
  first_.translation() = origin;
  for (std::size_t k = 0; k + 1 < kDof; ++k) {
    const Vector3d &p = chain.point[k + 1], &b = chain.axis[k + 1], d = p - origin;
    Vector3d from = origin, to = p, n = z.cross(b);
    const double sine = n.norm();
    if (sine > kParallel) {
      from = origin + (d.cross(b).dot(n) / (sine * sine)) * z;
      to = p + (d.cross(z).dot(n) / (sine * sine)) * b;
      n /= sine;
    } else {
      to = p - b.dot(d) * b;
      n = to - from;
      n -= z.dot(n) * z;
      n = n.norm() > kParallel ? Vector3d(n.normalized()) : x;
    }
    // `to` lies on axis k + 1 at the height of the foot of the common normal.
    const Vector3d y = z.cross(x);
    Link& link = link_[k];
    link.turn = std::atan2(n.dot(y), n.dot(x));
    link.height = z.dot(to - origin);
    link.width = n.dot(to - origin);
    link.twist_cosine = z.dot(b);
    link.twist_sine = n.dot(z.cross(b));
    origin = to;
    z = b;
    x = n;
  }
  Pose frame = Pose::Identity();
  frame.linear() << x, z.cross(x), z;
  frame.translation() = origin;
  last_ = product(frame.inverse(Eigen::Isometry), chain.home);
}

bool PoseNewton::linear(const Config& q, const Pose& tool, Linear& out) const {
  std::array<double, kLanes> angle{}, sine, cosine;
  for (std::size_t k = 0; k < kDof; ++k) angle[k] = q[static_cast<Eigen::Index>(k)] + link_[k].turn;
  sines_cosines(angle, sine, cosine);
  Vector3d X = first_.linear().col(0), Y = first_.linear().col(1), Z = first_.linear().col(2), P = first_.translation();
  std::array<Vector3d, kDof> axis, point;
  for (std::size_t k = 0; k < kDof; ++k) {
    axis[k] = Z;
    point[k] = P;
    const Link& link = link_[k];
    const Vector3d x = cosine[k] * X + sine[k] * Y, y = cosine[k] * Y - sine[k] * X;
    P += link.height * Z + link.width * x;
    X = x;
    Y = link.twist_cosine * y + link.twist_sine * Z;
    Z = link.twist_cosine * Z - link.twist_sine * y;
  }
  const Matrix3d& L = last_.linear();
  const Vector3d& p = last_.translation();
  P += p.x() * X + p.y() * Y + p.z() * Z;
  const Vector3d tx = L(0, 0) * X + L(1, 0) * Y + L(2, 0) * Z, ty = L(0, 1) * X + L(1, 1) * Y + L(2, 1) * Z,
                 tz = L(0, 2) * X + L(1, 2) * Y + L(2, 2) * Z;
  const Vector3d miss = tool.translation() - P;
  const Vector3d turn = 0.5 * (tx.cross(tool.linear().col(0)) + ty.cross(tool.linear().col(1)) + tz.cross(tool.linear().col(2)));

  using Row = Eigen::Array<double, kLanes, 1>;
  std::array<Row, 6> A;  // the Jacobian and what is missing
  for (std::size_t k = 0; k < kDof; ++k) {
    const Vector3d v = axis[k].cross(P - point[k]);
    const auto column = static_cast<Eigen::Index>(k);
    for (std::size_t r = 0; r < 3; ++r) {
      A[r][column] = v[static_cast<Eigen::Index>(r)];
      A[r + 3][column] = axis[k][static_cast<Eigen::Index>(r)];
    }
  }
  for (std::size_t r = 0; r < 3; ++r) {
    A[r][kDof] = miss[static_cast<Eigen::Index>(r)];
    A[r + 3][kDof] = turn[static_cast<Eigen::Index>(r)];
  }
  // Gauss; each row takes the largest column that is left.
  std::array<int, 6> pivot;
  Row left;
  left << 1, 1, 1, 1, 1, 1, 1, 0;
  for (std::size_t r = 0; r < 6; ++r) {
    const Row size = A[r].abs() * left;
    int column = 0;
    for (int c = 1; c < kDof; ++c) column = size[c] > size[column] ? c : column;
    if (!(size[column] > kRank)) return false;
    left[column] = 0;
    pivot[r] = column;
    A[r] *= 1 / A[r][column];
    for (std::size_t i = r + 1; i < 6; ++i) A[i] -= A[i][column] * A[r];
  }
  int free = 0;
  while (left[free] == 0) ++free;
  out.particular[free] = 0;
  out.null[free] = 1;
  for (std::size_t r = 6; r-- > 0;) {
    double particular = A[r][kDof], null = -A[r][free];
    for (std::size_t i = r + 1; i < 6; ++i) {
      const double a = A[r][pivot[i]];
      particular -= a * out.particular[pivot[i]];
      null -= a * out.null[pivot[i]];
    }
    out.particular[pivot[r]] = particular;
    out.null[pivot[r]] = null;
  }
  return true;
}

std::optional<PoseNewton::Point> PoseNewton::nearest(const Config& start, const Pose& tool, const Config& scale2, int steps) const {
  Config q = start;
  Linear at;
  for (int step = 0; step < steps; ++step) {
    if (!linear(q, tool, at)) return std::nullopt;
    const Config weighted = scale2.cwiseProduct(at.null);
    const Config move = at.particular - (weighted.dot(at.particular) / weighted.dot(at.null)) * at.null;
    const double length2 = move.squaredNorm();
    if (!(length2 < kLongest * kLongest)) return std::nullopt;
    q += move;
    if (length2 < kSettled * kSettled) return Point{q, at.null / at.null.norm()};
  }
  return std::nullopt;
}

std::optional<PoseNewton::Point> PoseNewton::approach(const Config& start, const Pose& tool, int steps) const {
  constexpr double kStride = 0.5;  // rad
  Config q = start;
  Linear at;
  for (int step = 0; step < steps; ++step) {
    if (!linear(q, tool, at)) return std::nullopt;
    Config move = at.particular - (at.null.dot(at.particular) / at.null.squaredNorm()) * at.null;
    const double length2 = move.squaredNorm();
    if (!(length2 < 1e12)) return std::nullopt;
    if (length2 > kStride * kStride) move *= kStride / std::sqrt(length2);
    q += move;
    if (length2 < kSettled * kSettled) return Point{q, at.null / at.null.norm()};
  }
  return std::nullopt;
}

std::optional<PoseNewton::Point> PoseNewton::with_joint_at(const Config& start, const Pose& tool, int joint, double value) const {
  constexpr int kSteps = 8;
  Config q = start;
  Linear at;
  for (int step = 0; step < kSteps; ++step) {
    if (!linear(q, tool, at) || at.null[joint] == 0) return std::nullopt;
    const Config move = at.particular + ((value - q[joint] - at.particular[joint]) / at.null[joint]) * at.null;
    const double length2 = move.squaredNorm();
    if (!(length2 < kLongest * kLongest)) return std::nullopt;
    q += move;
    q[joint] = value;
    if (length2 < kSettled * kSettled) return Point{q, at.null / at.null.norm()};
  }
  return std::nullopt;
}

}  // namespace swivel
