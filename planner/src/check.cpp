// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "collision_validity.hpp"
#include "swivel/core/tool_path.hpp"
#include "swivel/planner/planner.hpp"

namespace swivel {

namespace {

constexpr double kPose = 1e-6, kLimit = 1e-9;

/// The waypoints' own straight segments: a path cut at waypoints alone.
ToolPath segments_of(const Problem& problem) {
  const Resolution coarse{.ds = 1e9, .dphi = 1, .dalpha = 1e9};
  return ToolPath(waypoints_in_base(problem), coarse, problem.source);
}

struct Place {
  int segment = 0;
  double fraction = 0;
  double position_error = 1e9, angle_error = 1e9;
  [[nodiscard]] double along() const { return segment + fraction; }
};

/// The place on the path at arc length s that the tool is at, not before `from`. Where the path only turns, s repeats and the
/// tool's orientation tells the place.
Place locate(const ToolPath& path, double s, const Pose& tool, double from) {
  Place best;
  for (int i = std::max(0, static_cast<int>(std::floor(from - 1e-9))); i + 1 < path.size(); ++i) {
    const PathLayer& segment = path.layer(i);
    if (segment.s > s + 1e-9) break;
    if (segment.s + segment.step_length < s - 1e-9) continue;
    Place place;
    place.segment = i;
    if (segment.step_length > 1e-9) {
      place.fraction = std::clamp((s - segment.s) / segment.step_length, 0.0, 1.0);
    } else {
      const Eigen::AngleAxisd turned(segment.tool.linear().transpose() * tool.linear());
      const Vector3d axis = segment.step_rotation / segment.step_angle;
      place.fraction = std::clamp(turned.angle() * turned.axis().dot(axis) / segment.step_angle, 0.0, 1.0);
    }
    const Pose there = path.at(i, place.fraction);
    place.position_error = (there.translation() - tool.translation()).norm();
    place.angle_error = Eigen::AngleAxisd(there.linear().transpose() * tool.linear()).angle();
    if (place.along() < from - 1e-9) continue;
    if (std::max(place.position_error, place.angle_error) < std::max(best.position_error, best.angle_error)) best = place;
  }
  return best;
}

double distance_to_segment(const Vector3d& x, const Vector3d& a, const Vector3d& b) {
  const Vector3d d = b - a;
  const double length2 = d.squaredNorm();
  const double t = length2 < 1e-18 ? 0 : std::clamp((x - a).dot(d) / length2, 0.0, 1.0);
  return (x - a - t * d).norm();
}

/// Distance of a point from the path between two places.
double distance_to_path(const ToolPath& path, const Place& from, const Place& to, const Vector3d& x) {
  double least = 1e9;
  for (int i = from.segment; i <= to.segment; ++i) {
    const double t0 = i == from.segment ? from.fraction : 0, t1 = i == to.segment ? to.fraction : 1;
    least = std::min(least, distance_to_segment(x, path.at(i, t0).translation(), path.at(i, t1).translation()));
  }
  return least;
}

class Report {
 public:
  explicit Report(CheckResult& result) : result_(result) {}
  [[gnu::format(printf, 2, 3)]] void fail(const char* format, ...) {
    char line[300];
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    if (result_.failures.size() < 20) result_.failures.emplace_back(line);
    failed_ = true;
  }
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  CheckResult& result_;
  bool failed_ = false;
};

}  // namespace

CheckResult check_trajectory(const Problem& problem, const std::vector<TrajectoryRow>& rows) {
  CheckResult result;
  Report report(result);
  const PreparedRobot robot(problem);
  const Chain& chain = robot.arm().chain;
  const ToolPath path = segments_of(problem);
  const World& world = robot.world();
  World::Query query(world);
  const Limits& limits = problem.limits;
  EdgeRule rule = edge_rule(limits, robot.radii());
  rule.d_edge = std::max(0.0, rule.d_edge - kVerdictBand);

  if (rows.size() < 2) report.fail("%zu row(s): at least two are needed", rows.size());
  if (problem.start && !rows.empty() && (rows[0].q - *problem.start).lpNorm<Eigen::Infinity>() > kPose)
    report.fail("row 0: joints are not the given start");

  Place before;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Config& q = rows[k].q;
    const Pose tool = chain.tool(q);
    const Place place = locate(path, rows[k].s, tool, k == 0 ? 0 : before.along());
    result.worst_position = std::max(result.worst_position, place.position_error);
    result.worst_angle = std::max(result.worst_angle, place.angle_error);
    if (!(place.position_error <= kPose && place.angle_error <= kPose)) {
      report.fail("row %zu: the tool is %.3g m and %.3g rad from the path at s = %.9g", k, place.position_error, place.angle_error,
                  rows[k].s);
      if (place.position_error > 1e8) break;  // s lies outside the path or runs backwards
    }
    if (k == 0 && place.along() > 1e-6) report.fail("row 0: begins at s = %.9g, not with the path", rows[k].s);
    if (k + 1 == rows.size() && place.along() < path.size() - 1 - 1e-6)
      report.fail("row %zu: ends at s = %.9g, before the path", k, rows[k].s);
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain.limit[j];
      const double value = q[static_cast<Eigen::Index>(j)];
      if (!limit.continuous &&
          !(value >= limit.lower + limits.joint_margin - kLimit && value <= limit.upper - limits.joint_margin + kLimit))
        report.fail("row %zu: joint '%s' at %.9g is outside its limits", k, chain.joint_names[j].c_str(), value);
    }
    if (limits.manipulability > 0 && !(chain.manipulability(q) >= limits.manipulability - 1e-9))
      report.fail("row %zu: manipulability %.3g is below %.3g", k, chain.manipulability(q), limits.manipulability);
    const auto clearance = query.clearance(q);
    if (clearance) {
      result.min_clearance = std::min(result.min_clearance.value_or(clearance->distance), clearance->distance);
      if (!(clearance->distance >= limits.clearance - kVerdictBand))
        report.fail("row %zu: clearance %.3f mm between '%s' and '%s' is below %.3f mm", k, 1e3 * clearance->distance,
                    world.body_names()[static_cast<std::size_t>(clearance->pair.a)].c_str(),
                    world.body_names()[static_cast<std::size_t>(clearance->pair.b)].c_str(), 1e3 * limits.clearance);
    }
    if (k > 0) {
      const Config& from = rows[k - 1].q;
      const Config delta = q - from;
      double l2 = 0, most = 0;
      for (std::size_t j = 0; j < kDof; ++j) {
        const double move = delta[static_cast<Eigen::Index>(j)];
        const double scaled =
            problem.cost.metric == CostMetric::kTime ? move / chain.limit[j].velocity : problem.cost.weights[j] * move;
        l2 += scaled * scaled;
        most = std::max(most, std::abs(scaled));
      }
      result.cost += problem.cost.metric == CostMetric::kL2 ? std::sqrt(l2) : most;
      for (const double t : {0.25, 0.5, 0.75}) {
        const double error = distance_to_path(path, before, place, chain.tool(from + t * delta).translation());
        result.worst_path_error = std::max(result.worst_path_error, error);
        if (limits.tool_path_error && !(error <= *limits.tool_path_error + kPose))
          report.fail("rows %zu-%zu: the tool leaves the path by %.3f mm", k - 1, k, 1e3 * error);
      }
      if (limits.edges == EdgeMode::kContinuous) {
        const auto pair = edge_blocked(query, rule, from, q);
        if (pair)
          report.fail("rows %zu-%zu: '%s' and '%s' come closer than %.3f mm", k - 1, k,
                      world.body_names()[static_cast<std::size_t>(pair->a)].c_str(),
                      world.body_names()[static_cast<std::size_t>(pair->b)].c_str(), 1e3 * limits.d_edge());
      }
    }
    before = place;
  }
  result.passed = !report.failed();
  return result;
}

}  // namespace swivel
