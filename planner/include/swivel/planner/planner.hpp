// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "swivel/collision/world.hpp"
#include "swivel/core/arm.hpp"
#include "swivel/core/budget.hpp"
#include "swivel/core/plan.hpp"
#include "swivel/core/problem.hpp"
#include "swivel/core/srs.hpp"
#include "swivel/graph/eager.hpp"
#include "swivel/graph/validity.hpp"
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

/// What the search came to know, for those who draw it.
struct SearchRecord {
  /// Of every node, [layer][slot]; empty where the planner is eager: it asks about all of them.
  std::vector<Verdict> nodes;
  /// One slot in each layer: the answer; where there is none, a valid path to the furthest layer (not of eager planners).
  std::vector<int> path;
};

struct PlanOptions {
  PlannerKind planner = PlannerKind::kParallel;
  int threads = 0;  ///< 0: all cores; kLazy always uses one
  /// s, any positive number, for everything from the call on. Where it passes after the verdict is known, the verdict stays, and
  /// what was asked for besides may be missing (PlanResult::evidence, Diagnosis::complete).
  std::optional<double> timeout_s;
  const std::atomic<bool>* cancel = nullptr;  ///< set from elsewhere to stop, as a time-out does
  Evidence evidence;                          ///< what to find besides the verdict
  EagerSearch eager_search = EagerSearch::kDijkstra;
  /// lazy, parallel: FCL is asked about every pair as well; std::logic_error where a certificate contradicts it. For tests.
  bool compare_with_fcl = false;
  Executor::Backend backend = Executor::Backend::kTbb;
  SearchRecord* record = nullptr;  ///< filled when given; not counted in the time of the plan
  /// Called now and then from the planning thread with one phrase on what is going on.
  std::function<void(const std::string&)> progress;
};

/// What depends on the robot alone, not on path, scene poses, limits or start: built once, shared by every plan of the robot.
/// Immutable and safe to share between threads.
class PreparedRobot {
 public:
  /// Throws InputError: unknown links, fewer than seven joints, an arm that is not S-R-S, ...; InvalidArgument: see validate();
  /// Stopped, only with a budget.
  explicit PreparedRobot(const Problem& problem, const Budget& budget = {});
  /// Throws InvalidArgument for a problem that another robot would have to be prepared for: another model, base_link, tip_link,
  /// tool, hold or attached body. Limits may differ.
  void require_prepared_for(const Problem& problem) const;
  [[nodiscard]] const ArmModel& arm() const { return arm_; }
  [[nodiscard]] const SrsArm& srs() const { return srs_; }
  [[nodiscard]] const std::array<double, kDof>& radii() const { return radii_; }
  /// Robot pairs and the trees of all meshes met so far; the worlds of single plans are made from it.
  [[nodiscard]] const World& world() const { return world_; }

 private:
  Robot basis_;  // holds the model, so that no other takes its address
  ArmModel arm_;
  SrsArm srs_;
  World world_;
  std::array<double, kDof> radii_;
};

/// Plans one problem. Const, reentrant, deterministic at any thread count (except where it times out).
/// Throws InputError for problems that make no sense, InvalidArgument for values that no problem may have (validate());
/// "no path" is a status, not an exception.
[[nodiscard]] PlanResult plan(const Problem& problem, const PlanOptions& options = {});
/// The same on a robot prepared before. Throws InvalidArgument unless it was prepared for this problem
/// (PreparedRobot::require_prepared_for).
[[nodiscard]] PlanResult plan(const PreparedRobot& robot, const Problem& problem, const PlanOptions& options = {});

}  // namespace swivel
