// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/kinematics/srs/srs.hpp"
#include "swivel/core/problem/hooks.hpp"

namespace swivel {

/// Refuses every step from one branch to another.
class KeepsBranch final : public StateCheck {
 public:
  explicit KeepsBranch(const SrsArm& arm) : arm_(&arm) {}
  [[nodiscard]] std::string name() const override { return "branch"; }
  [[nodiscard]] bool concurrent() const override { return true; }
  void states(std::span<const Config> states, std::span<bool> allowed) override {
    std::fill_n(allowed.begin(), states.size(), true);
  }
  [[nodiscard]] bool checks_motions() const override { return true; }
  void motions(std::span<const Motion> motions, std::span<bool> allowed) override {
    for (std::size_t k = 0; k < motions.size(); ++k)
      allowed[k] = arm_->branch(motions[k].from) == arm_->branch(motions[k].to);
  }

 private:
  const SrsArm* arm_;
};

/// Returns true if the rows are not all on one branch.
inline bool changes_branch(const std::vector<TrajectoryRow>& rows) {
  return std::any_of(rows.begin(), rows.end(),
                     [&](const TrajectoryRow& row) { return row.branch != rows[0].branch; });
}

}  // namespace swivel
