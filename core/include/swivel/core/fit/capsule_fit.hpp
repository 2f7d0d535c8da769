// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/problem/shape.hpp"

namespace swivel {

/// Capsules (spheres where these suffice) whose union contains a mesh, with its inside where it is
/// closed.
struct CapsuleFit {
  std::vector<PlacedShape> capsules;  ///< in the mesh's frame
  /// Sum of the capsules' volumes, m^3; what they share counts twice.
  double volume = 0;
  /// The most by which the hull of the capsules stands out beyond that of the mesh, m.
  double excess = 0;
};

/// Encloses a mesh in at most `most` capsules, fewer where one more takes away less than a
/// twentieth of the volume. A single capsule has the least volume of a search over directions of
/// its axis; along it the points are enclosed in their smallest circle (Welzl 1991). Of several,
/// each encloses a part that planes cut off, with all corners of its cut: capsules are convex, so
/// both neighbours contain the section. Ends and radii are multiples of 1e-6 m, radii rounded up,
/// so that a file can state them exactly. Deterministic.
[[nodiscard]] CapsuleFit fit_capsules(const TriangleMesh& mesh, int most);

}  // namespace swivel
