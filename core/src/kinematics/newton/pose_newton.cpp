// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/newton/pose_newton.hpp"

#include <algorithm>
#include <cmath>

#include "swivel/core/base/isa.hpp"

namespace swivel {

namespace {

constexpr double kSettled = 4e-6;  // rad: after so small a step the remaining error is its square
// sine below which neighbouring axes have no common normal of their own
constexpr double kParallel = 1e-9;
constexpr double kLongest = 1;  // rad: longest step
constexpr int kLockedSteps = 8;
constexpr int kRoll = kDof - 1;

void put(const Vector3d& v, double (&to)[3]) {
  for (std::size_t r = 0; r < 3; ++r) to[r] = v[static_cast<Eigen::Index>(r)];
}

void put(const Pose& pose, double (&to)[4][3]) {
  for (std::size_t c = 0; c < 3; ++c) put(pose.linear().col(static_cast<Eigen::Index>(c)), to[c]);
  put(pose.translation(), to[3]);
}

}  // namespace

const NewtonKernels& newton_kernels() {
#ifdef SWIVEL_X86_KERNELS
  switch (active_isa()) {
    case Isa::kAvx2:
      return avx2_newton_kernels();
    case Isa::kAvx512:
      return avx512_newton_kernels();
    case Isa::kScalar:
      break;
  }
#endif
  return scalar_newton_kernels();
}

PoseNewton::PoseNewton(const Chain& chain) : arm_(chain) {
  chain_.slide = chain.slide();
  Vector3d origin = chain.point[0], z = chain.axis[0];
  Vector3d x = z.unitOrthogonal();
  put(x, chain_.first[0]);
  put(z.cross(x), chain_.first[1]);
  put(z, chain_.first[2]);
  put(origin, chain_.first[3]);
  chain_.link[kDof - 1] = {0, 0, 0, 1, 0};
  for (std::size_t k = 0; k + 1 < kDof; ++k) {
    const Vector3d &p = chain.point[k + 1], &b = chain.axis[k + 1], d = p - origin;
    Vector3d from = origin, to = p, n = z.cross(b);
    const double sine = n.norm();
    if (sine > kParallel) {
      from = origin + (d.cross(b).dot(n) / (sine * sine)) * z;
      to = p + (d.cross(z).dot(n) / (sine * sine)) * b;
      n /= sine;
    } else {
      to = p - b.dot(d) * b;
      n = to - from;
      n -= z.dot(n) * z;
      n = n.norm() > kParallel ? Vector3d(n.normalized()) : x;
    }
    // `to` lies on axis k + 1 at the height of the foot of the common normal.
    const Vector3d y = z.cross(x);
    NewtonChain::Link& link = chain_.link[k];
    link.turn = std::atan2(n.dot(y), n.dot(x));
    link.height = z.dot(to - origin);
    link.width = n.dot(to - origin);
    link.twist_cosine = z.dot(b);
    link.twist_sine = n.dot(z.cross(b));
    origin = to;
    z = b;
    x = n;
  }
  Pose frame = Pose::Identity();
  frame.linear() << x, z.cross(x), z;
  frame.translation() = origin;
  put(product(frame.inverse(Eigen::Isometry), chain.home), chain_.last);
}

NewtonTask PoseNewton::task(const Pose& tool, NewtonMove move, int steps) const {
  NewtonTask task{};
  task.chain = &chain_;
  put(tool, task.tool);
  task.move = move;
  task.steps = steps;
  task.longest = kLongest;
  task.settled = kSettled;
  // An array of configurations is one of numbers.
  static_assert(sizeof(Config) == kMaxDof * sizeof(double));
  task.stride = kMaxDof;
  return task;
}

void PoseNewton::run(NewtonTask& task, std::span<const Config> starts, Points& out) {
  out.q.resize(starts.size());
  out.tangent.resize(starts.size());
  out.found.resize(starts.size());
  if (starts.empty()) return;
  task.n = static_cast<int>(starts.size());
  task.start = starts.front().data();
  task.q = task.particular = out.q.front().data();
  task.null = out.tangent.front().data();
  task.found = out.found.data();
  newton_kernels().solve(task);
}

std::optional<PoseNewton::Point> PoseNewton::run(NewtonTask& task, const Config& start) {
  Point point;
  unsigned char found = 0;
  task.n = 1;
  task.start = start.data();
  task.q = task.particular = point.q.data();
  task.null = point.tangent.data();
  task.found = &found;
  newton_kernels().solve(task);
  if (found == 0) return std::nullopt;
  return point;
}

bool PoseNewton::linear(const Config& q, const Pose& tool, Linear& out) const {
  NewtonTask one = task(tool, NewtonMove::kNone, 0);
  const auto found = run(one, q);
  if (found) out = {found->q, found->tangent};
  return found.has_value();
}

void PoseNewton::tangents(std::span<const Config> q, const Pose& tool, Points& out) const {
  NewtonTask all = task(tool, NewtonMove::kNone, 0);
  run(all, q, out);
  std::copy(q.begin(), q.end(), out.q.begin());
  for (Config& tangent : out.tangent) tangent /= joint_norm(tangent);
}

std::optional<PoseNewton::Point> PoseNewton::nearest(const Config& start, const Pose& tool,
                                                     const Config& scale2, int steps) const {
  if (arm_.roll_fixed) {
    const double roll = start[kRoll];
    NewtonTask one = task(tool, NewtonMove::kLocked, steps);
    one.joint = kRoll;
    one.value = &roll;
    const auto point = run(one, start);
    return point ? point : through_singular(start, tool);
  }
  NewtonTask one = task(tool, NewtonMove::kNearest, steps);
  std::copy_n(scale2.data(), kDof, one.scale2);
  return run(one, start);
}

void PoseNewton::nearest(std::span<const Config> starts, const Pose& tool, const Config& scale2,
                         int steps, Points& out) const {
  if (arm_.roll_fixed) {
    std::vector<double> rolls;
    for (const Config& start : starts) rolls.push_back(start[kRoll]);
    NewtonTask all = task(tool, NewtonMove::kLocked, steps);
    all.joint = kRoll;
    all.value = rolls.data();
    run(all, starts, out);
    for (std::size_t k = 0; k < starts.size(); ++k) {
      if (out.found[k] != 0) continue;
      const auto point = through_singular(starts[k], tool);
      out.found[k] = point ? 1 : 0;
      if (point) out.q[k] = point->q, out.tangent[k] = point->tangent;
    }
    return;
  }
  NewtonTask all = task(tool, NewtonMove::kNearest, steps);
  std::copy_n(scale2.data(), kDof, all.scale2);
  run(all, starts, out);
}

std::optional<PoseNewton::Point> PoseNewton::with_joint_at(const Config& start, const Pose& tool,
                                                           int joint, double value) const {
  NewtonTask one = task(tool, NewtonMove::kLocked, kLockedSteps);
  one.joint = joint;
  one.value = &value;
  return run(one, start);
}

void PoseNewton::with_joint_at(std::span<const Config> starts, const Pose& tool, int joint,
                               std::span<const double> values, Points& out) const {
  NewtonTask all = task(tool, NewtonMove::kLocked, kLockedSteps);
  all.joint = joint;
  all.value = values.data();
  run(all, starts, out);
}

std::optional<PoseNewton::Point> PoseNewton::through_singular(const Config& start,
                                                              const Pose& tool) const {
  constexpr int kSteps = 40;
  constexpr double kThere = 1e-10;  // m and rad
  Config q = start;
  for (int step = 0; step < kSteps; ++step) {
    const Pose reached = arm_.tool(q);
    const Eigen::AngleAxisd turn(tool.linear() * reached.linear().transpose());
    Eigen::Matrix<double, 6, 1> error;
    error << tool.translation() - reached.translation(), turn.angle() * turn.axis();
    const double damping = error.squaredNorm();
    if (damping <= kThere * kThere) return Point{q, Config::Zero()};
    const Eigen::Matrix<double, 6, kDof> J = arm_.jacobian(q);
    Eigen::Matrix<double, 6, 6> damped = J * J.transpose();
    damped.diagonal().array() += damping;
    const Config move = Config(J.transpose() * damped.ldlt().solve(error));
    if (!(joint_squared_norm(move) < kLongest * kLongest)) return std::nullopt;
    q += move;
  }
  return std::nullopt;
}

std::optional<PoseNewton::Point> PoseNewton::approach(const Config& start, const Pose& tool,
                                                      int steps) const {
  constexpr double kStride = 0.5;  // rad
  Config q = start;
  Linear at;
  for (int step = 0; step < steps; ++step) {
    if (!linear(q, tool, at)) return std::nullopt;
    Config move =
        at.particular - (joint_dot(at.null, at.particular) / joint_squared_norm(at.null)) * at.null;
    const double length2 = joint_squared_norm(move);
    if (!(length2 < 1e12)) return std::nullopt;
    if (length2 > kStride * kStride) move *= kStride / std::sqrt(length2);
    q += move;
    if (length2 < kSettled * kSettled) return Point{q, at.null / joint_norm(at.null)};
  }
  return std::nullopt;
}

}  // namespace swivel
