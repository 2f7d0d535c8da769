// SPDX-License-Identifier: BSD-3-Clause
// Finds lengths that were probably given in millimetres although they are read as metres, and
// angles that were probably given in degrees although they are read as radians, because they are
// out of all proportion to the arm.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// A size or distance of more than so many times the arm's reach is suspected to be in another
/// unit.
inline constexpr double kFar = 20;

/// Returns a bound on how far the tool's origin can be from `chain.point[0]` in any posture, m: the
/// sum of the distances from each axis to the next and on to the tool's origin.
[[nodiscard]] double most_reach(const Chain& chain);

/// Returns the first layer at a waypoint whose tool origin is more than kFar times most_reach()
/// away from `chain.point[0]`; nothing if there is no such layer.
[[nodiscard]] std::optional<int> first_far_waypoint(const Chain& chain, const ToolPath& path);

/// Returns problem_path(), cut off at first_far_waypoint() if there is one. Nothing leads through
/// that layer at any resolution, and the rest of the path, which is usually in millimetres, has too
/// many layers to look at. Throws as problem_path() does.
[[nodiscard]] ToolPath path_within_scale(const PathProblem& problem, const Chain& chain,
                                         const Budget& budget = {});

/// Returns the largest speed of the tool that is not suspected to be in millimetres a second: 10
/// times the arm's reach in a second, m/s.
[[nodiscard]] double most_tool_speed(const Chain& chain);
/// Returns one warning for a speed of the tool that is above most_tool_speed(), m/s; none else.
/// `what` names the speed, such as "speed".
[[nodiscard]] std::vector<std::string> tool_speed_warnings(const Chain& chain, double speed,
                                                           const std::string& what);
/// Throws InputError in the name of `what`, such as "--speed", for a speed of the tool that is
/// above most_tool_speed() of the arm, m/s.
void require_tool_speed(const Chain& chain, double speed, const std::string& what);

/// A length of `limits` or `path.smooth` that is suspected to be in millimetres: a clearance of
/// more than the arm's reach, a tolerance of more than a quarter of it, or a tool speed of more
/// than 10 times the reach in a second. Likewise an angle of `limits` that is suspected to be in
/// degrees: a speed of joints that turn, or of the tool's turn, of more than 50 rad/s, a tolerance
/// of more than half a turn, or a step of joints of more than a turn.
struct LargeLength {
  std::string section, key;  ///< such as "limits" and "clearance"
  /// Such as "is 5 m, and the arm reaches 1.31 m: are these millimetres? Lengths are read as
  /// metres".
  std::string fault;
  double most = 0;  ///< the largest value that is not suspected, m, m/s, rad or rad/s
};
[[nodiscard]] std::vector<LargeLength> large_lengths(const Chain& chain,
                                                     const PathProblem& problem);
/// Returns one warning for each of large_lengths().
[[nodiscard]] std::vector<std::string> limit_scale_warnings(const Chain& chain,
                                                            const PathProblem& problem);

/// Returns one warning for the tool and one for each body of the robot that is as large as if its
/// lengths were millimetres, and one for all joints of the chain whose limits are as large as if
/// their angles were degrees: positions from 25 to 1000 rad, or speeds of more than 50 rad/s.
[[nodiscard]] std::vector<std::string> scale_warnings(const Chain& chain, const Robot& robot);
/// Returns one warning for the path and one for each object of the scene that is as large or as far
/// away as if its lengths were millimetres.
[[nodiscard]] std::vector<std::string> scale_warnings(const Chain& chain, const ToolPath& path,
                                                      const std::vector<SceneObject>& scene);

}  // namespace swivel
