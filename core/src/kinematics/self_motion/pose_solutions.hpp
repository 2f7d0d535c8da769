// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "swivel/core/kinematics/self_motion/self_motion.hpp"

namespace swivel {

/// The inverse kinematics of an arm of six joints whose tool stands as the waypoints have it
/// (Chain::roll_fixed).
///
/// With a closed form all configurations of a pose are found, of a singular pose some
/// representatives of those that are connected. Without one, the tool is let turn about its z axis
/// first: the configurations are the points of the arm's self-motion curves at which the tool has
/// turned back; some may be missed.
class PoseSolutions {
 public:
  /// Prepares for a chain and its lock_method().
  PoseSolutions(const Chain& chain, const LockMethod& method);
  /// Returns the distinct configurations at a tool pose, rad, in lexicographic order, each joint in
  /// an arbitrary turn. Joint limits are ignored. Deterministic.
  [[nodiscard]] std::vector<Config> at(const Pose& tool) const;

 private:
  std::optional<ClosedForm> closed_form_;
  std::unique_ptr<const SelfMotion> turning_;  // of the arm whose tool may turn
};

}  // namespace swivel
