// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "kinematics/kernels/newton.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"

namespace swivel {

/// Newton's method for the six equations "the tool stands at a pose" in seven joints, made for very
/// many small calls. It writes the chain as frames along common normals (Denavit & Hartenberg
/// 1955), finds the step and the null vector by one elimination, and computes one point in each
/// lane of a vector. The position of a slide, m, takes the place of an angle, and so do its moves
/// in norms.
///
/// Where the roll of an arm of six joints is fixed, it keeps its value in nearest(), whatever the
/// scales are.
class PoseNewton {
 public:
  explicit PoseNewton(const Chain& chain);

  /// The moves that close the pose error to first order: particular + lambda null, for every
  /// lambda.
  struct Linear {
    Config particular, null;
  };
  /// Computes the moves from q (rad) that bring the tool to the pose `tool` to first order. Returns
  /// false where the Jacobian has lost rank.
  [[nodiscard]] bool linear(const Config& q, const Pose& tool, Linear& out) const;

  /// A point of a self-motion curve and its unit tangent, of either sign, rad.
  struct Point {
    Config q, tangent;
  };
  /// Returns the point within 1e-10 of the pose `tool` to which Newton steps of least norm, sum
  /// (scale_j dq_j)^2, lead from q; `scale2` has the squares of the scales. Returns none after
  /// `steps` steps, or where a step would be longer than 1 rad or the Jacobian loses rank.
  /// Where the roll is fixed, a point at which it loses rank is reached by damped steps: it is one
  /// of those nearest to q.
  [[nodiscard]] std::optional<Point> nearest(const Config& q, const Pose& tool,
                                             const Config& scale2, int steps) const;
  /// Returns the point of the pose `tool` to which Newton steps of least norm lead from a q that
  /// may be far away, none if they do not arrive in `steps` steps. Each step is cut to half a
  /// radian.
  [[nodiscard]] std::optional<Point> approach(const Config& q, const Pose& tool, int steps) const;
  /// Returns the point of the pose `tool` near q at which a joint (0-based) has a value, bit for
  /// bit, rad; none where Newton does not arrive in 8 steps.
  [[nodiscard]] std::optional<Point> with_joint_at(const Config& q, const Pose& tool, int joint,
                                                   double value) const;

  /// Returns the point of the pose `tool` to which damped Newton steps lead from q, also where the
  /// arm is singular there; its tangent is zero. Returns none after 40 steps, or where one would be
  /// longer than 1 rad. Source: Levenberg & Marquardt, with the squared error as the damping
  /// (Yamashita & Fukushima 2001).
  [[nodiscard]] std::optional<Point> through_singular(const Config& q, const Pose& tool) const;

  // Functions for many points at once, in vector code. They give the same bits as one call for each
  // point.
  /// Returns true if many points at once take less time than one after the other.
  [[nodiscard]] static bool sooner_at_once() { return newton_kernels().lanes > 1; }
  /// The results for many points.
  struct Points {
    std::vector<Config> q, tangent;
    // 0: there is no such point, and q and tangent are meaningless.
    std::vector<unsigned char> found;
    /// Returns the k-th point, none where it was not found.
    [[nodiscard]] std::optional<Point> at(std::size_t k) const {
      if (found[k] == 0) return std::nullopt;
      return Point{q[k], tangent[k]};
    }
  };
  /// Computes the tangents at points that reach the pose already; the points stay as they are.
  void tangents(std::span<const Config> q, const Pose& tool, Points& out) const;
  /// Computes for each start what nearest() for one start does.
  void nearest(std::span<const Config> starts, const Pose& tool, const Config& scale2, int steps,
               Points& out) const;
  /// Computes for each start and value what with_joint_at() for one start does.
  void with_joint_at(std::span<const Config> starts, const Pose& tool, int joint,
                     std::span<const double> values, Points& out) const;

  /// Returns the task for the vector kernels, without points.
  [[nodiscard]] NewtonTask task(const Pose& tool, NewtonMove move, int steps) const;

 private:
  static void run(NewtonTask& task, std::span<const Config> starts, Points& out);
  static std::optional<Point> run(NewtonTask& task, const Config& start);

  NewtonChain chain_{};
  Chain arm_;
};

}  // namespace swivel
