// SPDX-License-Identifier: BSD-3-Clause
#include "world/pair_rules.hpp"

#include <set>
#include <utility>

namespace swivel::detail {

namespace {

using NamePair = std::pair<std::string, std::string>;

NamePair ordered(const std::string& a, const std::string& b) {
  return a < b ? NamePair(a, b) : NamePair(b, a);
}

/// Clusters of links that fixed joints join. The index of a cluster is that of its top link.
class Clusters {
 public:
  explicit Clusters(const RobotModel& robot) : robot_(robot) {}
  [[nodiscard]] int of(int link) const {
    while (const Joint* joint = above(link)) {
      if (joint->movable()) break;
      link = joint->parent_link;
    }
    return link;
  }
  /// Returns true if one movable joint joins the clusters of the two links.
  [[nodiscard]] bool parent_and_child(int a, int b) const {
    return of_parent(of(a)) == of(b) || of_parent(of(b)) == of(a);
  }

 private:
  [[nodiscard]] const Joint* above(int link) const {
    const int joint = robot_.links[link].parent_joint;
    return joint < 0 ? nullptr : &robot_.joints[joint];
  }
  [[nodiscard]] int of_parent(int cluster) const {
    const Joint* joint = above(cluster);
    return joint ? of(joint->parent_link) : -1;
  }
  const RobotModel& robot_;
};

}  // namespace

std::vector<BodyPair> candidate_robot_pairs(const RobotModel& robot,
                                            const std::vector<RobotBody>& bodies) {
  std::set<NamePair> disabled;
  for (const auto& [a, b] : robot.disabled_pairs) disabled.insert(ordered(a, b));
  const Clusters clusters(robot);
  std::vector<BodyPair> pairs;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const RobotBody &a = bodies[i], &b = bodies[j];
      if (a.group == b.group || disabled.count(ordered(a.name, b.name))) continue;
      if (!a.attached && !b.attached && clusters.parent_and_child(a.link, b.link)) continue;
      pairs.push_back({static_cast<int>(i), static_cast<int>(j)});
    }
  return pairs;
}

}  // namespace swivel::detail
