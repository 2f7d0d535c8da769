// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "swivel/report/lattice_map.hpp"

namespace swivel {

/// False in a build with SWIVEL_REPORT=OFF, which has no page to fill.
[[nodiscard]] bool page_available();

/// One HTML file that needs nothing else: the arm among the scene in three dimensions, the (s, phi) map, plots over s, summary.
/// `result_json`: the result in the format of `--json`. Made after planning: clearances along the path are asked for again. Throws
/// Stopped.
[[nodiscard]] std::string to_page(const PlanView& view, const LatticeMap& map, const std::string& result_json,
                                  const Budget& budget = {});

}  // namespace swivel
