// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/collision/world/world.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "exact/depth.hpp"
#include "exact/nearest_points.hpp"
#include "exact/pair_test.hpp"
#include "proofs/distance_proof.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "world/robot_part.hpp"

namespace swivel {

using namespace detail;

namespace {

constexpr double kAskedNothing = -std::numeric_limits<double>::infinity();
/// The clearance that one pair must keep, m, indexed by Keep.
using RequiredByRule = std::array<double, 4>;
constexpr auto kMotionIndex = static_cast<std::size_t>(ClearanceRule::kMotion),
               kMidpointIndex = static_cast<std::size_t>(ClearanceRule::kMidpoint);
RequiredByRule required_by_rule(const RequiredClearance& required, double forgiven) {
  const double motion = std::max(0.0, required.motion - forgiven);
  return {0, std::max(0.0, required.node - forgiven), motion, motion + required.tolerance};
}

/// Added to bounds, which are exact up to rounding, m: far above the rounding error and far below
/// what FCL resolves.
constexpr double kBoundSafety = 1e-6;
/// A kept clearance proves a pair free only if it exceeds the threshold by this, m, so that FCL
/// would agree.
constexpr double kKeptSafety = kVerdictBand + kBoundSafety;
/// If a depth exceeds the threshold by this, m, bodies that are placed almost equally are too deep
/// as well; the search for a larger depth ends there.
constexpr double kTelling = 2 * kVerdictBand;
/// Clearances to be kept are sought this far beyond the threshold, m, unless a step like the last
/// one would use that up.
constexpr double kMargin = 0.005;

std::string millimetres(double metres) {
  return formatted("%.3g mm", 1e3 * metres);
}

std::string list_of(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 5;
  std::string list;
  for (std::size_t k = 0; k < std::min(names.size(), kMost); ++k)
    list += (k == 0 ? "" : ", ") + names[k];
  return names.size() <= kMost ? list
                               : list + " and " + std::to_string(names.size() - kMost) + " more";
}

}  // namespace

struct World::Impl {
  struct Body {
    FclShape shape;
    int group = 0;
    Pose pose;  ///< at q = 0, base frame
  };
  std::shared_ptr<const RobotPart> robot;  // shared: the worlds of one robot
  MeshStore meshes;
  Limits limits;
  std::vector<RobotPair> robot_pairs;
  std::vector<Body> bodies;
  std::vector<std::string> names;
  std::vector<BodyPair> pairs;
  std::vector<AllowedPair> allowed;
  std::vector<RequiredByRule> required_by_pair;  // by pair
  std::vector<char> may_touch;                   // by pair: it keeps a depth
  std::vector<int> numbers;                      // [a * bodies + b] of `pairs`; -1: none of them
  std::vector<EdgeRule::Near> near;
  std::vector<std::string> warnings;
  double forgiven;  // m, by which pairs may be nearer than they should

  Impl(std::shared_ptr<const RobotPart> robot_part, MeshStore store,
       const std::vector<SceneObject>& scene, const Limits& of_problem, const Budget& budget,
       double forgive, const Impl* like = nullptr)
      : robot(std::move(robot_part)),
        meshes(std::move(store)),
        limits(of_problem),
        robot_pairs(robot->pairs(limits)),
        warnings(robot->warnings()),
        forgiven(forgive) {
    const TraceSpan span("world");
    for (const RobotPair& p : robot_pairs)
      if (!p.dropped) pairs.push_back(p.pair);
    for (std::size_t i = 0; i < robot->bodies.size(); ++i)
      add(robot->bodies[i].name, {robot->shapes[i], robot->bodies[i].group, robot->bodies[i].pose});
    for (const SceneObject& object : scene) {
      budget.poll();
      const Body* known = like ? like->scene_body(object.shape) : nullptr;
      add(object.name,
          {known ? known->shape : make_fcl_shape(object.shape, meshes), 0, object.pose});
      const int index = static_cast<int>(bodies.size()) - 1;
      for (std::size_t i = 0; i < robot->bodies.size(); ++i) {
        const RobotBody& body = robot->bodies[i];
        if (body.group == 0) continue;
        const BodyPair pair{static_cast<int>(i), index};
        const auto found = std::find_if(object.allow.begin(), object.allow.end(),
                                        [&](const Allowed& a) { return a.body == body.name; });
        if (found != object.allow.end()) allowed.push_back({pair, found->depth});
        if (found == object.allow.end() || found->depth) pairs.push_back(pair);
      }
    }
    sort_pairs();
    required_by_pair.reserve(pairs.size());
    for (const BodyPair& p : pairs) {
      const RequiredClearance asked = required_of(p);
      required_by_pair.push_back(required_by_rule(asked, forgiven));
      const RobotPair* known = robot_pair(p);
      may_touch.push_back(known == nullptr && depth_of(p));
      if (may_touch.back())
        required_by_pair.back() = {kAskedNothing, asked.node - forgiven, asked.motion - forgiven,
                                   kAskedNothing};
      if (known ? !known->near : !may_touch.back()) continue;
      RequiredByRule& own = required_by_pair.back();
      const Chain::Joints joints = robot->chain.joints_between(body(p.a).group, body(p.b).group);
      near.push_back({p, own[kMotionIndex], asked.tolerance, joints.first, joints.last});
      own[kMotionIndex] = own[kMidpointIndex] = kAskedNothing;
    }
    number_pairs();
    warn_of_pairs();
    [[maybe_unused]] static const bool warm = warm_up();
  }

  /// Returns the clearance required of pair k at this threshold, m.
  [[nodiscard]] double required(std::size_t k, const Threshold& threshold) const {
    return required_by_pair[k][static_cast<std::size_t>(threshold.rule)] + threshold.more;
  }
  /// Returns true for a pair of two robot bodies. These come last in `pairs`.
  [[nodiscard]] bool is_own(const BodyPair& p) const {
    return p.b < static_cast<int>(robot->bodies.size());
  }
  [[nodiscard]] double required(const BodyPair& p, const Threshold& threshold) const {
    if (threshold.rule == ClearanceRule::kNothing) return threshold.more;
    const auto number = number_of(p);
    return number ? required(*number, threshold) : kAskedNothing;
  }
  /// Returns true if a threshold d, m, has to be tested for pair k: a negative one only for pairs
  /// that keep a depth.
  [[nodiscard]] bool is_asked(std::size_t k, double d) const {
    return d >= 0 || (may_touch[k] && d > kAskedNothing);
  }
  [[nodiscard]] bool is_asked(const BodyPair& p, double d) const {
    const auto number = number_of(p);
    return d >= 0 || (number && is_asked(*number, d));
  }
  [[nodiscard]] std::optional<std::size_t> number_of(const BodyPair& p) const {
    const int number = numbers[place_of(p)];
    return number < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(number));
  }
  [[nodiscard]] std::size_t place_of(const BodyPair& p) const {
    return static_cast<std::size_t>(p.a) * bodies.size() + static_cast<std::size_t>(p.b);
  }
  void number_pairs() {
    numbers.assign(robot->bodies.size() * bodies.size(), -1);
    for (std::size_t k = 0; k < pairs.size(); ++k)
      numbers[place_of(pairs[k])] = static_cast<int>(k);
  }
  [[nodiscard]] RequiredClearance required_of(const BodyPair& p) const {
    if (const RobotPair* known = robot_pair(p)) return known->required;
    if (const auto depth = depth_of(p)) return required_of_depth(*depth);
    return {limits.clearance, limits.d_edge(), limits.edge_tolerance};
  }
  /// Returns what a pair keeps whose bodies may be `depth`, m, deep in each other. A motion is
  /// proved by midpoints that are less deep than that by the tolerance. Planned nodes are less deep
  /// by twice the tolerance, so that a node from which no motion could be proved is refused at
  /// once. In verification (`forgiven` > 0) every row may be as deep as allowed, however close the
  /// rows are.
  [[nodiscard]] RequiredClearance required_of_depth(double depth) const {
    if (forgiven > 0) return {-depth, -depth, kVerdictBand};
    const double tolerance = std::min(limits.edge_tolerance, std::max(depth / 32, kVerdictBand));
    const double margin =
        limits.edges == EdgeMode::kContinuous ? std::min(2 * tolerance, depth / 8) : 0;
    return {margin - depth, -depth, tolerance};
  }
  /// Returns how deep, m, the bodies of a pair may be in each other; none if no depth bounds the
  /// pair.
  [[nodiscard]] std::optional<double> depth_of(const BodyPair& p) const {
    const auto found = std::find_if(allowed.begin(), allowed.end(),
                                    [&](const AllowedPair& x) { return x.pair == p; });
    return found == allowed.end() ? std::nullopt : found->depth;
  }
  [[nodiscard]] const RobotPair* robot_pair(const BodyPair& p) const {
    if (p.b >= static_cast<int>(robot->bodies.size())) return nullptr;
    return &*std::find_if(robot_pairs.begin(), robot_pairs.end(),
                          [&](const RobotPair& x) { return x.pair == p; });
  }

  void keep_pairs(const std::vector<int>& objects, Pairs wanted) {
    const int robot_bodies = static_cast<int>(robot->bodies.size());
    const auto all = std::move(pairs);
    const auto all_required = std::move(required_by_pair);
    const auto all_may_touch = std::move(may_touch);
    pairs.clear();
    required_by_pair.clear();
    may_touch.clear();
    const auto is_wanted = [&](const BodyPair& p) {
      return (std::find(objects.begin(), objects.end(), p.b - robot_bodies) != objects.end()) ==
             (wanted == Pairs::kOf);
    };
    for (std::size_t k = 0; k < all.size(); ++k)
      if (is_wanted(all[k])) {
        pairs.push_back(all[k]);
        required_by_pair.push_back(all_required[k]);
        may_touch.push_back(all_may_touch[k]);
      }
    std::erase_if(near, [&](const EdgeRule::Near& x) { return !is_wanted(x.pair); });
    std::erase_if(allowed, [&](const AllowedPair& x) { return !is_wanted(x.pair); });
    number_pairs();
  }

  void warn_of_pairs() {
    std::vector<std::string> dropped, reduced;
    for (const RobotPair& p : robot_pairs) {
      if (!p.dropped && !p.reduced) continue;
      const std::string text = names[p.pair.a] + " - " + names[p.pair.b];
      if (p.dropped)
        dropped.push_back(text);
      else if (p.required.node < limits.d_self())
        reduced.push_back(text + " " + millimetres(p.required.node));
    }
    if (!dropped.empty())
      warnings.push_back("robot pairs that touch in every posture are not kept apart: " +
                         list_of(dropped));
    if (!reduced.empty())
      warnings.push_back("robot pairs that are near by design keep less than " +
                         millimetres(limits.d_self()) + ": " + list_of(reduced));
  }

  void add(const std::string& name, Body body) {
    if (const auto* mesh = std::get_if<MeshPtr>(&body.shape.shape); mesh && !(*mesh)->closed)
      warnings.push_back(name + ": mesh " + (*mesh)->source +
                         " is not closed: it is treated as a surface, with nothing inside");
    bodies.push_back(std::move(body));
    names.push_back(name);
  }

  /// Returns a scene object of this shape; null if there is none.
  const Body* scene_body(const Shape& shape) const {
    const auto first = bodies.begin() + static_cast<std::ptrdiff_t>(robot->bodies.size());
    const auto found = std::find_if(first, bodies.end(),
                                    [&](const Body& body) { return body.shape.shape == shape; });
    return found == bodies.end() ? nullptr : &*found;
  }

  const Body& body(int i) const { return bodies[i]; }

  void sort_pairs() {
    const int robot_bodies = static_cast<int>(robot->bodies.size());
    const auto round = [&](int i) { return body(i).shape.kind == FclShape::Kind::kRound; };
    const auto key = [&](const BodyPair& p) {
      const int outermost =
          std::max(robot->chain.root_of(body(p.a).group), robot->chain.root_of(body(p.b).group));
      return std::tuple(p.b < robot_bodies, !round(p.a) && !round(p.b), -outermost, -p.a, -p.b);
    };
    std::sort(pairs.begin(), pairs.end(),
              [&](const BodyPair& p, const BodyPair& q) { return key(p) < key(q); });
  }

  /// Calls FCL once, because it builds its dispatch tables at the first call and does not promise
  /// that two threads may do so at once.
  static bool warm_up() {
    MeshStore none;
    const FclShape ball = make_fcl_shape(Sphere{1}, none);
    const Pose origin = Pose::Identity();
    PairTest test;
    static_cast<void>(test.below({&ball, &origin}, {&ball, &origin}, 0));
    static_cast<void>(test.clearance({&ball, &origin}, {&ball, &origin}));
    return true;
  }
};

World::World(const RobotModel& robot, const ArmModel& arm, const PathProblem& problem,
             const Budget& budget)
    : World(MeshStore(), robot, arm, problem, budget) {}
World::World(const World& like, const RobotModel& robot, const ArmModel& arm,
             const PathProblem& problem, const Budget& budget)
    : World(like.impl_->meshes, robot, arm, problem, budget) {}
World::World(MeshStore meshes, const RobotModel& robot, const ArmModel& arm,
             const PathProblem& problem, const Budget& budget) {
  auto part = std::make_shared<const RobotPart>(robot, arm, problem, meshes, budget);
  impl_ = std::make_unique<Impl>(std::move(part), std::move(meshes), problem.scene, problem.limits,
                                 budget, 0);
}
World::World(const World& like, const std::vector<SceneObject>& scene, const Budget& budget)
    : impl_(std::make_unique<Impl>(like.impl_->robot, like.impl_->meshes, scene, like.impl_->limits,
                                   budget, 0, like.impl_.get())) {}
World::World(const World& like, const PathProblem& problem, const Budget& budget, double forgiven)
    : impl_(std::make_unique<Impl>(RobotPart::for_limits(like.impl_->robot, problem.limits, budget),
                                   like.impl_->meshes, problem.scene, problem.limits, budget,
                                   forgiven, like.impl_.get())) {}
World::World(const World& whole, const std::vector<int>& objects, Pairs pairs)
    : impl_(std::make_unique<Impl>(*whole.impl_)) {
  impl_->keep_pairs(objects, pairs);
}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

const std::vector<std::string>& World::body_names() const {
  return impl_->names;
}
std::array<std::string, 2> World::names(const BodyPair& pair) const {
  return {impl_->names[pair.a], impl_->names[pair.b]};
}
const std::vector<BodyPair>& World::pairs() const {
  return impl_->pairs;
}
const std::vector<AllowedPair>& World::allowed() const {
  return impl_->allowed;
}
const std::vector<RobotBody>& World::bodies() const {
  return impl_->robot->bodies;
}
bool World::has_meshes() const {
  const auto is_mesh = [](const Impl::Body& body) {
    return std::holds_alternative<MeshPtr>(body.shape.shape);
  };
  return std::any_of(impl_->bodies.begin(), impl_->bodies.end(), is_mesh);
}
std::size_t World::triangles_to_make_ready() const {
  std::size_t sum = 0;
  for (const Impl::Body& body : impl_->bodies)
    if (const auto& mesh = body.shape.mesh; mesh && !mesh->is_ready())
      sum += std::get<MeshPtr>(body.shape.shape)->triangles.size();
  return sum;
}
void World::make_ready(const std::function<bool()>& stop) const {
  const TraceSpan span("meshes made ready");
  const auto each_mesh = [&](const auto& make) {
    for (const BodyPair& p : impl_->pairs)
      for (const int body : {p.a, p.b}) {
        if (stop()) return;
        if (const auto& mesh = impl_->body(body).shape.mesh) make(*mesh);
      }
  };
  each_mesh([](const MeshModel& mesh) { static_cast<void>(mesh.triangles()); });
  each_mesh([](const MeshModel& mesh) {
    static_cast<void>(mesh.part_points());
    if (mesh.is_closed()) static_cast<void>(mesh.solid());
  });
}
Chain::Joints World::joints_between(const BodyPair& pair) const {
  return impl_->robot->chain.joints_between(impl_->body(pair.a).group, impl_->body(pair.b).group);
}
RequiredClearance World::required_clearance(const BodyPair& pair) const {
  return impl_->required_of(pair);
}
double World::required(std::size_t pair, ClearanceRule rule) const {
  return impl_->required(pair, Threshold(rule));
}
double World::displacement(int object, const Pose& from, const Pose& to) const {
  const Bound& bound =
      impl_->bodies[impl_->robot->bodies.size() + static_cast<std::size_t>(object)].shape.bound;
  return motion(bound, place(bound, from), place(bound, to)) + kBoundSafety;
}
const std::vector<RobotPair>& World::robot_pairs() const {
  return impl_->robot_pairs;
}
std::vector<RobotPair> World::robot_pairs_with_medians() const {
  return impl_->robot->pairs_with_medians(impl_->limits);
}
EdgeRule World::edge_rule(const std::array<double, kDof>& radii) const {
  return {radii, impl_->limits.edge_tolerance, impl_->near, impl_->robot->followers};
}
const std::vector<std::string>& World::warnings() const {
  return impl_->warnings;
}

struct World::Query::Impl {
  const World::Impl* world;
  DistanceProofs distance_proofs;
  PairTest test;
  CollisionCounters own;     // all but what the test counts
  bool all_proved = false;   // no verdict of this query needed FCL
  bool last_proved = false;  // the last verdict was a distance proof's
  std::vector<Pose> poses;
  std::vector<PlacedBound> bounds;
  Config q = Config::Constant(std::numeric_limits<double>::quiet_NaN());
  std::array<Pose, kDof + 1> displacements;
  int displaced = 0;           // up to this group of the chain
  std::vector<char> in_place;  // bodies, at q
  // For find_violating_pair_incremental(): what a pair's two bodies have moved in all is subtracted
  // from the pair's lower bound of the distance. by body, up to `moved_to`: in all, and from the
  // posture before, m
  std::vector<double> moved, step;
  std::vector<PlacedBound> moved_to;     // by body; empty before the first posture
  std::vector<double> lower_bound;       // by pair, m
  std::vector<TrianglePair> warm_start;  // by pair: where its last proof was found
  std::vector<std::size_t> open;         // pairs whose bound does not prove them free
  // For find_violating_pair_over_motion().
  std::optional<MotionSegment> segment;
  /// The displacement of a group of bodies by the joint steps of a stretch, to first order: a point
  /// x, base frame, moves by origin + turn x x.
  struct Twist {
    Vector3d turn = Vector3d::Zero(), origin = Vector3d::Zero();  // rad, m
  };
  std::vector<Twist> twists;  // by group

  Impl(const World::Impl& w, DistanceProofs c)
      : world(&w),
        distance_proofs(c),
        test(c == DistanceProofs::kOn ? PairTest::Meshes::kNear : PairTest::Meshes::kWhole),
        in_place(w.bodies.size()),
        moved(w.bodies.size()),
        step(w.bodies.size()),
        lower_bound(w.pairs.size(), std::numeric_limits<double>::lowest()),
        warm_start(w.pairs.size()),
        twists(kDof + 1 + w.robot->chain.followers.size()) {
    open.reserve(lower_bound.size());
    moved_to.reserve(moved.size());
    displacements[0].setIdentity();
    for (const auto& body : w.bodies) {
      poses.push_back(body.pose);
      bounds.push_back(place(body.shape.bound, body.pose));
    }
  }

  /// Sets the posture. A body is placed only when a query needs it.
  void move_to(const Config& to) {
    if (to == q) return;  // an edge asks the same place at two distances
    q = to;
    displaced = 0;
    std::fill(in_place.begin(), in_place.end(), 0);
  }
  void place_body(int index) {
    const auto i = static_cast<std::size_t>(index);
    const auto& body = world->bodies[i];
    if (in_place[i] || body.group == 0) return;
    const Chain& chain = world->robot->chain;
    if (const int root = chain.root_of(body.group); displaced < root) {
      chain.displace(q, displaced, root, displacements);
      displaced = root;
    }
    poses[i] = body.group <= static_cast<int>(kDof)
                   ? product(displacements[body.group], body.pose)
                   : product(chain.displacement(body.group, q, displacements), body.pose);
    bounds[i] = place(body.shape.bound, poses[i]);
    in_place[i] = 1;
  }
  void place_bodies() {
    for (int i = 0; i < static_cast<int>(world->robot->bodies.size()); ++i) place_body(i);
  }

  void begin(const MotionSegment& asked) {
    segment = asked;
    place_bodies();
    const Chain& chain = world->robot->chain;
    for (int j = 0; j < displaced; ++j) {
      const auto k = static_cast<std::size_t>(j);
      const Vector3d turn = asked.half[j] * (displacements[k].linear() * chain.axis[k]);
      if (chain.limit[k].slides) {
        twists[k + 1] = {twists[k].turn, twists[k].origin + turn};
        continue;
      }
      twists[k + 1] = {twists[k].turn + turn,
                       twists[k].origin + (displacements[k] * chain.point[k]).cross(turn)};
    }
    for (std::size_t f = 0; f < chain.followers.size(); ++f) {
      const Chain::Follower& follower = chain.followers[f];
      if (follower.root > displaced) continue;  // it carries no body
      const Pose parent = chain.displacement(follower.parent, q, displacements);
      const Vector3d motion =
          asked.half[follower.leader] * follower.multiplier * (parent.linear() * follower.axis);
      const Twist& carried = twists[static_cast<std::size_t>(follower.parent)];
      twists[kDof + 1 + f] = follower.slides
                                 ? Twist{carried.turn, carried.origin + motion}
                                 : Twist{carried.turn + motion,
                                         carried.origin + (parent * follower.point).cross(motion)};
    }
  }
  /// Returns how much nearer two bodies can come on the segment, m, to first order: the sum of
  /// their speeds relative to the group of the chain that carries both. Without followers that
  /// group carries one of the two bodies, and only the other moves.
  [[nodiscard]] double comes_nearer(const BodyPair& p) const {
    const int group_a = world->body(p.a).group, group_b = world->body(p.b).group;
    const Chain& chain = world->robot->chain;
    const int common = std::min(chain.root_of(group_a), chain.root_of(group_b));
    double speed = 0;
    if (group_a != common) speed += speed_against(common, group_a, p.a);
    if (group_b != common) speed += speed_against(common, group_b, p.b);
    return speed;
  }
  /// Returns the highest speed of any point of a body of `group` relative to the group `still`, m
  /// per stretch.
  [[nodiscard]] double speed_against(int still, int group, int body) const {
    const Twist &far = twists[static_cast<std::size_t>(group)],
                &near = twists[static_cast<std::size_t>(still)];
    const Vector3d turn = far.turn - near.turn;
    const PlacedBound& at = placed_bound(body);
    double speed = (far.origin - near.origin + turn.cross(at.center)).norm();
    for (int k = 0; k < 3; ++k)
      if (const double half = bound(body).half[k]; half > 0)
        speed += half * turn.cross(at.axes.col(k)).norm();
    return speed;
  }
  /// Returns the clearance required of pair k at this threshold, m. On a stretch, level.more is
  /// replaced by how far the pair can come nearer, if that is less.
  [[nodiscard]] double required(std::size_t k, const Threshold& threshold) const {
    const double d = world->required(k, threshold);
    if (!segment || !(threshold.more > 0)) return d;
    return std::min(d, world->required(k, threshold.rule) + comes_nearer(world->pairs[k]) +
                           segment->tangent_deviation + segment->margin);
  }

  std::optional<BodyPair> find_violating_pair(const Threshold& threshold,
                                              const std::optional<BodyPair>& suspected, bool keep,
                                              bool own_too = true) {
    all_proved = distance_proofs != DistanceProofs::kOff;
    const auto found = first(threshold, suspected, keep && all_proved, own_too);
    (found ? own.proved_colliding : own.proved_free) += all_proved;
    return found;
  }
  std::optional<BodyPair> first(const Threshold& threshold,
                                const std::optional<BodyPair>& suspected, bool keep, bool own_too) {
    if (suspected && below(*suspected, threshold)) return suspected;
    place_bodies();
    if (keep) return first_open(threshold, suspected, own_too);
    for (std::size_t k = 0; k < world->pairs.size(); ++k) {
      const BodyPair& p = world->pairs[k];
      if (!own_too && world->is_own(p)) break;
      const double d = required(k, threshold);
      if (p != suspected && world->is_asked(k, d) && is_below(p, d, warm_start[k])) return p;
    }
    return std::nullopt;
  }
  std::optional<BodyPair> first_open(const Threshold& threshold,
                                     const std::optional<BodyPair>& suspected, bool own_too) {
    move_on();
    find_open(threshold);
    for (const std::size_t k : open) {
      const BodyPair& p = world->pairs[k];
      if (!own_too && world->is_own(p)) break;
      const double d = required(k, threshold);
      if (p == suspected || !world->is_asked(k, d)) continue;
      if (d < 0 ? is_deeper_now(k, -d) : is_below(p, d, renewed(k, d))) return p;
    }
    return std::nullopt;
  }
  bool below(const BodyPair& p, const Threshold& threshold) {
    const double d = world->required(p, threshold);
    if (!world->is_asked(p, d)) return false;
    place_body(p.a);
    place_body(p.b);
    TrianglePair none;
    const auto k = world->number_of(p);
    return is_below(p, d, k ? warm_start[*k] : none);
  }
  bool proves_violation(const BodyPair& p, const Threshold& threshold) {
    if (distance_proofs == DistanceProofs::kOff) return false;
    const auto k = world->number_of(p);
    if (!k) return false;
    place_body(p.a);
    place_body(p.b);
    const double d = world->required(p, threshold);
    if (d < 0 && world->may_touch[*k])
      last_proved =
          detail::depth(placed(p.a), placed(p.b), -d, -d + kTelling).at_least > -d + kVerdictBand;
    else
      last_proved = proves_below(placed(p.a), placed(p.b), d, warm_start[*k]);
    own.proved_colliding += last_proved;
    return last_proved;
  }
  bool is_below(const BodyPair& p, double d, TrianglePair& from) {
    return d < 0 ? is_deeper(p, -d) : is_below(p, d, prove_pair(p, d, from));
  }
  /// Returns true if the bodies of a pair are not proved to be at most d, m, deep in each other; a
  /// depth that the search leaves open counts as more. FCL is not called.
  bool is_deeper(const BodyPair& p, double d) {
    last_proved = true;
    if (proved_apart(bound(p.a), placed_bound(p.a), bound(p.b), placed_bound(p.b),
                     kBoundSafety - d))
      return false;
    return is_deeper(detail::depth(placed(p.a), placed(p.b), d, d + kTelling), d);
  }
  bool is_deeper(const Depth& found, double d) {
    const bool deeper = found.at_most > d;
    last_proved = !deeper || found.at_least > d + kVerdictBand;
    return deeper;
  }
  /// Returns what is_deeper() does for pair k, and renews the pair's lower bound.
  bool is_deeper_now(std::size_t k, double d) {
    const BodyPair& p = world->pairs[k];
    const double so_far = moved_together(p);
    lower_bound[k] =
        distance_bound(bound(p.a), placed_bound(p.a), bound(p.b), placed_bound(p.b)) + so_far;
    last_proved = true;
    if (lower_bound[k] - so_far >= kBoundSafety - d) return false;
    const Depth found = detail::depth(placed(p.a), placed(p.b), d, d + kTelling);
    lower_bound[k] = std::max(lower_bound[k], so_far - found.at_most);
    return is_deeper(found, d);
  }
  bool is_below(const BodyPair& p, double d, DistanceProof proved) {
    last_proved = proved != DistanceProof::kNone;
    all_proved &= last_proved;
    return last_proved ? proved == DistanceProof::kColliding
                       : test.below(placed(p.a), placed(p.b), d);
  }
  [[nodiscard]] DistanceProof prove_pair(const BodyPair& p, double d, TrianglePair& from) const {
    if (proved_apart(bound(p.a), placed_bound(p.a), bound(p.b), placed_bound(p.b),
                     d + kBoundSafety))
      return DistanceProof::kFree;
    return distance_proofs == DistanceProofs::kOff
               ? DistanceProof::kNone
               : prove(placed(p.a), placed(p.b), d, 0, from).proved;
  }

  /// Returns true if the clearance of pair k is proved to exceed d, m, without FCL.
  [[nodiscard]] bool proved_beyond(std::size_t k, double d) {
    const BodyPair& p = world->pairs[k];
    if (proved_apart(bound(p.a), placed_bound(p.a), bound(p.b), placed_bound(p.b),
                     d + kBoundSafety))
      return true;
    return distance_proofs == DistanceProofs::kOn &&
           proves_beyond(placed(p.a), placed(p.b), d, warm_start[k]);
  }

  void move_on() {
    if (moved_to.empty()) moved_to = bounds;
    for (std::size_t i = 0; i < world->robot->bodies.size(); ++i) {
      const auto& body = world->bodies[i];
      if (body.group == 0) continue;
      step[i] = motion(body.shape.bound, moved_to[i], bounds[i]);
      moved[i] += step[i];
      moved_to[i] = bounds[i];
    }
  }
  [[nodiscard]] double moved_together(const BodyPair& p) const { return moved[p.a] + moved[p.b]; }
  [[nodiscard]] double slack(const Threshold& threshold) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < lower_bound.size(); ++k)
      if (const double d = required(k, threshold); world->is_asked(k, d)) {
        const double here = lower_bound[k] - moved_together(world->pairs[k]) - d - kKeptSafety;
        if (!(here >= 0)) return -1;  // NaN
        least = std::min(least, here);
      }
    return least;
  }
  void find_open(const Threshold& threshold) {
    open.resize(lower_bound.size());
    std::size_t found = 0;
    for (std::size_t k = 0; k < lower_bound.size(); ++k) {
      open[found] = k;
      found += !(lower_bound[k] - moved_together(world->pairs[k]) >=
                 world->required(k, threshold) + kKeptSafety);  // NaN is open
    }
    open.resize(found);
    if (segment) {
      std::erase_if(open, [&](std::size_t k) {
        return lower_bound[k] - moved_together(world->pairs[k]) >=
               required(k, threshold) + kKeptSafety;
      });
      found = open.size();
    }
    own.pairs_kept += static_cast<std::int64_t>(lower_bound.size() - found);
  }
  /// Compares the clearance of pair k with d, m, as prove_pair() does, and renews the pair's
  /// lower bound.
  DistanceProof renewed(std::size_t k, double d) {
    const BodyPair& p = world->pairs[k];
    const double so_far = moved_together(p);
    double bound_now =
        ball_distance_bound(bound(p.a), placed_bound(p.a), bound(p.b), placed_bound(p.b));
    if (bound_now < d + kMargin)
      bound_now = distance_bound(bound(p.a), placed_bound(p.a), bound(p.b), placed_bound(p.b));
    lower_bound[k] = bound_now + so_far;
    if (bound_now >= d + kMargin) return DistanceProof::kFree;
    // A margin that the next step uses up is not worth searching for: for bodies that are near by
    // design that search takes most of the time.
    const double last_step = step[p.a] + step[p.b];
    const bool lasts = last_step < kMargin &&
                       !(distance_at(placed(p.a), placed(p.b), warm_start[k]) < d + last_step);
    const double margin = lasts ? kMargin : kBoundSafety;
    if (bound_now >= d + margin) return DistanceProof::kFree;
    // Most pairs are free.
    const Proof proof = prove(placed(p.a), placed(p.b), d, margin, warm_start[k], Expected::kFree);
    lower_bound[k] = std::max(bound_now, proof.bound) + so_far;
    return bound_now >= d + kBoundSafety ? DistanceProof::kFree : proof.proved;
  }
  std::optional<Clearance> nearest(const Clearance& so_far);
  std::vector<std::optional<BodyClearance>> nearest_of_bodies();
  double clearance_lower_bound(std::size_t k, double least, double enough) {
    const BodyPair& p = world->pairs[k];
    place_body(p.a);
    place_body(p.b);
    const double sought = enough + kKeptSafety;
    double found =
        ball_distance_bound(bound(p.a), placed_bound(p.a), bound(p.b), placed_bound(p.b));
    if (!(found >= sought))
      found = distance_bound(bound(p.a), placed_bound(p.a), bound(p.b), placed_bound(p.b));
    if (!(found >= sought) && world->may_touch[k]) {
      found = std::max(found, -detail::depth(placed(p.a), placed(p.b), -sought).at_most);
    } else if (!(found >= sought) && distance_proofs == DistanceProofs::kOn) {
      const Proof proof = prove(placed(p.a), placed(p.b), least,
                                std::max(kBoundSafety, sought - least), warm_start[k]);
      if (proof.proved == DistanceProof::kFree) found = std::max(found, proof.bound);
    }
    return found - kKeptSafety;
  }
  [[nodiscard]] PlacedShapeRef placed(int i) const { return {&world->body(i).shape, &poses[i]}; }
  [[nodiscard]] const Bound& bound(int i) const { return world->body(i).shape.bound; }
  [[nodiscard]] const PlacedBound& placed_bound(int i) const { return bounds[i]; }
};

World::Query::Query(const World& world, DistanceProofs distance_proofs)
    : impl_(std::make_unique<Impl>(*world.impl_, distance_proofs)) {}
World::Query::~Query() = default;
World::Query::Query(Query&&) noexcept = default;
World::Query& World::Query::operator=(Query&&) noexcept = default;

std::optional<BodyPair> World::Query::find_violating_pair(
    const Config& q, const Threshold& threshold, const std::optional<BodyPair>& suspected) {
  impl_->move_to(q);
  impl_->segment.reset();
  return impl_->find_violating_pair(threshold, suspected, false);
}

std::optional<BodyPair> World::Query::find_violating_pair_incremental(
    const Config& q, const Threshold& threshold, const std::optional<BodyPair>& suspected) {
  impl_->move_to(q);
  impl_->segment.reset();
  return impl_->find_violating_pair(threshold, suspected, true);
}

std::optional<BodyPair> World::Query::find_violating_pair_with_scene(
    const Config& q, const Threshold& threshold, const std::optional<BodyPair>& suspected) {
  impl_->move_to(q);
  impl_->segment.reset();
  return impl_->find_violating_pair(threshold, suspected, true, false);
}

std::optional<BodyPair> World::Query::find_violating_pair_over_motion(const MotionSegment& segment,
                                                                      const Config& q,
                                                                      const Threshold& threshold) {
  impl_->move_to(q);
  impl_->begin(segment);
  return impl_->find_violating_pair(threshold, {}, true);
}

double World::Query::slack(const Threshold& threshold) const {
  return impl_->slack(threshold);
}

double World::Query::clearance_lower_bound(const Config& q, std::size_t pair, double least,
                                           double enough) {
  impl_->move_to(q);
  return impl_->clearance_lower_bound(pair, least, enough);
}

std::span<const double> World::Query::accumulated_displacement(const Config& q) {
  impl_->move_to(q);
  impl_->place_bodies();
  impl_->move_on();
  return impl_->moved;
}

bool World::Query::violation_is_proved() const {
  return impl_->last_proved;
}

bool World::Query::pair_violates(const Config& q, const BodyPair& pair,
                                 const Threshold& threshold) {
  impl_->move_to(q);
  return impl_->below(pair, threshold);
}

bool World::Query::proves_violation(const Config& q, const BodyPair& pair,
                                    const Threshold& threshold) {
  impl_->move_to(q);
  return impl_->proves_violation(pair, threshold);
}

bool World::Query::violation_proof_is_cheap(const BodyPair& pair) const {
  // triangles; a search of fewer is short anyway, and their corners lie far apart
  constexpr std::size_t kHeavy = 500;
  const FclShape &a = impl_->world->body(pair.a).shape, &b = impl_->world->body(pair.b).shape;
  const auto held_against = [](const FclShape& body, const FclShape& solid) {
    const auto* mesh = std::get_if<MeshPtr>(&body.shape);
    return mesh && (*mesh)->triangles.size() >= kHeavy && solid.kind == FclShape::Kind::kSolid;
  };
  return impl_->distance_proofs != DistanceProofs::kOff &&
         (held_against(a, b) || held_against(b, a));
}

std::optional<World::Query::Clearance> World::Query::clearance(const Config& q) {
  constexpr double kMost = std::numeric_limits<double>::max();
  impl_->move_to(q);
  return impl_->nearest({kMost, {}, 0, kMost});
}

std::optional<World::Query::Clearance> World::Query::clearance_if_less(const Config& q,
                                                                       const Clearance& so_far) {
  impl_->move_to(q);
  return impl_->nearest(so_far);
}

/// Returns the pair of least margin and the least clearance, or none if neither is below that of
/// `so_far`.
std::optional<World::Query::Clearance> World::Query::Impl::nearest(const Clearance& so_far) {
  place_bodies();
  const auto& pairs = world->pairs;
  struct Candidate {
    double bound;  ///< least possible distance, m
    std::size_t pair;
    double required;
  };
  std::vector<Candidate> order;
  order.reserve(pairs.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (world->may_touch[k]) continue;
    const BodyPair& p = pairs[k];
    order.push_back({distance_bound(bound(p.a), placed_bound(p.a), bound(p.b), placed_bound(p.b)),
                     k, world->required(k, ClearanceRule::kNode)});
  }
  std::sort(order.begin(), order.end(), [](const Candidate& x, const Candidate& y) {
    return std::tuple(x.bound - x.required, x.pair) < std::tuple(y.bound - y.required, y.pair);
  });

  // does not touch, margin, pair
  std::tuple<bool, double, std::size_t> least{true, so_far.margin(), pairs.size()};
  Clearance answer{std::numeric_limits<double>::max(), {}, 0, so_far.least};
  bool nearer = false;
  for (const Candidate& c : order) {
    const bool may_touch = c.bound <= kBoundSafety,
               may_be_nearest = c.bound - kBoundSafety <= answer.least;
    if (!may_touch && !may_be_nearest && c.bound - c.required - kBoundSafety > std::get<1>(least))
      continue;
    // A pair that is proved to be further away than both has neither the least margin nor the least
    // clearance.
    const double beyond = std::max(std::get<1>(least) + c.required, answer.least);
    if (std::get<0>(least) && beyond < std::numeric_limits<double>::max() &&
        proved_beyond(c.pair, beyond))
      continue;
    const double found =
        test.clearance(placed(pairs[c.pair].a), placed(pairs[c.pair].b), &warm_start[c.pair]);
    nearer = nearer || found < answer.least;
    answer.least = std::min(answer.least, found);
    if (const std::tuple mine{found > 0, found - c.required, c.pair}; mine < least) {
      nearer = true;
      least = mine;
      answer.distance = found;
      answer.pair = pairs[c.pair];
      answer.required = c.required;
    }
  }
  return nearer ? std::optional(answer) : std::nullopt;
}

std::vector<std::optional<World::Query::BodyClearance>> World::Query::body_clearances(
    const Config& q) {
  impl_->move_to(q);
  return impl_->nearest_of_bodies();
}

std::vector<std::optional<World::Query::BodyClearance>> World::Query::Impl::nearest_of_bodies() {
  place_bodies();
  const auto& pairs = world->pairs;
  std::vector<std::pair<double, std::size_t>> order;  // least possible distance, m, and pair
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const BodyPair& p = pairs[k];
    if (!world->may_touch[k])
      order.emplace_back(
          distance_bound(bound(p.a), placed_bound(p.a), bound(p.b), placed_bound(p.b)), k);
  }
  std::sort(order.begin(), order.end());
  constexpr double kMost = std::numeric_limits<double>::max();
  // By body: distance and pair.
  std::vector<std::pair<double, std::size_t>> least(bounds.size(), {kMost, pairs.size()});
  for (const auto& [at_least, k] : order) {
    auto &a = least[static_cast<std::size_t>(pairs[k].a)],
         &b = least[static_cast<std::size_t>(pairs[k].b)];
    // A pair that is proved to be further away than the nearest one of either body is of no use.
    const double beyond = std::max(a.first, b.first);
    if (beyond < kMost && (at_least - kBoundSafety > beyond || proved_beyond(k, beyond))) continue;
    const std::pair found{test.clearance(placed(pairs[k].a), placed(pairs[k].b), &warm_start[k]),
                          k};
    a = std::min(a, found);
    b = std::min(b, found);
  }
  std::vector<std::optional<BodyClearance>> answer(least.size());
  for (std::size_t body = 0; body < least.size(); ++body)
    if (const auto& [distance, k] = least[body]; k < pairs.size())
      answer[body] = BodyClearance{distance, pairs[k]};
  return answer;
}

std::optional<std::array<Vector3d, 2>> World::Query::nearest_points(const Config& q,
                                                                    const Clearance& clearance) {
  impl_->move_to(q);
  impl_->place_bodies();
  return detail::nearest_points(impl_->placed(clearance.pair.a), impl_->placed(clearance.pair.b),
                                clearance.distance);
}

std::optional<Vector3d> World::Query::common_point(const Config& q, const BodyPair& pair) {
  impl_->move_to(q);
  impl_->place_bodies();
  return detail::common_point(impl_->placed(pair.a), impl_->placed(pair.b));
}

Depth World::Query::depth(const Config& q, const BodyPair& pair, double from) {
  impl_->move_to(q);
  impl_->place_body(pair.a);
  impl_->place_body(pair.b);
  const double apart = distance_bound(impl_->bound(pair.a), impl_->placed_bound(pair.a),
                                      impl_->bound(pair.b), impl_->placed_bound(pair.b));
  if (kBoundSafety - apart <= from)
    return {std::numeric_limits<double>::lowest(), kBoundSafety - apart};
  return detail::depth(impl_->placed(pair.a), impl_->placed(pair.b), from);
}

CollisionCounters World::Query::counters() const {
  CollisionCounters counters = impl_->own;
  counters += impl_->test.counters();
  return counters;
}

}  // namespace swivel
