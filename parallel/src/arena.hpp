// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>

namespace swivel::detail {

/// A TBB arena of a caller and `threads` - 1 of TBB's threads. Built under a thread sanitizer, which reports races within Debian's
/// uninstrumented libtbb, it is made of plain threads.
class Arena {
 public:
  explicit Arena(int threads);
  ~Arena();
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  /// How many of TBB's threads may work here now: what was asked for, less where the program has a tbb::global_control of its own.
  [[nodiscard]] int most_helpers() const;
  /// Runs `task` on one of TBB's threads as soon as one is free.
  void enqueue(std::function<void()> task);
  /// Calls body(index, worker) for index = 0 ... count - 1 on the caller's and TBB's threads, worker in 0 ... threads - 1.
  void for_each(int count, const std::function<void(int index, int worker)>& body);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swivel::detail
