// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/collision/world.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "certificate.hpp"
#include "nearest_points.hpp"
#include "pair_rules.hpp"
#include "pair_test.hpp"
#include "swivel/core/timeline.hpp"

namespace swivel {

namespace {

/// What does not depend on the scene.
struct RobotPart {
  Chain chain;
  std::vector<RobotBody> bodies;
  std::vector<FclShape> shapes;
  std::vector<BodyPair> pairs;
};

std::shared_ptr<const RobotPart> make_robot_part(const RobotModel& robot, const ArmModel& arm, const Problem& problem,
                                                 MeshStore& meshes) {
  auto part = std::make_shared<RobotPart>();
  part->chain = arm.chain;
  part->bodies = robot_bodies(robot, arm, problem.attached);
  for (const RobotBody& body : part->bodies) part->shapes.push_back(make_fcl_shape(body.shape, meshes));
  const double near = std::max(problem.limits.clearance, problem.limits.d_edge() + problem.limits.edge_tolerance);
  part->pairs =
      drop_always_near(candidate_robot_pairs(robot, part->bodies), robot.has_srdf, part->chain, part->bodies, part->shapes, near);
  return part;
}

}  // namespace

struct World::Impl {
  struct Body {
    FclShape shape;
    int group = 0;
    Pose pose;  ///< at q = 0, base frame
  };
  std::shared_ptr<const RobotPart> robot;  // shared: the worlds of one robot
  std::shared_ptr<MeshStore> meshes;       // shared: the same
  std::vector<Body> bodies;
  std::vector<std::string> names;
  std::vector<BodyPair> pairs;
  std::vector<std::string> warnings;

  Impl(std::shared_ptr<const RobotPart> robot_part, std::shared_ptr<MeshStore> store, const std::vector<SceneObject>& scene,
       const Impl* like = nullptr)
      : robot(std::move(robot_part)), meshes(std::move(store)), pairs(robot->pairs) {
    const Span span("world");
    for (std::size_t i = 0; i < robot->bodies.size(); ++i)
      add(robot->bodies[i].name, {robot->shapes[i], robot->bodies[i].group, robot->bodies[i].pose});
    for (const SceneObject& object : scene) {
      const Body* known = like ? like->scene_body(object.shape) : nullptr;
      add(object.name, {known ? known->shape : make_fcl_shape(object.shape, *meshes), 0, object.pose});
      const int index = static_cast<int>(bodies.size()) - 1;
      for (std::size_t i = 0; i < robot->bodies.size(); ++i) {
        const RobotBody& body = robot->bodies[i];
        const bool allowed = std::find(object.allow.begin(), object.allow.end(), body.name) != object.allow.end();
        if (body.group > 0 && !allowed) pairs.push_back({static_cast<int>(i), index});
      }
    }
    sort_pairs();
    warm_up();
  }

  void add(const std::string& name, Body body) {
    if (const auto* mesh = std::get_if<MeshPtr>(&body.shape.shape); mesh && !(*mesh)->closed)
      warnings.push_back(name + ": mesh " + (*mesh)->source + " is not closed: it is treated as a surface, with nothing inside");
    bodies.push_back(std::move(body));
    names.push_back(name);
  }

  /// A scene object of this shape; null if there is none.
  const Body* scene_body(const Shape& shape) const {
    const auto first = bodies.begin() + static_cast<std::ptrdiff_t>(robot->bodies.size());
    const auto found = std::find_if(first, bodies.end(), [&](const Body& body) { return body.shape.shape == shape; });
    return found == bodies.end() ? nullptr : &*found;
  }

  const Body& body(int i) const { return bodies[static_cast<std::size_t>(i)]; }

  void sort_pairs() {
    const int robot_bodies = static_cast<int>(robot->bodies.size());
    const auto round = [&](int i) { return body(i).shape.kind == FclShape::Kind::kRound; };
    const auto key = [&](const BodyPair& p) {
      const int outermost = std::max(body(p.a).group, body(p.b).group);
      return std::tuple(p.b < robot_bodies, !round(p.a) && !round(p.b), -outermost, -p.a, -p.b);
    };
    std::sort(pairs.begin(), pairs.end(), [&](const BodyPair& p, const BodyPair& q) { return key(p) < key(q); });
  }

  /// FCL builds its dispatch tables at the first call, without promising that two threads may do so at once.
  static void warm_up() {
    MeshStore none;
    const FclShape ball = make_fcl_shape(Sphere{1}, none);
    const Pose origin = Pose::Identity();
    PairTest test;
    static_cast<void>(test.below({&ball, &origin}, {&ball, &origin}, 0));
    static_cast<void>(test.clearance({&ball, &origin}, {&ball, &origin}));
  }
};

World::World(const RobotModel& robot, const ArmModel& arm, const Problem& problem) {
  auto meshes = std::make_shared<MeshStore>();
  auto part = make_robot_part(robot, arm, problem, *meshes);
  impl_ = std::make_unique<Impl>(std::move(part), std::move(meshes), problem.scene);
}
World::World(const World& like, const std::vector<SceneObject>& scene)
    : impl_(std::make_unique<Impl>(like.impl_->robot, like.impl_->meshes, scene, like.impl_.get())) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

const std::vector<std::string>& World::body_names() const {
  return impl_->names;
}
const std::vector<BodyPair>& World::pairs() const {
  return impl_->pairs;
}
const std::vector<RobotBody>& World::bodies() const {
  return impl_->robot->bodies;
}
const std::vector<std::string>& World::warnings() const {
  return impl_->warnings;
}

/// Bounds are exact up to rounding; this is far above it and far below what FCL resolves.
static constexpr double kBoundSafety = 1e-6;

struct World::Query::Impl {
  const World::Impl* world;
  Certificates certificates;
  PairTest test;
  CollisionCounters own;  // all but what the test counts
  bool certain = false;   // no verdict of this question needed FCL
  std::vector<Pose> poses;
  std::vector<PlacedBound> bounds;
  Config placed_at = Config::Constant(std::numeric_limits<double>::quiet_NaN());

  Impl(const World::Impl& w, Certificates c) : world(&w), certificates(c) {
    for (const auto& body : w.bodies) {
      poses.push_back(body.pose);
      bounds.push_back(place(body.shape.bound, body.pose));
    }
  }

  void move_to(const Config& q) {
    if (q == placed_at) return;  // an edge asks the same place at two distances
    const auto moved = world->robot->chain.displacements(q);
    for (std::size_t i = 0; i < world->robot->bodies.size(); ++i) {
      const auto& body = world->bodies[i];
      if (body.group == 0) continue;
      poses[i] = moved[static_cast<std::size_t>(body.group)] * body.pose;
      bounds[i] = place(body.shape.bound, poses[i]);
    }
    placed_at = q;
  }

  bool below(const BodyPair& p, double d) {
    const Certificate certificate = certify_pair(p, d);
    certain &= certificate != Certificate::kNone;
    if (certificates != Certificates::kCompared && certificate != Certificate::kNone) return certificate == Certificate::kColliding;
    const bool verdict = test.below(placed(p.a), placed(p.b), d);
    own.contradictions += certificate == (verdict ? Certificate::kFree : Certificate::kColliding);
    return verdict;
  }
  [[nodiscard]] Certificate certify_pair(const BodyPair& p, double d) const {
    if (surely_apart(bound(p.a), placed_bound(p.a), bound(p.b), placed_bound(p.b), d + kBoundSafety)) return Certificate::kFree;
    return certificates == Certificates::kOff ? Certificate::kNone : certify(placed(p.a), placed(p.b), d);
  }
  [[nodiscard]] PlacedShapeRef placed(int i) const { return {&world->body(i).shape, &poses[static_cast<std::size_t>(i)]}; }
  [[nodiscard]] const Bound& bound(int i) const { return world->body(i).shape.bound; }
  [[nodiscard]] const PlacedBound& placed_bound(int i) const { return bounds[static_cast<std::size_t>(i)]; }
};

World::Query::Query(const World& world, Certificates certificates) : impl_(std::make_unique<Impl>(*world.impl_, certificates)) {}
World::Query::~Query() = default;
World::Query::Query(Query&&) noexcept = default;
World::Query& World::Query::operator=(Query&&) noexcept = default;

std::optional<BodyPair> World::Query::first_below(const Config& q, double d, const std::optional<BodyPair>& suspect) {
  impl_->move_to(q);
  impl_->certain = impl_->certificates != Certificates::kOff;
  const auto is_below = [&](const BodyPair& p) {
    if (!impl_->below(p, d)) return false;
    impl_->own.certified_colliding += impl_->certain;
    return true;
  };
  if (suspect && is_below(*suspect)) return suspect;
  for (const BodyPair& p : impl_->world->pairs)
    if (p != suspect && is_below(p)) return p;
  impl_->own.certified_free += impl_->certain;
  return std::nullopt;
}

bool World::Query::pair_below(const Config& q, const BodyPair& pair, double d) {
  if (d < 0) return false;
  impl_->move_to(q);
  return impl_->below(pair, d);
}

std::optional<World::Query::Clearance> World::Query::clearance(const Config& q) {
  impl_->move_to(q);
  const auto& pairs = impl_->world->pairs;
  std::vector<std::pair<double, std::size_t>> order;  // least possible distance, index of the pair
  order.reserve(pairs.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const BodyPair& p = pairs[k];
    order.emplace_back(distance_floor(impl_->bound(p.a), impl_->placed_bound(p.a), impl_->bound(p.b), impl_->placed_bound(p.b)), k);
  }
  std::sort(order.begin(), order.end());

  double least = std::numeric_limits<double>::max();
  std::size_t where = pairs.size();
  for (const auto& [floor, k] : order) {
    if (floor - kBoundSafety > least) break;
    const double found = impl_->test.clearance(impl_->placed(pairs[k].a), impl_->placed(pairs[k].b));
    if (std::tie(found, k) < std::tie(least, where)) std::tie(least, where) = std::tie(found, k);
  }
  if (where == pairs.size()) return std::nullopt;
  return Clearance{least, pairs[where]};
}

std::optional<std::array<Vector3d, 2>> World::Query::nearest_points(const Config& q, const Clearance& clearance) {
  impl_->move_to(q);
  return swivel::nearest_points(impl_->placed(clearance.pair.a), impl_->placed(clearance.pair.b), clearance.distance);
}

CollisionCounters World::Query::counters() const {
  CollisionCounters counters = impl_->own;
  counters += impl_->test.counters();
  return counters;
}

}  // namespace swivel
