// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

namespace swivel {

/// A joint between base and tip that moves but is not planned: it stands still.
struct HeldJoint {
  std::string name;
  double position = 0;  ///< rad; m where it slides
  bool slides = false;  ///< a prismatic joint
  bool given = false;   ///< `hold` says where it stands; else it is at 0, or at the limit nearest to 0
  std::string leader;   ///< the joint that it mimics, whose position `hold` gives; empty where it mimics none
};

/// "rail_joint at 0 m", "b at 0.4 rad (as a)"; at most five joints by name. Empty where none is held.
[[nodiscard]] std::string words(const std::vector<HeldJoint>& held);
/// " with rail_joint held at 0 m", to be added to what is claimed of an arm; empty where none is held.
[[nodiscard]] std::string with_held(const std::vector<HeldJoint>& held);
/// A line for every joint whose position `hold` does not give: where it stands, and how to say so.
[[nodiscard]] std::vector<std::string> held_warnings(const std::vector<HeldJoint>& held);

}  // namespace swivel
