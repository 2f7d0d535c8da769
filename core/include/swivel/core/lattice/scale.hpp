// SPDX-License-Identifier: BSD-3-Clause
// Millimetres where metres are meant: lengths that are out of all proportion to the arm.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/tool_path.hpp"

namespace swivel {

/// Lengths of more than so many times the arm's reach are taken for another unit.
inline constexpr double kFar = 20;

/// No posture brings the tool farther than this from `chain.point[0]`, m: the distances from each
/// axis to the next and on to the tool's origin.
[[nodiscard]] double most_reach(const Chain& chain);

/// The first waypoint's layer whose tool origin is more than kFar times most_reach() away from
/// `chain.point[0]`; none where there is no such layer.
[[nodiscard]] std::optional<int> first_far_waypoint(const Chain& chain, const ToolPath& path);

/// problem_path(), cut off at first_far_waypoint() where there is one: nothing leads through it, at
/// any resolution, and what comes after, in millimetres as a rule, has too many layers to look at.
[[nodiscard]] ToolPath path_within_scale(const Problem& problem, const Chain& chain,
                                         const Budget& budget = {});

/// A length of `limits` or `path.smooth` that is as large as if it were millimetres: a clearance of
/// more than the arm's reach, a tolerance of more than a quarter of it, a tool speed of more than
/// 10 times the reach in a second.
struct LargeLength {
  std::string section, key;  ///< "limits", "clearance"
  std::string fault;  ///< "is 5 m, and the arm reaches 1.31 m: are these millimetres? Lengths are
                      ///< read as metres"
  double most = 0;    ///< the most that is not suspected
};
[[nodiscard]] std::vector<LargeLength> large_lengths(const Chain& chain, const Problem& problem);
/// One line for each of these.
[[nodiscard]] std::vector<std::string> limit_scale_warnings(const Chain& chain,
                                                            const Problem& problem);

/// One line for the tool, and for each body of the robot, that is as large as if its lengths were
/// millimetres.
[[nodiscard]] std::vector<std::string> scale_warnings(const Chain& chain, const Robot& robot);
/// One line for the path, and for each object of the scene, that is as large or as far away as if
/// its lengths were millimetres.
[[nodiscard]] std::vector<std::string> scale_warnings(const Chain& chain, const ToolPath& path,
                                                      const std::vector<SceneObject>& scene);

}  // namespace swivel
