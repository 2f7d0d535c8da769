// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>

#include "swivel/core/kinematics/closed_form/closed_form.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"

namespace swivel {

/// How the self-motion of an arm is explored.
enum class ArmKind {
  kSrs,      ///< spherical shoulder and wrist, revolute elbow: a grid of arm angles
  kArcs,     ///< a closed form with one joint locked: arcs of self-motion
  kSampled,  ///< neither: arcs found by restarts and continuation alone
};

struct ArmClass {
  ArmKind kind = ArmKind::kSampled;
  std::optional<SrsArm> srs;  ///< of kSrs
  LockMethod lock;            ///< of the others
  std::string not_srs;        ///< why the arm is not S-R-S: which axes miss each other, and by how much
  /// "closed form" or "sampled": whether all solutions of a pose are known, or only those that turned up.
  [[nodiscard]] bool complete() const { return kind != ArmKind::kSampled; }
  [[nodiscard]] const char* completeness() const { return complete() ? "closed form" : "sampled"; }
  /// The method in a line, for people.
  [[nodiscard]] std::string method() const;
};

/// Of a chain of seven joints; of six joints and the turn of the tool about its own axis, that turn is the seventh.
[[nodiscard]] ArmClass classify(const Chain& chain, const std::string& source);

}  // namespace swivel
