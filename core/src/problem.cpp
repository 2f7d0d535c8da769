// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/problem.hpp"

#include <algorithm>
#include <cmath>

#include "swivel/core/input_error.hpp"

namespace swivel {

namespace {

/// Steele, Lea, Flood 2014: the generator whose every output is a mix of a counter.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t state) : state_(state) {}
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  /// Uniform in [-1, 1).
  double symmetric() { return static_cast<double>(next() >> 11) * 0x1.0p-52 - 1.0; }

 private:
  std::uint64_t state_;
};

Matrix3d from_rpy(const Vector3d& rpy) {
  return (Eigen::AngleAxisd(rpy.z(), Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace

Problem episode_problem(const Problem& problem, std::uint64_t seed, std::uint64_t episode) {
  Problem result = problem;
  SplitMix64 mixed_seed(seed);
  SplitMix64 random(mixed_seed.next() ^ episode);
  random.next();  // one more mix, so that neighbouring episodes share nothing
  for (const Vary& vary : problem.vary) {
    Vector3d offset, rpy;
    for (int k = 0; k < 3; ++k) offset[k] = vary.xyz[k] * random.symmetric();
    for (int k = 0; k < 3; ++k) rpy[k] = vary.rpy[k] * random.symmetric();
    for (SceneObject& object : result.scene)
      if (object.name == vary.object) {
        object.pose.translation() += offset;
        object.pose.linear() = from_rpy(rpy) * object.pose.linear();
      }
  }
  return result;
}

std::vector<Waypoint> waypoints_in_base(const Problem& problem) {
  Pose frame = Pose::Identity();
  if (problem.path_frame != problem.base_link && !problem.path_frame.empty()) {
    const auto object =
        std::find_if(problem.scene.begin(), problem.scene.end(), [&](const auto& o) { return o.name == problem.path_frame; });
    if (object == problem.scene.end())
      throw InputError(problem.source + ": path.frame: unknown frame '" + problem.path_frame +
                       "': allowed are the base link and the names of scene objects");
    frame = object->pose;
  }
  std::vector<Waypoint> result;
  result.reserve(problem.waypoints.size());
  for (std::size_t k = 0; k < problem.waypoints.size(); ++k) {
    const Waypoint& w = problem.waypoints[k];
    const double norm = w.orientation.norm();
    if (!w.position.allFinite() || !std::isfinite(norm) || std::abs(norm - 1) > 1e-3)
      throw InputError(problem.source + ": path: waypoint " + std::to_string(k) +
                       ": not a pose: allowed are finite numbers and a quaternion of length 1 within 1e-3");
    Waypoint moved;
    moved.position = frame * w.position;
    moved.orientation = (Quaterniond(frame.linear()) * w.orientation.normalized()).normalized();
    result.push_back(moved);
  }
  if (result.size() < 2)
    throw InputError(problem.source + ": path: " + std::to_string(result.size()) + " waypoint(s): allowed are at least two");
  return result;
}

}  // namespace swivel
