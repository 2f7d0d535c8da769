// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <sys/types.h>

#include <functional>
#include <memory>

#include "arena.hpp"

namespace swivel::detail {

/// Helps one caller with loops of a few microseconds: tasks of a TBB arena that take indices of whatever loop is open, look for the
/// next loop for 2 ms, and then return their thread to TBB. Starting a task and waking its thread takes longer than such a loop,
/// hence the wait.
class Helpers {
 public:
  /// At most `most` tasks at a time, in `arena`, which must live as long.
  Helpers(Arena& arena, int most);
  /// Waits for tasks that run; a task that has not begun ends by itself later.
  ~Helpers();
  Helpers(const Helpers&) = delete;
  Helpers& operator=(const Helpers&) = delete;

  /// Whether a task was started and has not returned.
  [[nodiscard]] bool any() const;
  /// Calls body(index, worker) for index = first ... count - 1, in any order. The caller is worker 0, and does `work` first unless
  /// it is null; tasks are workers 1 ... most. Starts the tasks that have returned. Every index is called whatever throws; rethrows
  /// what `work` threw, else what a body threw first. Throws std::logic_error if called from within body or work.
  void share(int first, int count, const std::function<void(int index, int worker)>& body,
             const std::function<void()>* work = nullptr);
  /// Starts the tasks, for a caller who is about to share.
  void start();
  /// How many indices the tasks have called, all within the arena.
  [[nodiscard]] std::int64_t helped() const;

 private:
  struct State;
  void share_some(int first, int count, const std::function<void(int, int)>& body, const std::function<void()>* work);

  Arena* arena_;
  pid_t process_;
  bool sharing_ = false;
  std::shared_ptr<State> state_;  // tasks that have not begun may outlive their caller
};

}  // namespace swivel::detail
