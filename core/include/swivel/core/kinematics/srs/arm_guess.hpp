// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/robot_model.hpp"

namespace swivel {

/// An arm found in a robot model, by the names of its links.
struct ArmGuess {
  std::string base, tip;
  int joints = kDof;  ///< 7, or 6 for an arm that needs a path with a roll
};

/// The arms found in a robot model.
struct ArmGuesses {
  std::vector<ArmGuess> arms;
  /// Names of the joints of the longest row of arm joints, for messages.
  std::vector<std::string> longest_row;
};

/// Returns every arm of a robot model that has at least six joints that turn, one for each tip:
/// first S-R-S arms, then others of seven joints, then those of six, each in the order of the file.
/// Of a longer row of joints the last seven count.
///
/// A row of joints begins anew at a link named like the base of an arm (base_link, link_0, ...) and
/// where several arms part. It ends where links part (a hand), at a link named tool0, tcp, flange,
/// ee or the like, and at joints that slide, mimic another or are named like fingers or cameras.
/// Joints of legs do not count, and linkages beside the arm, whose joints mimic its own, are
/// ignored. The tip is a link fixed to the last one that is named like a tool, else the last link
/// before the hand.
[[nodiscard]] ArmGuesses guess_arms(const RobotModel& robot);

}  // namespace swivel
