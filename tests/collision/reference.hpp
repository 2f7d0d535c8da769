// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/problem/shape.hpp"

namespace swivel::testing {

/// Computes the clearance of two placed shapes by closed forms, one-dimensional searches and loops
/// over all triangles: no tree, no GJK, nothing shared with the code under test. 0 when they touch
/// or one is inside the other (closed meshes are solids). Error below 1e-5 m for shapes smaller
/// than 0.5 m.
double reference_clearance(const Shape& a, const Pose& X_a, const Shape& b, const Pose& X_b);

/// Computes the winding number of the mesh about the point, by solid angles (van Oosterom and
/// Strackee 1983): 1 inside, 0 outside.
double winding_number(const TriangleMesh& mesh, const Vector3d& point);

}  // namespace swivel::testing
