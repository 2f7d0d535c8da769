// SPDX-License-Identifier: BSD-3-Clause
#include "validity/clearance_error.hpp"

#include <algorithm>
#include <limits>
#include <memory>

#include "swivel/core/kinematics/equations/pose_error_bound.hpp"

namespace swivel {

std::vector<ClearanceError::Body> ClearanceError::measured() const {
  std::vector<Body> bodies;
  if (!lattice_->is_approximate()) return bodies;
  for (const RobotBody& body : world_->bodies()) {
    Body& mine = bodies.emplace_back(Body{body.group, 0});
    if (body.group == 0 || body.group > static_cast<int>(kDof)) continue;
    const Vector3d about = lattice_->pose_error_of_node(0, body.group, Config::Zero()).about;
    for (const Ball& ball : bounding_balls(body.shape))
      mine.radius = std::max(mine.radius, (body.pose * ball.center - about).norm() + ball.radius);
  }
  return bodies;
}

template <class Shift>
double ClearanceError::sum(const BodyPair& pair, const Shift& shift) const {
  const std::vector<Body>& bodies =
      bodies_.get([this] { return std::make_unique<std::vector<Body>>(measured()); });
  double sum = 0;
  for (const int body : {pair.a, pair.b}) {
    if (body >= static_cast<int>(bodies.size())) continue;
    const Body& moving = bodies[static_cast<std::size_t>(body)];
    // A body on a follower is moved by two joints, for which no bound is known.
    if (moving.group > static_cast<int>(kDof)) return std::numeric_limits<double>::infinity();
    if (moving.group > 0) sum += shift(moving.group).of(moving.radius);
  }
  return sum;
}

double ClearanceError::from_node(int layer, const Config& q, const BodyPair& pair) const {
  return sum(pair, [&](int group) { return lattice_->pose_error_of_node(layer, group, q); });
}

double ClearanceError::between_exact_configs(int layer, const Config& q,
                                             const BodyPair& pair) const {
  return sum(pair, [&](int group) { return lattice_->pose_error_between(layer, group, q); });
}

}  // namespace swivel
