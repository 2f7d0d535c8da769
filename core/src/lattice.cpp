// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/lattice.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/kernels.hpp"
#include "swivel/core/angle.hpp"
#include "swivel/core/input_error.hpp"

namespace swivel {

namespace {

constexpr double kLimitTolerance = 1e-9;  // rad, limits are inclusive within this
constexpr double kSingularSine = 1e-6;
constexpr int kShoulderJoints = 0, kElbowJoint = 3, kWristJoints = 4;

int wrapped_index(long long j, int n) {
  return static_cast<int>(((j % n) + n) % n);
}

/// Least k with q + 2 pi k >= base; as the kernels compute it.
double image_from(double q, double base) {
  return q + kTwoPi * std::ceil((base - q) / kTwoPi);
}

std::string gigabytes(double bytes) {
  return std::to_string(static_cast<long long>(bytes / 1e9 + 0.5)) + " GB";
}

}  // namespace

Lattice::Lattice(const Chain& chain, const SrsArm& arm, const ToolPath& path, const Problem& problem)
    : chain_(&chain), arm_(&arm), path_(&path), limits_(problem.limits), cost_(problem.cost) {
  const Resolution& resolution = problem.resolution;
  const double wanted = std::ceil(kTwoPi / resolution.dphi - 1e-9);
  for (int k = 0; k < kDof; ++k) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(k)];
    Images& images = images_[static_cast<std::size_t>(k)];
    continuous_[static_cast<std::size_t>(k)] = limit.continuous;
    cost_scale_[static_cast<std::size_t>(k)] =
        cost_.metric == CostMetric::kTime ? 1 / limit.velocity : cost_.weights[static_cast<std::size_t>(k)];
    if (limit.continuous) {
      images = {-kPi, std::numeric_limits<double>::infinity(), 1};
      continue;
    }
    const double lower = limit.lower + limits_.joint_margin, upper = limit.upper - limits_.joint_margin;
    if (lower > upper)
      throw InputError(problem.source + ": limits.joint_margin: leaves no range for joint '" +
                       chain.joint_names[static_cast<std::size_t>(k)] + "': allowed is at most " +
                       std::to_string((limit.upper - limit.lower) / 2));
    images.base = lower - kLimitTolerance;
    images.upper = upper + kLimitTolerance;
    const double range = upper - lower;
    images.count = range > kTwoPi + kLimitTolerance ? static_cast<int>(std::floor((range + 2 * kLimitTolerance) / kTwoPi)) + 1 : 1;
    windings_ *= images.count;
  }

  const double width = wanted * kBranches * windings_;
  const double needed = width * layers() * 17.0;  // cost-to-go, states, search
  const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  if (width > 1e8 || needed > 0.8 * memory)
    throw InputError(problem.source + ": resolution: " + std::to_string(layers()) + " layers x " +
                     std::to_string(static_cast<long long>(width)) + " nodes need " + gigabytes(needed) + ", this machine has " +
                     gigabytes(memory) + ": allowed are larger ds or dphi");
  angles_ = static_cast<int>(wanted);
  window_ = static_cast<int>(
      std::min<double>(angles_ / 2, std::max(1.0, std::floor(limits_.arm_slope * resolution.ds / resolution.dphi + 1e-9))));
  window_ = std::max(window_, angles_ > 1 ? 1 : 0);

  sine_.resize(static_cast<std::size_t>(3 * angles_));
  cosine_.resize(sine_.size());
  for (int j = 0; j < angles_; ++j)
    for (const int k : {j, j + angles_, j + 2 * angles_}) {
      const double phi_j = -kPi + kTwoPi * j / angles_;
      sine_[static_cast<std::size_t>(k)] = std::sin(phi_j);
      cosine_[static_cast<std::size_t>(k)] = std::cos(phi_j);
    }

  const auto m = static_cast<std::size_t>(layers());
  planes_.reserve(m);
  reach_.reserve(m);
  circles_.resize(m);
  for (int i = 0; i < layers(); ++i) {
    const Pose& tool = path.layer(i).tool;
    planes_.push_back(i == 0 ? first_plane(arm, tool) : carry_plane(arm, planes_.back(), tool));
    reach_.push_back(reach_status(arm, planes_.back().reach));
    if (reach_.back() == ReachStatus::kReachable) circles_[static_cast<std::size_t>(i)] = elbow_circles(arm, planes_.back(), tool);
  }

  const bool timed = limits_.tool_speed || limits_.tool_turn_speed;
  for (int k = 0; k < kDof; ++k)
    if ((timed || cost_.metric == CostMetric::kTime) && chain.limit[static_cast<std::size_t>(k)].velocity <= 0)
      throw InputError(problem.source + (timed ? ": limits.tool_speed" : ": cost.metric: time") + ": joint '" +
                       chain.joint_names[static_cast<std::size_t>(k)] +
                       "' has no speed limit in the URDF: allowed are robots whose joints all have one");
  step_bounds_.resize(timed ? m - 1 : 1, Config::Constant(limits_.joint_step));
  if (timed)
    for (int i = 0; i + 1 < layers(); ++i) {
      const PathLayer& layer = path.layer(i);
      double dt = 0;
      if (limits_.tool_speed) dt = std::max(dt, layer.step_length / *limits_.tool_speed);
      if (limits_.tool_turn_speed) dt = std::max(dt, layer.step_angle / *limits_.tool_turn_speed);
      if (dt <= 0) continue;  // a step that the given speed does not time
      for (int k = 0; k < kDof; ++k) {
        double& bound = step_bounds_[static_cast<std::size_t>(i)][k];
        bound = std::min(bound, chain.limit[static_cast<std::size_t>(k)].velocity * dt);
      }
    }

  if (problem.start) place_start(*problem.start, problem.source);
}

void Lattice::place_start(const Config& q, const std::string& source) {
  const Pose reached = chain_->tool(q);
  const Pose& first = path_->layer(0).tool;
  const double distance = (reached.translation() - first.translation()).norm();
  const double angle = Eigen::AngleAxisd(reached.linear().transpose() * first.linear()).angle();
  for (int k = 0; k < kDof; ++k) {
    const JointLimit& limit = chain_->limit[static_cast<std::size_t>(k)];
    const double lower = limit.lower + limits_.joint_margin, upper = limit.upper - limits_.joint_margin;
    if (!std::isfinite(q[k]) || (!limit.continuous && (q[k] < lower - kLimitTolerance || q[k] > upper + kLimitTolerance)))
      throw InputError(source + ": start.joints: joint '" + chain_->joint_names[static_cast<std::size_t>(k)] + "' at " +
                       std::to_string(q[k]) + " is outside its limits: allowed is " + std::to_string(lower) + " to " +
                       std::to_string(upper));
  }
  if (!(distance <= 1e-6 && angle <= 1e-6)) {
    char text[160];
    std::snprintf(text, sizeof text,
                  ": start.joints: the tool is %.3g m and %.3g rad from the path's first pose: allowed are 1e-6 m and 1e-6 rad",
                  distance, angle);
    throw InputError(source + text);
  }
  Start start;
  start.q = q;
  start.phi = planes_[0].angle_of(arm_->elbow_axis(q));
  int winding = 0;
  for (int k = 0; k < kDof; ++k) {
    const Images& images = images_[static_cast<std::size_t>(k)];
    const int image =
        images.count == 1 ? 0 : std::clamp(static_cast<int>(std::floor((q[k] - images.base) / kTwoPi)), 0, images.count - 1);
    winding = winding * images.count + image;
  }
  const int nearest = wrapped_index(std::llround((start.phi + kPi) / kTwoPi * angles_), angles_);
  start.slot = (arm_->branch(q) * windings_ + winding) * angles_ + nearest;
  start_ = start;
}

double Lattice::phi(int layer, int slot) const {
  if (layer == 0 && start_) return start_->phi;
  return -kPi + kTwoPi * angle_of(slot) / angles_;
}

int Lattice::winding_images(int winding, int joint) const {
  for (int k = kDof - 1; k > joint; --k) winding /= images_[static_cast<std::size_t>(k)].count;
  return winding % images_[static_cast<std::size_t>(joint)].count;
}

void Lattice::solve(int layer, int first, int count, LayerNodes& out) const {
  if (arm_->exact)
    solve_exact(sine_.data() + first, cosine_.data() + first, layer, count, out);
  else
    solve_polished(layer, first, count, out);
  if (layer != 0 || !start_) return;
  std::fill(out.valid_.begin(), out.valid_.begin() + static_cast<std::ptrdiff_t>(labels()) * count, std::uint8_t{0});
  const int label = label_of(start_->slot);
  const bool valid = fault(0, start_->slot).status == NodeStatus::kValid;
  for (int k = wrapped_index(static_cast<long long>(angle_of(start_->slot)) - first, angles_); k < count; k += angles_) {
    for (int j = 0; j < kDof; ++j)
      out.data_[static_cast<Eigen::Index>(out.q_[static_cast<std::size_t>(label * kDof + j)]) + k] = start_->q[j];
    out.valid_[static_cast<std::size_t>(label * count + k)] = valid;
  }
}

void Lattice::solve_exact(const double* sine, const double* cosine, int layer, int count, LayerNodes& out) const {
  const auto n = static_cast<std::size_t>(count);
  const auto label_count = static_cast<std::size_t>(labels());
  out.count_ = count;
  out.q_.resize(label_count * kDof);
  out.valid_.resize(label_count * n);
  if (reach_[static_cast<std::size_t>(layer)] != ReachStatus::kReachable) {
    out.data_.setZero(count);
    std::fill(out.q_.begin(), out.q_.end(), std::size_t{0});
    std::fill(out.valid_.begin(), out.valid_.end(), std::uint8_t{0});
    return;
  }

  // One array per (elbow sign, joint, sign of its triple, image): branches share what they have in common.
  std::size_t image_count = 0;
  for (const Images& images : images_) image_count += static_cast<std::size_t>(images.count);
  out.data_.resize(static_cast<Eigen::Index>((image_count * 4 + 4) * n));
  std::size_t used = 0;
  const auto allot = [&](int images) {
    const std::size_t offset = used;
    used += static_cast<std::size_t>(images) * n;
    return offset;
  };
  double* const data = out.data_.data();
  for (int elbow = 0; elbow < 2; ++elbow) {
    const ElbowCircle& circle = circles_[static_cast<std::size_t>(layer)][static_cast<std::size_t>(elbow)];
    const double q4 = image_from(circle.q4, images_[kElbowJoint].base);
    if (q4 > images_[kElbowJoint].upper) {  // one elbow angle serves the whole circle, so four branches are gone at once
      const int first_label = (elbow ? kElbowBit : 0) * windings_, last_label = first_label + 4 * windings_;
      std::fill(out.q_.begin() + first_label * kDof, out.q_.begin() + last_label * kDof, std::size_t{0});
      std::fill(out.valid_.begin() + first_label * count, out.valid_.begin() + last_label * count, std::uint8_t{0});
      continue;
    }
    std::array<std::array<std::size_t, kDof>, 2> track;  // [sign of the triple][joint]
    std::array<std::size_t, 2> sines;                    // [shoulder, wrist]
    for (int triple = 0; triple < 2; ++triple) {
      const int joint0 = triple == 0 ? kShoulderJoints : kWristJoints;
      TripleTask task;
      const TripleCircle& m = triple == 0 ? circle.shoulder : circle.wrist;
      for (std::size_t row = 0; row < 5; ++row)
        for (std::size_t column = 0; column < 3; ++column) task.m[row][column] = m[row][column];
      task.shift = triple == 0 ? arm_->shoulder.shift : arm_->wrist.shift;
      task.n = count;
      task.sin_phi = sine;
      task.cos_phi = cosine;
      for (std::size_t j = 0; j < 3; ++j) {
        const Images& images = images_[static_cast<std::size_t>(joint0) + j];
        task.base[j] = images.base;
        for (std::size_t sign = 0; sign < 2; ++sign) {
          track[sign][static_cast<std::size_t>(joint0) + j] = allot(images.count);
          task.q[sign][j] = data + track[sign][static_cast<std::size_t>(joint0) + j];
        }
      }
      sines[static_cast<std::size_t>(triple)] = allot(1);
      task.sin_middle = data + sines[static_cast<std::size_t>(triple)];
      circle_kernels().solve_triple(task);
    }
    track[0][kElbowJoint] = track[1][kElbowJoint] = allot(images_[kElbowJoint].count);
    std::fill_n(data + track[0][kElbowJoint], n, q4);
    for (std::size_t sign = 0; sign < 2; ++sign)
      for (std::size_t j = 0; j < kDof; ++j)
        for (std::size_t image = 1; image < static_cast<std::size_t>(images_[j].count); ++image)
          for (std::size_t k = 0; k < n; ++k)
            if (j != kElbowJoint || sign == 0)
              data[track[sign][j] + image * n + k] = data[track[sign][j] + k] + kTwoPi * static_cast<double>(image);

    const double* const shoulder_sine = data + sines[0];
    const double* const wrist_sine = data + sines[1];
    for (int sign = 0; sign < 4; ++sign) {
      const int branch = sign | (elbow ? kElbowBit : 0);
      for (int winding = 0; winding < windings_; ++winding) {
        const std::size_t label = static_cast<std::size_t>(branch * windings_ + winding);
        std::array<const double*, kDof> q;
        for (int j = 0; j < kDof; ++j) {
          const std::size_t bit = j < kWristJoints ? (sign & kShoulderBit ? 1 : 0) : (sign & kWristBit ? 1 : 0);
          const std::size_t offset =
              track[bit][static_cast<std::size_t>(j)] + static_cast<std::size_t>(winding_images(winding, j)) * n;
          out.q_[label * kDof + static_cast<std::size_t>(j)] = offset;
          q[static_cast<std::size_t>(j)] = data + offset;
        }
        std::uint8_t* const valid = out.valid_.data() + label * n;
        const auto& u = images_;
        for (std::size_t k = 0; k < n; ++k)
          valid[k] = static_cast<std::uint8_t>((shoulder_sine[k] >= kSingularSine) & (wrist_sine[k] >= kSingularSine) &
                                               (q[0][k] <= u[0].upper) & (q[1][k] <= u[1].upper) & (q[2][k] <= u[2].upper) &
                                               (q[3][k] <= u[3].upper) & (q[4][k] <= u[4].upper) & (q[5][k] <= u[5].upper) &
                                               (q[6][k] <= u[6].upper));
      }
    }
  }
}

void Lattice::solve_polished(int layer, int first, int count, LayerNodes& out) const {
  const auto n = static_cast<std::size_t>(count);
  const auto label_count = static_cast<std::size_t>(labels());
  out.count_ = count;
  out.q_.resize(label_count * kDof);
  out.valid_.assign(label_count * n, 0);
  out.data_.setZero(static_cast<Eigen::Index>(label_count * kDof * n));
  for (std::size_t k = 0; k < out.q_.size(); ++k) out.q_[k] = k * n;
  if (reach_[static_cast<std::size_t>(layer)] != ReachStatus::kReachable) return;
  constexpr double kLargestMove = 0.05;  // of polish(): limits further off than this stay violated
  const auto& circles = circles_[static_cast<std::size_t>(layer)];
  for (int k = 0; k < count; ++k) {
    const double phi_k = -kPi + kTwoPi * ((first + k) % angles_) / angles_;
    for (int branch = 0; branch < kBranches; ++branch) {
      const Config seed = srs_ik(*arm_, circles, phi_k, branch);
      if (std::abs(std::sin(arm_->shoulder_angle(seed))) < kSingularSine ||
          std::abs(std::sin(arm_->wrist_angle(seed))) < kSingularSine)
        continue;
      bool hopeless = false;
      for (int j = 0; j < kDof && !hopeless; ++j) {
        const Images& images = images_[static_cast<std::size_t>(j)];
        hopeless = image_from(seed[j], images.base - kLargestMove) > images.upper + kLargestMove;
      }
      if (hopeless) continue;
      const auto polished = polish(*chain_, *arm_, planes_[static_cast<std::size_t>(layer)], path_->layer(layer).tool, phi_k, seed);
      if (!polished) continue;
      for (int winding = 0; winding < windings_; ++winding) {
        const auto label = static_cast<std::size_t>(branch * windings_ + winding);
        bool inside = true;
        for (int j = 0; j < kDof; ++j) {
          const Images& images = images_[static_cast<std::size_t>(j)];
          const double q = image_from((*polished)[j], images.base) + kTwoPi * winding_images(winding, j);
          inside = inside && q <= images.upper;
          out.data_[static_cast<Eigen::Index>((label * kDof + static_cast<std::size_t>(j)) * n) + k] = q;
        }
        out.valid_[label * n + static_cast<std::size_t>(k)] = inside;
      }
    }
  }
}

std::optional<Config> Lattice::node(int layer, int slot) const {
  LayerNodes nodes;
  solve(layer, angle_of(slot), 1, nodes);
  if (!nodes.valid(label_of(slot))[0]) return std::nullopt;
  return nodes.config(label_of(slot), 0);
}

bool Lattice::manipulable(const Config& q) const {
  return !asks_manipulability() || chain_->manipulability(q) >= limits_.manipulability;
}

Lattice::NodeFault Lattice::fault(int layer, int slot) const {
  NodeFault fault;
  const bool given = layer == 0 && start_;
  if (given && slot != start_->slot) return {NodeStatus::kNoIk, 0};
  const ReachStatus reach = reach_[static_cast<std::size_t>(layer)];
  if (reach == ReachStatus::kOutOfReach) return {NodeStatus::kNoIk, 0};
  if (reach == ReachStatus::kSingular) return {NodeStatus::kSingular, 0};
  Config q = given ? start_->q : srs_ik(*arm_, circles_[static_cast<std::size_t>(layer)], phi(layer, slot), branch_of(slot));
  if (std::abs(std::sin(arm_->shoulder_angle(q))) < kSingularSine || std::abs(std::sin(arm_->wrist_angle(q))) < kSingularSine)
    return {NodeStatus::kSingular, 0};
  if (given) return fault;
  const auto polished =
      polish(*chain_, *arm_, planes_[static_cast<std::size_t>(layer)], path_->layer(layer).tool, phi(layer, slot), q);
  if (!polished) return {NodeStatus::kNoIk, 0};
  const int winding = label_of(slot) % windings_;
  for (int j = 0; j < kDof; ++j) {
    const Images& images = images_[static_cast<std::size_t>(j)];
    if (image_from((*polished)[j], images.base) + kTwoPi * winding_images(winding, j) > images.upper)
      fault.joints |= static_cast<std::uint8_t>(1 << j);
  }
  if (fault.joints) fault.status = NodeStatus::kLimit;
  return fault;
}

bool Lattice::in_window(int layer, int a, int b) const {
  if (layer == 0 && start_) return std::abs(wrap_angle(phi(1, b) - start_->phi)) <= window_ * kTwoPi / angles_ + 1e-9;
  const int apart = std::abs(angle_of(a) - angle_of(b));
  return std::min(apart, angles_ - apart) <= window_;
}

Lattice::Run Lattice::grid_run(double phi_from) const {
  const double step = kTwoPi / angles_;
  const auto first = static_cast<long long>(std::ceil((phi_from + kPi - 1e-9) / step - window_));
  const auto last = static_cast<long long>(std::floor((phi_from + kPi + 1e-9) / step + window_));
  return {wrapped_index(first, angles_), static_cast<int>(std::min<long long>(last - first + 1, angles_))};
}

Lattice::Run Lattice::successors(int layer, int a) const {
  if (layer == 0 && start_) return grid_run(start_->phi);
  return {wrapped_index(static_cast<long long>(angle_of(a)) - window_, angles_), std::min(2 * window_ + 1, angles_)};
}

Lattice::Run Lattice::predecessors(int layer, int b) const {
  if (layer == 0 && start_) return in_window(0, start_->slot, b) ? Run{angle_of(start_->slot), 1} : Run{0, 0};
  return {wrapped_index(static_cast<long long>(angle_of(b)) - window_, angles_), std::min(2 * window_ + 1, angles_)};
}

}  // namespace swivel
