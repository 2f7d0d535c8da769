// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <memory>

namespace swivel {

/// Runs loops over indices on the caller's thread and TBB's threads. A body must write only to its
/// own index (and its worker's workspace), so that results do not depend on the number of threads.
/// If the program limits TBB by a tbb::global_control, fewer threads help.
class Executor {
 public:
  /// Name of the spans of a Timeline in which a helper runs one index.
  static constexpr const char* kHelperSpan = "in TBB's arena";

  /// Creates an executor of `threads` threads, the caller's included; if threads < 1, as many as
  /// the machine has cores. No thread is started yet.
  explicit Executor(int threads);
  ~Executor();
  Executor(Executor&&) noexcept;
  Executor& operator=(Executor&&) noexcept;

  /// Returns the number of threads, the caller's included.
  [[nodiscard]] int threads() const;
  /// Calls body(index, worker) once for each index = 0 ... count - 1, with worker in 0 ...
  /// threads() - 1. A worker runs on one thread at a time. Rethrows an exception that a body threw.
  void for_each(int count, const std::function<void(int index, int worker)>& body);
  /// Calls body(index, worker) once for each index = 0 ... count - 1, for loops that may end before
  /// another thread is awake. The caller runs the first indices itself, as worker 0, and shares the
  /// rest once they would take it long enough to wake a helper, or at once if helpers are still
  /// awake. No thread is started before that. Helpers, at most 7, are tasks of a TBB arena that
  /// wait 2 ms for the next loop. Rethrows an exception that a body threw. Throws std::logic_error
  /// if called from within a body that is shared.
  void for_each_short(int count, const std::function<void(int index, int worker)>& body);
  /// Runs `work` on the caller's thread and calls body(index, worker) for each index = 0 ... count
  /// - 1 as for_each_short() does: on helpers meanwhile if any are awake, else after `work`. `work`
  /// must not share work itself. Rethrows what `work` threw, else what a body threw.
  void for_each_overlapped(int count, const std::function<void(int index, int worker)>& body,
                           const std::function<void()>& work);
  /// Starts the helpers of for_each_short() now, for a caller that expects enough work to share.
  /// Does nothing with one thread.
  void start_helpers();
  /// Returns how many indices of for_each_short() and for_each_overlapped() ran on helpers; all
  /// others ran on the caller's thread.
  [[nodiscard]] std::int64_t helped() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swivel
