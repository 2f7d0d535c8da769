// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/problem/shape.hpp"

namespace swivel {

/// Capsules, or spheres where these do as well, whose union contains a mesh, its inside too where it is closed.
struct CapsuleFit {
  std::vector<PlacedShape> capsules;  ///< in the mesh's frame
  double volume = 0;                  ///< m^3, the sum of theirs: what they share counts twice
  double excess = 0;                  ///< m, by which their hull stands further out than the mesh's where it does so most
};

/// At most `most` of them, fewer where one more takes away less than a twentieth of the volume. One capsule has the least volume of
/// a search over directions of its axis; along it the points are seen in their least circle (Welzl 1991). More capsules take the
/// parts that planes cut off, each with all corners of its cut: capsules are convex, so the section is in both of two neighbours.
/// Ends and radii are multiples of 1e-6 m, radii rounded up: numbers that a file can say. Deterministic.
[[nodiscard]] CapsuleFit fit_capsules(const TriangleMesh& mesh, int most);

}  // namespace swivel
