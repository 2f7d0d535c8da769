// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/srs/srs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

namespace {

constexpr double kMissTolerance = 1e-3;    // m: real URDFs carry 0.4 mm
constexpr double kAngleTolerance = 10e-3;  // rad: pi written as 3.14 gives 1.6 mrad a joint
constexpr double kExact = 1e-11;           // m, rad: below it the fitted arm is exact

struct Line {
  Vector3d p, a;
};

struct Crossing {
  double miss = 0;     // distance between the lines
  double along_b = 0;  // place of the crossing along the second line, from its point
  double right = 0;    // deviation from a right angle
  Vector3d middle = Vector3d::Zero();
  bool parallel = false;
};

Crossing cross(const Line& first, const Line& second) {
  Crossing result;
  const Vector3d normal = first.a.cross(second.a);
  const double cosine = first.a.dot(second.a);
  const Vector3d d = second.p - first.p;
  result.right = std::abs(std::asin(std::clamp(cosine, -1.0, 1.0)));
  if (normal.norm() < 1e-6) {
    result.parallel = true;
    return result;
  }
  result.miss = std::abs(d.dot(normal) / normal.norm());
  const double sine2 = normal.squaredNorm();
  const double along_a = (d.dot(first.a) - d.dot(second.a) * cosine) / sine2;
  result.along_b = (d.dot(first.a) * cosine - d.dot(second.a)) / sine2;
  result.middle = 0.5 * (first.p + along_a * first.a + second.p + result.along_b * second.a);
  return result;
}

/// Returns the common point of axes i, i+1, i+2 (0-based), neighbours perpendicular; appends to
/// `problem` what is wrong.
Vector3d fit_centre(const std::array<Line, kDof>& line, std::size_t i, const char* what,
                    FitDeviation& deviation, std::string& problem) {
  const std::string names[2] = {"axes " + std::to_string(i + 1) + " and " + std::to_string(i + 2),
                                "axes " + std::to_string(i + 2) + " and " + std::to_string(i + 3)};
  const Crossing crossing[2] = {cross(line[i], line[i + 1]), cross(line[i + 2], line[i + 1])};
  for (int k = 0; k < 2; ++k) {
    const std::string& pair = names[k];
    if (crossing[k].parallel) {
      problem += problem.empty() ? "" : "; ";
      problem += pair + " are parallel";
      return line[i + 1].p;
    }
    deviation.angle = std::max(deviation.angle, crossing[k].right);
    deviation.offset = std::max(deviation.offset, crossing[k].miss);
    if (crossing[k].miss > kMissTolerance) {
      problem += problem.empty() ? "" : "; ";
      problem += pair + " miss each other by " + formatted("%.1f mm", 1e3 * crossing[k].miss);
    } else if (crossing[k].right > kAngleTolerance) {
      problem += problem.empty() ? "" : "; ";
      problem += pair + formatted(" are %.2f deg off perpendicular", crossing[k].right * 180 / kPi);
    }
  }
  const double gap = std::abs(crossing[0].along_b - crossing[1].along_b);
  deviation.offset = std::max(deviation.offset, gap);
  if (gap > kMissTolerance) {
    problem += problem.empty() ? "" : "; ";
    problem += "axes " + std::to_string(i + 1) + " and " + std::to_string(i + 3) + " meet axis " +
               std::to_string(i + 2) + formatted(" %.1f mm apart", 1e3 * gap) + " (no spherical " +
               what + ")";
  }
  return 0.5 * (crossing[0].middle + crossing[1].middle);
}

Vector3d perpendicular_part(const Vector3d& v, const Vector3d& n) {
  return (v - v.dot(n) * n).normalized();
}

EulerTriple fit_triple(const Vector3d& first, const Vector3d& second, const Vector3d& third) {
  EulerTriple triple;
  triple.basis << second.cross(first), second, first;
  // third = Rot(second, shift) first: its z and x parts.
  triple.shift = std::atan2(third.dot(second.cross(first)), third.dot(first));
  return triple;
}

/// Returns the entries (TripleCircle) of B^T M B Ry(shift) needed for z-y-z, for one of the three
/// matrices of R(phi) = A sin + B cos + C.
std::array<double, 5> triple_entries(const EulerTriple& triple, const Matrix3d& M) {
  const Matrix3d N = triple.basis.transpose() * M * triple.basis *
                     Eigen::AngleAxisd(triple.shift, Vector3d::UnitY()).toRotationMatrix();
  return {N(0, 2), N(1, 2), N(2, 2), N(2, 0), N(2, 1)};
}

TripleCircle triple_circle(const EulerTriple& triple, const Matrix3d& A, const Matrix3d& B,
                           const Matrix3d& C) {
  const auto a = triple_entries(triple, A), b = triple_entries(triple, B),
             c = triple_entries(triple, C);
  TripleCircle circle;
  for (std::size_t k = 0; k < 5; ++k) circle[k] = {a[k], b[k], c[k]};
  return circle;
}

Matrix3d turn(const Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

std::array<double, 3> solve_euler(const TripleCircle& circle, double shift, double s, double c,
                                  bool flip) {
  const auto at = [&](std::size_t k) { return circle[k][0] * s + circle[k][1] * c + circle[k][2]; };
  const double first = std::atan2(at(1), at(0)),
               middle = std::atan2(std::hypot(at(0), at(1)), at(2)),
               last = std::atan2(at(4), -at(3));
  if (!flip) return {first, middle - shift, last};
  return {wrap_angle(first + kPi), -middle - shift, wrap_angle(last + kPi)};
}

/// Returns how far the tool's origin and its z axis are from a line, at q = 0.
FitDeviation tool_off_axis(const Chain& chain, const Line& line) {
  const Vector3d z = chain.home.linear().col(2);
  return {(chain.home.translation() - line.p).cross(line.a).norm(),
          std::atan2(z.cross(line.a).norm(), std::abs(z.dot(line.a)))};
}

}  // namespace

SrsArm fit_srs(const Chain& chain, const std::string& source) {
  std::array<Line, kDof> line;
  for (std::size_t k = 0; k < kDof; ++k) line[k] = {chain.point[k], chain.axis[k]};
  SrsArm arm;
  std::string problem;
  arm.S = fit_centre(line, 0, "shoulder", arm.deviation, problem);
  arm.W = fit_centre(line, 4, "wrist", arm.deviation, problem);
  const Vector3d& a4 = line[3].a;
  const double out_of_plane = (arm.W - arm.S).dot(a4);
  if (problem.empty()) {
    arm.deviation.offset = std::max(arm.deviation.offset, std::abs(out_of_plane));
    if (std::abs(out_of_plane) > kMissTolerance)
      problem = formatted(
          "the wrist centre is %.1f mm out of the plane through the shoulder centre that axis 4 is "
          "normal to",
          1e3 * std::abs(out_of_plane));
  }
  if (!problem.empty())
    throw NotSrs(source, problem, "a spherical shoulder and wrist within 1 mm and 0.57 deg");

  arm.axis[1] = line[1].a;
  arm.axis[0] = perpendicular_part(line[0].a, line[1].a);
  arm.axis[2] = perpendicular_part(line[2].a, line[1].a);
  arm.axis[3] = a4;
  arm.axis[5] = line[5].a;
  arm.axis[4] = perpendicular_part(line[4].a, line[5].a);
  arm.axis[6] = perpendicular_part(line[6].a, line[5].a);
  arm.W -= out_of_plane * a4;
  arm.E = line[3].p + (arm.S - line[3].p).dot(a4) * a4;
  arm.upper = (arm.E - arm.S).norm();
  arm.fore = (arm.W - arm.E).norm();
  if (arm.upper < kMissTolerance || arm.fore < kMissTolerance)
    throw NotSrs(source,
                 std::string("axis 4 runs through the ") +
                     (arm.upper < arm.fore ? "shoulder" : "wrist") + " centre",
                 "elbows at least 1 mm away");
  const Vector3d straight = (arm.E - arm.S).normalized(), fore = (arm.W - arm.E).normalized();
  arm.elbow_shift = std::atan2(straight.cross(fore).dot(a4), straight.dot(fore));
  arm.shoulder = fit_triple(arm.axis[0], arm.axis[1], arm.axis[2]);
  arm.wrist = fit_triple(arm.axis[4], arm.axis[5], arm.axis[6]);
  arm.home_rotation = chain.home.linear();
  arm.wrist_in_tool = chain.home.linear().transpose() * (arm.W - chain.home.translation());
  if (chain.free_roll && chain.free_roll->circle()) {
    const FitDeviation off = tool_off_axis(chain, line[6]);
    arm.coaxial = off.offset <= kMissTolerance && off.angle <= kAngleTolerance;
    if (arm.coaxial && (off.offset >= kExact || off.angle >= kExact)) {
      arm.deviation.offset = std::max(arm.deviation.offset, off.offset);
      arm.deviation.angle = std::max(arm.deviation.angle, off.angle);
      // The fitted arm's tool is on the axis.
      const Vector3d z = arm.home_rotation.col(2);
      const Vector3d along = z.dot(arm.axis[6]) < 0 ? Vector3d(-arm.axis[6]) : arm.axis[6];
      arm.home_rotation =
          Quaterniond::FromTwoVectors(z, along).toRotationMatrix() * arm.home_rotation;
      arm.wrist_in_tool = {0, 0, arm.wrist_in_tool.z()};
    }
  }
  arm.exact = arm.deviation.offset < kExact && arm.deviation.angle < kExact;
  if (!arm.exact) arm.fit_error = measure_fit_error(chain, arm);
  return arm;
}

int SrsArm::branch(const Config& q) const {
  return (std::sin(shoulder_angle(q)) < 0 ? kShoulderBit : 0) |
         (std::sin(wrist_angle(q)) < 0 ? kWristBit : 0) |
         (std::sin(elbow_angle(q)) < 0 ? kElbowBit : 0);
}

Vector3d SrsArm::elbow_axis(const Config& q) const {
  return turn(axis[0], q[0]) * (turn(axis[1], q[1]) * (turn(axis[2], q[2]) * axis[3]));
}

double ArmPlane::angle_of(const Vector3d& elbow_axis) const {
  return std::atan2(elbow_axis.dot(u.cross(r)), elbow_axis.dot(r));
}

Vector3d wrist_centre(const SrsArm& arm, const Pose& tool) {
  return tool * arm.wrist_in_tool;
}

ArmPlane first_plane(const SrsArm& arm, const Pose& tool) {
  ArmPlane plane;
  const Vector3d sw = wrist_centre(arm, tool) - arm.S;
  plane.reach = sw.norm();
  if (plane.reach >= 1e-6) plane.u = sw / plane.reach;
  Vector3d r = plane.u.cross(Vector3d::UnitZ());
  if (r.norm() < 1e-3) r = plane.u.cross(Vector3d::UnitX());
  plane.r = r.normalized();
  return plane;
}

ArmPlane carry_plane(const SrsArm& arm, const ArmPlane& previous, const Pose& tool) {
  ArmPlane plane = previous;
  const Vector3d sw = wrist_centre(arm, tool) - arm.S;
  plane.reach = sw.norm();
  if (plane.reach < 1e-6) return plane;
  plane.u = sw / plane.reach;
  const Vector3d axis = previous.u.cross(plane.u);
  const double sine = axis.norm(), cosine = previous.u.dot(plane.u);
  Vector3d r = previous.r;
  if (std::atan2(sine, cosine) <= 179.9 * kPi / 180) {
    // Rodrigues with the half-angle form, exact for tiny turns: R r = r + a x r + a x (a x r) / (1
    // + cos).
    const Vector3d ar = axis.cross(r);
    r += ar + axis.cross(ar) / (1 + cosine);
  }  // else a half turn about r itself, which leaves r
  plane.r = perpendicular_part(r, plane.u);
  return plane;
}

ReachStatus reach_status(const SrsArm& arm, double reach) {
  constexpr double kMargin = 1e-9;
  const double low = std::abs(arm.upper - arm.fore), high = arm.upper + arm.fore;
  if (reach < low - kMargin || reach > high + kMargin) return ReachStatus::kOutOfReach;
  if (reach < low + kMargin || reach > high - kMargin || reach < 1e-6)
    return ReachStatus::kSingular;
  return ReachStatus::kReachable;
}

std::array<ElbowCircle, 2> elbow_circles(const SrsArm& arm, const ArmPlane& plane,
                                         const Pose& tool) {
  const double d2 = plane.reach * plane.reach, sum = arm.upper + arm.fore,
               difference = arm.upper - arm.fore;
  // Half-angle form: acos loses half the digits near the straight arm.
  const double bend = 2 * std::atan2(std::sqrt(std::max(0.0, sum * sum - d2)),
                                     std::sqrt(std::max(0.0, d2 - difference * difference)));
  const Vector3d& a4 = arm.axis[3];
  const Vector3d ur = plane.u.cross(plane.r);
  const Matrix3d goal = tool.linear() * arm.home_rotation.transpose();
  std::array<ElbowCircle, 2> circles;
  for (int negative = 0; negative < 2; ++negative) {
    ElbowCircle& circle = circles[static_cast<std::size_t>(negative)];
    circle.q4 = (negative ? -bend : bend) - arm.elbow_shift;
    const Matrix3d R4 = turn(a4, circle.q4);
    const Vector3d u0 = (arm.E - arm.S + R4 * (arm.W - arm.E)).normalized();
    const Vector3d v0 = u0.cross(a4);
    // R_03 takes (u0, a4, u0 x a4) to (u, h, u x h), h = r cos(phi) + (u x r) sin(phi).
    const Matrix3d A = ur * a4.transpose() - plane.r * v0.transpose();
    const Matrix3d B = plane.r * a4.transpose() + ur * v0.transpose();
    const Matrix3d C = plane.u * u0.transpose();
    circle.shoulder = triple_circle(arm.shoulder, A, B, C);
    const Matrix3d R4t = R4.transpose();
    circle.wrist = triple_circle(arm.wrist, R4t * A.transpose() * goal, R4t * B.transpose() * goal,
                                 R4t * C.transpose() * goal);
  }
  return circles;
}

Config srs_ik(const SrsArm& arm, const std::array<ElbowCircle, 2>& circles, double phi,
              int branch) {
  const ElbowCircle& circle = circles[branch & kElbowBit ? 1 : 0];
  const double s = std::sin(phi), c = std::cos(phi);
  const auto shoulder =
      solve_euler(circle.shoulder, arm.shoulder.shift, s, c, branch & kShoulderBit);
  const auto wrist = solve_euler(circle.wrist, arm.wrist.shift, s, c, branch & kWristBit);
  Config q;
  q.head<kDof>() << shoulder[0], shoulder[1], shoulder[2], circle.q4, wrist[0], wrist[1], wrist[2];
  return q;
}

}  // namespace swivel
