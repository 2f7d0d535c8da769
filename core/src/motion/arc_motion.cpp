// SPDX-License-Identifier: BSD-3-Clause
#include "motion/arc_motion.hpp"

#include <algorithm>

#include "swivel/core/lattice/kinds/arc_lattice.hpp"
#include "swivel/core/lattice/problem_path.hpp"

namespace swivel {

ArcMotion::ArcMotion(const Chain& chain, const LockMethod& lock, const ToolPath& path,
                     const std::vector<TrajectoryRow>& rows, double apart, double off_limits,
                     const std::vector<BetweenRow>& between)
    : PathMotion(chain, path, rows, apart, between),
      lock_(lock),
      newton_(chain),
      alignments_(alignments_of(chain)) {
  // An alignment with the axis of the roll makes no joint of the arm move fast.
  if (chain.roll)
    std::erase_if(alignments_, [](const Alignment& a) { return a.joint + 2 == kDof; });
  move_off_limits(off_limits);
  for (Eigen::Index j = 0; j < kDof; ++j) {
    std::vector<double> values;
    for (const TrajectoryRow& row : rows_) values.push_back(row.q[j]);
    spline_.emplace_back(travel_, std::move(values));
  }
  find_jumps();
}

void ArcMotion::move_off_limits(double by) {
  constexpr double kFarthest = 0.1;  // rad: most that other joints may move
  for (std::size_t k = 1; k + 1 < rows_.size(); ++k)
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = chain_->limit[j];
      if (limit.continuous) continue;
      double lower = limit.lower, upper = limit.upper;
      if (chain_->roll && j + 1 == kDof) {
        const Roll window = path_->window_at(travel_[k]);
        lower = std::max(lower, window.lower), upper = std::min(upper, window.upper);
      }
      if (upper - lower < 2 * by) continue;
      const auto joint = static_cast<Eigen::Index>(j);
      const double value = rows_[k].q[joint], inside = std::clamp(value, lower + by, upper - by);
      if (inside == value) continue;
      const auto moved = newton_.with_joint_at(rows_[k].q, pose_of(k), static_cast<int>(j), inside);
      if (moved && (moved->q - rows_[k].q).lpNorm<Eigen::Infinity>() < kFarthest)
        rows_[k].q = moved->q;
    }
}

std::optional<Config> ArcMotion::joints(double travel) const {
  constexpr int kSteps = 10;
  const Pose tool = path_->at_travel(travel);
  Config q;
  for (std::size_t j = 0; j < kDof; ++j) q[static_cast<Eigen::Index>(j)] = spline_[j].at(travel);
  auto near = newton_.nearest(q, tool, Config::Ones(), kSteps);
  if (!near) near = newton_.through_singular(q, tool);
  if (!near) return std::nullopt;
  // One more step makes joints as smooth as their digits allow: jerks are differences over
  // milliseconds.
  const auto exact = newton_.nearest(near->q, tool, Config::Ones(), 1);
  return exact ? exact->q : near->q;
}

/// Returns true if joints go on continuously from q0 at x0 to q1 at x1. Halves that are hardly
/// shorter than the whole, down to nothing, show a jump.
bool ArcMotion::leads_over(double x0, const Config& q0, double x1, const Config& q1) const {
  constexpr double kSmall = 1e-3, kUneven = 0.75;  // rad, and of the whole
  const double whole = joint_norm(q1 - q0);
  if (whole < kSmall) return true;
  const double middle = (x0 + x1) / 2;
  if (!(x0 < middle && middle < x1)) return false;
  const auto q = joints(middle);
  if (!q) return false;
  return (joint_norm(*q - q0) <= kUneven * whole || leads_over(x0, q0, middle, *q)) &&
         (joint_norm(q1 - *q) <= kUneven * whole || leads_over(middle, *q, x1, q1));
}

void ArcMotion::find_jumps() {
  constexpr int kParts = 4;
  for (std::size_t k = 0; k + 1 < travel_.size(); ++k) {
    double before = travel_[k];
    auto q = joints(before);
    for (int part = 1; part <= kParts; ++part) {
      const double after = travel_[k] + part * (travel_[k + 1] - travel_[k]) / kParts;
      const auto next = joints(after);
      if (q && next && leads_over(before, *q, after, *next)) {
        before = after;
        q = next;
        continue;
      }
      NoMotion& jump = jumps_.emplace_back();
      jump.s = rows_[k].s;
      jump.reason = q && next ? "the joints would have to jump to the next layer"
                              : "the arm has no solution between layers";
      break;
    }
  }
}

TrajectoryRow ArcMotion::row(double travel, const Config& q) const {
  return counted_from_waypoints(
      *chain_, *path_, travel,
      {place(travel).s, arc_angle(*chain_, q), arc_branch(*chain_, lock_, q), q});
}

std::optional<PathMotion::Singular> ArcMotion::nearest_singular(const Config& q) const {
  std::optional<Singular> nearest;
  for (const Alignment& a : alignments_)
    if (const double away = a.away(q); !nearest || away < nearest->angle)
      nearest = {a.where(), away};
  return nearest;
}

}  // namespace swivel
