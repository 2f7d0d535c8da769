// SPDX-License-Identifier: BSD-3-Clause
#include "plan/layout/lattice_cache.hpp"

#include <algorithm>
#include <utility>

namespace swivel {

namespace {

/// Returns the pose of the path's frame in the base frame.
Pose path_frame_of(const PathProblem& problem) {
  const auto object = std::find_if(problem.scene.begin(), problem.scene.end(),
                                   [&](const auto& o) { return o.name == problem.path_frame; });
  return object == problem.scene.end() ? Pose(Pose::Identity()) : object->pose;
}

}  // namespace

void LatticeCache::Entry::begin(CostToGo& cost_to_go) {
  const std::lock_guard lock(mutex_);
  if (!std::exchange(came_before_, true)) return;
  if (!values_) {
    cost_to_go.sweep(cost_to_go.lattice().layers() - 1);
    values_ = cost_to_go.values_without_removals();
  } else {
    cost_to_go.begin_with(values_);
  }
}

std::shared_ptr<LatticeCache::Entry> LatticeCache::entry_of(const PathProblem& problem) {
  constexpr std::int64_t kMostNodes = 4'000'000;  // some 20 to 100 bytes each
  constexpr std::size_t kMostTasks = 64;
  const Pose frame = path_frame_of(problem);
  const std::lock_guard lock(mutex_);
  const auto known = std::find_if(entries_.begin(), entries_.end(), [&](const auto& entry) {
    return entry->frame_.matrix() == frame.matrix() && same_task(entry->task_, problem);
  });
  if (known != entries_.end())
    entries_.splice(entries_.begin(), entries_, known);
  else
    entries_.push_front(std::make_shared<Entry>(problem, frame));
  std::int64_t nodes = 0;
  std::size_t kept = 0;
  auto entry = entries_.begin();
  for (; entry != entries_.end() && kept < kMostTasks; ++entry, ++kept)
    if ((nodes += (*entry)->nodes_) > kMostNodes && kept > 0) break;
  entries_.erase(entry, entries_.end());
  return entries_.front();
}

std::shared_ptr<LatticeCache::Entry> LatticeCache::of(const PreparedRobot& robot,
                                                      const PathProblem& problem,
                                                      const Hooks& hooks, const Budget& budget) {
  std::shared_ptr<Entry> entry = entry_of(problem);
  const std::lock_guard lock(entry->mutex_);
  if (!entry->lattice_) {
    entry->lattice_ = std::make_shared<const TaskLattice>(robot, problem, hooks, budget);
    entry->nodes_ = entry->lattice_->first()->nodes();
    ++made_;
  }
  return entry;
}

}  // namespace swivel
