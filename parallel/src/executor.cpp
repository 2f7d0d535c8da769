// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/parallel/executor.hpp"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "team.hpp"

namespace swivel {

namespace {

using Clock = std::chrono::steady_clock;
/// Work that is worth waking a thread, and beginning threads: what the caller has done alone since threads last helped counts as
/// well, since as much is likely to follow. On two cores waking costs some 10 us and beginning 0.5 ms.
constexpr Clock::duration kWorthWaking = std::chrono::microseconds(40);
constexpr Clock::duration kWorthBeginning = std::chrono::milliseconds(3);
/// What is left of a call and worth handing over.
constexpr Clock::duration kWorthSharing = std::chrono::microseconds(10);
constexpr int kMostHelpers = 7;  // of brief calls, which have few parts

}  // namespace

struct Executor::Impl {
  int threads = 1;
  Backend backend = Backend::kTbb;
  Clock::duration alone{0};  // what the caller has worked in brief calls since threads last helped
  /// TBB allows as many threads as the machine has cores, and prints a warning to stderr where more are asked for. Not set for
  /// fewer: the least of all controls holds for the whole process.
  std::unique_ptr<tbb::global_control> allowed;
  std::unique_ptr<tbb::task_arena> arena;
  std::unique_ptr<detail::Team> team;  // for brief calls
};

Executor::Executor(int threads, Backend backend) : impl_(std::make_unique<Impl>()) {
  impl_->threads = threads >= 1 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  impl_->backend = backend;
}
Executor::~Executor() = default;
Executor::Executor(Executor&&) noexcept = default;
Executor& Executor::operator=(Executor&&) noexcept = default;

int Executor::threads() const {
  return impl_->threads;
}

void Executor::for_each(int count, const std::function<void(int, int)>& body) {
  if (impl_->threads > 1 && count > 1) return share(count, body);
  for (int index = 0; index < count; ++index) body(index, 0);
}

void Executor::begin_brief() {
  if (impl_->threads > 1 && !impl_->team) impl_->team = std::make_unique<detail::Team>(std::min(kMostHelpers, impl_->threads - 1));
}

void Executor::for_each_beside(int count, const std::function<void(int, int)>& body, const std::function<void()>& work) {
  if (count > 0 && impl_->team && impl_->team->awake()) return impl_->team->share(0, count, body, &work);
  work();
  for_each_brief(count, body);
}

void Executor::for_each_brief(int count, const std::function<void(int, int)>& body) {
  if (impl_->threads == 1 || count <= 1) {
    for (int index = 0; index < count; ++index) body(index, 0);
    return;
  }
  if (impl_->team && impl_->team->awake()) return impl_->team->share(0, count, body);
  const Clock::time_point begin = Clock::now();
  for (int index = 0; index < count; ++index) {
    const Clock::duration lasted = Clock::now() - begin;
    const Clock::duration left = index > 0 ? lasted / index * (count - index) : Clock::duration(0);
    if (left > kWorthSharing && impl_->alone + left > (impl_->team ? kWorthWaking : kWorthBeginning)) {
      begin_brief();
      impl_->alone = Clock::duration(0);
      return impl_->team->share(index, count, body);
    }
    body(index, 0);
  }
  impl_->alone += Clock::now() - begin;
}

void Executor::share(int count, const std::function<void(int, int)>& body) {
  if (impl_->backend == Backend::kTbb) {
    if (!impl_->arena) {
      impl_->allowed = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                             static_cast<std::size_t>(impl_->threads));
      impl_->arena = std::make_unique<tbb::task_arena>(impl_->threads);
    }
    impl_->arena->execute([&] {
      tbb::parallel_for(tbb::blocked_range<int>(0, count, 1), [&](const tbb::blocked_range<int>& range) {
        const int worker = tbb::this_task_arena::current_thread_index();
        for (int index = range.begin(); index != range.end(); ++index) body(index, worker);
      });
    });
    return;
  }
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

}  // namespace swivel
