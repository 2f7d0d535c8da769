// SPDX-License-Identifier: BSD-3-Clause
// Types and tolerances of the answers to collision queries.
#pragma once
#include <cstdint>

namespace swivel {

/// Half width of the band of clearances about a threshold, m, within which no distance proof
/// answers and by which FCL may err. Within the band FCL decides, except about two bodies of
/// triangles, about which Swivel's own trees of triangles decide down to 1 um. docs/model.md.
inline constexpr double kVerdictBand = 0.05e-3;

/// Bounds of the penetration depth of two bodies, m. The depth is the greatest sum, over all points
/// of space, of how deep the point lies beneath the surface of one body and beneath that of the
/// other; a point outside of a body counts by its distance from it, as a negative number. Bodies
/// that are apart therefore have minus their distance. If the bodies move, the depth changes by no
/// more than they do; no translation by less than the depth separates them; a body that contains
/// another is at least as deep as that one. A mesh that is not closed has no inside.
struct Depth {
  double at_least = 0;  ///< minus infinity where nothing is known
  /// Infinity where nothing is known: for meshes that are not closed, and where a search ends as
  /// soon as the bodies are found to be deeper than asked.
  double at_most = 0;
};

/// Work counters of one query object. Add them up over threads.
struct CollisionCounters {
  std::int64_t fcl_calls = 0;         ///< fcl::collide and fcl::distance
  std::int64_t fcl_failures = 0;      ///< calls that threw; the bodies then count as touching
  std::int64_t proved_free = 0;       ///< answers "no pair" that needed no FCL
  std::int64_t proved_colliding = 0;  ///< pairs found without FCL
  std::int64_t pairs_kept = 0;        ///< pairs proved free by a clearance kept from before
  CollisionCounters& operator+=(const CollisionCounters& o) {
    fcl_calls += o.fcl_calls;
    fcl_failures += o.fcl_failures;
    proved_free += o.proved_free;
    proved_colliding += o.proved_colliding;
    pairs_kept += o.pairs_kept;
    return *this;
  }
};

}  // namespace swivel
