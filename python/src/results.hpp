// SPDX-License-Identifier: BSD-3-Clause
// Answers as Python holds them. They are shared, so that arrays are views which outlive the object
// from which they were read.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "problem.hpp"
#include "swivel/core/answer/advice.hpp"
#include "swivel/io/motions/motion.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/verify/check.hpp"

namespace swivel::python {

struct Trajectory {
  std::shared_ptr<const std::vector<TrajectoryRow>> rows;  // shared with arrays and other answers
  io::JointNames joint_names;
};

struct Motion {
  std::shared_ptr<const TimingResult> timing;
  io::JointNames joint_names;
  std::string frame;  ///< name of the base link
  [[nodiscard]] std::shared_ptr<const std::vector<TimedRow>> rows() const;
  [[nodiscard]] const TimedPath& path() const;  ///< throws ValueError if not executable
};

struct RefinedPath {
  std::shared_ptr<const Refined> refined;
  io::JointNames joint_names;
};

struct Plan {
  std::shared_ptr<const MotionPlan> plan;
  std::optional<TimingOptions> timing;
  std::string frame;
  bool refined = false;        ///< a refinement was asked for
  bool own_functions = false;  ///< it depends on checks or costs that are functions of Python
  /// The problem as it was planned, of which reports are made. Null after unpickling.
  std::shared_ptr<const PathProblem> problem = nullptr;
  [[nodiscard]] const PlanResult& result() const { return plan->result; }
};

struct Check {
  CheckResult result;
  io::JointNames joint_names;
};

/// Whether there is a figure, as to_string() says it.
using MeasureStatusName = Typed<"Literal['measured', 'none', 'not_measured']">;

/// Throws ValueError if this build has no pages.
void require_pages();
/// Returns work done by name, as JSON names it.
[[nodiscard]] Typed<"dict[str, int]"> counters_of(const Counters& c);

}  // namespace swivel::python
