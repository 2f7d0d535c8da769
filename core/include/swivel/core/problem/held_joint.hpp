// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

namespace swivel {

/// A joint between base and tip that could move but is not planned: it stands still.
struct HeldJoint {
  std::string name;
  double position = 0;  ///< rad, or m for a prismatic joint
  bool slides = false;  ///< a prismatic joint
  /// true: Robot::hold gives its position; else it is 0, or the limit nearest to 0.
  bool given = false;
  /// Name of the joint that it mimics, whose position Robot::hold gives; empty: none.
  std::string leader;
};

/// Returns where joints are held, at most five by name: "rail_joint at 0 m, b at 0.4 rad (as a)".
/// Empty where none is held.
[[nodiscard]] std::string words(const std::vector<HeldJoint>& held);
/// Returns " with rail_joint held at 0 m", to be appended to a statement about an arm; empty where
/// no joint is held.
[[nodiscard]] std::string with_held(const std::vector<HeldJoint>& held);
/// Returns a line for every joint whose position Robot::hold does not give: where it is held, and
/// how to state another position. Joints that mimic one leader give one line.
[[nodiscard]] std::vector<std::string> held_warnings(const std::vector<HeldJoint>& held);

}  // namespace swivel
