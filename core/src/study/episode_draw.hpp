// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "base/split_mix.hpp"
#include "swivel/core/problem/path_problem.hpp"

namespace swivel {

/// Calls each(variation, offset (m), (roll, pitch, yaw) (rad)) with what is drawn for each
/// variation in an episode.
template <class Each>
void draw_episode(const std::vector<Variation>& vary, std::uint64_t seed, std::uint64_t episode,
                  const Each& each) {
  SplitMix64 random(seed, episode);
  for (const Variation& one : vary) {
    Vector3d offset, rpy;
    for (int k = 0; k < 3; ++k) offset[k] = one.xyz[k] * random.symmetric();
    for (int k = 0; k < 3; ++k) rpy[k] = one.rpy[k] * random.symmetric();
    each(one, offset, rpy);
  }
}

}  // namespace swivel
