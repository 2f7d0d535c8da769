// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <optional>
#include <stop_token>
#include <string>

#include "swivel/core/budget.hpp"
#include "swivel/core/hooks.hpp"
#include "swivel/core/plan.hpp"
#include "swivel/graph/eager.hpp"
#include "swivel/parallel/executor.hpp"

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
  /// s, any positive number, for everything from the call on. Where it passes after the verdict is known, the verdict stays, and
  /// what was asked for besides may be missing (PlanResult::evidence, Diagnosis::complete).
  std::optional<double> timeout_s;
  std::stop_token stop;                       ///< asked from elsewhere to stop, as a time-out does
  const std::atomic<bool>* cancel = nullptr;  ///< the same, for signal handlers
  Evidence evidence;                          ///< what to find besides the verdict
  Hooks hooks;                                ///< rules and costs of the caller's own, of any planner
  ProgressFunction progress;                  ///< called now and then from the planning thread; must be quick
  EagerSearch eager_search = EagerSearch::kDijkstra;
  /// lazy, parallel: FCL is asked about every pair as well; std::logic_error where a certificate contradicts it. For tests.
  bool compare_with_fcl = false;
  Executor::Backend backend = Executor::Backend::kTbb;
  /// The budget of a plan that begins now. The options must outlive it.
  [[nodiscard]] Budget budget() const { return Budget(timeout_s, cancel, stop, &progress); }
};

}  // namespace swivel
