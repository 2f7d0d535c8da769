// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <memory>

namespace swivel {

/// Runs loops over indices on the caller's thread and those of TBB. A body must write only to its own index (and its worker's
/// workspace), so that results do not depend on the number of threads. Where the program limits TBB by a tbb::global_control, fewer
/// threads help.
class Executor {
 public:
  /// threads < 1: as many as the machine has cores.
  explicit Executor(int threads);
  ~Executor();
  Executor(Executor&&) noexcept;
  Executor& operator=(Executor&&) noexcept;

  [[nodiscard]] int threads() const;
  /// Calls body(index, worker) for index = 0 ... count - 1, worker in 0 ... threads() - 1, each worker on one thread at a time.
  /// Exceptions of body reach the caller.
  void for_each(int count, const std::function<void(int index, int worker)>& body);
  /// Does what for_each() does, for loops that may be over before another thread is awake: the caller calls body for the first
  /// indices itself, as worker 0, and shares the others once they would keep it for long, or at once with helpers that are still
  /// awake. Until then no thread is begun. Helpers are tasks of a TBB arena that look for the next loop for 2 ms. Throws
  /// std::logic_error if called from within body.
  void for_each_brief(int count, const std::function<void(int index, int worker)>& body);
  /// Does what for_each_brief() does beside `work`, which the caller does first and which must not share work itself. Exceptions of
  /// `work` come before those of `body`.
  void for_each_beside(int count, const std::function<void(int index, int worker)>& body, const std::function<void()>& work);
  /// Starts the helpers of for_each_brief() now, for a caller who knows that there will be enough to share.
  void begin_brief();
  /// How many indices of for_each_brief() and for_each_beside() helpers have called; the caller called all others.
  [[nodiscard]] std::int64_t helped() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swivel
