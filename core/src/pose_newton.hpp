// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>

#include "swivel/core/arm.hpp"

namespace swivel {

/// Newton's method for the six equations "the tool stands at a pose" in seven joints, made for very many small calls: the chain as
/// frames along common normals (Denavit & Hartenberg 1955), one elimination for the step and the null vector.
class PoseNewton {
 public:
  explicit PoseNewton(const Chain& chain);

  /// To first order, every move  particular + lambda null  closes the error.
  struct Linear {
    Config particular, null;
  };
  /// False where the Jacobian has lost rank.
  [[nodiscard]] bool linear(const Config& q, const Pose& tool, Linear& out) const;

  /// A point of a self-motion curve and its unit tangent, of either sign.
  struct Point {
    Config q, tangent;
  };
  /// The point near q at which Newton steps of least norm, sum (scale_j dq_j)^2, end; `scale2` has the squares. Within 1e-10 of the
  /// pose. None after `steps` steps, or where a step would be longer than 1 rad.
  [[nodiscard]] std::optional<Point> nearest(const Config& q, const Pose& tool, const Config& scale2, int steps) const;
  /// The same from far away: steps are cut to half a radian.
  [[nodiscard]] std::optional<Point> approach(const Config& q, const Pose& tool, int steps) const;
  /// `nearest` with the joint at the value, bit for bit.
  [[nodiscard]] std::optional<Point> with_joint_at(const Config& q, const Pose& tool, int joint, double value) const;

 private:
  struct Link {  // from the frame of a joint to that of the next: Rz(q + turn) Tz(height) Tx(width) Rx(twist)
    double turn = 0, height = 0, width = 0, twist_cosine = 1, twist_sine = 0;
  };
  Pose first_ = Pose::Identity();  // frame of joint 1 in base
  std::array<Link, kDof> link_;    // the last has a turn only
  Pose last_ = Pose::Identity();   // tool in the frame of joint 7
};

}  // namespace swivel
