// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <utility>

#include "plan/layout/task_lattice.hpp"
#include "swivel/graph/cost_to_go/cost_to_go.hpp"

namespace swivel {

/// Lattices of tasks of one robot, with their cost-to-go without obstacles. Planners on several
/// threads share them, so that the lattice of a path is made once, however many scenes the path is
/// planned in. A planner that shares a lattice gets the values that it would compute by itself, bit
/// for bit.
class LatticeCache {
 public:
  /// What the planners of one task share.
  class Entry {
   public:
    /// `of`, at `frame`, the pose of the path's frame.
    Entry(Task of, const Pose& frame) : task_(std::move(of)), frame_(frame) {}
    [[nodiscard]] const std::shared_ptr<const TaskLattice>& lattice() const { return lattice_; }
    /// Gives a new cost-to-go of lattice()->first() its values without obstacles. The first planner
    /// of a task that comes here computes its own; they are kept from the second one on, because
    /// most paths that are planned once are never planned again. Throws Stopped.
    void begin(CostToGo& cost_to_go);

   private:
    friend class LatticeCache;
    Task task_;
    Pose frame_;
    std::mutex mutex_;  // of what follows
    std::shared_ptr<const TaskLattice> lattice_;
    std::shared_ptr<const CostToGo::SavedValues> values_;
    bool came_before_ = false;
    std::atomic<std::int64_t> nodes_ = 0;
  };

  /// Returns what is shared of the task of a problem; makes its lattice if there is none, while
  /// other threads that want the same one wait. `robot` and `hooks` must be the same in all
  /// calls, and `robot` outlive all entries. Throws as TaskLattice does.
  [[nodiscard]] std::shared_ptr<Entry> of(const PreparedRobot& robot, const PathProblem& problem,
                                          const Hooks& hooks, const Budget& budget);
  /// Returns how many lattices were made so far.
  [[nodiscard]] std::int64_t made() const { return made_; }

 private:
  [[nodiscard]] std::shared_ptr<Entry> entry_of(const PathProblem& problem);

  std::mutex mutex_;
  std::list<std::shared_ptr<Entry>> entries_;  // the one asked for last first
  std::atomic<std::int64_t> made_ = 0;
};

}  // namespace swivel
