// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

/// Throws InvalidArgument for options that only problems with one path have. `what` names what is
/// planned, in the plural.
inline void require_supported(const PlanOptions& options, const std::string& what) {
  if (options.planner == PlannerKind::kEager || options.planner == PlannerKind::kEagerDp)
    throw InvalidArgument("planner: allowed for " + what + " are lazy and parallel");
  if (options.hooks.check || options.hooks.cost)
    throw InvalidArgument("hooks: allowed for " + what + " are none");
}

}  // namespace swivel
