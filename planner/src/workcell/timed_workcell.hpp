// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/problem/tool_path.hpp"
#include "swivel/planner/workcell/prepared/prepared_workcell.hpp"

namespace swivel {

/// Throws InputError where the motion of an arm is given, beside which nothing is refined.
void require_refinable(const PreparedWorkcell& prepared);
/// Throws InvalidArgument unless a workcell was completed by with_motion_defaults() before it was
/// prepared.
void require_motion_defaults(const PreparedWorkcell& prepared);
/// Throws InputError for a speed of the tool, m/s, that is out of all proportion to both arms.
void require_tool_speed_of_arms(const PreparedWorkcell& prepared, double speed);

/// How far a follower's tool is off its path on the leader's tool: m and rad.
struct FollowerError {
  double position = 0, angle = 0;
};

/// Returns how far the follower's tool of a workcell that has one is off its path on the leader's
/// tool, as the leader's joints have turned that, at a layer of both paths; `q` is by arm, rad.
[[nodiscard]] FollowerError follower_error(const PreparedWorkcell& prepared,
                                           const std::array<Config, 2>& q, int layer);

/// Measures followers of a workcell that has one, against the leader's tool as its joints have
/// turned it.
class FollowerMeter {
 public:
  /// The workcell must outlive it.
  FollowerMeter(const PreparedWorkcell& prepared, const Budget& budget);
  /// Returns how far the follower's tool is from where it belongs while the leader is at joints q
  /// and, by its row, at s (m along its path); `q` is by arm.
  [[nodiscard]] FollowerError at(const std::array<Config, 2>& q, double leader_s) const;

 private:
  const PreparedWorkcell* prepared_;
  std::size_t follower_;
  ToolPath path_;  // of the leader
};

}  // namespace swivel
