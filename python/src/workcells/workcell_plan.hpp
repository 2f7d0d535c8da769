// SPDX-License-Identifier: BSD-3-Clause
// The plan of a workcell as Python holds it.
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "bindings.hpp"
#include "swivel/core/problem/workcell.hpp"
#include "swivel/planner/workcell/time_workcell.hpp"

namespace swivel::python {

struct WorkcellPlan {
  std::shared_ptr<const WorkcellMotionPlan> plan;  // shared with trajectories
  std::optional<TimingOptions> timing = {};
  bool refined = false;                               ///< a refinement was asked for
  std::string frame = {};                             ///< name of the base link
  std::shared_ptr<const swivel::Workcell> cell = {};  ///< as it was given
  /// Returns the workcell as it was planned: with what motions and refinements need.
  [[nodiscard]] swivel::Workcell completed() const;
};

}  // namespace swivel::python
