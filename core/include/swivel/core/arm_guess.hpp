// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "swivel/core/robot_model.hpp"

namespace swivel {

/// A seven-joint arm of a robot whose links have not been named.
struct ArmGuess {
  std::string base, tip;
};

struct ArmGuesses {
  std::vector<ArmGuess> arms;
  std::vector<std::string> longest_row;  ///< names of the joints of the longest row that there is, for messages
};

/// Every arm of seven joints that turn, one a chain, in the order of the file; arms that are S-R-S first. Gripper fingers, joints
/// that slide and joints that mimic are not taken for arm joints. Tips are the links called tool0, tcp, flange, ee or the like that
/// are fixed to the last link, else the last link before the hand.
[[nodiscard]] ArmGuesses guess_arms(const RobotModel& robot);

}  // namespace swivel
