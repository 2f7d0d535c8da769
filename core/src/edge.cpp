// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "swivel/core/angle.hpp"
#include "swivel/core/lattice.hpp"

namespace swivel {

namespace {

/// Rounds to a multiple of 2^-40 units (for |x| < 2048 units): sums of costs are then exact in any order.
double rounded(double x, double unit) {
  const double shift = 6144.0 * unit;  // 1.5 * 2^12, whose last place is 2^-40
  return (x + shift) - shift;
}

/// The tool's straight line from a layer to the next; a point where they coincide.
class Step {
 public:
  Step(const ToolPath& path, int layer) : start_(path.layer(layer).tool.translation()) {
    const Vector3d along = path.layer(layer + 1).tool.translation() - start_;
    length_ = along.norm();
    if (length_ >= kShortest) direction_ = along / length_;
  }
  /// Distance of a point from the line, m.
  [[nodiscard]] double aside(const Vector3d& p) const {
    const Vector3d d = p - start_;
    return (d - d.dot(direction_) * direction_).norm();
  }
  /// Where on the step the foot of a point lies, 0 to 1; none on a point.
  [[nodiscard]] std::optional<double> fraction(const Vector3d& p) const {
    if (length_ < kShortest) return std::nullopt;
    return std::clamp((p - start_).dot(direction_) / length_, 0.0, 1.0);
  }

 private:
  static constexpr double kShortest = 1e-9;  // m
  Vector3d start_, direction_ = Vector3d::Zero();
  double length_;
};

}  // namespace

Config Lattice::delta(const Config& q0, const Config& q1) const {
  Config d = q1 - q0;
  for (int k = 0; k < kDof; ++k)
    if (continuous_[static_cast<std::size_t>(k)]) d[k] = wrap_angle(d[k]);
  return d;
}

bool Lattice::step_allowed(int layer, const Config& delta) const {
  const Config& bound = step_bound(layer);
  for (int k = 0; k < kDof; ++k)
    if (!(std::abs(delta[k]) <= bound[k])) return false;
  return true;
}

double Lattice::edge_cost(const Config& delta) const {
  double x[kDof];
  for (std::size_t k = 0; k < kDof; ++k) x[k] = cost_scale_[k] * delta[static_cast<Eigen::Index>(k)];
  if (cost_.metric == CostMetric::kL2)
    // Shoulder, elbow, wrist: the order in which the vector sweep adds, so that the bits agree.
    return rounded(
        std::sqrt(((x[0] * x[0] + x[1] * x[1]) + x[2] * x[2]) + x[3] * x[3] + ((x[4] * x[4] + x[5] * x[5]) + x[6] * x[6])),
        cost_unit_);
  double most = 0;
  for (const double value : x) most = std::max(most, std::abs(value));
  return rounded(most, cost_unit_);
}

bool Lattice::follows_path(int layer, int a, const Config& q0, int b, const Config& q1) const {
  const auto within = [](const std::array<double, 3>& deviation, double limit) {
    return std::all_of(deviation.begin(), deviation.end(), [limit](double x) { return x <= limit; });
  };
  const Config move = delta(q0, q1);
  if (limits_.tool_path_error && !within(path_deviation(*chain_, *path_, layer, q0, move), *limits_.tool_path_error)) return false;
  if (limits_.tool_angle_error && !within(angle_deviation(*chain_, *path_, layer, q0, move), *limits_.tool_angle_error))
    return false;
  if (limits_.step_error) {
    const double phi_a = phi(layer, a), phi_b = phi(layer + 1, b), dphi = wrap_angle(phi_b - phi_a);
    if (!(step_error(*this, layer, 0, branch_of(a), phi_a, dphi) <= *limits_.step_error)) return false;
    if (!(step_error(*this, layer, 1, branch_of(b), phi_b, dphi) <= *limits_.step_error)) return false;
  }
  return true;
}

std::array<double, 3> path_deviation(const Chain& chain, const ToolPath& path, int layer, const Config& q0, const Config& delta) {
  const Step step(path, layer);
  // t = 1/2 as it is; 1/4 and 3/4 are a quarter of the move, h, before and after it.
  Config c, s, c_before, s_before, c_after, s_after;
  for (int k = 0; k < kDof; ++k) {
    const double middle = q0[k] + 0.5 * delta[k], h = 0.25 * delta[k];
    c[k] = std::cos(middle), s[k] = std::sin(middle);
    const double ch = std::cos(h), sh = std::sin(h);
    c_before[k] = c[k] * ch + s[k] * sh, s_before[k] = s[k] * ch - c[k] * sh;
    c_after[k] = c[k] * ch - s[k] * sh, s_after[k] = s[k] * ch + c[k] * sh;
  }
  return {step.aside(chain.tool_point(c_before, s_before)), step.aside(chain.tool_point(c, s)),
          step.aside(chain.tool_point(c_after, s_after))};
}

std::array<double, 3> angle_deviation(const Chain& chain, const ToolPath& path, int layer, const Config& q0, const Config& delta) {
  const Step step(path, layer);
  std::array<double, 3> deviation{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double t = 0.25 * static_cast<double>(k + 1);
    const Pose tool = chain.tool(q0 + t * delta);
    const Pose asked = path.at(layer, step.fraction(tool.translation()).value_or(t));
    deviation[k] = Eigen::AngleAxisd(asked.linear().transpose() * tool.linear()).angle();
  }
  return deviation;
}

double step_error(const Lattice& lattice, int layer, int end, int branch, double phi, double dphi) {
  constexpr double kStep = 1e-3;  // of the step parameter; truncation and rounding both stay below 1e-6 of the value
  const SrsArm& arm = lattice.arm();
  const ArmPlane& plane = lattice.plane(layer + end);
  const auto joints = [&](double t, double angle) -> std::optional<Config> {
    const Pose tool = lattice.path().at(layer, end + t);
    const ArmPlane carried = carry_plane(arm, plane, tool);
    if (reach_status(arm, carried.reach) != ReachStatus::kReachable) return std::nullopt;
    return srs_ik(arm, elbow_circles(arm, carried, tool), angle, branch);
  };
  const auto center = joints(0, phi);
  const auto ahead = joints(kStep, phi + kStep * dphi), behind = joints(-kStep, phi - kStep * dphi);
  const auto s_ahead = joints(kStep, phi), s_behind = joints(-kStep, phi), phi_ahead = joints(0, phi + kStep),
             phi_behind = joints(0, phi - kStep);
  if (!center || !ahead || !behind || !s_ahead || !s_behind || !phi_ahead || !phi_behind)
    return std::numeric_limits<double>::infinity();
  const auto difference = [](const Config& a, const Config& b) {
    Config d = a - b;
    for (int k = 0; k < kDof; ++k) d[k] = wrap_angle(d[k]);
    return d;
  };
  Config second = (difference(*ahead, *center) - difference(*center, *behind)) / (kStep * kStep);
  // Remove the part in the tangent plane spanned by theta_s and theta_phi (Gram-Schmidt).
  Config t1 = difference(*s_ahead, *s_behind), t2 = difference(*phi_ahead, *phi_behind);
  if (t1.norm() > 0) {
    t1.normalize();
    second -= second.dot(t1) * t1;
    t2 -= t2.dot(t1) * t1;
  }
  if (t2.norm() > 1e-12) {
    t2.normalize();
    second -= second.dot(t2) * t2;
  }
  return 0.5 * second.norm();
}

}  // namespace swivel
