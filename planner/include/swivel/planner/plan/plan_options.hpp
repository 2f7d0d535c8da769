// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <optional>
#include <stop_token>
#include <string>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/problem/hooks.hpp"

namespace swivel {

/// The same question, answered four ways; all give the same trajectory, bit for bit.
enum class PlannerKind {
  kEager,     ///< the paper: everything validated, explicit graph
  kEagerDp,   ///< the same without stored edges
  kLazy,      ///< path-first over the implicit lattice
  kParallel,  ///< lazy with collision work in batches over threads
};
[[nodiscard]] const char* to_string(PlannerKind kind);
/// Throws InputError for an unknown name.
[[nodiscard]] PlannerKind planner_from_string(const std::string& name);

struct PlanOptions {
  PlannerKind planner = PlannerKind::kParallel;
  int threads = 0;  ///< 0: all cores; kLazy always uses one
  /// s, any positive number, for everything from the call on. Where it passes after the verdict is
  /// known, the verdict stays, and what was asked for besides may be missing (PlanResult::evidence,
  /// Diagnosis::complete).
  std::optional<double> timeout_s;
  std::stop_token stop;                       ///< asked from elsewhere to stop, as a time-out does
  const std::atomic<bool>* cancel = nullptr;  ///< the same, for signal handlers
  /// Prove every trajectory (and motion) as check_trajectory() does before it is returned, within
  /// the time-out: one that fails is a bug and std::logic_error, never an answer; one that is not
  /// proved in time is none.
  bool check = false;
  /// FCL decides every clearance that the search asks about, behind bounding volumes, as it always
  /// does for the eager planners: no closed forms, no triangle trees of our own, and nothing is
  /// kept from one posture to the next. Depths of contact (AllowedPair::depth), which FCL does not
  /// measure, stay ours. The answer is the same; it takes longer.
  bool fcl_alone = false;
  Evidence evidence;          ///< what to find besides the verdict
  Hooks hooks;                ///< rules and costs of the caller's own, of any planner
  ProgressFunction progress;  ///< called now and then from the planning thread; must be quick
  /// The budget of a plan that begins now. The options must outlive it.
  [[nodiscard]] Budget budget() const { return Budget(timeout_s, cancel, stop, &progress); }
};

}  // namespace swivel
