// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/core/answer/workcell_result.hpp"

namespace swivel::cli {

/// Returns the answer of a workcell for people: what both arms do together, then a line about each
/// arm; where there is no plan, why.
[[nodiscard]] std::string workcell_text(const WorkcellResult& result);

}  // namespace swivel::cli
