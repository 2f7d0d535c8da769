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

/// The four planners. All return the same trajectory, bit for bit; they differ in time and memory.
enum class PlannerKind {
  kEager,     ///< the paper's: validates everything and searches an explicit graph
  kEagerDp,   ///< validates everything, but stores no edges
  kLazy,      ///< searches paths of the implicit lattice and validates only those
  kParallel,  ///< as kLazy, with collision questions in batches over threads
};
[[nodiscard]] const char* to_string(PlannerKind kind);
/// Throws InputError for an unknown name.
[[nodiscard]] PlannerKind planner_from_string(const std::string& name);

struct PlanOptions {
  PlannerKind planner = PlannerKind::kParallel;
  int threads = 0;  ///< 0: all cores; kLazy always uses one
  /// The time allowed for everything from the call on, s, > 0. If it passes after the verdict is
  /// known, the verdict stays, and the evidence and explanations asked for may be missing
  /// (PlanResult::evidence, Diagnosis::complete).
  std::optional<double> timeout_s;
  std::stop_token stop;                       ///< lets another thread stop the plan
  const std::atomic<bool>* cancel = nullptr;  ///< for signal handlers: stops the plan once true
  /// Whether every answer (trajectory, job, two arms, and the motion made of it) is proved as
  /// check_trajectory(), check_job() and check_workcell() do, within the time-out, before it is
  /// returned. One that fails is a bug and throws std::logic_error; one that is not proved in time
  /// is not returned as an answer: its status is that of a plan which was stopped, and its rows are
  /// in `partial`. An answer says whether it was proved (PlanResult::checked).
  bool check = true;
  /// Whether FCL, behind bounding volumes, decides every clearance that the search asks about, as
  /// it always does for the eager planners: without closed forms, without Swivel's own triangle
  /// trees, and with nothing kept from one posture to the next. Depths of contact
  /// (AllowedPair::depth), which FCL does not measure, are still Swivel's. The answer is the same;
  /// it takes longer.
  bool fcl_alone = false;
  Evidence evidence;          ///< what to compute besides the verdict
  Hooks hooks;                ///< the caller's own rules and costs; every planner honours them
  ProgressFunction progress;  ///< called now and then from the planning thread; must be quick
  /// Returns the budget of a plan that begins now. The options must outlive it.
  [[nodiscard]] Budget budget() const { return Budget(timeout_s, cancel, stop, &progress); }
};

}  // namespace swivel
