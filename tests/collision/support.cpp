// SPDX-License-Identifier: BSD-3-Clause
#include "support.hpp"

#include <cmath>
#include <cstdlib>
#include <iostream>

namespace swivel::testing {

namespace {

std::uint64_t test_seed() {
  static const std::uint64_t seed = [] {
    const char* text = std::getenv("SWIVEL_TEST_SEED");
    const std::uint64_t value = text ? std::strtoull(text, nullptr, 10) : 1;
    std::cout << "SWIVEL_TEST_SEED=" << value << std::endl;
    return value;
  }();
  return seed;
}

/// Appends the grid of (n + 1) x (m + 1) points at(i, j) as triangles; normal along d/di x d/dj.
template <class At>
void add_grid(TriangleMesh& mesh, int n, int m, const At& at) {
  const int base = static_cast<int>(mesh.vertices.size());
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= m; ++j) mesh.vertices.push_back(at(i, j));
  const auto id = [&](int i, int j) { return base + i * (m + 1) + j; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      mesh.triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      mesh.triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
}

}  // namespace

Random::Random(std::uint64_t stream) : engine_(test_seed() * 1000003 + stream) {}
double Random::uniform(double low, double high) {
  return low + static_cast<double>(engine_() >> 11) * 0x1.0p-53 * (high - low);
}
int Random::index(int count) {
  return static_cast<int>(engine_() % static_cast<std::uint64_t>(count));
}
Vector3d Random::vector(double low, double high) {
  Vector3d v;
  for (int k = 0; k < 3; ++k) v[k] = uniform(low, high);
  return v;
}
Matrix3d Random::rotation() {
  Eigen::Vector4d v;
  do {
    for (int k = 0; k < 4; ++k) v[k] = uniform(-1, 1);
  } while (v.squaredNorm() > 1 || v.squaredNorm() < 1e-3);
  return Quaterniond(v.normalized()).toRotationMatrix();
}
Pose Random::pose(double range) {
  Pose pose = Pose::Identity();
  pose.linear() = rotation();
  pose.translation() = vector(-range, range);
  return pose;
}
Config Random::config(double range) {
  Config q;
  for (int j = 0; j < kDof; ++j) q[j] = uniform(-range, range);
  return q;
}

std::string numbered(const std::string& name, int number) {
  std::string result = name;
  return result.append(std::to_string(number));
}

Shape random_shape(int kind, Random& random) {
  const double r = random.uniform(0.02, 0.12);
  switch (kind) {
    case 0:
      return Sphere{r};
    case 1:
      return Capsule{r, random.uniform(0.02, 0.3)};
    case 2:
      return Box{random.vector(0.03, 0.3)};
    case 3:
      return Cylinder{r, random.uniform(0.02, 0.3)};
    case 4:
      return as_mesh(random.index(2) ? box_mesh(random.vector(0.05, 0.3), 2) : sphere_mesh(r, 5),
                     "closed");
    case 5:
      return as_mesh(tube_mesh(r, random.uniform(0.1, 0.3), 12), "open");
    default:
      return as_mesh(torus_mesh(0.12, 0.04, 8), "torus");
  }
}

MeshPtr as_mesh(TriangleMesh mesh, const std::string& name) {
  mesh.source = name;
  mesh.closed = is_closed(mesh);
  return std::make_shared<const TriangleMesh>(std::move(mesh));
}

TriangleMesh box_mesh(const Vector3d& size, int n) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      add_grid(mesh, n, n, [&](int i, int j) {
        const double a = 2.0 * (side > 0 ? i : j) / n - 1, b = 2.0 * (side > 0 ? j : i) / n - 1;
        Vector3d p;
        p[axis] = side;
        p[(axis + 1) % 3] = a;
        p[(axis + 2) % 3] = b;
        return Vector3d(p.cwiseProduct(size / 2));
      });
  return mesh;
}

TriangleMesh sphere_mesh(double radius, int n) {
  TriangleMesh mesh;
  add_grid(mesh, n, 2 * n, [&](int i, int j) {
    if (i == 0 || i == n) return Vector3d(0, 0, i == 0 ? radius : -radius);
    const double theta = kPi * i / n, phi = kTwoPi * (j % (2 * n)) / (2 * n);
    return Vector3d(radius * std::sin(theta) * std::cos(phi),
                    radius * std::sin(theta) * std::sin(phi), radius * std::cos(theta));
  });
  return mesh;
}

TriangleMesh torus_mesh(double ring, double tube, int n) {
  TriangleMesh mesh;
  add_grid(mesh, 2 * n, n, [&](int i, int j) {
    const double u = kTwoPi * (i % (2 * n)) / (2 * n), v = kTwoPi * (j % n) / n;
    const double r = ring + tube * std::cos(v);
    return Vector3d(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
  });
  return mesh;
}

TriangleMesh tube_mesh(double radius, double length, int n) {
  TriangleMesh mesh;
  add_grid(mesh, n, 2, [&](int i, int j) {
    const double u = kTwoPi * (i % n) / n;
    return Vector3d(radius * std::cos(u), radius * std::sin(u), length * (j / 2.0 - 0.5));
  });
  return mesh;
}

TriangleMesh panel_mesh(double width, double height, double thickness, int n) {
  const int m = 2 * n;
  const auto at = [&](int i, int j, double side) {
    const double x = width * (static_cast<double>(i) / m - 0.5),
                 y = height * (static_cast<double>(j) / n - 0.5);
    return Vector3d(
        x, y, 0.15 * std::cos(2 * x / width) * std::cos(1.5 * y / height) + side * thickness / 2);
  };
  TriangleMesh mesh;
  add_grid(mesh, m, n, [&](int i, int j) { return at(i, j, 1); });
  add_grid(mesh, n, m, [&](int j, int i) { return at(i, j, -1); });
  add_grid(mesh, m, 1, [&](int i, int k) { return at(i, 0, k == 0 ? -1 : 1); });
  add_grid(mesh, 1, m, [&](int k, int i) { return at(i, n, k == 0 ? -1 : 1); });
  add_grid(mesh, 1, n, [&](int k, int j) { return at(0, j, k == 0 ? -1 : 1); });
  add_grid(mesh, n, 1, [&](int j, int k) { return at(m, j, k == 0 ? -1 : 1); });
  return mesh;
}

void move(TriangleMesh& mesh, const Pose& pose) {
  for (Vector3d& v : mesh.vertices) v = pose * v;
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh = a;
  const int base = static_cast<int>(a.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles)
    mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  return mesh;
}

RobotModel capsule_arm() {
  struct Part {
    double joint_z, radius, length;  // joint above its parent; capsule along z from the joint
  };
  constexpr Part kParts[7] = {{0.15, 0.08, 0.1},  {0.19, 0.08, 0.12}, {0.21, 0.075, 0.1},
                              {0.19, 0.07, 0.12}, {0.21, 0.065, 0.1}, {0.19, 0.06, 0.05},
                              {0.08, 0.04, 0.12}};
  RobotModel robot;
  robot.name = robot.source = "capsule_arm";
  robot.links.push_back({"l0", {{Box{Vector3d(0.2, 0.2, 0.1)}, Pose::Identity()}}, -1});
  for (int j = 0; j < 7; ++j) {
    const Part& part = kParts[j];
    Joint joint;
    joint.name = numbered("j", j + 1);
    joint.type = Joint::Type::kRevolute;
    joint.parent_link = j;
    joint.child_link = j + 1;
    joint.origin.translation().z() = part.joint_z;
    joint.axis = j % 2 == 0 ? Vector3d::UnitZ() : Vector3d::UnitY();
    joint.lower = -2.9;
    joint.upper = 2.9;
    robot.joints.push_back(joint);
    Pose pose = Pose::Identity();
    pose.translation().z() = part.length / 2;
    robot.links.push_back({numbered("l", j + 1), {{Capsule{part.radius, part.length}, pose}}, j});
  }
  return robot;
}

RobotModel near_wrist_arm(double gap) {
  RobotModel robot = capsule_arm();
  Pose eccentric = Pose::Identity();  // of the centre about joint 6, which is 0.09 above the end of
                                      // link 5's axis
  eccentric.translation() = Vector3d(1.1 * gap, 0, -0.08);
  robot.links[7].collision = {{Sphere{0.09 - 0.065 - gap}, eccentric}};
  return robot;
}

PathProblem problem_for(const RobotModel& robot) {
  PathProblem problem;
  problem.source = "test";
  problem.model = std::shared_ptr<const RobotModel>(std::shared_ptr<void>(), &robot);
  problem.base_link = "l0";
  problem.tip_link = "l7";
  return problem;
}

ArmModel arm_of(const RobotModel& robot) {
  return build_arm(robot, "l0", "l7", {}, Pose::Identity());
}

}  // namespace swivel::testing
