// SPDX-License-Identifier: BSD-3-Clause
#include "lattice/start.hpp"

#include <cmath>
#include <string>

#include "swivel/core/base/angle.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

void validate_start(const Problem& problem, const Chain& chain, const ToolPath& path) {
  const Config& q = *problem.start;
  const Pose reached = chain.tool(q);
  const Pose& first = path.layer(0).tool;
  const double distance = (reached.translation() - first.translation()).norm();
  const double angle = Eigen::AngleAxisd(reached.linear().transpose() * first.linear()).angle();
  for (int k = 0; k < kDof; ++k) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(k)];
    const double lower = limit.lower + problem.limits.joint_margin,
                 upper = limit.upper - problem.limits.joint_margin;
    if (!std::isfinite(q[k]) ||
        (!limit.continuous && (q[k] < lower - kLimitTolerance || q[k] > upper + kLimitTolerance)))
      throw InputError(problem.source,
                       "start.joints: joint '" + chain.joint_names[static_cast<std::size_t>(k)] +
                           "' at " + formatted("%.9g", q[k]) + " is outside its limits" +
                           ": allowed is " + formatted("%.9g", lower) + " to " +
                           formatted("%.9g", upper));
  }
  const double tolerance = problem.start_tolerance;
  if (!(distance <= tolerance && angle <= tolerance)) {
    const std::string pose =
        problem.start_at ? formatted("pose at start_at, %.9g m", *problem.start_at) : "first pose";
    const std::string text = formatted(
        "start.joints: the tool is %.3g m and %.3g rad from the path's %s: allowed are %g m and "
        "rad (start_tolerance)",
        distance, angle, pose.c_str(), tolerance);
    throw InputError(problem.source, text);
  }
}

double roll_of_start(const Problem& problem, const Chain& chain, const ToolPath& path,
                     const Roll& range) {
  constexpr double kRoll = 1e-6;  // rad: the precision to which joints are usually written
  double roll = chain.roll ? (*problem.start)[kDof - 1]
                           : roll_between(path.layer(0).tool, chain.tool(*problem.start));
  if (!range.circle())
    roll += kTwoPi * std::round(((range.lower + range.upper) / 2 - roll) / kTwoPi);
  const auto refuse = [&](const Roll& allowed, const char* whose) {
    const std::string text =
        formatted("start.joints: the tool stands turned by %.6g rad: allowed is %.6g to %.6g (%s)",
                  roll, allowed.lower, allowed.upper, whose);
    throw InputError(problem.source, text);
  };
  if (!range.circle() && !(roll >= range.lower - kRoll && roll <= range.upper + kRoll))
    refuse(range, "path.roll");
  if (!path.layer(0).in_window(roll, kRoll))
    refuse(path.layer(0).window, "the roll_min and roll_max of its waypoints");
  return roll;
}

}  // namespace swivel
