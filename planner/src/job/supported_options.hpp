// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

/// Throws InvalidArgument for options that jobs do not have.
inline void require_supported(const PlanOptions& options) {
  if (options.planner == PlannerKind::kEager || options.planner == PlannerKind::kEagerDp)
    throw InvalidArgument("planner: allowed for jobs are lazy and parallel");
  if (options.hooks.check || options.hooks.cost)
    throw InvalidArgument("hooks: allowed for jobs are none");
}

}  // namespace swivel
