// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {

/// Returns at which of the nodes 0 ... count - 1 of layer 0, in slot order, the answer begins; -1
/// where `least` is kUnreachable. cost(k) is the least cost of a path from node k, `least` the
/// least of all, joints(k) the node's joints.
template <class Cost, class Joints>
int best_start(const Lattice& lattice, int count, double least, const Cost& cost,
               const Joints& joints) {
  if (least == kUnreachable) return -1;
  const double coarse = lattice.coarse_cost(least),
               most = lattice.largest_of_same_coarse_cost(least);
  int best = -1;
  double nearest = kUnreachable;  // distance of `best` from the middle, once it has a rival
  for (int k = 0; k < count; ++k) {
    if (cost(k) > most || lattice.coarse_cost(cost(k)) != coarse) continue;
    if (best < 0) {
      best = k;
      continue;
    }
    if (nearest == kUnreachable) nearest = lattice.off_middle(joints(best));
    if (const double off = lattice.off_middle(joints(k)); off < nearest) nearest = off, best = k;
  }
  return best;
}

}  // namespace swivel
