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

/// Finds why no path goes beyond the furthest layer that one reaches, and with `layers` also what
/// removed the nodes and edges just past it and which later layers are empty. `path` is the best
/// path to that layer; empty if layer 0 has no valid node. The result depends on the problem and
/// that path alone, so it is the same for all planners. The search ends when it would take more
/// than about a second by a fixed estimate. Throws Stopped; `diagnosis` then holds what was found,
/// and `complete` is false.
void diagnose(const Lattice& lattice, const World& world, const EdgeRule& rule,
              const SlotPath& path, bool layers, const Budget& budget, Diagnosis& diagnosis,
              const std::shared_ptr<StateCheck>& check = nullptr);

/// Returns the best valid path from layer 0 to `layer`, which a valid path must reach. Throws
/// Stopped.
[[nodiscard]] SlotPath best_path_to(const Lattice& lattice, const World& world,
                                    const EdgeRule& rule, int layer, const Budget& budget,
                                    const Hooks& hooks = {});

}  // namespace swivel
