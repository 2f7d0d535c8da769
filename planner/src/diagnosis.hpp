// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/collision/world.hpp"
#include "swivel/core/lattice.hpp"
#include "swivel/core/plan.hpp"

namespace swivel {

/// Why there is no path: the layers without nodes, and what removed nodes and edges just past the deepest layer reached.
/// Looks at layers one by one and stops in each at the first valid node, so it is cheap where most layers are fine.
[[nodiscard]] Diagnosis diagnose(const Lattice& lattice, const World& world, const EdgeRule& rule, int deepest_layer);

}  // namespace swivel
