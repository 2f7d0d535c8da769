// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <vector>

#include "base/bindings.hpp"
#include "swivel/planner/measure/state_clearance.hpp"

namespace swivel::python {

/// Clearances of a batch of states, as Python holds them.
struct Clearances {
  std::shared_ptr<const StateClearances> result;
};

/// Returns states from an array (n, width) or (width,), rad. Throws ValueError for other shapes and
/// numbers that are not finite.
[[nodiscard]] std::vector<Config> to_states(py::handle joints, std::size_t width);

}  // namespace swivel::python
