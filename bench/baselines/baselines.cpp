// SPDX-License-Identifier: BSD-3-Clause
#include "baselines.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel::baselines {

namespace {

using Twist = Eigen::Matrix<double, 6, 1>;
using Svd = Eigen::JacobiSVD<Eigen::Matrix<double, 6, kDof>>;

/// Least singular value of J below which the arm counts as singular: the pseudo-inverse would then
/// move the joints a thousand times as far as the tool.
constexpr double kSingular = 1e-3;
constexpr double kLimitTolerance = 1e-9;
constexpr int kNewtonSteps = 20;

/// Returns the motion that takes the tool from `from` to `to`, in the base frame.
Twist tool_error(const Pose& from, const Pose& to) {
  const Eigen::AngleAxisd turn(to.linear() * from.linear().transpose());
  Twist error;
  error << to.translation() - from.translation(), turn.angle() * turn.axis();
  return error;
}

class Tracker {
 public:
  Tracker(const PreparedRobot& robot, const PathProblem& problem, const TrackOptions& options)
      : chain_(robot.arm().chain),
        options_(options),
        margin_(problem.limits.joint_margin),
        safe_(problem.limits.clearance),
        path_(waypoints_in_base(problem),
              Resolution{.ds = options.step, .dalpha = options.turn_step}, problem.source),
        world_(robot.world(), problem.scene),
        query_(world_) {
    if (!problem.start) throw InputError(problem.source + ": start: a local tracker needs one");
    q_ = result_.end = *problem.start;
    if (tool_error(chain_.tool(q_), path_.layer(0).tool).norm() > 1e-6)
      throw InputError(problem.source + ": start: not at the first pose of the path");
  }

  TrackResult run(bool push) {
    for (int i = 0; i < path_.size(); ++i) {
      const Pose& tool = path_.layer(i).tool;
      const auto next = on_tool(tool, q_);
      if (!next || (*next - q_).cwiseAbs().maxCoeff() > options_.largest_move)
        return stop(StopReason::kDiverged);
      result_.end = *next;
      if (const int joint = outside(*next); joint >= 0)
        return stop(StopReason::kJointLimit, chain_.joint_names[static_cast<std::size_t>(joint)]);
      Config q = *next;
      const auto stuck = push ? push_away(tool, q) : std::nullopt;
      result_.end = q;
      if (stuck) return stop(*stuck);
      if (clearance(q) < safe_) return stop(StopReason::kCollision, nearest_pair());
      q_ = q;
      result_.rows.push_back(q_);
      result_.s = path_.layer(i).s;
    }
    result_.finished = true;
    return stop(StopReason::kFinished);
  }

 private:
  TrackResult stop(StopReason reason, const std::string& blocking = {}) {
    result_.reason = reason;
    if (!blocking.empty()) result_.blocking = blocking;
    return std::move(result_);
  }

  /// Returns the end of Newton steps J^+ error from q; nothing if they do not converge.
  std::optional<Config> on_tool(const Pose& tool, Config q) const {
    for (int k = 0; k < kNewtonSteps; ++k) {
      const Twist error = tool_error(chain_.tool(q), tool);
      if (error.norm() <= options_.tool_error) return q;
      const Svd svd(chain_.jacobian(q), Eigen::ComputeFullU | Eigen::ComputeFullV);
      if (svd.singularValues()[5] < kSingular) return std::nullopt;
      q += Config(svd.solve(error));
    }
    return std::nullopt;
  }

  /// Returns the first joint that is outside its limits, or -1.
  int outside(const Config& q) const {
    for (int j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain_.limit[static_cast<std::size_t>(j)];
      if (limit.continuous) continue;
      if (q[j] < limit.lower + margin_ - kLimitTolerance ||
          q[j] > limit.upper - margin_ + kLimitTolerance)
        return j;
    }
    return -1;
  }

  /// Returns the least clearance, m, and remembers its pair.
  double clearance(const Config& q) {
    const auto least = query_.clearance(q);
    if (!least) return std::numeric_limits<double>::infinity();
    nearest_ = least->pair;
    result_.clearance = least->distance;
    return least->distance;
  }
  std::string nearest_pair() const {
    return world_.body_names()[static_cast<std::size_t>(nearest_.a)] + " - " +
           world_.body_names()[static_cast<std::size_t>(nearest_.b)];
  }

  /// Moves q along the self-motion in the direction of rising clearance. The null space has one
  /// direction n, so that (I - J^+ J) grad c = n (dc/dn), and one difference quotient to each side
  /// suffices: if both fall, no self-motion helps. Returns a reason if that leaves q short of the
  /// safe clearance.
  std::optional<StopReason> push_away(const Pose& tool, Config& q) {
    double here = clearance(q);
    for (int k = 0; k < options_.most_pushes && here < options_.influence && here > 0; ++k) {
      if (here >= safe_ && k >= options_.pushes) return std::nullopt;
      const Config n = Svd(chain_.jacobian(q), Eigen::ComputeFullU | Eigen::ComputeFullV)
                           .matrixV()
                           .col(kDof - 1);
      const std::array<double, 2> slopes{
          (clearance(q + options_.probe * n) - here) / options_.probe,
          (clearance(q - options_.probe * n) - here) / options_.probe};
      const double ascent = std::max({0.0, slopes[0], slopes[1]});
      const double sign = slopes[0] >= slopes[1] ? 1 : -1;
      const double wanted =
          std::min(options_.largest_push, options_.gain * (1 - here / options_.influence) * ascent);
      std::optional<Config> better;
      int held_by = -1;  // joint whose limit ended the push
      if (ascent > options_.vanishing) {
        // Halve the push if it would overshoot the ridge or a limit; the clearance at the probe
        // itself is known to be higher.
        for (double push = wanted; !better && push > options_.probe / 4; push /= 2) {
          const auto pushed = on_tool(tool, q + sign * push * n);
          if (!pushed) continue;
          held_by = outside(*pushed);
          if (held_by < 0 && clearance(*pushed) > here) better = pushed;
        }
      }
      if (better) {
        q = *better;
        here = clearance(q);
        continue;
      }
      here = clearance(q);
      if (here >= safe_) return std::nullopt;
      result_.projected_gradient = ascent;
      result_.slopes = slopes;
      if (held_by >= 0) {
        result_.blocking = chain_.joint_names[static_cast<std::size_t>(held_by)];
        return StopReason::kJointLimit;
      }
      result_.blocking = nearest_pair();
      return ascent > options_.vanishing ? StopReason::kCollision : StopReason::kLocalMinimum;
    }
    return std::nullopt;
  }

  const Chain& chain_;
  const TrackOptions& options_;
  double margin_, safe_;
  ToolPath path_;
  World world_;
  World::Query query_;
  Config q_;
  BodyPair nearest_;
  TrackResult result_;
};

}  // namespace

const char* to_string(StopReason reason) {
  switch (reason) {
    case StopReason::kFinished:
      return "finished";
    case StopReason::kJointLimit:
      return "joint limit";
    case StopReason::kCollision:
      return "collision";
    case StopReason::kLocalMinimum:
      return "local minimum";
    case StopReason::kDiverged:
      return "diverged";
  }
  return "?";
}

TrackResult track_jacobian(const PreparedRobot& robot, const PathProblem& problem,
                           const TrackOptions& options) {
  return Tracker(robot, problem, options).run(false);
}

TrackResult track_null_space(const PreparedRobot& robot, const PathProblem& problem,
                             const TrackOptions& options) {
  return Tracker(robot, problem, options).run(true);
}

}  // namespace swivel::baselines
