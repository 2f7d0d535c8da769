// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>

#include "swivel/core/kinematics/closed_form/closed_form.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"

namespace swivel {

/// How the self-motion of an arm is found and divided into nodes.
enum class ArmKind {
  kSrs,      ///< spherical shoulder and wrist, revolute elbow: a grid of arm angles
  kArcs,     ///< closed form with one joint locked: arcs of self-motion; of six joints, solutions
  kSampled,  ///< neither: arcs or solutions found by Newton and continuation, maybe not all
};

/// The class of an arm: which inverse kinematics it has.
struct ArmClass {
  ArmKind kind = ArmKind::kSampled;
  std::optional<SrsArm> srs;  ///< set for kSrs
  LockMethod lock;            ///< set for the other kinds
  /// False for an arm of six joints whose tool may not turn (Chain::roll_fixed).
  bool redundant = true;
  std::string not_srs;  ///< why the arm is not S-R-S: which axes miss each other, by how much
  /// Returns true if all solutions of a pose are found, false if only those that sampling meets.
  [[nodiscard]] bool complete() const { return kind != ArmKind::kSampled; }
  /// Returns "closed form" or "sampled", see complete().
  [[nodiscard]] const char* completeness() const { return complete() ? "closed form" : "sampled"; }
  /// Returns the inverse kinematics of the arm in one line for people.
  [[nodiscard]] std::string method() const;
};

/// Returns the class of a chain: S-R-S where fit_srs() succeeds, else by lock_method(). The roll of
/// the tool counts as the seventh joint of an arm of six, which is never S-R-S. `source` is the
/// file for messages. Throws InputError for a seven-joint chain with a free roll that is not S-R-S,
/// and for one with a slide whose other six joints have no closed form.
[[nodiscard]] ArmClass classify(const Chain& chain, const std::string& source);

}  // namespace swivel
