// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {

/// Finds from which slots of layer 0 of a closed lattice no path leads back to the slot over what
/// is not removed, and sets their items of `may_close` to 0: it goes once through all edges with
/// the set of slots from which each node is reached. Of many slots, neighbours share a bit, and one
/// that stays may close or not. The cost-to-go must be whole and swept to all slots of the last
/// layer that may close. Throws Stopped.
void leave_out_open_slots(CostToGo& cost_to_go, std::vector<std::uint8_t>& may_close);

}  // namespace swivel
