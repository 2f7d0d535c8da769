// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel {

namespace {

/// Replaces every cylinder with two spheres of its radius at its ends by one capsule (URDF has no
/// capsule).
std::vector<PlacedShape> join_capsules(const std::vector<PlacedShape>& shapes) {
  constexpr double kSame = 1e-9;
  std::vector<PlacedShape> result;
  std::vector<char> used(shapes.size(), 0);
  const auto sphere_at = [&](const Vector3d& center, double radius) {
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const auto* sphere = std::get_if<Sphere>(&shapes[i].shape);
      if (sphere && !used[i] && std::abs(sphere->radius - radius) <= kSame &&
          (shapes[i].pose.translation() - center).norm() <= kSame)
        return i;
    }
    return shapes.size();
  };
  std::vector<std::pair<std::size_t, PlacedShape>> kept;  // in file order
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto* cylinder = std::get_if<Cylinder>(&shapes[i].shape);
    if (!cylinder) continue;
    const Vector3d half(0, 0, cylinder->length / 2);
    const std::size_t top = sphere_at(shapes[i].pose * half, cylinder->radius);
    const std::size_t bottom = sphere_at(shapes[i].pose * Vector3d(-half), cylinder->radius);
    if (top == shapes.size() || bottom == shapes.size() || top == bottom) continue;
    used[i] = used[top] = used[bottom] = 1;
    kept.emplace_back(i, PlacedShape{Capsule{cylinder->radius, cylinder->length}, shapes[i].pose});
  }
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (!used[i]) kept.emplace_back(i, shapes[i]);
  std::sort(kept.begin(), kept.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  for (auto& [order, shape] : kept) result.push_back(std::move(shape));
  return result;
}

/// Closest point of line (p, a) to line (q, b); the foot of q where they are parallel.
Vector3d nearest_on_line(const Vector3d& p, const Vector3d& a, const Vector3d& q,
                         const Vector3d& b) {
  const double cosine = a.dot(b), sine2 = 1 - cosine * cosine;
  const Vector3d d = q - p;
  const double t = sine2 < 1e-12 ? d.dot(a) : (d.dot(a) - d.dot(b) * cosine) / sine2;
  return p + t * a;
}

/// How far what each follower carries, with all followers behind it, is from its line, over all
/// configurations.
struct FollowerReaches {
  FollowerReaches(const Chain& chain, const std::vector<RobotBody>& bodies) {
    const std::size_t count = chain.followers.size();
    about_point.assign(count, 0);
    about_axis.assign(count, 0);
    carries.assign(count, 0);
    for (const Chain::Follower& follower : chain.followers) point.push_back(follower.point);
    for (std::size_t f = count; f-- > 0;) {  // parents come first
      const Chain::Follower& follower = chain.followers[f];
      const auto add = [&](const Vector3d& x, double radius) {
        carries[f] = 1;
        about_axis[f] =
            std::max(about_axis[f], (x - point[f]).cross(follower.axis).norm() + radius);
        about_point[f] = std::max(about_point[f], (x - point[f]).norm() + radius);
      };
      const int group = static_cast<int>(kDof + 1 + f);
      for (const RobotBody& body : bodies)
        if (body.group == group)
          for (const Ball& ball : bounding_balls(body.shape))
            add(body.pose * ball.center, ball.radius);
      for (std::size_t g = f + 1; g < count; ++g)
        if (chain.followers[g].parent == group && carries[g]) add(point[g], about_point[g]);
      if (!follower.slides || !carries[f]) continue;
      const JointLimit& limit = chain.limit[static_cast<std::size_t>(follower.leader)];
      about_axis[f] = 1;  // m per m
      about_point[f] +=
          std::abs(follower.multiplier) * std::max(std::abs(limit.lower), std::abs(limit.upper));
    }
  }
  std::vector<Vector3d> point;      ///< of the line, as it stands at q = 0
  std::vector<double> about_point;  ///< m, from `point` as its parent carries it
  std::vector<double> about_axis;   ///< m for 1 rad of a turn, and for 1 m of a shift
  std::vector<char> carries;        ///< some body
};

}  // namespace

std::vector<RobotBody> robot_bodies(const RobotModel& robot, const ArmModel& arm,
                                    const std::vector<AttachedBody>& attached) {
  std::vector<RobotBody> bodies;
  for (std::size_t l = 0; l < robot.links.size(); ++l) {
    const LinkPlacement& placement = arm.links[l];
    for (const PlacedShape& shape : join_capsules(robot.links[l].collision))
      bodies.push_back({robot.links[l].name, static_cast<int>(l), false, placement.group,
                        shape.shape, placement.pose * shape.pose});
  }
  for (const AttachedBody& body : attached) {
    if (robot.find_link(body.name) >= 0)
      throw InputError(robot.source,
                       "robot.attached: '" + body.name + "' is a link's name: choose another");
    const int link = robot.find_link(body.link);
    if (link < 0)
      throw InputError(robot.source, "robot.attached." + body.name + ".link: unknown link '" +
                                         body.link + "': allowed are the links of the robot");
    const LinkPlacement& placement = arm.links[static_cast<std::size_t>(link)];
    bodies.push_back(
        {body.name, link, true, placement.group, body.shape, placement.pose * body.pose});
  }
  return bodies;
}

FollowerMotion follower_motion(const Chain& chain, const std::vector<RobotBody>& bodies) {
  FollowerMotion result;
  if (chain.followers.empty()) return result;
  const FollowerReaches reaches(chain, bodies);
  std::array<double, kDof> second{};
  std::vector<std::array<double, kDof>> reach(chain.followers.size()),
      turns(chain.followers.size());
  for (std::size_t f = 0; f < chain.followers.size(); ++f) {
    const Chain::Follower& follower = chain.followers[f];
    if (!reaches.carries[f]) continue;  // and so do none of those behind it
    if (follower.parent > static_cast<int>(kDof)) {
      const auto parent = static_cast<std::size_t>(follower.parent) - kDof - 1;
      reach[f] = reach[parent];
      turns[f] = turns[parent];
    }
    const auto leader = static_cast<std::size_t>(follower.leader);
    reach[f][leader] += std::abs(follower.multiplier) * reaches.about_axis[f];
    turns[f][leader] += std::abs(follower.multiplier);
    for (std::size_t j = 0; j < kDof; ++j) {
      second[j] = std::max(second[j], std::min(reach[f][j], result.reach[j]));
      result.reach[j] = std::max(result.reach[j], reach[f][j]);
      result.turns[j] = std::max(result.turns[j], turns[f][j]);
    }
  }
  for (std::size_t j = 0; j < kDof; ++j)
    result.reach[j] += second[j];  // both bodies of a pair may be on followers
  return result;
}

std::array<double, kDof> motion_radii(const Chain& chain, const std::vector<RobotBody>& bodies) {
  const auto& p = chain.point;
  const auto& a = chain.axis;
  // A point on each axis; on axes 1-3 the shoulder centre, on 4 the elbow's foot, on 5-7 the wrist
  // centre.
  std::array<Vector3d, kDof> c;
  c[0] = nearest_on_line(p[0], a[0], p[1], a[1]);
  c[1] = nearest_on_line(p[1], a[1], p[0], a[0]);
  c[2] = nearest_on_line(p[2], a[2], p[1], a[1]);
  c[3] = p[3] + (c[2] - p[3]).dot(a[3]) * a[3];
  c[4] = nearest_on_line(p[4], a[4], p[5], a[5]);
  c[5] = nearest_on_line(p[5], a[5], p[6], a[6]);
  c[6] = nearest_on_line(p[6], a[6], p[5], a[5]);
  const auto off_axis = [&](std::size_t j, const Vector3d& x) {
    return (x - c[j]).cross(a[j]).norm();
  };

  const FollowerReaches followers(chain, bodies);
  std::array<double, kDof> radii{};
  double reach = 0;  // of everything that joint j+1 moves, from c[j+1]
  for (std::size_t j = kDof; j-- > 0;) {
    double about_axis = 0, about_point = 0;
    for (const RobotBody& body : bodies) {
      if (body.group != static_cast<int>(j) + 1) continue;
      for (const Ball& ball : bounding_balls(body.shape)) {
        const Vector3d x = body.pose * ball.center;
        about_axis = std::max(about_axis, off_axis(j, x) + ball.radius);
        about_point = std::max(about_point, (x - c[j]).norm() + ball.radius);
      }
    }
    for (std::size_t f = 0; f < chain.followers.size(); ++f) {
      if (chain.followers[f].parent != static_cast<int>(j) + 1 || !followers.carries[f]) continue;
      about_axis = std::max(about_axis, off_axis(j, followers.point[f]) + followers.about_point[f]);
      about_point =
          std::max(about_point, (followers.point[f] - c[j]).norm() + followers.about_point[f]);
    }
    if (j + 1 < kDof && reach > 0) {
      about_axis = std::max(about_axis, off_axis(j, c[j + 1]) + reach);
      about_point = std::max(about_point, (c[j + 1] - c[j]).norm() + reach);
    }
    radii[j] = about_axis;
    reach = about_point;
    if (chain.limit[j].slides && about_point > 0) {
      radii[j] = 1;  // m per m
      reach += std::max(std::abs(chain.limit[j].lower), std::abs(chain.limit[j].upper));
    }
  }
  const FollowerMotion beside = follower_motion(chain, bodies);
  for (std::size_t j = 0; j < kDof; ++j) radii[j] += beside.reach[j];
  return radii;
}

}  // namespace swivel
