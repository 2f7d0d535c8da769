// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>
#include <variant>

#include "swivel/core/answer/advice.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/answer/infeasibility_certificate.hpp"
#include "swivel/core/answer/workcell_certificate.hpp"
#include "swivel/core/problem/problem.hpp"
#include "swivel/planner/plan/plan_options.hpp"
#include "swivel/planner/plan/problem_view.hpp"

namespace swivel {

class PreparedRobot;
class PreparedWorkcell;

/// What is asked of a plan besides the rows at the layers.
struct MotionRequest {
  bool refine = false;  ///< moves the rows off the lattice's nodes
  /// Set: a motion in time is made. For strokes `speed` may be 0: each has its own.
  std::optional<TimingOptions> timing;
};

/// A proof that a problem has no answer at its resolution: that one run has no path by itself, or
/// that two arms have no paths without conflict.
using AnyCertificate = std::variant<InfeasibilityCertificate, WorkcellCertificate>;

/// Plans a problem of any kind: one path, strokes or two arms.
class ProblemPlanner {
 public:
  /// Prepares to plan a problem. It is completed for what is asked: by with_motion_defaults() for a
  /// motion, and by keep_clearance_between_layers() for a refinement alone. Throws InputError and
  /// InvalidArgument as Planner, PreparedRobot and PreparedWorkcell do, and Stopped.
  explicit ProblemPlanner(Problem problem, MotionRequest asked = {}, const Budget& budget = {});
  ~ProblemPlanner();
  ProblemPlanner(ProblemPlanner&&) noexcept;
  ProblemPlanner& operator=(ProblemPlanner&&) noexcept;

  /// Replaces the problem, which is completed as by the constructor. What is known of a robot that
  /// stays is kept, and of one path all that Planner keeps: so objects that move, another home,
  /// start or part take less time. The next plan is that of a new planner, but for its counters.
  /// Throws as the constructor does, and changes nothing then.
  void set_problem(Problem problem, const Budget& budget = {});
  /// Replaces the problem, and what is asked of a plan besides.
  void set_problem(Problem problem, MotionRequest asked, const Budget& budget = {});
  /// Returns the problem as it is planned.
  [[nodiscard]] const Problem& problem() const;
  /// Plans as plan_motion(), plan_job_motion() and plan_workcell_motion() do, and throws as they
  /// do. With `keeps_view`, view(), and prove_infeasible() of strokes, may follow.
  [[nodiscard]] Answer plan(const PlanOptions& options, bool keeps_view = false);
  /// Returns what the last plan found out; its `runs` are empty if that was stopped before there
  /// was an answer or a verdict. Valid until the next plan.
  [[nodiscard]] const ProblemView& view() const;
  /// Returns changes that would help, as advise(), advise_job() and advise_workcell() do. `answer`
  /// is that of the last plan.
  [[nodiscard]] AdviceList advise(const Answer& answer, const PlanOptions& options) const;
  /// Returns a proof that the problem has no answer, from what the last plan found out, which must
  /// be that. Where there is none, adds the reason to the warnings of `answer`: of strokes only one
  /// that has no path by itself, and is not reversible, has a proof. Throws Stopped.
  [[nodiscard]] std::optional<AnyCertificate> prove_infeasible(Answer& answer,
                                                               const Budget& budget) const;
  /// Returns what was prepared of one arm, and of two arms.
  [[nodiscard]] const PreparedRobot& robot() const;
  [[nodiscard]] const PreparedWorkcell& two_arms() const;

 private:
  struct Impl;
  struct OfPath;
  struct OfStrokes;
  struct OfTwoArms;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swivel
