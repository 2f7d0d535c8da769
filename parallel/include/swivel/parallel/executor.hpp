// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>

namespace swivel {

/// Runs index ranges on a fixed number of threads. What runs must write only to its own index (and its worker's workspace), so that
/// results do not depend on the number of threads.
class Executor {
 public:
  /// kThreads: plain std::thread, for thread sanitizers, which do not understand an uninstrumented TBB.
  enum class Backend { kTbb, kThreads };
  /// threads < 1: as many as the machine has cores.
  explicit Executor(int threads, Backend backend = Backend::kTbb);
  ~Executor();
  Executor(Executor&&) noexcept;
  Executor& operator=(Executor&&) noexcept;

  [[nodiscard]] int threads() const;
  /// Calls body(index, worker) for index = 0 ... count - 1, worker in 0 ... threads() - 1, each worker on one thread at a time.
  /// Exceptions of body reach the caller.
  void for_each(int count, const std::function<void(int index, int worker)>& body);
  /// The same for calls that may be over before another thread is awake: the caller makes the first ones itself, as worker 0, and
  /// shares out what is left once that would keep it for long, or at once with threads that are still awake. Until then no thread
  /// is begun. By threads of its own, whatever the backend; not from within body.
  void for_each_brief(int count, const std::function<void(int index, int worker)>& body);
  /// The same beside `work`, which the caller does first and which shares nothing itself. Exceptions of `work` come before those of
  /// `body`.
  void for_each_beside(int count, const std::function<void(int index, int worker)>& body, const std::function<void()>& work);
  /// Begins those threads now, for a caller who knows that there will be enough to share.
  void begin_brief();

 private:
  void share(int count, const std::function<void(int index, int worker)>& body);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace swivel
