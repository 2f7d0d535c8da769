// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "swivel/core/lattice/kinds/srs_lattice.hpp"

namespace swivel::test {

/// Says by the definition whether two nodes of neighbouring layers may be joined: their grid
/// angles, the nearest to their own, are within the window. A given start counts with its own
/// angle.
inline bool window_allows(const SrsLattice& lattice, int layer, int a, int b) {
  const double step = kTwoPi / lattice.angles();
  const auto cell = [&](int i, int slot) {
    const double phi = lattice.phi(i, slot);
    return i == 0 && lattice.has_start() ? phi : step * std::round((phi + kPi) / step) - kPi;
  };
  return std::abs(std::remainder(cell(layer + 1, b) - cell(layer, a), kTwoPi)) <=
         lattice.window() * step + 1e-9;
}

}  // namespace swivel::test
