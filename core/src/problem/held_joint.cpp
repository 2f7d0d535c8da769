// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/problem/held_joint.hpp"

#include <set>

#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

std::string position_of(const HeldJoint& joint) {
  return formatted(joint.slides ? "%.6g m" : "%.6g rad", joint.position);
}

/// Joins the words that of(joint) gives of the first five joints, and says how many more there are.
template <class Of>
std::string list(const std::vector<HeldJoint>& held, const Of& of) {
  constexpr std::size_t kMost = 5;
  std::string text;
  for (std::size_t k = 0; k < held.size() && k < kMost; ++k)
    text += (k == 0 ? "" : ", ") + of(held[k]);
  return held.size() <= kMost ? text : text + formatted(" and %zu more", held.size() - kMost);
}

}  // namespace

std::string words(const std::vector<HeldJoint>& held) {
  return list(held, [](const HeldJoint& joint) {
    return joint.name + " at " + position_of(joint) +
           (joint.leader.empty() ? "" : " (as " + joint.leader + ")");
  });
}

std::string with_held(const std::vector<HeldJoint>& held) {
  if (held.empty()) return "";
  return " with " + list(held, [](const HeldJoint& joint) {
           return joint.name + " held at " + position_of(joint);
         });
}

std::vector<std::string> held_warnings(const std::vector<HeldJoint>& held) {
  std::vector<std::string> warnings;
  std::set<std::string> said;  // several joints may mimic one
  for (const HeldJoint& joint : held) {
    const std::string& own = joint.leader.empty() ? joint.name : joint.leader;
    if (joint.given || !said.insert(own).second) continue;
    warnings.push_back("joint '" + joint.name +
                       "' lies between base and tip and is not planned: it is held at " +
                       position_of(joint) +
                       (joint.leader.empty() ? "" : ", since it mimics '" + joint.leader + "'") +
                       ": robot.hold: {" + own + ": POSITION} says where it stands");
  }
  return warnings;
}

}  // namespace swivel
