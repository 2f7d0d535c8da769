// SPDX-License-Identifier: BSD-3-Clause
#include "world/robot_part.hpp"

#include <algorithm>
#include <limits>
#include <random>

#include "exact/pair_test.hpp"
#include "proofs/distance_proof.hpp"
#include "proofs/distances_about.hpp"
#include "swivel/core/base/timeline.hpp"
#include "world/pair_rules.hpp"

namespace swivel::detail {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kFarAway = 1e6;  // m, beyond any robot, with a square
constexpr int kSamples = 1000;
/// How many of the samples a median is taken of; an odd number. A pair keeps half of its median,
/// for which two digits suffice.
constexpr std::size_t kMedianSamples = 201;

/// A fixed pseudo-random sequence of postures inside the joint limits, as displacements of the
/// rigid groups.
class Samples {
 public:
  explicit Samples(const Chain& chain) : chain_(&chain) {}
  std::vector<Pose> next() {
    Config q;
    for (int j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain_->limit[j];
      const double lower = limit.continuous ? -kPi : limit.lower,
                   upper = limit.continuous ? kPi : limit.upper;
      // The standard library's distributions differ by vendor.
      q[j] = lower + static_cast<double>(random_() >> 11) * 0x1.0p-53 * (upper - lower);
    }
    return chain_->all_displacements(q);
  }

 private:
  const Chain* chain_;
  std::mt19937_64 random_{20141};
};

/// A pair of the robot's bodies at one posture.
struct PlacedPair {
  PlacedPair(const RobotPart& part, const BodyPair& pair, const std::vector<Pose>& moved)
      : shape_a(&part.shapes[pair.a]),
        shape_b(&part.shapes[pair.b]),
        pose_a(pose(part.bodies[pair.a], moved)),
        pose_b(pose(part.bodies[pair.b], moved)) {}
  static Pose pose(const RobotBody& body, const std::vector<Pose>& moved) {
    return moved[body.group] * body.pose;
  }
  [[nodiscard]] PlacedShapeRef a() const { return {shape_a, &pose_a}; }
  [[nodiscard]] PlacedShapeRef b() const { return {shape_b, &pose_b}; }
  [[nodiscard]] DistanceProof prove(double d) const {
    if (proved_apart(shape_a->bound, place(shape_a->bound, pose_a), shape_b->bound,
                     place(shape_b->bound, pose_b), d + kVerdictBand))
      return DistanceProof::kFree;
    return prove_distance(a(), b(), d);
  }
  [[nodiscard]] bool touching(PairTest& fcl) const {
    const DistanceProof proof = prove(0);
    return proof == DistanceProof::kNone ? fcl.below(a(), b(), 0)
                                         : proof == DistanceProof::kColliding;
  }
  const FclShape *shape_a, *shape_b;
  Pose pose_a, pose_b;
};

/// Returns a warning for each joint that moves no collision shape: what it moves is kept clear of
/// nothing.
std::vector<std::string> shapeless_links(const RobotModel& robot, const ArmModel& arm,
                                         const std::vector<RobotBody>& bodies) {
  std::vector<bool> has_shape(kDof + 1 + arm.chain.followers.size());
  for (const RobotBody& body : bodies) has_shape[body.group] = true;
  if (std::find(has_shape.begin() + 1, has_shape.end(), true) == has_shape.end())
    return {robot.name + ": the arm has no collision shape at all: it is kept clear of nothing"};
  std::vector<std::string> warnings;
  // a roll is no joint of the arm
  for (std::size_t group = 1; group <= (arm.chain.roll ? kDof - 1 : kDof); ++group) {
    if (has_shape[group]) continue;
    std::string links;
    for (std::size_t l = 0; l < robot.links.size(); ++l)
      if (arm.links[l].group == static_cast<int>(group))
        links += (links.empty() ? "" : ", ") + robot.links[l].name;
    warnings.push_back(links + ": no collision shape on what joint " +
                       arm.chain.joint_names[group - 1] + " moves: it is kept clear of nothing");
  }
  return warnings;
}

/// Returns the median clearance, m, from which on a pair keeps what other pairs keep and needs no
/// extra midpoints on motions.
double far_enough(const Limits& limits) {
  constexpr double kNoBurden = 0.01;
  return std::max(
      {2 * limits.d_self(), 4 * limits.d_self_edge(), 2 * limits.edge_tolerance, kNoBurden});
}

}  // namespace

RobotPart::RobotPart(const RobotModel& robot, const ArmModel& arm, const Problem& problem,
                     MeshStore& meshes, const Budget& budget)
    : chain(arm.chain),
      bodies(robot_bodies(robot, arm, problem.attached)),
      followers(follower_motion(chain, bodies)),
      warnings_(shapeless_links(robot, arm, bodies)) {
  for (const RobotBody& body : bodies) {
    budget.poll();
    shapes.push_back(make_fcl_shape(body.shape, meshes));
  }
  const auto attached = [&](int i) { return bodies[i].attached; };
  for (const BodyPair& pair : candidate_robot_pairs(robot, bodies))
    candidates_.push_back({pair, !robot.has_srdf || attached(pair.a) || attached(pair.b)});
  medians_.assign(candidates_.size(), kFar);
  drop_always_touching(budget);
  find_medians(far_enough(problem.limits), budget);
}

void RobotPart::drop_always_touching(const Budget& budget) {
  const TraceSpan span("pairs that touch by design");
  std::vector<Candidate*> open;
  for (Candidate& candidate : candidates_)
    if (candidate.sampled) open.push_back(&candidate);
  Samples samples(chain);
  PairTest fcl(PairTest::Meshes::kNear);
  for (int sample = 0; sample < kSamples && !open.empty(); ++sample) {
    const auto moved = samples.next();
    std::erase_if(open, [&](const Candidate* c) {
      budget.poll();
      return !PlacedPair(*this, c->pair, moved).touching(fcl);
    });
  }
  for (Candidate* candidate : open) candidate->dropped = true;
}

double RobotPart::median(const BodyPair& pair, double far,
                         const std::vector<std::vector<Pose>>& samples,
                         const Budget& budget) const {
  constexpr std::size_t kHalf = kMedianSamples / 2;
  std::vector<const std::vector<Pose>*> near;
  near.reserve(samples.size());
  for (const auto& moved : samples) {
    budget.poll();
    if (far == kFar || PlacedPair(*this, pair, moved).prove(far) != DistanceProof::kFree)
      near.push_back(&moved);
    const std::size_t asked = static_cast<std::size_t>(&moved - samples.data()) + 1;
    if (asked - near.size() > kHalf) return kFar;
  }
  PairTest fcl(PairTest::Meshes::kNear);
  TrianglePair warm_start;
  const auto exact = [&](const std::vector<Pose>& moved) {
    budget.poll();
    const PlacedPair placed(*this, pair, moved);
    return fcl.clearance(placed.a(), placed.b(), &warm_start);
  };
  const auto middle_of = [&](std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(kHalf);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  // Our own triangle distances show which samples decide the median; only about these FCL has to be
  // asked.
  const PlacedPair first(*this, pair, *near.front());
  const bool triangles = are_triangles(first.a(), first.b());
  std::vector<double> clearances;
  if (triangles)
    clearances = distances_about(near.size(), kHalf, kFarAway, 3 * kTriangleBand,
                                 [&](std::size_t k, double enough, double limit) {
                                   budget.poll();
                                   const PlacedPair placed(*this, pair, *near[k]);
                                   return triangle_distance(placed.a(), placed.b(), enough, limit,
                                                            warm_start);
                                 });
  else
    for (const auto* moved : near) clearances.push_back(exact(*moved));
  const double middle = middle_of(clearances);
  if (!triangles) return middle;
  for (std::size_t k = 0; k < near.size(); ++k)
    if (std::abs(clearances[k] - middle) <= 2 * kTriangleBand) clearances[k] = exact(*near[k]);
  return middle_of(clearances);
}

std::shared_ptr<const RobotPart> RobotPart::for_limits(const std::shared_ptr<const RobotPart>& part,
                                                       const Limits& limits, const Budget& budget) {
  if (far_enough(limits) <= part->medians_up_to_) return part;
  auto more = std::make_shared<RobotPart>(*part);
  more->find_medians(far_enough(limits), budget);
  return more;
}

void RobotPart::find_medians(double far, const Budget& budget) {
  const TraceSpan span("medians of robot pairs");
  std::vector<std::vector<Pose>> samples;
  Samples random(chain);
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    if (!candidates_[k].sampled || candidates_[k].dropped || medians_[k] < medians_up_to_) continue;
    while (samples.size() < kMedianSamples) samples.push_back(random.next());
    medians_[k] = median(candidates_[k].pair, far, samples, budget);
  }
  medians_up_to_ = far;
}

std::vector<RobotPair> RobotPart::pairs_with_medians(const Limits& limits) const {
  RobotPart all = *this;
  all.find_medians(kFar, {});
  return all.pairs(limits);
}

std::vector<RobotPair> RobotPart::pairs(const Limits& limits) const {
  std::vector<RobotPair> pairs;
  pairs.reserve(candidates_.size());
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    const double m = medians_[k], h = limits.edge_tolerance;
    RobotPair pair;
    pair.pair = candidates_[k].pair;
    pair.dropped = candidates_[k].dropped;
    if (!pair.dropped) {
      pair.median = m;
      // Even if the median is nearly zero, the tolerance stays large enough for a proof.
      pair.required = {std::min(limits.d_self(), m / 2), std::min(limits.d_self_edge(), m / 4),
                       std::min(h, std::max(m / 2, kVerdictBand))};
      pair.near = m < far_enough(limits);
      pair.reduced = pair.required.node < limits.d_self() ||
                     pair.required.motion < limits.d_self_edge() || pair.required.tolerance < h;
    }
    pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace swivel::detail
