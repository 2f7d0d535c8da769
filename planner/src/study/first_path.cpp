// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/study/first_path.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <utility>

#include "swivel/planner/plan/planner.hpp"
#include "swivel/planner/robot/planning_arm.hpp"

namespace swivel {

namespace {

/// Returns element `index` of the Halton sequence of a prime base, in [0, 1). Source: Halton 1960.
double halton(int index, int base) {
  double result = 0, fraction = 1;
  for (int rest = index; rest > 0; rest /= base)
    fraction /= base, result += fraction * (rest % base);
  return result;
}

/// A posture of the arm, and how far it is from a limit and from a singular posture.
struct Sample {
  Config joints;
  Pose tool;
  double quality = 0;
};

/// Returns postures that fill the joints' ranges evenly, the best first: those that are far from
/// limits, as shares of the ranges, and have a large manipulability.
std::vector<Sample> sample_postures(const Chain& chain) {
  constexpr std::array<int, kDof> kBases{2, 3, 5, 7, 11, 13, 17};
  constexpr int kSamples = 512;
  std::vector<Sample> samples;
  for (int k = 1; k <= kSamples; ++k) {
    Sample sample;
    double room = 0.5;
    for (int j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
      const double share = halton(k, kBases[static_cast<std::size_t>(j)]);
      const double lower = limit.continuous ? -kPi : std::max(limit.lower, -kPi);
      const double upper = limit.continuous ? kPi : std::min(limit.upper, kPi);
      // A range that zero does not lie in is used as it is.
      const bool usable = lower < upper;
      sample.joints[j] = usable ? lower + share * (upper - lower)
                                : limit.lower + share * (limit.upper - limit.lower);
      if (!limit.continuous) room = std::min({room, share, 1 - share});
    }
    sample.tool = chain.tool(sample.joints);
    sample.quality = room * chain.manipulability(sample.joints);
    samples.push_back(sample);
  }
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& a, const Sample& b) { return a.quality > b.quality; });
  return samples;
}

/// Returns a number rounded to thousandths, so that a file with it is easy to read.
double rounded(double value) {
  return std::round(1e3 * value) / 1e3 + 0.0;
}

/// Returns both ends of a straight path, their positions rounded to 1 mm.
std::vector<Waypoint> line(const Vector3d& middle, const Vector3d& half, const Quaterniond& turn) {
  std::vector<Waypoint> ends(2);
  for (int end = 0; end < 2; ++end) {
    const Vector3d at = middle + (2 * end - 1) * half;
    ends[static_cast<std::size_t>(end)].position = at.unaryExpr(&rounded);
    ends[static_cast<std::size_t>(end)].orientation = turn;
  }
  return ends;
}

/// Returns paths whose tool points down, about an arm whose first axis passes through `centre`, of
/// a given reach.
std::vector<std::vector<Waypoint>> paths_from_above(const Vector3d& centre, double reach) {
  std::vector<std::vector<Waypoint>> paths;
  for (const double azimuth : {0.0, kPi / 2, -kPi / 2, kPi})
    for (const double height : {0.0, -0.2, 0.2})
      for (const double radius : {0.55, 0.7}) {
        const Vector3d out(std::cos(azimuth), std::sin(azimuth), 0), along(-out.y(), out.x(), 0);
        const Vector3d middle = centre + reach * (radius * out + height * Vector3d::UnitZ());
        // The tool's x axis points along the path: turned by pi about it, z points down.
        const Quaterniond turn =
            Quaterniond(Eigen::AngleAxisd(azimuth + kPi / 2, Vector3d::UnitZ())) *
            Quaterniond(0, 1, 0, 0);
        paths.push_back(line(middle, reach / 8 * along, turn));
      }
  return paths;
}

/// Returns paths through postures, along x and y of the tool there.
std::vector<std::vector<Waypoint>> paths_through(const std::vector<Sample>& samples, double reach) {
  constexpr std::size_t kPostures = 24;
  std::vector<std::vector<Waypoint>> paths;
  for (std::size_t k = 0; k < std::min(kPostures, samples.size()); ++k)
    for (const int axis : {0, 1}) {
      const Pose& tool = samples[k].tool;
      Quaterniond turn(tool.linear());
      turn.coeffs() = turn.coeffs().unaryExpr(&rounded);
      paths.push_back(
          line(tool.translation(), reach / 16 * tool.linear().col(axis), turn.normalized()));
    }
  return paths;
}

}  // namespace

FirstPath find_first_path(const Robot& robot, const PlanOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  const Chain chain = planning_arm(robot).model.chain;
  const std::vector<Sample> samples = sample_postures(chain);
  // The point of the first axis that is nearest to the middle of what the tool reaches.
  Vector3d mean = Vector3d::Zero();
  for (const Sample& sample : samples)
    mean += sample.tool.translation() / static_cast<double>(samples.size());
  const Vector3d centre =
      chain.point[0] + (mean - chain.point[0]).dot(chain.axis[0]) * chain.axis[0];
  double reach = 0;
  for (const Sample& sample : samples)
    reach = std::max(reach, (sample.tool.translation() - centre).norm());

  std::vector<std::vector<Waypoint>> paths = paths_from_above(centre, reach);
  std::ranges::move(paths_through(samples, reach), std::back_inserter(paths));
  FirstPath found;
  Planner planner(robot);
  PlanOptions of_one = options;
  for (std::vector<Waypoint>& path : paths) {
    if (path[0].position == path[1].position) continue;  // an arm that hardly moves
    Task task;
    task.waypoints = path;
    planner.set_task(task);
    if (options.timeout_s) {
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
      of_one.timeout_s = std::max(*options.timeout_s - spent.count(), 1e-3);
    }
    found.plan = planner.plan(of_one);
    ++found.tried;
    if (found.plan.status == PlanStatus::kSolved) {
      found.waypoints = std::move(path);
      break;
    }
    if (found.plan.status != PlanStatus::kInfeasible) break;
  }
  return found;
}

}  // namespace swivel
