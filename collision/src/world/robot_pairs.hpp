// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "shapes/fcl_shapes.hpp"
#include "swivel/collision/world/world.hpp"

namespace swivel::detail {

/// Returns at each call the next posture of a fixed sequence, as the displacements of the rigid
/// groups from q = 0, base frame.
using Postures = std::function<std::vector<Pose>()>;

/// Bodies of a robot and the postures that it may take.
struct SampledBodies {
  std::span<const RobotBody> bodies;
  std::span<const FclShape> shapes;    ///< of the bodies
  std::function<Postures()> postures;  ///< begins the sequence of postures
};

/// A pair of bodies that may have to keep clear.
struct CandidatePair {
  BodyPair pair;  ///< indices into the bodies
  /// True: no SRDF speaks for it, so that postures are sampled.
  bool sampled = false;
  bool dropped = false;  ///< it touches in all sampled postures
};

/// The pairs of robot bodies that must keep clear, and what sampled postures say about them
/// (swivel::RobotPair). Every function that takes a budget throws Stopped once it is spent.
class RobotPairs {
 public:
  explicit RobotPairs(std::vector<CandidatePair> candidates);
  /// Drops the sampled pairs that touch in every posture.
  void drop_always_touching(const SampledBodies& of, const Budget& budget);
  /// Finds the median clearances of sampled pairs, as far as these limits need them.
  void find_medians(const SampledBodies& of, const Limits& limits, const Budget& budget);
  /// Finds the median clearance of every sampled pair, however far.
  void find_all_medians(const SampledBodies& of);
  /// Returns true if medians are known as far as these limits need them.
  [[nodiscard]] bool suffices(const Limits& limits) const;
  /// Returns the pairs by a problem's limits, whose medians must be known.
  [[nodiscard]] std::vector<RobotPair> pairs(const Limits& limits) const;

 private:
  void find_medians(const SampledBodies& of, double far, const Budget& budget);
  std::vector<CandidatePair> candidates_;
  double medians_up_to_ = 0;     // m
  std::vector<double> medians_;  // by candidate; infinite from medians_up_to_ on
};

/// Returns a joint configuration inside the limits of a chain, rad; continuous joints are within
/// half a turn. `random` draws 64 bits.
template <class Random>
[[nodiscard]] Config sampled_config(const Chain& chain, Random& random) {
  Config q;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[j];
    const double lower = limit.continuous ? -kPi : limit.lower,
                 upper = limit.continuous ? kPi : limit.upper;
    // The standard library's distributions differ by vendor.
    q[j] = lower + static_cast<double>(random() >> 11) * 0x1.0p-53 * (upper - lower);
  }
  return q;
}

}  // namespace swivel::detail
