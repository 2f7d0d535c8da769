// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <sys/types.h>

#include <functional>
#include <memory>

#include "arena.hpp"

namespace swivel::detail {

/// Helps one caller with loops of a few microseconds. Helpers are tasks of a TBB arena that run
/// indices of the loop that is open, wait 2 ms for the next loop, and then return their thread to
/// TBB. They wait because starting a task and waking its thread takes longer than such a loop.
class Helpers {
 public:
  /// Allows at most `most` tasks at a time in `arena`, which must outlive this object.
  Helpers(Arena& arena, int most);
  /// Waits for the tasks that run. A task that has not begun ends by itself later.
  ~Helpers();
  Helpers(const Helpers&) = delete;
  Helpers& operator=(const Helpers&) = delete;

  /// Returns true if a task was started and has not returned.
  [[nodiscard]] bool any() const;
  /// Calls body(index, worker) once for each index = first ... count - 1, in any order. The caller
  /// is worker 0 and runs `work` first, unless it is null; tasks are workers 1 ... most. Starts the
  /// tasks that have returned. Every index is run even if a body throws; afterwards rethrows what
  /// `work` threw, else the first exception of a body. Throws std::logic_error if called from
  /// within body or work.
  void share(int first, int count, const std::function<void(int index, int worker)>& body,
             const std::function<void()>* work = nullptr);
  /// Starts the tasks that do not run, for a caller that is about to share.
  void start();
  /// Returns how many indices the tasks have run since construction.
  [[nodiscard]] std::int64_t helped() const;

 private:
  struct State;
  void share_some(int first, int count, const std::function<void(int, int)>& body,
                  const std::function<void()>* work);

  Arena* arena_;
  pid_t process_;
  bool sharing_ = false;
  std::shared_ptr<State> state_;  // tasks that have not begun may outlive their caller
};

}  // namespace swivel::detail
