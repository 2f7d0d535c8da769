// SPDX-License-Identifier: BSD-3-Clause
// What is found out of two bodies, how exactly, and what it took.
#pragma once
#include <cstdint>

namespace swivel {

/// Half width of the band of clearances about a threshold, m, in which no certificate answers, and by which FCL may err. Within it
/// FCL decides, save for two bodies of triangles: our own trees of triangles decide about them down to 1 um. docs/model.md.
inline constexpr double kVerdictBand = 0.05e-3;

/// How deep two bodies are in each other, m: the greatest sum, over all points of space, of how deep the point lies beneath the
/// surface of one body and beneath that of the other, where a point outside of a body counts by its distance from it, less than
/// zero. So bodies that are apart have minus their distance. As the bodies move, the depth changes by no more than they do; no
/// translation by less takes them apart; a body that contains another is as deep or deeper. A mesh that is not closed has no
/// inside.
struct Depth {
  double at_least = 0;  ///< minus infinity where nothing is known
  double at_most = 0;   ///< infinity where nothing is known: of two meshes, and of meshes that are not closed
};

/// Work counted per query object; add up over threads.
struct CollisionCounters {
  std::int64_t fcl_calls = 0;            ///< fcl::collide and fcl::distance
  std::int64_t fcl_failures = 0;         ///< of those, the ones that threw; the bodies then count as touching
  std::int64_t certified_free = 0;       ///< first_below: answers "none" that needed no FCL
  std::int64_t certified_colliding = 0;  ///< first_below: pairs found without FCL
  std::int64_t pairs_kept = 0;           ///< next_below: pairs that a clearance kept proved free
  CollisionCounters& operator+=(const CollisionCounters& o) {
    fcl_calls += o.fcl_calls;
    fcl_failures += o.fcl_failures;
    certified_free += o.certified_free;
    certified_colliding += o.certified_colliding;
    pairs_kept += o.pairs_kept;
    return *this;
  }
};

}  // namespace swivel
