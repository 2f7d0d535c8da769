// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/problem/hooks.hpp"
#include "swivel/graph/search/path_first.hpp"

namespace swivel {

/// Why no path goes beyond the furthest layer that one reaches, and with `layers` what removed the nodes and edges just past it and
/// which later layers are empty. `path`: the best one to that layer; empty where layer 0 has no valid node. A function of the
/// problem and that path alone: the same for all planners. Looks until it would take more than about a second by a fixed estimate.
/// Throws Stopped; `diagnosis` then holds what was found, and `complete` is false.
void diagnose(const Lattice& lattice, const World& world, const EdgeRule& rule, const SlotPath& path, bool layers,
              const Budget& budget, Diagnosis& diagnosis, const std::shared_ptr<StateCheck>& check = nullptr);

/// The best valid path from layer 0 to a layer that one reaches. Throws Stopped.
[[nodiscard]] SlotPath best_path_to(const Lattice& lattice, const World& world, const EdgeRule& rule, int layer,
                                    const Budget& budget, const Hooks& hooks = {});

}  // namespace swivel
