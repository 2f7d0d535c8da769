// SPDX-License-Identifier: BSD-3-Clause
#include "lattice/circle_turns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "swivel/core/base/angle.hpp"

namespace swivel {

namespace {

/// The least, first and largest value of a joint along rows, rad.
struct Extent {
  double least = 0, first = 0, most = 0;
};

Extent extent_of(const std::vector<Config>& rows, Eigen::Index joint) {
  Extent extent{rows[0][joint], rows[0][joint], rows[0][joint]};
  for (const Config& q : rows) {
    extent.least = std::min(extent.least, q[joint]);
    extent.most = std::max(extent.most, q[joint]);
  }
  return extent;
}

/// Returns the turn, rad, that takes an extent into lower ... upper, and its first value as near to
/// the middle of the range as possible, the lower of two as near; nothing if none does.
std::optional<double> best_turn(const Extent& extent, double lower, double upper) {
  constexpr double kAlike = 1e-9;  // rad: two turns whose first values are as near to the middle
  const double least = std::ceil((lower - extent.least) / kTwoPi),
               most = std::floor((upper - extent.most) / kTwoPi);
  if (!(least <= most)) return std::nullopt;
  const double wanted = ((lower + upper) / 2 - extent.first) / kTwoPi,
               below = std::clamp(std::floor(wanted), least, most),
               above = std::clamp(std::floor(wanted) + 1, least, most);
  const auto off = [&](double turns) { return std::abs(turns - wanted) * kTwoPi; };
  return (off(above) < off(below) - kAlike ? above : below) * kTwoPi;
}

/// Returns by how much an extent that fits into lower ... upper in no turn leaves it in the best
/// one, rad.
double least_over(const Extent& extent, double lower, double upper) {
  const double center = (extent.least + extent.most) / 2, middle = (lower + upper) / 2,
               off = std::abs(std::remainder(center - middle, kTwoPi));
  return (extent.most - extent.least) / 2 + off - (upper - lower) / 2;
}

}  // namespace

CircleTurns circle_turns(const Lattice& lattice, const Lattice::Joints& circles,
                         const std::vector<Config>& rows, bool starts_given, const Config* end) {
  CircleTurns turns;
  for (std::size_t j = 0; j < kDof && !rows.empty(); ++j) {
    if (!circles[j]) continue;
    const auto joint = static_cast<Eigen::Index>(j);
    const JointLimit& limit = lattice.chain().limit[j];
    const double inside = lattice.limits().joint_margin - kLimitTolerance,
                 lower = limit.lower + inside, upper = limit.upper - inside;
    const Extent extent = extent_of(rows, joint);
    const bool closes =
        lattice.is_closed() && static_cast<int>(rows.size()) == lattice.path_of_rows().size();
    // No lattice tells the turns of a wide joint apart.
    if (!limit.wide() && ((closes && std::abs(rows.back()[joint] - rows.front()[joint]) > kPi) ||
                          (end != nullptr && std::abs(rows.back()[joint] - (*end)[joint]) > kPi)))
      turns.over[joint] = std::numeric_limits<double>::infinity();
    else if (starts_given || end != nullptr)
      turns.over[joint] = std::max({lower - extent.least, extent.most - upper, 0.0});
    else if (const auto turn = best_turn(extent, lower, upper))
      turns.turn[joint] = *turn;
    else
      turns.over[joint] = std::max(least_over(extent, lower, upper), kLimitTolerance);
  }
  return turns;
}

Lattice::Joints CircleTurns::furthest_over() const {
  Lattice::Joints joints{};
  Eigen::Index furthest = 0;
  if (!fit()) {
    over.maxCoeff(&furthest);
    joints[static_cast<std::size_t>(furthest)] = true;
  }
  return joints;
}

}  // namespace swivel
