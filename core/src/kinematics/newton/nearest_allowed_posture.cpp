// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/newton/nearest_allowed_posture.hpp"

#include <array>

#include "kinematics/newton/pose_newton.hpp"

namespace swivel {

std::optional<Config> nearest_allowed_posture(const Chain& chain, const Config& q, double farthest,
                                              const std::function<bool(const Config&)>& allowed) {
  constexpr double kFirst = 1e-4, kGrowth = 1.3;  // rad
  constexpr int kSteps = 6;
  if (allowed(q)) return q;
  const Pose tool = chain.tool(q);
  const PoseNewton newton(chain);
  const auto point_near = [&](const Config& start) {
    return newton.nearest(start, tool, Config::Ones(), kSteps);
  };
  const auto here = point_near(q);
  if (!here) return std::nullopt;
  struct Side {
    PoseNewton::Point at;
    bool leads_on = true;
  };
  std::array<Side, 2> sides{Side{*here}, Side{{here->q, -here->tangent}}};
  double gone = 0;
  for (double length = kFirst; gone < farthest; length *= kGrowth) {
    gone += length;
    for (Side& side : sides) {
      if (!side.leads_on) continue;
      auto next = point_near(side.at.q + length * side.at.tangent);
      side.leads_on = next.has_value();
      if (!next) continue;
      if (joint_dot(next->tangent, side.at.tangent) < 0) next->tangent = -next->tangent;
      side.at = *next;
      if (allowed(side.at.q)) return side.at.q;
    }
  }
  return std::nullopt;
}

}  // namespace swivel
