// SPDX-License-Identifier: BSD-3-Clause
#include "pose_newton.hpp"

#include <cmath>

namespace swivel {

namespace {

constexpr double kRank = 1e-9;      // pivot below which the Jacobian has lost rank
constexpr double kSettled = 4e-6;   // rad: after so small a step the error is its square
constexpr double kParallel = 1e-9;  // sine below which neighbouring axes have no common normal of their own
constexpr double kLongest = 1;      // rad, of one step

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
  Vector3d X = first_.linear().col(0), Y = first_.linear().col(1), Z = first_.linear().col(2), P = first_.translation();
  std::array<Vector3d, kDof> axis, point;
  for (std::size_t k = 0; k < kDof; ++k) {
    axis[k] = Z;
    point[k] = P;
    const Link& link = link_[k];
    const double angle = q[static_cast<Eigen::Index>(k)] + link.turn, c = std::cos(angle), s = std::sin(angle);
    const Vector3d x = c * X + s * Y, y = c * Y - s * X;
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

  double A[6][8];
  for (std::size_t k = 0; k < kDof; ++k) {
    const Vector3d v = axis[k].cross(P - point[k]);
    for (int r = 0; r < 3; ++r) {
      A[r][k] = v[r];
      A[r + 3][k] = axis[k][r];
    }
  }
  for (int r = 0; r < 3; ++r) {
    A[r][7] = miss[r];
    A[r + 3][7] = turn[r];
  }
  // Gauss and Jordan; each row takes the largest column that is left.
  int pivot[6];
  unsigned left = 0x7f;
  for (int r = 0; r < 6; ++r) {
    int column = 0;
    double largest = -1;
    for (int c = 0; c < kDof; ++c) {
      const double size = std::abs(A[r][c]);
      if ((left >> c & 1) != 0 && size > largest) {
        largest = size;
        column = c;
      }
    }
    if (!(largest > kRank)) return false;
    left &= ~(1u << column);
    pivot[r] = column;
    const double inverse = 1 / A[r][column];
    for (double& a : A[r]) a *= inverse;
    for (int i = 0; i < 6; ++i) {
      if (i == r) continue;
      const double factor = A[i][column];
      for (int c = 0; c < 8; ++c) A[i][c] -= factor * A[r][c];
    }
  }
  int free = 0;
  while ((left >> free & 1) == 0) ++free;
  out.particular[free] = 0;
  out.null[free] = 1;
  for (int r = 0; r < 6; ++r) {
    out.particular[pivot[r]] = A[r][7];
    out.null[pivot[r]] = -A[r][free];
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
