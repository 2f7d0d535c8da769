// SPDX-License-Identifier: BSD-3-Clause
#include "plan/layout/told_turns.hpp"

#include <algorithm>
#include <cmath>

#include "plan/layout/keeps_branch.hpp"
#include "swivel/core/base/angle.hpp"
#include "swivel/core/messages/formatted.hpp"

namespace swivel {

namespace {

/// The values that a joint has along a path, rad, unwrapped: at the first node, at the last, the
/// least and the greatest.
struct Sweep {
  double first, last, least, most;
};

Sweep sweep_of(const Lattice& lattice, const std::vector<int>& slots, Eigen::Index joint) {
  double value = (*lattice.node(0, slots[0]))[joint];
  Sweep sweep{value, value, value, value};
  for (std::size_t i = 1; i < slots.size(); ++i) {
    const int layer = static_cast<int>(i);
    value += lattice.delta(*lattice.node(layer - 1, slots[i - 1]),
                           *lattice.node(layer, slots[i]))[joint];
    sweep.least = std::min(sweep.least, value);
    sweep.most = std::max(sweep.most, value);
  }
  sweep.last = value;
  return sweep;
}

double degrees(double angle) {
  return angle * 180 / kPi;
}

/// Returns what turns_note() says of one joint that may go from `low` to `high`.
std::string note_of(const std::string& name, const Sweep& sweep, double low, double high,
                    const Task& task, Eigen::Index joint, const std::string& cheapest) {
  const std::string would = "but for its limits, " + name + " would turn ",
                    along = " deg along the cheapest " + cheapest + ": ";
  if (!task.start && !task.end) {
    if (sweep.most - sweep.least <= high - low) return {};
    return would + formatted("by %.0f", degrees(sweep.most - sweep.least)) + along +
           formatted("its range is %.0f deg", degrees(high - low));
  }
  // The path in the turn of its given start, else in that of its given end.
  const double turn =
      task.start ? (*task.start)[joint] - sweep.first : (*task.end)[joint] - sweep.last;
  const double over = sweep.most + turn - high, under = low - (sweep.least + turn);
  if (over <= 0 && under <= 0) return {};  // the other end's turn bars it
  const double first = sweep.first + turn, last = sweep.last + turn,
               furthest = over > under ? sweep.most + turn : sweep.least + turn;
  const double from = task.start ? first : furthest, to = task.start ? furthest : last;
  return would + formatted("from %.0f to %.0f", degrees(from), degrees(to)) + along +
         formatted("it may from %.0f to %.0f deg", degrees(low), degrees(high));
}

}  // namespace

bool may_tell_turns_apart(const Hooks& hooks) {
  const bool keeps_branch = dynamic_cast<const KeepsBranch*>(hooks.check.get()) != nullptr;
  return hooks.cost || (hooks.check && !keeps_branch);
}

void add_failed_nodes(const Verdicts& verdicts, const Lattice& lattice,
                      std::vector<std::vector<int>>& failed) {
  failed.resize(static_cast<std::size_t>(lattice.layers()));
  if (verdicts.removed() == 0) return;
  for (int layer = 0; layer < lattice.layers(); ++layer) {
    std::vector<int>& slots = failed[static_cast<std::size_t>(layer)];
    for (int slot = 0; slot < lattice.slots(layer); ++slot) {
      if (verdicts.node(layer, slot) != Verdict::kRemoved) continue;
      const int on_circles = lattice.slot_on_circles(layer, slot);
      if (on_circles >= 0) slots.push_back(on_circles);
    }
    std::sort(slots.begin(), slots.end());
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
  }
}

void remove_failed_nodes(const std::vector<std::vector<int>>& failed, const Lattice& lattice,
                         Verdicts& verdicts) {
  std::vector<int> images;
  for (int layer = 0; layer < lattice.layers(); ++layer) {
    const std::vector<int>& slots = failed[static_cast<std::size_t>(layer)];
    if (slots.empty()) continue;
    images.clear();
    for (int slot = 0; slot < lattice.slots(layer); ++slot)
      if (std::binary_search(slots.begin(), slots.end(), lattice.slot_on_circles(layer, slot)))
        images.push_back(slot);
    verdicts.remove_nodes(layer, images);
  }
}

std::string turns_note(const Lattice& lattice, const std::vector<int>& slots,
                       const Lattice::Joints& off, const Task& task, const std::string& cheapest) {
  for (std::size_t j = 0; j < kDof; ++j) {
    if (!off[j]) continue;
    const auto joint = static_cast<Eigen::Index>(j);
    const JointLimit& limit = lattice.chain().limit[j];
    const double margin = lattice.limits().joint_margin;
    std::string note = note_of(lattice.chain().joint_names[j], sweep_of(lattice, slots, joint),
                               limit.lower + margin, limit.upper - margin, task, joint, cheapest);
    if (!note.empty()) return note;
  }
  return {};
}

}  // namespace swivel
