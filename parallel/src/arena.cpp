// SPDX-License-Identifier: BSD-3-Clause
#include "arena.hpp"

#include <unistd.h>

#include <utility>

#ifndef __SANITIZE_THREAD__
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>

namespace swivel::detail {

struct Arena::Impl {
  pid_t process = getpid();
  int threads;
  /// TBB allows as many threads as the machine has cores, and prints a warning to stderr if an
  /// arena asks for more. This control raises the limit, and is set only then: the least of all
  /// controls of a process applies, so a lower one would slow the program's other work.
  std::optional<tbb::global_control> allowed;
  std::unique_ptr<tbb::task_arena> arena;
};

Arena::Arena(int threads) : impl_(std::make_unique<Impl>()) {
  impl_->threads = threads;
  if (threads > tbb::info::default_concurrency())
    impl_->allowed.emplace(tbb::global_control::max_allowed_parallelism,
                           static_cast<std::size_t>(threads));
  impl_->arena = std::make_unique<tbb::task_arena>(threads);
}

Arena::~Arena() {
  if (getpid() == impl_->process) return;
  // After a fork TBB's threads exist in the parent alone, and may hold locks here for ever; so
  // nothing is destroyed.
  static_cast<void>(impl_->arena.release());
  static_cast<void>(impl_.release());
}

int Arena::most_helpers() const {
  if (getpid() != impl_->process) return 0;
  const auto allowed =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::min(impl_->threads, static_cast<int>(std::min<std::size_t>(allowed, 1 << 20))) - 1;
}

void Arena::enqueue(std::function<void()> task) {
  impl_->arena->enqueue(std::move(task));
}

void Arena::for_each(int count, const std::function<void(int, int)>& body) {
  impl_->arena->execute([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, count, 1),
                      [&](const tbb::blocked_range<int>& range) {
                        const int worker = tbb::this_task_arena::current_thread_index();
                        for (int index = range.begin(); index != range.end(); ++index)
                          body(index, worker);
                      });
  });
}

}  // namespace swivel::detail

#else
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace swivel::detail {

struct Arena::Impl {
  int threads;
};

Arena::Arena(int threads) : impl_(new Impl{threads}) {}
Arena::~Arena() = default;

int Arena::most_helpers() const {
  return impl_->threads - 1;
}

void Arena::enqueue(std::function<void()> task) {
  std::thread(std::move(task)).detach();
}

void Arena::for_each(int count, const std::function<void(int, int)>& body) {
  std::atomic<int> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  std::vector<std::thread> workers;
  for (int worker = 0; worker < std::min(impl_->threads, count); ++worker)
    workers.emplace_back([&, worker] {
      try {
        for (int index; (index = next.fetch_add(1)) < count;) body(index, worker);
      } catch (...) {
        const std::lock_guard lock(failure_mutex);
        if (!failure) failure = std::current_exception();
      }
    });
  for (std::thread& worker : workers) worker.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace swivel::detail
#endif
