// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/srs/arm_guess.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <optional>
#include <set>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

namespace {

std::string lower_case(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

/// Returns true if a name is the word, or ends with it after a separator, as arm_left_link_tool0
/// does.
bool ends_with_word(const std::string& name, const std::string& word) {
  const std::string lower = lower_case(name);
  if (!lower.ends_with(word)) return false;
  return lower.size() == word.size() ||
         std::isalnum(static_cast<unsigned char>(lower[lower.size() - word.size() - 1])) == 0;
}

/// Returns true if a name has the word between separators, as left_hip_yaw has hip.
bool has_word(const std::string& name, const std::string& word) {
  const std::string lower = lower_case(name);
  const auto letter = [&](std::size_t at) {
    return at < lower.size() && std::isalpha(static_cast<unsigned char>(lower[at])) != 0;
  };
  for (std::size_t at = lower.find(word); at != std::string::npos; at = lower.find(word, at + 1))
    if ((at == 0 || !letter(at - 1)) && !letter(at + word.size())) return true;
  return false;
}

/// Returns true if makers name the link like this from which they measure an arm.
bool is_base_name(const std::string& name) {
  for (const char* const word : {"base_link", "base", "link_base", "link_0", "link0"})
    if (ends_with_word(name, word)) return true;
  return false;
}

bool is_leg_name(const std::string& name) {
  for (const char* const word : {"hip", "knee", "ankle", "leg"})
    if (has_word(name, word)) return true;
  return false;
}

/// Returns true if a joint is named like those of hands, beyond the arm.
bool is_hand_name(const std::string& name) {
  const std::string lower = lower_case(name);
  for (const char* const word : {"finger", "gripper", "knuckle", "thumb", "claw", "jaw", "spindle"})
    if (lower.find(word) != std::string::npos) return true;
  return false;
}

/// Returns true if a name is that of a sensor that an arm carries, and may tilt.
bool is_sensor_name(const std::string& name) {
  const std::string lower = lower_case(name);
  for (const char* const word : {"camera", "gimbal", "lidar"})
    if (lower.find(word) != std::string::npos) return true;
  return false;
}

/// Fewest joints of an arm: the tool's roll is then the seventh.
constexpr int kLeast = static_cast<int>(kDof) - 1;

class Guesser {
 public:
  explicit Guesser(const RobotModel& robot)
      : robot_(robot),
        children_(robot.links.size()),
        depth_(robot.links.size(), 0),
        row_below_(robot.links.size(), 0) {
    for (const Joint& joint : robot.joints) {
      children_[joint.parent_link].push_back(&joint);
      if (joint.mimic) leaders_.insert(joint.mimic->joint);
    }
    std::vector<int> order{robot.root_link};  // parents first
    for (std::size_t k = 0; k < order.size(); ++k)
      for (const Joint* joint : children_[order[k]]) order.push_back(joint->child_link);
    for (auto link = order.rbegin(); link != order.rend(); ++link)
      for (const Joint* joint : children_[*link]) {
        depth_[*link] = std::max(depth_[*link], depth_below(*joint));
        row_below_[*link] = std::max(row_below_[*link], row_from(*joint));
      }
  }

  ArmGuesses run() {
    walk();
    std::vector<ArmGuess> srs, seven, six;
    for (const Row& row : rows_) {
      const bool is_six = std::ssize(row) == kLeast;
      // From the tip of the row inwards, so that a joint of the torso does not count where there
      // are seven others.
      constexpr std::ptrdiff_t kMostTried = 16;  // a finger has few joints
      const auto end = row.rbegin() + (is_six ? 0 : std::min(kMostTried, std::ssize(row) - kLeast));
      const auto spherical =
          std::find_if(row.rbegin(), end, [&](int link) { return is_srs(link); });
      const int last = spherical == end ? row.back() : *spherical;
      const int joints = is_six ? kLeast : static_cast<int>(kDof);
      const ArmGuess guess{base_name(last, joints), tip_name(last), joints};
      const auto known = [&](const ArmGuess& other) { return other.tip == guess.tip; };
      if (std::any_of(srs.begin(), srs.end(), known) ||
          std::any_of(seven.begin(), seven.end(), known) ||
          std::any_of(six.begin(), six.end(), known))
        continue;
      (is_six ? six : spherical == end ? seven : srs).push_back(guess);
    }
    srs.insert(srs.end(), seven.begin(), seven.end());
    srs.insert(srs.end(), six.begin(), six.end());
    return {std::move(srs), longest_row()};
  }

 private:
  /// Links that the first, second, ... joint of a row of arm joints move.
  using Row = std::vector<int>;

  static bool moves_alone(const Joint& joint) { return joint.movable() && !joint.mimic; }

  /// Returns how many joints move on their own in the longest chain from this joint on.
  [[nodiscard]] int depth_below(const Joint& joint) const {
    return depth_[joint.child_link] + moves_alone(joint);
  }

  /// Returns how many arm joints follow each other in the longest row from this joint on.
  [[nodiscard]] int row_from(const Joint& joint) const {
    if (joint.type == Joint::Type::kFixed || mimics_above(joint))
      return row_below_[joint.child_link];
    return is_arm_joint(joint) ? row_below_[joint.child_link] + 1 : 0;
  }

  /// Returns true if there is a joint above a link, and one that an arm may lead through.
  bool leads_up_from(int link) const {
    const int joint = robot_.links[link].parent_joint;
    return joint >= 0 && robot_.joints[joint].type != Joint::Type::kFree;
  }

  /// Returns true if a joint turns on its own, as those of an arm do. A joint that others mimic
  /// moves a linkage if the arm goes on behind it, else a hand.
  bool is_arm_joint(const Joint& joint) const {
    return (joint.type == Joint::Type::kRevolute || joint.type == Joint::Type::kContinuous) &&
           !joint.mimic &&
           (depth_[joint.child_link] > 0 ||
            !leaders_.contains(static_cast<int>(&joint - robot_.joints.data()))) &&
           !is_leg_name(joint.name);
  }

  [[nodiscard]] bool is_sensor(const Joint& joint) const {
    return is_sensor_name(joint.name) || is_sensor_name(robot_.links[joint.child_link].name);
  }

  /// Returns true if a joint mimics one that carries it. Such a joint ends no row: build_arm()
  /// reports that an arm through it is not supported.
  bool mimics_above(const Joint& joint) const {
    if (!joint.movable() || !joint.mimic) return false;
    for (int above = robot_.links[joint.parent_link].parent_joint; above >= 0;
         above = robot_.links[robot_.joints[above].parent_link].parent_joint)
      if (above == joint.mimic->joint) return true;
    return false;
  }

  /// Returns true if an arm begins at a link, whatever turns above it: at its maker's base, or at
  /// the torso of several arms.
  bool begins_at(int link) const {
    if (row_below_[link] < kLeast) return false;
    if (is_base_name(robot_.links[link].name)) return true;
    const auto& below = children_[link];
    return std::count_if(below.begin(), below.end(),
                         [&](const Joint* joint) { return row_from(*joint) >= kLeast; }) > 1;
  }

  /// Returns the link and those fixed to it, from the link outwards.
  std::vector<int> fixed_to(int link) const {
    std::vector<int> fixed{link};
    for (std::size_t k = 0; k < fixed.size(); ++k)
      for (const Joint* joint : children_[fixed[k]])
        if (joint->type == Joint::Type::kFixed) fixed.push_back(joint->child_link);
    return fixed;
  }

  /// Returns a link fixed to this one that is named like a tool, none if there is none.
  std::optional<int> tool_link(int link) const {
    const std::vector<int> fixed = fixed_to(link);
    for (const char* const word : {"tool0", "tcp", "flange", "ee_link", "ee", "eef", "end_effector",
                                   "end_effector_link", "tool_frame"})
      for (const int other : fixed)
        if (ends_with_word(robot_.links[other].name, word)) return other;
    return {};
  }

  void walk() {
    struct Visit {
      int link;
      Row row;
    };
    std::vector<Visit> open{{robot_.root_link, {}}};
    while (!open.empty()) {
      Visit visit = std::move(open.back());
      open.pop_back();
      if (begins_at(visit.link)) visit.row.clear();
      if (std::ssize(visit.row) > most_) {
        most_ = static_cast<int>(visit.row.size());
        end_of_most_ = visit.link;
      }
      const bool whole = std::ssize(visit.row) >= kLeast;
      std::vector<const Joint*> moving;
      for (const Joint* joint : children_[visit.link])
        if (depth_below(*joint) > 0) moving.push_back(joint);
      // A hand begins where an arm branches, and behind a flange.
      const bool hand =
          whole && (moving.size() > 1 || (visit.row.back() == visit.link && tool_link(visit.link)));
      if (moving.empty() || hand) {
        if (whole) rows_.push_back(visit.row);
        continue;
      }
      // the first in the file is visited first
      for (auto joint = moving.rbegin(); joint != moving.rend(); ++joint) {
        constexpr int kFinger = 4;  // joints, at most
        if (moving.size() > 1 && depth_below(**joint) <= kFinger) continue;
        Visit next{(*joint)->child_link, (*joint)->type == Joint::Type::kFree ? Row() : visit.row};
        if (mimics_above(**joint)) {
          if (row_below_[next.link] >= kLeast) next.row.clear();  // a whole arm goes on behind it
        } else if ((*joint)->movable()) {
          const bool goes_on = is_arm_joint(**joint) &&
                               !(whole && (is_hand_name((*joint)->name) || is_sensor(**joint)));
          if (whole && !goes_on) {  // a finger
            rows_.push_back(visit.row);
            continue;
          }
          goes_on ? next.row.push_back(next.link) : next.row.clear();
        }
        open.push_back(std::move(next));
      }
    }
  }

  /// Returns the joints of the longest row below the root that an arm could have, even where they
  /// are as few as a finger's.
  std::vector<std::string> longest_row_anywhere() const {
    const auto longest = [&](const auto& joints) -> const Joint* {
      const Joint* best = nullptr;
      for (const Joint* joint : joints)
        if (row_from(*joint) > (best == nullptr ? 0 : row_from(*best))) best = joint;
      return best;
    };
    std::vector<const Joint*> all;
    for (const Joint& joint : robot_.joints) all.push_back(&joint);
    std::vector<std::string> names;
    for (const Joint* joint = longest(all); joint != nullptr;
         joint = longest(children_[joint->child_link]))
      if (is_arm_joint(*joint)) names.push_back(joint->name);
    return names;
  }

  std::vector<std::string> longest_row() const {
    if (most_ == 0) return longest_row_anywhere();
    std::vector<std::string> names;
    for (int joint = robot_.links[end_of_most_].parent_joint;
         joint >= 0 && static_cast<int>(names.size()) < most_;) {
      if (moves_alone(robot_.joints[joint])) names.push_back(robot_.joints[joint].name);
      joint = robot_.links[robot_.joints[joint].parent_link].parent_joint;
    }
    std::reverse(names.begin(), names.end());
    return names;
  }

  bool is_srs(int link) const {
    try {
      int root = link;
      while (leads_up_from(root)) root = robot_.joints[robot_.links[root].parent_joint].parent_link;
      const Chain chain =
          build_arm(robot_, robot_.links[root].name, robot_.links[link].name, {}, Pose::Identity())
              .chain;
      if (chain.roll) return false;  // six joints
      static_cast<void>(fit_srs(chain, ""));
      return true;
    } catch (const InputError&) {
      return false;
    }
  }

  /// Returns the one joint that leads on from a link, null if there are none or several. Cameras
  /// are ignored, and so is, beside other links, a leaf fixed at the link's own place: it holds
  /// collision shapes.
  const Joint* only_onwards(int link) const {
    constexpr double kSame = 1e-9;
    const Joint* found = nullptr;
    for (const Joint* joint : children_[link]) {
      if (is_sensor(*joint)) continue;
      if (children_[link].size() == 1) return joint;
      if (!joint->movable() && children_[joint->child_link].empty() &&
          joint->origin.isApprox(Pose::Identity(), kSame))
        continue;
      if (found != nullptr) return nullptr;
      found = joint;
    }
    return found;
  }

  std::string tip_name(int last) const {
    if (const std::optional<int> tool = tool_link(last)) return robot_.links[*tool].name;
    // The last link before the hand.
    int tip = last;
    while (const Joint* const onwards = only_onwards(tip)) {
      if (onwards->type != Joint::Type::kFixed) break;
      const auto& below = children_[onwards->child_link];
      if (std::any_of(below.begin(), below.end(),
                      [](const Joint* joint) { return joint->movable(); }))
        break;
      tip = onwards->child_link;
    }
    return robot_.links[tip].name;
  }

  /// Returns the nearest link above the arm that is named like a base, else the root. For six
  /// joints below another one that turns, with which they would be seven, it is the link that this
  /// one turns.
  std::string base_name(int last, int joints) const {
    int link = last;
    for (int count = 0; leads_up_from(link);
         link = robot_.joints[robot_.links[link].parent_joint].parent_link) {
      if (count >= joints && is_base_name(robot_.links[link].name)) break;
      const Joint& joint = robot_.joints[robot_.links[link].parent_joint];
      if (count == kLeast && joints == kLeast && joint.movable() && !joint.mimic &&
          joint.type != Joint::Type::kPrismatic)
        break;
      count += moves_alone(joint);
    }
    return robot_.links[link].name;
  }

  const RobotModel& robot_;
  std::vector<std::vector<const Joint*>> children_;  ///< by link
  /// By link: joints below it that move on their own, in the longest chain.
  std::vector<int> depth_;
  /// By link: arm joints that follow each other below it, in the longest row.
  std::vector<int> row_below_;
  std::set<int> leaders_;  ///< joints that others mimic
  std::vector<Row> rows_;  ///< of at least six
  int most_ = 0, end_of_most_ = 0;
};

}  // namespace

ArmGuesses guess_arms(const RobotModel& robot) {
  return Guesser(robot).run();
}

}  // namespace swivel
