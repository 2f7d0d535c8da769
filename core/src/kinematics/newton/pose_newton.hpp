// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "kinematics/kernels/newton.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"

namespace swivel {

/// Newton's method for the six equations "the tool stands at a pose" in seven joints, made for very many small calls: the chain as
/// frames along common normals (Denavit & Hartenberg 1955), one elimination for the step and the null vector, a vector's lanes for
/// points.
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

  // --- of many points at once, in vector code: the bits are those of one after the other
  /// False where that takes as long.
  [[nodiscard]] static bool sooner_at_once() { return newton_kernels().lanes > 1; }
  struct Points {
    std::vector<Config> q, tangent;
    std::vector<unsigned char> found;  // 0: none, and what stands in its place is no point
    [[nodiscard]] std::optional<Point> at(std::size_t k) const {
      if (found[k] == 0) return std::nullopt;
      return Point{q[k], tangent[k]};
    }
  };
  /// Of points that reach the pose, as they are.
  void tangents(std::span<const Config> q, const Pose& tool, Points& out) const;
  void nearest(std::span<const Config> starts, const Pose& tool, const Config& scale2, int steps, Points& out) const;
  void with_joint_at(std::span<const Config> starts, const Pose& tool, int joint, std::span<const double> values,
                     Points& out) const;

  /// What the kernels are asked, without the points.
  [[nodiscard]] NewtonTask task(const Pose& tool, NewtonMove move, int steps) const;

 private:
  static void run(NewtonTask& task, std::span<const Config> starts, Points& out);
  static std::optional<Point> run(NewtonTask& task, const Config& start);

  NewtonChain chain_{};
};

}  // namespace swivel
