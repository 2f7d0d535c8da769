// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/infeasibility_certificate.hpp"
#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "swivel/core/problem/hooks.hpp"
#include "swivel/graph/search/pair_search.hpp"
#include "swivel/graph/verdicts/verdicts.hpp"
#include "swivel/planner/certificate/infeasibility_certificate.hpp"

namespace swivel {

struct ArmClass;

/// The lattice for which a certificate says that it is.
struct StatedLayout {
  const Resolution* resolution = nullptr;
  EdgeMode edges = EdgeMode::kContinuous;
  int layers = 0;
};
/// Throws InputError if a certificate is for another lattice than that of the problem and the arm,
/// which has `layers` layers.
void require_same_layout(const PathProblem& problem, const ArmClass& arm,
                         const StatedLayout& stated, int layers);

/// What regions of conflict with another arm remove of an arm. Regions are witnesses of its cut
/// besides its own causes: witness r below count() is region r, and witness count() + k is cause k.
class RegionSides {
 public:
  RegionSides() = default;
  /// Takes the sides of arm `arm` of regions, which must outlive it. Slots of a side ascend.
  RegionSides(std::vector<const ConflictRegion*> regions, int arm)
      : regions_(std::move(regions)), arm_(static_cast<std::size_t>(arm)) {}

  [[nodiscard]] int count() const { return static_cast<int>(regions_.size()); }
  [[nodiscard]] bool removes_node(int region, int layer, int slot) const {
    const ConflictRegion& of = *regions_[static_cast<std::size_t>(region)];
    return !of.of_moves && of.layer == layer &&
           std::binary_search(of.slots[arm_].begin(), of.slots[arm_].end(), slot);
  }
  [[nodiscard]] bool removes_edge(int region, int layer, int a, int b) const {
    const ConflictRegion& of = *regions_[static_cast<std::size_t>(region)];
    return of.of_moves && of.layer == layer &&
           std::find(of.moves[arm_].begin(), of.moves[arm_].end(), SlotMove{a, b}) !=
               of.moves[arm_].end();
  }
  /// Returns the first region that removes a node; -1 if none does.
  [[nodiscard]] int of_node(int layer, int slot) const {
    for (int region = 0; region < count(); ++region)
      if (removes_node(region, layer, slot)) return region;
    return -1;
  }
  /// Returns the first region that removes an edge; -1 if none does.
  [[nodiscard]] int of_edge(int layer, int a, int b) const {
    for (int region = 0; region < count(); ++region)
      if (removes_edge(region, layer, a, b)) return region;
    return -1;
  }

 private:
  std::vector<const ConflictRegion*> regions_;
  std::size_t arm_ = 0;
};

/// Returns a lattice in which the turns of joints are told apart as a certificate says, list by
/// list; null where a list has no joint, one of less than two turns, or one that was told apart
/// before.
[[nodiscard]] std::shared_ptr<Lattice> told_apart(std::shared_ptr<Lattice> lattice,
                                                  const std::vector<Lattice::Joints>& windings);

/// Returns a cut of a lattice in which no path is left once what `verdicts` call removed is left
/// out: its band and its witnesses. Throws InvalidArgument if there is a path, std::logic_error for
/// a removal that has no witness, and Stopped.
[[nodiscard]] InfeasibilityCertificate find_cut(const Lattice& lattice, const World& world,
                                                const EdgeRule& rule, const Verdicts& verdicts,
                                                const RegionSides& regions,
                                                const std::shared_ptr<StateCheck>& check,
                                                const Budget& budget);
/// Returns why a cut is none, in one line; an empty text if it is one. Adds the tests of witnesses
/// to `result`. Throws Stopped.
[[nodiscard]] std::string fault_of_cut(const Lattice& lattice, const World& world,
                                       const EdgeRule& rule, const InfeasibilityCertificate& cut,
                                       const RegionSides& regions,
                                       const std::shared_ptr<StateCheck>& check,
                                       const Budget& budget, CertificateCheck& result);

}  // namespace swivel
