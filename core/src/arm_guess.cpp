// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/arm_guess.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <optional>
#include <set>

#include "swivel/core/arm.hpp"
#include "swivel/core/input_error.hpp"
#include "swivel/core/srs.hpp"

namespace swivel {

namespace {

/// Whether a name is the word, or ends with it after a separator, as arm_left_link_tool0 does.
bool ends_with_word(std::string name, const std::string& word) {
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (!name.ends_with(word)) return false;
  return name.size() == word.size() || std::isalnum(static_cast<unsigned char>(name[name.size() - word.size() - 1])) == 0;
}

class Guesser {
 public:
  explicit Guesser(const RobotModel& robot) : robot_(robot), children_(robot.links.size()), depth_(robot.links.size(), 0) {
    for (const Joint& joint : robot.joints) {
      children_[joint.parent_link].push_back(&joint);
      if (joint.mimic) leaders_.insert(joint.mimic->joint);
    }
    std::vector<int> order{robot.root_link};  // parents first
    for (std::size_t k = 0; k < order.size(); ++k)
      for (const Joint* joint : children_[order[k]]) order.push_back(joint->child_link);
    for (auto link = order.rbegin(); link != order.rend(); ++link)
      for (const Joint* joint : children_[*link]) depth_[*link] = std::max(depth_[*link], depth_below(*joint));
  }

  ArmGuesses run() {
    walk();
    std::vector<ArmGuess> first, others;
    for (const Chain& chain : chains_) {
      // From the tip of the chain inwards, so that a joint of the torso does not count where there are seven others.
      constexpr std::ptrdiff_t kMostTried = 16;  // a finger has few joints
      const auto end = chain.rbegin() + std::min(kMostTried, std::ssize(chain));
      const auto spherical = std::find_if(chain.rbegin(), end, [&](int link) { return is_srs(link); });
      const int last = spherical == end ? chain.back() : *spherical;
      auto& guesses = spherical == end ? others : first;
      const ArmGuess guess{base_name(last), tip_name(last)};
      const auto known = [&](const ArmGuess& other) { return other.tip == guess.tip; };
      if (std::none_of(first.begin(), first.end(), known) && std::none_of(others.begin(), others.end(), known))
        guesses.push_back(guess);
    }
    first.insert(first.end(), others.begin(), others.end());
    return {std::move(first), longest_row()};
  }

 private:
  /// Links that the last of at least seven arm joints in a row moves, from the base outwards.
  using Chain = std::vector<int>;

  /// Movable joints from this one on, in the longest chain.
  [[nodiscard]] int depth_below(const Joint& joint) const { return depth_[joint.child_link] + joint.movable(); }

  /// Turns on its own, as the joints of an arm do.
  bool is_arm_joint(const Joint& joint) const {
    return (joint.type == Joint::Type::kRevolute || joint.type == Joint::Type::kContinuous) && !joint.mimic &&
           !leaders_.contains(static_cast<int>(&joint - robot_.joints.data()));
  }

  void walk() {
    struct Visit {
      int link, count;  // arm joints in a row above the link
      Chain chain;
    };
    std::vector<Visit> open{{robot_.root_link, 0, {}}};
    while (!open.empty()) {
      const Visit visit = std::move(open.back());
      open.pop_back();
      if (visit.count > most_) {
        most_ = visit.count;
        end_of_most_ = visit.link;
      }
      std::vector<const Joint*> moving;
      for (const Joint* joint : children_[visit.link])
        if (depth_below(*joint) > 0) moving.push_back(joint);
      // Where an arm branches, its hand begins.
      const bool hand = visit.count >= static_cast<int>(kDof) && moving.size() > 1;
      if (moving.empty() || hand) {
        if (!visit.chain.empty()) chains_.push_back(visit.chain);
        continue;
      }
      for (auto joint = moving.rbegin(); joint != moving.rend(); ++joint) {  // the first in the file is visited first
        constexpr int kFinger = 4;                                           // movable joints, at most; so have heads and wheels
        if (moving.size() > 1 && depth_below(**joint) <= kFinger) continue;
        Visit next{(*joint)->child_link, visit.count, visit.chain};
        if ((*joint)->movable()) next.count = is_arm_joint(**joint) ? visit.count + 1 : 0;
        if (visit.count >= static_cast<int>(kDof) && next.count == 0) {  // a finger
          chains_.push_back(visit.chain);
          continue;
        }
        if ((*joint)->movable() && next.count >= static_cast<int>(kDof)) next.chain.push_back(next.link);
        open.push_back(std::move(next));
      }
    }
  }

  std::vector<std::string> longest_row() const {
    std::vector<std::string> names;
    for (int joint = robot_.links[end_of_most_].parent_joint; joint >= 0 && static_cast<int>(names.size()) < most_;) {
      if (robot_.joints[joint].movable()) names.push_back(robot_.joints[joint].name);
      joint = robot_.links[robot_.joints[joint].parent_link].parent_joint;
    }
    std::reverse(names.begin(), names.end());
    return names;
  }

  bool is_srs(int link) const {
    try {
      const std::string& root = robot_.links[robot_.root_link].name;
      static_cast<void>(fit_srs(build_arm(robot_, root, robot_.links[link].name, {}, Pose::Identity()).chain, ""));
      return true;
    } catch (const InputError&) {
      return false;
    }
  }

  std::string tip_name(int last) const {
    std::vector<int> fixed{last};
    for (std::size_t k = 0; k < fixed.size(); ++k)
      for (const Joint* joint : children_[fixed[k]])
        if (!joint->movable()) fixed.push_back(joint->child_link);
    for (const char* const word :
         {"tool0", "tcp", "flange", "ee_link", "ee", "eef", "end_effector", "end_effector_link", "tool_frame"})
      for (const int link : fixed)
        if (ends_with_word(robot_.links[link].name, word)) return robot_.links[link].name;
    // The last link before the hand.
    int tip = last;
    while (children_[tip].size() == 1 && !children_[tip].front()->movable()) {
      const int next = children_[tip].front()->child_link;
      const auto& below = children_[next];
      if (std::any_of(below.begin(), below.end(), [](const Joint* joint) { return joint->movable(); })) break;
      tip = next;
    }
    return robot_.links[tip].name;
  }

  /// A link above the arm that is called base_link or the like, else the root.
  std::string base_name(int last) const {
    std::vector<int> above;
    for (int joint = robot_.links[last].parent_joint, count = 0; joint >= 0;) {
      const int link = robot_.joints[joint].parent_link;
      count += robot_.joints[joint].movable();
      if (count >= static_cast<int>(kDof)) above.push_back(link);
      joint = robot_.links[link].parent_joint;
    }
    for (const char* const word : {"base_link", "base", "link_base"})
      for (auto link = above.rbegin(); link != above.rend(); ++link)
        if (ends_with_word(robot_.links[*link].name, word)) return robot_.links[*link].name;
    return robot_.links[robot_.root_link].name;
  }

  const RobotModel& robot_;
  std::vector<std::vector<const Joint*>> children_;  ///< by link
  std::vector<int> depth_;                           ///< by link: movable joints below it, in the longest chain
  std::set<int> leaders_;                            ///< joints that others mimic
  std::vector<Chain> chains_;
  int most_ = 0, end_of_most_ = 0;
};

}  // namespace

ArmGuesses guess_arms(const RobotModel& robot) {
  return Guesser(robot).run();
}

}  // namespace swivel
