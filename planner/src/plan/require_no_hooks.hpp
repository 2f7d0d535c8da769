// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

/// Throws InvalidArgument for options that problems with two arms do not have.
inline void require_no_hooks(const PlanOptions& options) {
  if (options.hooks.check || options.hooks.cost)
    throw InvalidArgument("hooks: allowed for two arms are none");
}

}  // namespace swivel
