// SPDX-License-Identifier: BSD-3-Clause
// Keywords that all functions which plan have.
#pragma once
#include <optional>

#include "bindings.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel::python {

/// Returns options of a plan. `planner`: a PlannerKind or its name; `threads`: 0 to 1024, 0 for all
/// cores; `timeout`: s; `prove`: whether answers are proved. Throws ValueError, which names the
/// keyword, for other values.
[[nodiscard]] PlanOptions to_plan_options(const py::object& planner, int threads,
                                          std::optional<double> timeout, bool prove = true);
/// Returns a function that passes progress on to Python every 20 ms at most: often enough to look
/// smooth, and seldom enough to cost nothing. It is empty for None. The Python object must outlive
/// it. Throws TypeError for what cannot be called.
[[nodiscard]] ProgressFunction to_progress(const py::object& progress);

}  // namespace swivel::python
