// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/collision/arms/inter_arm_world.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>

#include "exact/depth.hpp"
#include "exact/nearest_points.hpp"
#include "exact/pair_test.hpp"
#include "proofs/distance_proof.hpp"
#include "swivel/core/base/timeline.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "world/pair_rules.hpp"
#include "world/robot_pairs.hpp"

namespace swivel {

using namespace detail;

namespace {

/// Added to bounds, which are exact up to rounding, m.
constexpr double kRounding = 1e-6;
/// Bodies whose poses are equal when rounded to this (m, and entries of rotations) stand alike: no
/// point of a body of up to 10 m differs by more than a tenth of kAlike.
constexpr double kSamePose = 1e-8;
/// What a pair must be nearer than it should, m, at one of several poses that are alike.
constexpr double kAlike = 1e-6;

/// The entries of poses, rounded to kSamePose.
using RoundedPoses = std::vector<std::int64_t>;
void add_rounded(const Pose& pose, RoundedPoses& rounded) {
  for (Eigen::Index row = 0; row < 3; ++row)
    for (Eigen::Index column = 0; column < 4; ++column)
      rounded.push_back(std::llround(pose(row, column) / kSamePose));
}

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

}  // namespace

struct InterArmWorld::Impl {
  struct Body {
    FclShape shape;
    int arm = 0;
    int group = 0;              ///< of the arm's chain
    Pose pose;                  ///< at q = 0, base frame
    Chain::Joints joints = {};  ///< those that move it
  };
  std::array<Chain, 2> chains;
  std::vector<Body> bodies;
  std::vector<std::string> names;
  std::vector<RobotPair> pairs;
  std::vector<RobotPair> kept;      // those that are not dropped
  std::vector<std::size_t> number;  // [a * bodies + b] of `kept`
  /// Whether every pair keeps so much that stances may stand for several configurations.
  bool merges = true;
  std::vector<std::string> warnings;

  Impl(const RobotModel& robot, const std::array<ArmInPair, 2>& arms,
       const std::vector<std::array<std::string, 2>>& may_touch, const Limits& limits,
       const Budget& budget)
      : chains{arms[0].arm->chain, arms[1].arm->chain} {
    const TraceSpan span("world between arms");
    MeshStore meshes;
    std::vector<RobotBody> placed;
    std::vector<FclShape> shapes;
    for (int arm = 0; arm < 2; ++arm)
      for (RobotBody& body : robot_bodies(robot, *arms[at(arm)].arm, *arms[at(arm)].attached)) {
        if (body.group == 0) continue;
        budget.poll();
        const Chain& chain = chains[at(arm)];
        shapes.push_back(make_fcl_shape(body.shape, meshes));
        bodies.push_back(
            {shapes.back(), arm, body.group, body.pose, chain.joints_between(0, body.group)});
        names.push_back(body.name);
        body.group += arm * groups(0);
        placed.push_back(std::move(body));
      }
    find_pairs(robot, placed, shapes, may_touch, limits, budget);
    warn_of_pairs(limits);
  }

  [[nodiscard]] std::size_t place_of(const BodyPair& pair) const {
    return at(pair.a) * bodies.size() + at(pair.b);
  }
  /// Returns how many groups of bodies an arm has.
  [[nodiscard]] int groups(int arm) const {
    return static_cast<int>(kDof) + 1 + static_cast<int>(chains[at(arm)].followers.size());
  }

  void find_pairs(const RobotModel& robot, const std::vector<RobotBody>& placed,
                  const std::vector<FclShape>& shapes,
                  const std::vector<std::array<std::string, 2>>& may_touch, const Limits& limits,
                  const Budget& budget) {
    for (const auto& two : may_touch)
      for (const std::string& name : two)
        if (std::find(names.begin(), names.end(), name) == names.end())
          throw InputError(robot.source, "'" + name +
                                             "' may touch a body of the other arm: allowed are "
                                             "bodies that one of the arms moves");
    const auto touch = [&](const BodyPair& pair) {
      const std::string &a = names[at(pair.a)], &b = names[at(pair.b)];
      return std::any_of(may_touch.begin(), may_touch.end(), [&](const auto& two) {
        return (two[0] == a && two[1] == b) || (two[0] == b && two[1] == a);
      });
    };
    std::vector<CandidatePair> candidates;
    for (const BodyPair& pair : candidate_robot_pairs(robot, placed)) {
      if (bodies[at(pair.a)].arm == bodies[at(pair.b)].arm || touch(pair)) continue;
      candidates.push_back(
          {pair, !robot.has_srdf || placed[at(pair.a)].attached || placed[at(pair.b)].attached});
    }
    const SampledBodies sampled{
        placed, shapes, [this] {
          return [this, random = std::mt19937_64(20141)]() mutable {
            auto all = chains[0].all_displacements(sampled_config(chains[0], random));
            const auto other = chains[1].all_displacements(sampled_config(chains[1], random));
            all.insert(all.end(), other.begin(), other.end());
            return all;
          };
        }};
    RobotPairs found(std::move(candidates));
    found.drop_always_touching(sampled, budget);
    found.find_medians(sampled, limits, budget);
    pairs = found.pairs(limits);
    for (const RobotPair& pair : pairs)
      if (!pair.dropped) kept.push_back(pair);
    number.resize(bodies.size() * bodies.size());
    for (std::size_t k = 0; k < kept.size(); ++k) {
      number[place_of(kept[k].pair)] = k;
      merges = merges && kept[k].required.node > 2 * kAlike;
    }
  }

  void warn_of_pairs(const Limits& limits) {
    for (const RobotPair& p : pairs) {
      const std::string two = names[at(p.pair.a)] + " and " + names[at(p.pair.b)];
      if (p.dropped)
        warnings.push_back(two + " of the two arms touch in every posture: not kept apart");
      else if (p.required.node < limits.d_self())
        warnings.push_back(two + " of the two arms are near by design: they keep " +
                           formatted("%.3g mm", 1e3 * p.required.node));
    }
  }
};

struct InterArmWorld::Stances::Impl {
  struct At {
    Pose pose;
    PlacedBound bound;
  };
  int first = 0;                    // body
  std::size_t of = 1;               // bodies
  std::vector<At> at;               // by stance, then by body
  std::vector<std::size_t> stance;  // by configuration
  [[nodiscard]] const At& where(std::size_t of_stance, int body) const {
    return at[of_stance * of + static_cast<std::size_t>(body - first)];
  }
};

std::size_t InterArmWorld::Stances::stance_of(std::size_t configuration) const {
  return impl_->stance[configuration];
}
std::size_t InterArmWorld::Stances::count() const {
  return impl_->at.size() / impl_->of;
}

InterArmWorld::Stances::Stances(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
InterArmWorld::Stances::Stances(Stances&&) noexcept = default;
InterArmWorld::Stances& InterArmWorld::Stances::operator=(Stances&&) noexcept = default;
InterArmWorld::Stances::~Stances() = default;

struct InterArmWorld::Query::Impl {
  const InterArmWorld::Impl* world;
  DistanceProofs distance_proofs;
  PairTest test;
  CollisionCounters own;
  std::vector<TrianglePair> warm_start;  // by kept pair
  std::array<Config, 2> q;
  std::array<std::vector<Pose>, 2> displacements;
  std::vector<Pose> poses;
  std::vector<PlacedBound> bounds;

  Impl(const InterArmWorld::Impl& w, DistanceProofs proofs)
      : world(&w),
        distance_proofs(proofs),
        test(proofs == DistanceProofs::kOn ? PairTest::Meshes::kNear : PairTest::Meshes::kWhole),
        warm_start(w.kept.size()),
        poses(w.bodies.size()),
        bounds(w.bodies.size()) {
    for (Config& joints : q) joints.setConstant(std::numeric_limits<double>::quiet_NaN());
  }

  void move_to(const std::array<Config, 2>& to) {
    for (int arm = 0; arm < 2; ++arm) {
      if (to[at(arm)] == q[at(arm)]) continue;
      q[at(arm)] = to[at(arm)];
      displacements[at(arm)] = world->chains[at(arm)].all_displacements(q[at(arm)]);
      for (std::size_t i = 0; i < poses.size(); ++i) {
        const auto& body = world->bodies[i];
        if (body.arm != arm) continue;
        poses[i] = displacements[at(arm)][at(body.group)] * body.pose;
        bounds[i] = place(body.shape.bound, poses[i]);
      }
    }
  }

  /// Two bodies where they are.
  struct Placed {
    PlacedShapeRef a, b;
    const PlacedBound *bound_a, *bound_b;
  };
  [[nodiscard]] Placed placed(const BodyPair& p) const {
    return {{&world->bodies[at(p.a)].shape, &poses[at(p.a)]},
            {&world->bodies[at(p.b)].shape, &poses[at(p.b)]},
            &bounds[at(p.a)],
            &bounds[at(p.b)]};
  }
  /// Returns whether two bodies are nearer than d >= 0, m.
  bool below(const Placed& two, double d, TrianglePair& from) {
    if (proved_apart(two.a.shape->bound, *two.bound_a, two.b.shape->bound, *two.bound_b,
                     d + kRounding))
      return false;
    if (distance_proofs == DistanceProofs::kOn) {
      const DistanceProof proof = prove(two.a, two.b, d, 0, from).proved;
      own.proved_free += proof == DistanceProof::kFree;
      own.proved_colliding += proof == DistanceProof::kColliding;
      if (proof != DistanceProof::kNone) return proof == DistanceProof::kColliding;
    }
    return test.below(two.a, two.b, d);
  }
  bool below(std::size_t k, double d) {
    return below(placed(world->kept[k].pair), d, warm_start[k]);
  }

  [[nodiscard]] static double required(const RobotPair& pair, ClearanceRule rule, double forgiven) {
    const double asked = rule == ClearanceRule::kNode ? pair.required.node : pair.required.motion;
    return std::max(0.0, asked - forgiven) +
           (rule == ClearanceRule::kMidpoint ? pair.required.tolerance : 0.0);
  }

  /// A motion of both arms, straight in joint space, of which a pair is asked.
  struct Motion {
    std::array<Config, 2> from, change;
    double forgiven = 0;
    const Budget* budget = nullptr;
  };
  /// A pair of bodies, by its index in `kept`, on a motion: its leaves are `leaves` intervals, and
  /// its bodies come nearer by at most `bound`, m, on all of it.
  struct OnMotion {
    std::size_t pair = 0;
    double leaves = 1, bound = 0;
  };
  [[nodiscard]] OnMotion on_motion(std::size_t k,
                                   const std::array<std::array<double, kDof>, 2>& radii,
                                   const std::array<Config, 2>& change) const {
    OnMotion of{k};
    const RobotPair& pair = world->kept[k];
    for (const int body : {pair.pair.a, pair.pair.b}) {
      const auto& moved = world->bodies[at(body)];
      for (int j = moved.joints.first; j < moved.joints.last; ++j)
        of.bound += std::abs(change[at(moved.arm)][j]) * radii[at(moved.arm)][at(j)];
    }
    while (of.bound / (2 * of.leaves) > pair.required.tolerance) of.leaves *= 2;
    return of;
  }
  /// Returns a pair that comes too near on the interval of a motion about `middle` that is a share
  /// of all of it.
  std::optional<std::size_t> blocked(const Motion& motion, double middle, double share,
                                     const std::vector<OnMotion>& asked) {
    motion.budget->poll();
    move_to(
        {motion.from[0] + middle * motion.change[0], motion.from[1] + middle * motion.change[1]});
    std::vector<OnMotion> open;
    for (const OnMotion& of : asked) {
      const RobotPair& pair = world->kept[of.pair];
      const bool leaf = share * of.leaves <= 1;
      const double most = required(pair, ClearanceRule::kMidpoint, motion.forgiven) +
                          (leaf ? 0 : of.bound * share / 2);
      if (!below(of.pair, most)) continue;
      if (leaf || below(of.pair, required(pair, ClearanceRule::kMotion, motion.forgiven)))
        return of.pair;
      open.push_back(of);
    }
    if (open.empty()) return std::nullopt;
    for (const double side : {-1.0, 1.0})
      if (const auto pair = blocked(motion, middle + side * share / 4, share / 2, open))
        return pair;
    return std::nullopt;
  }
};

InterArmWorld::InterArmWorld(const RobotModel& robot, const std::array<ArmInPair, 2>& arms,
                             const std::vector<std::array<std::string, 2>>& may_touch,
                             const Limits& limits, const Budget& budget)
    : impl_(std::make_unique<Impl>(robot, arms, may_touch, limits, budget)) {}
InterArmWorld::~InterArmWorld() = default;
InterArmWorld::InterArmWorld(InterArmWorld&&) noexcept = default;
InterArmWorld& InterArmWorld::operator=(InterArmWorld&&) noexcept = default;

const std::vector<std::string>& InterArmWorld::body_names() const {
  return impl_->names;
}
std::array<std::string, 2> InterArmWorld::names(const BodyPair& pair) const {
  return {impl_->names[at(pair.a)], impl_->names[at(pair.b)]};
}
const std::vector<RobotPair>& InterArmWorld::pairs() const {
  return impl_->pairs;
}
const std::vector<std::string>& InterArmWorld::warnings() const {
  return impl_->warnings;
}

InterArmWorld::Query::Query(const InterArmWorld& world, DistanceProofs distance_proofs)
    : impl_(std::make_unique<Impl>(*world.impl_, distance_proofs)) {}
InterArmWorld::Query::~Query() = default;
InterArmWorld::Query::Query(Query&&) noexcept = default;
InterArmWorld::Query& InterArmWorld::Query::operator=(Query&&) noexcept = default;

std::optional<BodyPair> InterArmWorld::Query::find_violating_pair(const std::array<Config, 2>& q,
                                                                  ClearanceRule rule,
                                                                  double forgiven) {
  impl_->move_to(q);
  for (std::size_t k = 0; k < impl_->world->kept.size(); ++k) {
    const RobotPair& pair = impl_->world->kept[k];
    if (impl_->below(k, Impl::required(pair, rule, forgiven))) return pair.pair;
  }
  return std::nullopt;
}

std::optional<BodyPair> InterArmWorld::Query::find_deepest_pair(const std::array<Config, 2>& q) {
  impl_->move_to(q);
  std::optional<BodyPair> deepest;
  double most = std::numeric_limits<double>::lowest();
  for (std::size_t k = 0; k < impl_->world->kept.size(); ++k) {
    const RobotPair& pair = impl_->world->kept[k];
    if (!impl_->below(k, pair.required.node)) continue;
    const Impl::Placed two = impl_->placed(pair.pair);
    // The depth of two bodies that touch; minus the distance of two that do not.
    const bool touch = impl_->below(two, 0, impl_->warm_start[k]);
    const double deep = touch ? std::max(0.0, detail::depth(two.a, two.b).at_least)
                              : -impl_->test.clearance(two.a, two.b);
    if (!deepest || deep > most) deepest = pair.pair, most = deep;
  }
  return deepest;
}

std::optional<BodyPair> InterArmWorld::Query::find_pair_blocking_motion(
    const std::array<std::array<double, kDof>, 2>& radii, const std::array<Config, 2>& from,
    const std::array<Config, 2>& to, double forgiven, const Budget& budget) {
  const Impl::Motion motion{from, {to[0] - from[0], to[1] - from[1]}, forgiven, &budget};
  std::vector<Impl::OnMotion> asked;
  asked.reserve(impl_->world->kept.size());
  for (std::size_t k = 0; k < impl_->world->kept.size(); ++k)
    asked.push_back(impl_->on_motion(k, radii, motion.change));
  const auto pair = impl_->blocked(motion, 0.5, 1, asked);
  return pair ? std::optional(impl_->world->kept[*pair].pair) : std::nullopt;
}

InterArmWorld::Stances InterArmWorld::Query::stances(int arm, int body, std::span<const Config> q) {
  auto found = std::make_unique<Stances::Impl>();
  const auto& bodies = impl_->world->bodies;
  const auto of_arm = [&](const InterArmWorld::Impl::Body& one) { return one.arm == arm; };
  const auto begin = std::find_if(bodies.begin(), bodies.end(), of_arm);
  found->first = body >= 0 ? body : static_cast<int>(begin - bodies.begin());
  found->of =
      body >= 0 ? 1 : at(static_cast<int>(std::count_if(bodies.begin(), bodies.end(), of_arm)));
  std::map<RoundedPoses, std::size_t> known;
  std::vector<Pose> poses(found->of);
  for (const Config& joints : q) {
    const std::vector<Pose> displaced = impl_->world->chains[at(arm)].all_displacements(joints);
    RoundedPoses rounded;
    for (std::size_t k = 0; k < found->of; ++k) {
      const auto& one = bodies[at(found->first) + k];
      poses[k] = displaced[at(one.group)] * one.pose;
      if (impl_->world->merges) add_rounded(poses[k], rounded);
    }
    const std::size_t next = found->at.size() / found->of;
    if (!impl_->world->merges) rounded.push_back(static_cast<std::int64_t>(next));
    const auto [place_known, is_new] = known.emplace(std::move(rounded), next);
    found->stance.push_back(place_known->second);
    if (!is_new) continue;
    for (std::size_t k = 0; k < found->of; ++k)
      found->at.push_back({poses[k], place(bodies[at(found->first) + k].shape.bound, poses[k])});
  }
  return Stances(std::move(found));
}

bool InterArmWorld::Query::violates(const BodyPair& pair, const Stances& a, std::size_t i,
                                    const Stances& b, std::size_t j) {
  const std::size_t k = impl_->world->number[impl_->world->place_of(pair)];
  const Stances::Impl::At &here = a.impl_->where(i, pair.a), &there = b.impl_->where(j, pair.b);
  const Impl::Placed two{{&impl_->world->bodies[at(pair.a)].shape, &here.pose},
                         {&impl_->world->bodies[at(pair.b)].shape, &there.pose},
                         &here.bound,
                         &there.bound};
  const double required = impl_->world->kept[k].required.node;
  return impl_->below(two, impl_->world->merges ? required - kAlike : required,
                      impl_->warm_start[k]);
}

bool InterArmWorld::Query::any_violates(const Stances& a, std::size_t i, const Stances& b,
                                        std::size_t j) {
  return std::any_of(impl_->world->kept.begin(), impl_->world->kept.end(),
                     [&](const RobotPair& pair) { return violates(pair.pair, a, i, b, j); });
}

std::optional<InterArmWorld::Query::Clearance> InterArmWorld::Query::clearance(
    const std::array<Config, 2>& q) {
  impl_->move_to(q);
  std::optional<Clearance> least;
  for (std::size_t k = 0; k < impl_->world->kept.size(); ++k) {
    const RobotPair& pair = impl_->world->kept[k];
    const Impl::Placed two = impl_->placed(pair.pair);
    const double bound =
        distance_bound(two.a.shape->bound, *two.bound_a, two.b.shape->bound, *two.bound_b);
    if (least && bound - kRounding - pair.required.node > least->margin()) continue;
    const double distance = impl_->test.clearance(two.a, two.b, &impl_->warm_start[k]);
    const Clearance found{distance, pair.required.node, pair.pair};
    if (!least || found.margin() < least->margin()) least = found;
  }
  return least;
}

std::vector<std::optional<InterArmWorld::Query::Clearance>> InterArmWorld::Query::body_clearances(
    const std::array<Config, 2>& q) {
  impl_->move_to(q);
  const std::vector<RobotPair>& kept = impl_->world->kept;
  std::vector<std::pair<double, std::size_t>> order;  // least possible distance, m, and pair
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const Impl::Placed two = impl_->placed(kept[k].pair);
    order.emplace_back(
        distance_bound(two.a.shape->bound, *two.bound_a, two.b.shape->bound, *two.bound_b), k);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::optional<Clearance>> nearest(impl_->world->bodies.size());
  for (const auto& [at_least, k] : order) {
    const RobotPair& pair = kept[k];
    const auto may_be = [&](int body) {
      const auto& known = nearest[at(body)];
      return !known || at_least - kRounding <= known->distance;
    };
    if (!may_be(pair.pair.a) && !may_be(pair.pair.b)) continue;
    const Impl::Placed two = impl_->placed(pair.pair);
    const Clearance found{impl_->test.clearance(two.a, two.b, &impl_->warm_start[k]),
                          pair.required.node, pair.pair};
    for (const int body : {pair.pair.a, pair.pair.b})
      if (auto& known = nearest[at(body)]; !known || found.distance < known->distance)
        known = found;
  }
  return nearest;
}

std::optional<std::array<Vector3d, 2>> InterArmWorld::Query::nearest_points(
    const std::array<Config, 2>& q, const Clearance& clearance) {
  impl_->move_to(q);
  const Impl::Placed two = impl_->placed(clearance.pair);
  return detail::nearest_points(two.a, two.b, clearance.distance);
}

std::optional<Vector3d> InterArmWorld::Query::common_point(const std::array<Config, 2>& q,
                                                           const BodyPair& pair) {
  impl_->move_to(q);
  const Impl::Placed two = impl_->placed(pair);
  return detail::common_point(two.a, two.b);
}

CollisionCounters InterArmWorld::Query::counters() const {
  CollisionCounters counters = impl_->own;
  counters += impl_->test.counters();
  return counters;
}

}  // namespace swivel
