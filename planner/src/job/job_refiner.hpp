// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "refine/refine_until_timed.hpp"
#include "swivel/core/answer/answer.hpp"
#include "swivel/core/problem/problem.hpp"

namespace swivel {

/// Refines the runs among the parts of a job one by one, as refine_job() says.
class JobRefiner {
 public:
  /// Refines the runs among `parts`, which are replaced by what they become. All references must
  /// outlive the refiner.
  JobRefiner(const PreparedRobot& robot, const Problem& job, std::vector<Part>& parts,
             const RefineOptions& options, const Budget& budget)
      : robot_(robot),
        job_(job),
        parts_(parts),
        options_(options),
        budget_(budget),
        refined_(parts.size()) {}

  /// Refines the run that is parts[k] and, if asked for, times it: its rows are refined again with
  /// more clearance where they come too near between samples. Returns the motion.
  std::optional<MotionResult> refine(std::size_t k, const std::optional<TimingOptions>& timing);
  /// Refines the runs that refine() was not called for.
  void refine_others();

  /// Returns what refining made of the runs so far.
  [[nodiscard]] RefinedRuns runs() const;
  [[nodiscard]] double refine_ms() const { return refine_ms_; }

 private:
  const PreparedRobot& robot_;
  const Problem& job_;
  std::vector<Part>& parts_;
  const RefineOptions& options_;
  const Budget& budget_;
  std::vector<std::optional<Refined>> refined_;  // by part
  double refine_ms_ = 0;
};

}  // namespace swivel
