// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "swivel/collision/world.hpp"
#include "swivel/core/budget.hpp"
#include "swivel/core/hooks.hpp"
#include "swivel/core/plan.hpp"
#include "swivel/core/srs_lattice.hpp"

namespace swivel {

/// Why no path goes beyond the deepest layer that one reaches (-1: none has a node in layer 0), and with `layers` what removed the
/// nodes and edges just past it and which later layers are empty. A function of the problem and that layer alone: the same for all
/// planners. Later layers are looked at until they would take more than about a second by a fixed estimate. Throws Stopped;
/// `diagnosis` then holds what was found, and `complete` is false.
void diagnose(const SrsLattice& lattice, const World& world, const EdgeRule& rule, int deepest_layer, bool layers,
              const Budget& budget, Diagnosis& diagnosis, const std::shared_ptr<StateCheck>& check = nullptr);

}  // namespace swivel
