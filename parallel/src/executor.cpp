// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/parallel/executor.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "arena.hpp"
#include "helpers.hpp"

namespace swivel {

namespace {

using Clock = std::chrono::steady_clock;
/// The work, estimated in time, for which it pays to wake a helper, or to start TBB's first
/// threads. What the caller has done alone since helpers last helped counts too, because as much is
/// likely to follow. On two cores waking takes some 10 us and starting 0.5 ms.
constexpr Clock::duration kWorthWaking = std::chrono::microseconds(40);
constexpr Clock::duration kWorthBeginning = std::chrono::milliseconds(3);
/// The rest of a loop, estimated in time, that is worth sharing.
constexpr Clock::duration kWorthSharing = std::chrono::microseconds(10);
constexpr int kMostHelpers = 7;  // in brief loops, which have few indices

}  // namespace

struct Executor::Impl {
  int threads = 1;
  Clock::duration alone{0};  // the caller's time in brief loops since helpers last helped
  std::unique_ptr<detail::Arena> arena;
  std::unique_ptr<detail::Helpers> helpers;  // for brief loops; tasks of the arena

  detail::Arena& in_arena() {
    if (!arena) arena = std::make_unique<detail::Arena>(threads);
    return *arena;
  }
};

Executor::Executor(int threads) : impl_(std::make_unique<Impl>()) {
  impl_->threads =
      threads >= 1 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}
Executor::~Executor() = default;
Executor::Executor(Executor&&) noexcept = default;
Executor& Executor::operator=(Executor&&) noexcept = default;

int Executor::threads() const {
  return impl_->threads;
}

std::int64_t Executor::helped() const {
  return impl_->helpers ? impl_->helpers->helped() : 0;
}

void Executor::for_each(int count, const std::function<void(int, int)>& body) {
  if (impl_->threads > 1 && count > 1) return impl_->in_arena().for_each(count, body);
  for (int index = 0; index < count; ++index) body(index, 0);
}

void Executor::start_helpers() {
  if (impl_->threads == 1) return;
  if (!impl_->helpers)
    impl_->helpers = std::make_unique<detail::Helpers>(impl_->in_arena(),
                                                       std::min(kMostHelpers, impl_->threads - 1));
  impl_->helpers->start();
}

void Executor::for_each_overlapped(int count, const std::function<void(int, int)>& body,
                                   const std::function<void()>& work) {
  if (count > 0 && impl_->helpers && impl_->helpers->any())
    return impl_->helpers->share(0, count, body, &work);
  work();
  for_each_short(count, body);
}

void Executor::for_each_short(int count, const std::function<void(int, int)>& body) {
  if (impl_->threads == 1 || count <= 1) {
    for (int index = 0; index < count; ++index) body(index, 0);
    return;
  }
  if (impl_->helpers && impl_->helpers->any()) return impl_->helpers->share(0, count, body);
  const Clock::time_point begin = Clock::now();
  for (int index = 0; index < count; ++index) {
    const Clock::duration lasted = Clock::now() - begin;
    const Clock::duration left = index > 0 ? lasted / index * (count - index) : Clock::duration(0);
    if (left > kWorthSharing &&
        impl_->alone + left > (impl_->helpers ? kWorthWaking : kWorthBeginning)) {
      start_helpers();
      impl_->alone = Clock::duration(0);
      return impl_->helpers->share(index, count, body);
    }
    body(index, 0);
  }
  impl_->alone += Clock::now() - begin;
}

}  // namespace swivel
