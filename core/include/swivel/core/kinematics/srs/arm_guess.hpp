// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "swivel/core/base/types.hpp"
#include "swivel/core/problem/robot_model.hpp"

namespace swivel {

/// An arm of a robot whose links have not been named.
struct ArmGuess {
  std::string base, tip;
  int joints = kDof;  ///< 7, or 6: an arm for paths with a roll
};

struct ArmGuesses {
  std::vector<ArmGuess> arms;
  std::vector<std::string> longest_row;  ///< names of the joints of the longest row that there is, for messages
};

/// Every arm of at least six joints that turn, one a chain, in the order of the file: S-R-S arms first, then others of seven
/// joints, then those of six. Of a longer row the last seven joints are taken. A row begins anew at a link that is called as bases
/// of arms are (base_link, link_0, ...) and where several arms part. It ends where links part (a hand), at a link called tool0,
/// tcp, flange, ee or the like, and at joints that slide, mimic or are called as fingers and cameras are; joints of legs are none
/// of an arm. Linkages beside the arm, whose joints mimic its own, are passed by. Tips are the links called as tools are that are
/// fixed to the last link, else the last link before the hand.
[[nodiscard]] ArmGuesses guess_arms(const RobotModel& robot);

}  // namespace swivel
