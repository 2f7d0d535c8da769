// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "swivel/core/answer/plan.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/problem/hooks.hpp"
#include "swivel/core/problem/path_problem.hpp"
#include "swivel/graph/verdicts/verdicts.hpp"

namespace swivel {

/// Returns which joints have limits, though the lattice treats them as circles. The roll of a tool
/// counts as none.
[[nodiscard]] inline Lattice::Joints bounded_circles(const Lattice& lattice) {
  Lattice::Joints circles{};
  for (std::size_t j = 0; j < kDof; ++j) {
    const JointLimit& limit = lattice.chain().limit[j];
    circles[j] = lattice.continuous()[j] && !limit.continuous && !limit.wide() &&
                 !(lattice.chain().roll && j + 1 == kDof);
  }
  return circles;
}

/// Throws InputError where a joint of over 64 turns, whose turns no lattice tells apart, comes back
/// on a closed path in another turn. There must be rows; `source` names the problem.
inline void require_same_turns(const Lattice& lattice, const std::vector<TrajectoryRow>& rows,
                               const std::string& source) {
  for (int j = 0; j < kDof && lattice.is_closed(); ++j) {
    const auto k = static_cast<std::size_t>(j);
    const double turns = std::round((rows.back().q[j] - rows.front().q[j]) / kTwoPi);
    if (lattice.chain().limit[k].wide() && turns != 0)
      throw InputError(source, "path.closed: joint '" + lattice.chain().joint_names[k] +
                                   "' comes back " + formatted("%+.0f", turns) +
                                   " turn(s) on, and whether another path brings it back is not "
                                   "known: allowed are joints without limits, or of at most 64 "
                                   "turns");
  }
}

/// Returns whether what the hooks say of a state may differ from turn to turn of a joint.
[[nodiscard]] bool may_tell_turns_apart(const Hooks& hooks);

/// Returns a lattice like `lattice` that treats no bounded joint as a circle.
[[nodiscard]] inline std::shared_ptr<Lattice> with_all_windings(std::shared_ptr<Lattice> lattice) {
  const Lattice::Joints circles = bounded_circles(*lattice);
  if (circles == Lattice::Joints{}) return lattice;
  std::shared_ptr<Lattice> wound = lattice->with_windings(circles);
  return wound ? wound : lattice;
}

/// Adds the nodes that were removed from a lattice, by layer, as Lattice::slot_on_circles() numbers
/// them: they fail in every turn. Adds none where these numbers are not known.
void add_failed_nodes(const Verdicts& verdicts, const Lattice& lattice,
                      std::vector<std::vector<int>>& failed);
/// Removes the images of nodes that failed.
void remove_failed_nodes(const std::vector<std::vector<int>>& failed, const Lattice& lattice,
                         Verdicts& verdicts);

/// Returns a line on the first of the joints `off` whose turning along the path `slots` does not
/// fit its limits: by how much it turns along that path, or, where the start or the end is given,
/// from where to where. `lattice` treats these joints as circles; `cheapest` says what is the
/// cheapest: a path, a job. Returns an empty line where each fits in some turn.
[[nodiscard]] std::string turns_note(const Lattice& lattice, const std::vector<int>& slots,
                                     const Lattice::Joints& off, const Task& task,
                                     const std::string& cheapest = "path");

}  // namespace swivel
