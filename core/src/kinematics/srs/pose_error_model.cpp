// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/kinematics/srs/pose_error_model.hpp"

#include <algorithm>
#include <cmath>

namespace swivel {

PoseErrorModel::PoseErrorModel(const Chain& chain, const SrsArm& arm)
    : upper_(arm.upper),
      fore_(arm.fore),
      hand_(arm.wrist_in_tool.norm()),
      shoulder_shift_(arm.shoulder.shift),
      wrist_shift_(arm.wrist.shift),
      about_{arm.S, arm.E, arm.W} {
  constexpr double kRounding = 1e-12;
  for (int joint = 1; joint <= kDof; ++joint) {
    const auto j = static_cast<std::size_t>(joint - 1);
    const std::size_t own = part_of(joint);
    const double angle =
        std::atan2(chain.axis[j].cross(arm.axis[j]).norm(), chain.axis[j].dot(arm.axis[j])) +
        kRounding;
    const double offset = (about_[own] - chain.point[j]).cross(chain.axis[j]).norm() + kRounding;
    // A turn about an axis at an angle e from the fitted one, d beside its point, takes what is at
    // a distance r from that point 2 e (r + d) + 2 d away from where the fitted turn takes it, and
    // turns it by 2 asin(e) against that.
    for (std::size_t part = own; part < about_.size(); ++part) {
      const double radius = (own == kShoulder && part > kShoulder ? upper_ : 0) +
                            (own < kWrist && part == kWrist ? fore_ : 0);
      shift_[part] += 2 * angle * (radius + offset) + 2 * offset;
      turn_[part] += 2 * std::asin(std::min(1.0, angle));
    }
  }
}

PoseErrorBound PoseErrorModel::from_fitted(int group, double reach, const Config& q) const {
  const std::size_t part = part_of(group);
  const PoseErrorBound unknown = PoseErrorBound::unknown(about_[part]);
  if (group == kDof) return {about_[part], 0, 0};  // the tool stands where the layer puts it
  // With a smaller sine a row might have flipped the elbow: solve_exact_chain() moves no joint by
  // more than kMostCorrection.
  constexpr double kLeastSine = 0.05;
  static_assert(kLeastSine >= kMostCorrection);
  const double wrist =
      // Distance of the fitted arm's wrist centre at the row's joints from where it should be.
      shift_[kWrist];
  if (!(wrist < reach)) return unknown;
  const auto cosine = [&](double d) {
    return (d * d - upper_ * upper_ - fore_ * fore_) / (2 * upper_ * fore_);
  };
  const double most = std::max(std::abs(cosine(reach - wrist)), std::abs(cosine(reach + wrist)));
  if (!(most < 1) || std::sqrt(1 - most * most) < kLeastSine) return unknown;
  const double sine = std::sqrt(1 - most * most);
  // the plane of shoulder, elbow and wrist turns
  const double plane = 2 * std::asin(wrist / reach);
  // the upper arm turns
  const double upper = plane + wrist / (upper_ * sine);
  // the forearm turns
  const double fore = upper + (reach + wrist) * wrist / (upper_ * fore_ * sine);
  // A direction turns by `turn`; the sine of `angle` is that of its angle to an axis: returns how
  // far its azimuth about that axis turns at most.
  const auto azimuth = [](double turn, double angle) {
    const double ratio = std::sin(turn) / std::abs(std::sin(angle));
    return turn < kPi / 2 && ratio < 1 ? std::asin(ratio) : std::numeric_limits<double>::infinity();
  };
  const auto known = [&](double turn, double shift) {
    return std::isfinite(turn)
               ? PoseErrorBound{about_[part], turn + turn_[part], shift + shift_[part]}
               : unknown;
  };
  if (part == kElbow) return known(fore, upper_ * upper);
  if (part == kShoulder) {
    if (group == 3) return known(upper, 0);
    const double first = azimuth(upper, q[1] + shoulder_shift_);
    return known(group == 1 ? first : first + upper, 0);
  }
  // forearm and last link
  const double against = fore + turn_[kWrist], last = azimuth(against, q[5] + wrist_shift_);
  return known(group == 5 ? fore + last : turn_[kWrist] + last, wrist);
}

PoseErrorBound PoseErrorModel::from_node(int group, double reach, const Config& q) const {
  const PoseErrorBound row = from_fitted(group, reach, q);
  return {row.about, row.turn + turn_[part_of(group)], row.shift + shift_[part_of(group)]};
}

double PoseErrorModel::jacobian_change(double reach, const Config& q) const {
  const double tool = from_node(kDof, reach, q).of(hand_);  // m, from where the layer has it
  const std::array<double, 3> from_tool{reach + hand_ + tool, fore_ + hand_ + tool, hand_ + tool};
  double squares = 0;
  // an axis turns, and its point next to the centre moves
  for (int joint = 1; joint <= kDof; ++joint) {
    const PoseErrorBound moved = from_node(joint, reach, q);
    const double moment = moved.of(from_tool[part_of(joint)]);
    squares += moved.turn * moved.turn + moment * moment;
  }
  return std::sqrt(squares);
}

PoseErrorBound PoseErrorModel::between_exact_configs(int group, double reach,
                                                     const Config& q) const {
  const PoseErrorBound row = from_fitted(group, reach, q);
  return {row.about, 2 * row.turn, 2 * row.shift};
}

}  // namespace swivel
