// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/plan.hpp"

namespace swivel::cli {

/// Why an infeasible problem has no path, for people: one line, then a line for every run of layers that are empty for one reason.
[[nodiscard]] std::string diagnosis_text(const PlanResult& result);

}  // namespace swivel::cli
