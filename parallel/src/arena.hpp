// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>

namespace swivel::detail {

/// A TBB arena for a caller and `threads` - 1 of TBB's threads. In builds with a thread sanitizer,
/// which reports false races within Debian's uninstrumented libtbb, it consists of plain threads
/// instead.
class Arena {
 public:
  explicit Arena(int threads);
  ~Arena();
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  /// Returns how many of TBB's threads may work here now: `threads` - 1, or less if the program has
  /// a tbb::global_control of its own; 0 in a process that was forked after construction.
  [[nodiscard]] int most_helpers() const;
  /// Runs `task` on one of TBB's threads as soon as one is free. Returns at once.
  void enqueue(std::function<void()> task);
  /// Calls body(index, worker) once for each index = 0 ... count - 1, on the caller's and TBB's
  /// threads, with worker in 0 ... threads - 1. Rethrows an exception that a body threw.
  void for_each(int count, const std::function<void(int index, int worker)>& body);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swivel::detail
