// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace swivel::detail {

/// Of `count` distances, m: exactly the one that `rank` are smaller than, and what lies within
/// `beside` of it; of the others on which side of it they are, which takes less time. distance(k,
/// enough, limit) is as TriangleTree::distance: the distance k where it lies in [enough, limit],
/// something below `enough` where it is less, `limit` where it is more. None is `most` or more.
template <class Distance>
std::vector<double> distances_about(std::size_t count, std::size_t rank, double most, double beside,
                                    const Distance& distance) {
  // The first ones, known exactly, tell between which two the answer lies: their ranks are off by
  // 2.5 at most, mostly.
  constexpr std::size_t kFirst = 25, kApart = 4;
  std::vector<double> found;
  found.reserve(count);
  while (found.size() < std::min(kFirst, count)) found.push_back(distance(found.size(), 0.0, most));
  if (count <= kFirst) return found;
  std::vector<double> sorted = found;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t near = rank * kFirst / count;
  const double low = near < kApart ? 0 : sorted[near - kApart],
               high = near + kApart < kFirst ? sorted[near + kApart] : most;
  while (found.size() < count) found.push_back(distance(found.size(), low, high));
  const auto at_most = [&](double d) {
    return static_cast<std::size_t>(
        std::count_if(found.begin(), found.end(), [&](double x) { return x <= d; }));
  };
  const auto again = [&](const auto& beyond) {
    for (std::size_t k = kFirst; k < count; ++k)
      if (beyond(found[k])) found[k] = distance(k, 0.0, most);
  };
  if (at_most(low + beside) > rank) again([&](double x) { return x < low; });
  if (at_most(high - beside) <= rank) again([&](double x) { return x >= high; });
  return found;
}

}  // namespace swivel::detail
