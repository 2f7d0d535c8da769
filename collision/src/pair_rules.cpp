// SPDX-License-Identifier: BSD-3-Clause
#include "pair_rules.hpp"

#include <algorithm>
#include <random>
#include <set>
#include <utility>

#include "pair_test.hpp"

namespace swivel {

namespace {

using NamePair = std::pair<std::string, std::string>;

NamePair ordered(const std::string& a, const std::string& b) {
  return a < b ? NamePair(a, b) : NamePair(b, a);
}

/// Links joined by fixed joints are one cluster; the cluster's number is that of its top link.
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
  /// One movable joint joins them.
  [[nodiscard]] bool parent_and_child(int a, int b) const { return of_parent(of(a)) == of(b) || of_parent(of(b)) == of(a); }

 private:
  [[nodiscard]] const Joint* above(int link) const {
    const int joint = robot_.links[static_cast<std::size_t>(link)].parent_joint;
    return joint < 0 ? nullptr : &robot_.joints[static_cast<std::size_t>(joint)];
  }
  [[nodiscard]] int of_parent(int cluster) const {
    const Joint* joint = above(cluster);
    return joint ? of(joint->parent_link) : -1;
  }
  const RobotModel& robot_;
};

Config random_config(const Chain& chain, std::mt19937_64& random) {
  Config q;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    const double lower = limit.continuous ? -kPi : limit.lower, upper = limit.continuous ? kPi : limit.upper;
    q[j] =
        lower + static_cast<double>(random() >> 11) * 0x1.0p-53 * (upper - lower);  // the library's distributions differ by vendor
  }
  return q;
}

}  // namespace

std::vector<BodyPair> candidate_robot_pairs(const RobotModel& robot, const std::vector<RobotBody>& bodies) {
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

std::vector<BodyPair> drop_always_near(std::vector<BodyPair> pairs, bool has_srdf, const Chain& chain,
                                       const std::vector<RobotBody>& bodies, const std::vector<FclShape>& shapes, double d,
                                       const Budget& budget) {
  constexpr int kSamples = 1000;
  const auto body = [&](int i) -> const RobotBody& { return bodies[static_cast<std::size_t>(i)]; };
  const auto split = std::stable_partition(
      pairs.begin(), pairs.end(), [&](const BodyPair& p) { return has_srdf && !body(p.a).attached && !body(p.b).attached; });
  std::vector<BodyPair> suspects(split, pairs.end());
  pairs.erase(split, pairs.end());

  std::mt19937_64 random(20141);
  PairTest test;
  for (int sample = 0; sample < kSamples && !suspects.empty(); ++sample) {
    const auto moved = chain.displacements(random_config(chain, random));
    const auto pose = [&](int i) { return Pose(moved[static_cast<std::size_t>(body(i).group)] * body(i).pose); };
    const auto near = [&](const BodyPair& p) {
      budget.poll();
      const Pose at_a = pose(p.a), at_b = pose(p.b);
      return test.below({&shapes[static_cast<std::size_t>(p.a)], &at_a}, {&shapes[static_cast<std::size_t>(p.b)], &at_b}, d);
    };
    const auto cleared = std::stable_partition(suspects.begin(), suspects.end(), near);
    pairs.insert(pairs.end(), cleared, suspects.end());
    suspects.erase(cleared, suspects.end());
  }
  return pairs;
}

}  // namespace swivel
