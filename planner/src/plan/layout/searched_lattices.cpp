// SPDX-License-Identifier: BSD-3-Clause
#include "plan/layout/searched_lattices.hpp"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <utility>

namespace swivel {

SearchedLattices::SearchedLattices(Ptr first) {
  first_.lattice = std::move(first);
}

template <class Make>
SearchedLattices::Ptr SearchedLattices::get(const Ptr& from, const std::set<int>& steps,
                                            const Lattice::Joints& joints, const Make& make) {
  const auto known = std::find_if(others_.begin(), others_.end(), [&](const Kept& kept) {
    return kept.from == from && kept.steps == steps && kept.joints == joints;
  });
  if (known != others_.end()) {
    others_.splice(others_.begin(), others_, known);
    return known->lattice;
  }
  Ptr made = make();
  if (made) others_.push_front({from, steps, joints, made, {}});
  return made;
}

SearchedLattices::Ptr SearchedLattices::with_knots(const Ptr& from, const std::set<int>& steps,
                                                   const Budget& budget) {
  return get(from, steps, {}, [&] { return Ptr(from->with_knots(steps, budget)); });
}

SearchedLattices::Ptr SearchedLattices::with_windings(const Ptr& from,
                                                      const Lattice::Joints& joints) {
  return get(from, {}, joints, [&] { return Ptr(from->with_windings(joints)); });
}

SearchedLattices::Ptr SearchedLattices::second(const std::function<Ptr()>& make) {
  return get(nullptr, {}, {}, make);
}

void SearchedLattices::forget_old() {
  constexpr std::size_t kMost = 8;
  constexpr std::int64_t kMostNodes = 1'000'000;  // some 20 to 100 bytes each
  std::int64_t nodes = 0;
  std::size_t count = 0;
  auto kept = others_.begin();
  for (; kept != others_.end() && count < kMost; ++kept, ++count)
    if ((nodes += kept->lattice->nodes()) > kMostNodes) break;
  others_.erase(kept, others_.end());
}

ClearanceMemory& SearchedLattices::memory_of(const Lattice& lattice) {
  if (first_.lattice.get() == &lattice) return first_.memory;
  for (Kept& kept : others_)
    if (kept.lattice.get() == &lattice) return kept.memory;
  throw std::logic_error("not a lattice of the task");
}

void SearchedLattices::object_removed(int object) {
  first_.memory.object_removed(object);
  for (Kept& kept : others_) kept.memory.object_removed(object);
}

void SearchedLattices::take_clearances(const Limits& limits) {
  first_.lattice->take_clearances(limits);
  first_.memory = {};
  for (Kept& kept : others_) {
    kept.lattice->take_clearances(limits);
    kept.memory = {};
  }
}

}  // namespace swivel
