// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <random>
#include <string>

#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel::testing {

/// Draws numbers from the seed SWIVEL_TEST_SEED, or 1, which is printed, so that a failure can be
/// run again. The seed is mixed with `stream`, so that tests differ.
class Random {
 public:
  explicit Random(std::uint64_t stream);
  double uniform(double low, double high);
  int index(int count);
  Vector3d vector(double low, double high);
  Matrix3d rotation();
  /// Draws a pose turned at random, with a translation in [-range, range]^3.
  Pose pose(double range);
  Config config(double range);

 private:
  std::mt19937_64 engine_;
};

/// Joins a name and a number: "l" and 3 become "l3".
std::string numbered(const std::string& name, int number);

MeshPtr as_mesh(TriangleMesh mesh, const std::string& name);
inline const std::vector<std::string> kKinds{"sphere",      "capsule",   "box",  "cylinder",
                                             "closed mesh", "open mesh", "torus"};
/// Draws a shape of a kind, 0 ... kKinds.size() - 1, that is some 0.1 m large.
Shape random_shape(int kind, Random& random);
/// Returns a closed box with edges of length `size`, each side cut into n x n squares.
TriangleMesh box_mesh(const Vector3d& size, int n);
/// Returns a closed sphere of circles of latitude and longitude.
TriangleMesh sphere_mesh(double radius, int n);
/// Returns a closed torus.
TriangleMesh torus_mesh(double ring, double tube, int n);
/// Returns a pipe along z without ends: an open mesh.
TriangleMesh tube_mesh(double radius, double length, int n);
/// Returns a closed, doubly curved plate like a car door, with its normal along z and about
/// 2 * (2 n) * n * 2 triangles.
TriangleMesh panel_mesh(double width, double height, double thickness, int n);
void move(TriangleMesh& mesh, const Pose& pose);
TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b);

/// Returns an upright arm like the usual 7-axis ones: links l0 ... l7, joints j1 ... j7, one
/// capsule each (l0: a box).
RobotModel capsule_arm();
/// Returns an arm like capsule_arm() whose links 5 and 7 are about `gap`, m, apart at all joint
/// values, and 1.1 gap nearer where sin q6 cos q7 = 1.
RobotModel near_wrist_arm(double gap);
/// Returns a problem with base l0, tip l7 and no scene; the caller fills in the rest. `robot` must
/// outlive it.
PathProblem problem_for(const RobotModel& robot);
ArmModel arm_of(const RobotModel& robot);

}  // namespace swivel::testing
