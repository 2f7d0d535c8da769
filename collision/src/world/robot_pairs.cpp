// SPDX-License-Identifier: BSD-3-Clause
#include "world/robot_pairs.hpp"

#include <algorithm>
#include <limits>

#include "exact/pair_test.hpp"
#include "proofs/distance_proof.hpp"
#include "proofs/distances_about.hpp"
#include "swivel/core/base/timeline.hpp"

namespace swivel::detail {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kFarAway = 1e6;  // m, beyond any robot, with a square
constexpr int kSamples = 1000;
/// How many of the samples a median is taken of; an odd number. A pair keeps half of its median,
/// for which two digits suffice.
constexpr std::size_t kMedianSamples = 201;

/// A pair of the robot's bodies at one posture.
struct PlacedPair {
  PlacedPair(const SampledBodies& of, const BodyPair& pair, const std::vector<Pose>& moved)
      : shape_a(&of.shapes[pair.a]),
        shape_b(&of.shapes[pair.b]),
        pose_a(pose(of.bodies[pair.a], moved)),
        pose_b(pose(of.bodies[pair.b], moved)) {}
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

/// Returns the median clearance of a pair over samples, m; infinite where it is `far` or more.
double median(const SampledBodies& of, const BodyPair& pair, double far,
              const std::vector<std::vector<Pose>>& samples, const Budget& budget) {
  constexpr std::size_t kHalf = kMedianSamples / 2;
  std::vector<const std::vector<Pose>*> near;
  near.reserve(samples.size());
  for (const auto& moved : samples) {
    budget.poll();
    if (far == kFar || PlacedPair(of, pair, moved).prove(far) != DistanceProof::kFree)
      near.push_back(&moved);
    const std::size_t asked = static_cast<std::size_t>(&moved - samples.data()) + 1;
    if (asked - near.size() > kHalf) return kFar;
  }
  PairTest fcl(PairTest::Meshes::kNear);
  TrianglePair warm_start;
  const auto exact = [&](const std::vector<Pose>& moved) {
    budget.poll();
    const PlacedPair placed(of, pair, moved);
    return fcl.clearance(placed.a(), placed.b(), &warm_start);
  };
  const auto middle_of = [&](std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(kHalf);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  // Our own triangle distances show which samples decide the median; only about these FCL has to be
  // asked.
  const PlacedPair first(of, pair, *near.front());
  const bool triangles = are_triangles(first.a(), first.b());
  std::vector<double> clearances;
  if (triangles)
    clearances = distances_about(near.size(), kHalf, kFarAway, 3 * kTriangleBand,
                                 [&](std::size_t k, double enough, double limit) {
                                   budget.poll();
                                   const PlacedPair placed(of, pair, *near[k]);
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

/// Returns the median clearance, m, from which on a pair keeps what other pairs keep and needs no
/// extra midpoints on motions.
double far_enough(const Limits& limits) {
  constexpr double kNoBurden = 0.01;
  return std::max(
      {2 * limits.d_self(), 4 * limits.d_self_edge(), 2 * limits.edge_tolerance, kNoBurden});
}

}  // namespace

RobotPairs::RobotPairs(std::vector<CandidatePair> candidates)
    : candidates_(std::move(candidates)), medians_(candidates_.size(), kFar) {}

void RobotPairs::drop_always_touching(const SampledBodies& of, const Budget& budget) {
  const TraceSpan span("pairs that touch by design");
  std::vector<CandidatePair*> open;
  for (CandidatePair& candidate : candidates_)
    if (candidate.sampled) open.push_back(&candidate);
  const Postures samples = of.postures();
  PairTest fcl(PairTest::Meshes::kNear);
  for (int sample = 0; sample < kSamples && !open.empty(); ++sample) {
    const auto moved = samples();
    std::erase_if(open, [&](const CandidatePair* c) {
      budget.poll();
      return !PlacedPair(of, c->pair, moved).touching(fcl);
    });
  }
  for (CandidatePair* candidate : open) candidate->dropped = true;
}

void RobotPairs::find_medians(const SampledBodies& of, const Limits& limits, const Budget& budget) {
  find_medians(of, far_enough(limits), budget);
}
void RobotPairs::find_medians(const SampledBodies& of, double far, const Budget& budget) {
  const TraceSpan span("medians of robot pairs");
  std::vector<std::vector<Pose>> samples;
  const Postures random = of.postures();
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    if (!candidates_[k].sampled || candidates_[k].dropped || medians_[k] < medians_up_to_) continue;
    while (samples.size() < kMedianSamples) samples.push_back(random());
    medians_[k] = median(of, candidates_[k].pair, far, samples, budget);
  }
  medians_up_to_ = far;
}

void RobotPairs::find_all_medians(const SampledBodies& of) {
  find_medians(of, kFar, {});
}

bool RobotPairs::suffices(const Limits& limits) const {
  return far_enough(limits) <= medians_up_to_;
}

std::vector<RobotPair> RobotPairs::pairs(const Limits& limits) const {
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
