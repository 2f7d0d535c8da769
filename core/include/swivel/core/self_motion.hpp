// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "swivel/core/closed_form.hpp"

namespace swivel {

/// A connected piece of a self-motion curve inside the joint limits: points along it, neighbours at most 0.1 rad apart (Euclidean),
/// values inside the limits where a joint's range is below a turn, in (-pi, pi] elsewhere. Each point reaches the pose within 1e-9.
struct SelfMotionArc {
  std::vector<Config>
      q;  ///< from the lexicographically smaller end; a closed arc from its least point, towards the smaller neighbour
  bool closed = false;  ///< the first point follows the last
  int first_limit = -1,
      last_limit = -1;  ///< joint (0-based) that stands on its limit there, exactly; -1: none (closed or singular)
};

/// Curves along which a seven-joint chain moves while the tool stays, by tracing from the closed form at values of the lock, inside
/// and outside the limits: in-limit seeds alone miss arcs. A six-joint arm with a free tool axis is such a chain, its last joint
/// the turn of the tool.
class SelfMotion {
 public:
  /// `method` must have a lock. Limits are kept with `margin` (rad).
  SelfMotion(const Chain& chain, const LockMethod& method, double margin);
  /// Arcs in the order of their first points; deterministic.
  [[nodiscard]] std::vector<SelfMotionArc> arcs(const Pose& tool) const;
  /// The whole curves, limits ignored, as points in no given winding; for tests and drawings.
  [[nodiscard]] std::vector<SelfMotionArc> curves(const Pose& tool) const;

 private:
  Chain chain_;
  int lock_;
  std::array<double, kDof> lower_{}, upper_{};
  std::array<bool, kDof> bounded_{};
  std::vector<std::pair<double, ClosedForm>> forms_;  // by lock value
};

}  // namespace swivel
