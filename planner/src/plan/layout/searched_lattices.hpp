// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <list>
#include <memory>
#include <set>

#include "swivel/core/base/budget.hpp"
#include "swivel/core/lattice/lattice.hpp"
#include "validity/clearance_memory.hpp"

namespace swivel {

/// The lattices of one task that a planner has searched, each with what its plans found out about
/// the nodes and edges. A lattice depends on the task alone, and not on obstacles, so that the next
/// plan of the task that asks for the same one need not make it.
class SearchedLattices {
 public:
  using Ptr = std::shared_ptr<Lattice>;

  /// Begins with the lattice that every plan of the task searches first, which is kept always.
  explicit SearchedLattices(Ptr first);

  /// Returns Lattice::with_knots() of a lattice; null where there is none. Throws Stopped.
  [[nodiscard]] Ptr with_knots(const Ptr& from, const std::set<int>& steps, const Budget& budget);
  /// Returns Lattice::with_windings() of a lattice.
  [[nodiscard]] Ptr with_windings(const Ptr& from, const Lattice::Joints& joints);
  /// Returns the lattice that is searched second, which `make` makes. Throws as `make` does.
  [[nodiscard]] Ptr second(const std::function<Ptr()>& make);
  /// Forgets lattices until few are left, those asked for last; references by memory_of() end.
  void forget_old();

  /// Returns what plans found out about the nodes and edges of a lattice of this object.
  [[nodiscard]] ClearanceMemory& memory_of(const Lattice& lattice);
  /// Tells all memories that a scene object was removed (ClearanceMemory::object_removed()).
  void object_removed(int object);
  /// Changes the least clearances of all lattices and forgets what plans found out. No other object
  /// may use the lattices.
  void take_clearances(const Limits& limits);

 private:
  struct Kept {
    Ptr from;  // null: of first lattice and free lattice
    std::set<int> steps;
    Lattice::Joints joints{};
    Ptr lattice;
    ClearanceMemory memory;
  };
  template <class Make>
  Ptr get(const Ptr& from, const std::set<int>& steps, const Lattice::Joints& joints,
          const Make& make);

  Kept first_;
  std::list<Kept> others_;  // the one asked for last first
};

}  // namespace swivel
