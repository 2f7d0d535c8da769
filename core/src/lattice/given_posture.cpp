// SPDX-License-Identifier: BSD-3-Clause
#include "lattice/given_posture.hpp"

#include <cmath>
#include <string>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

namespace {

constexpr double kOnPath = 1e-6;  // m and rad: how far the tool may stand from the path at the end

const PathLayer& layer_of(PathEnd which, const ToolPath& path) {
  return path.layer(which == PathEnd::kFirst ? 0 : path.size() - 1);
}

/// Returns the key of problem files that gives the joints.
std::string key_of(PathEnd which) {
  return which == PathEnd::kFirst ? "start.joints" : "path.end.joints";
}

/// Returns the line about a tool that stands too far from the path.
std::string off_path(PathEnd which, const PathProblem& problem, double distance, double angle) {
  if (which == PathEnd::kLast)
    return formatted(
        ": the end posture is not on the path: its tool is %.3g mm and %.3g rad from the last "
        "pose: allowed are %g mm and %g rad",
        1e3 * distance, angle, 1e3 * kOnPath, kOnPath);
  const std::string pose =
      problem.start_at ? formatted("pose at start_at, %.9g m", *problem.start_at) : "first pose";
  return formatted(
      ": the tool is %.3g m and %.3g rad from the path's %s: allowed are %g m and rad "
      "(start_tolerance)",
      distance, angle, pose.c_str(), problem.start_tolerance);
}

}  // namespace

Config joints_given(PathEnd which, const PathProblem& problem, const Chain& chain,
                    const ToolPath& path) {
  TrajectoryRow row;
  row.q = which == PathEnd::kFirst ? *problem.start : *problem.end;
  return counted_from_path(chain, path, layer_of(which, path).travel, row).q;
}

void validate_given(PathEnd which, const PathProblem& problem, const Chain& chain,
                    const ToolPath& path) {
  const Config q = joints_given(which, problem, chain, path);
  const Pose reached = chain.tool(q);
  const Pose& wanted = layer_of(which, path).tool;
  const double distance = (reached.translation() - wanted.translation()).norm();
  const double angle = Eigen::AngleAxisd(reached.linear().transpose() * wanted.linear()).angle();
  for (int k = 0; k < kDof; ++k) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(k)];
    const double lower = limit.lower + problem.limits.joint_margin,
                 upper = limit.upper - problem.limits.joint_margin;
    if (!std::isfinite(q[k]) ||
        (!limit.continuous && (q[k] < lower - kLimitTolerance || q[k] > upper + kLimitTolerance)))
      throw InputError(problem.source,
                       key_of(which) + ": joint '" +
                           chain.joint_names[static_cast<std::size_t>(k)] + "' at " +
                           formatted("%.9g", q[k]) + " is outside its limits" + ": allowed is " +
                           formatted("%.9g", lower) + " to " + formatted("%.9g", upper));
  }
  const double tolerance = which == PathEnd::kFirst ? problem.start_tolerance : kOnPath;
  if (!(distance <= tolerance && angle <= tolerance))
    throw InputError(problem.source, key_of(which) + off_path(which, problem, distance, angle));
}

double roll_of_given(PathEnd which, const PathProblem& problem, const Chain& chain,
                     const ToolPath& path, const Roll& range) {
  constexpr double kRoll = 1e-6;  // rad: the precision to which joints are usually written
  const Config q = joints_given(which, problem, chain, path);
  const PathLayer& layer = layer_of(which, path);
  double roll = chain.roll ? q[kDof - 1] : roll_between(layer.tool, chain.tool(q));
  if (!range.circle())
    roll += kTwoPi * std::round(((range.lower + range.upper) / 2 - roll) / kTwoPi);
  const auto refuse = [&](const Roll& allowed, const char* whose) {
    const std::string text =
        formatted(": the tool stands turned by %.6g rad: allowed is %.6g to %.6g (%s)", roll,
                  allowed.lower, allowed.upper, whose);
    throw InputError(problem.source, key_of(which) + text);
  };
  if (!range.circle() && !(roll >= range.lower - kRoll && roll <= range.upper + kRoll))
    refuse(range, "path.roll");
  if (!layer.in_window(roll, kRoll))
    refuse(layer.window, "the roll_min and roll_max of its waypoints");
  return roll;
}

}  // namespace swivel
