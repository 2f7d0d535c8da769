// SPDX-License-Identifier: BSD-3-Clause
#include "team.hpp"

#include <chrono>
#include <utility>

namespace swivel::detail {

namespace {

using Clock = std::chrono::steady_clock;
/// What a plan does between two batches of questions.
constexpr Clock::duration kStayAwake = std::chrono::milliseconds(2);
constexpr int kLooks = 16;  // between two looks at the clock

constexpr std::uint64_t kShared = std::uint64_t{1} << 32;
std::uint64_t left_of(std::uint64_t open) {
  return open % kShared;
}

}  // namespace

Team::Team(int helpers) {
  for (int k = 0; k < helpers; ++k) helpers_.emplace_back([this, worker = k + 1] { help(worker); });
}

Team::~Team() {
  ended_ = true;
  open_ += kShared;
  open_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

/// False where nobody's help is wanted. Work that was shared since fails the exchange, so what was read belongs to what is taken.
bool Team::take_one(int worker) {
  std::uint64_t open = open_.load();
  while (left_of(open) > 0) {
    const std::function<void(int, int)>& body = *body_.load();
    const int index = first_.load() + static_cast<int>(left_of(open)) - 1;
    if (!open_.compare_exchange_weak(open, open - 1)) continue;
    try {
      body(index, worker);
    } catch (...) {
      const std::lock_guard lock(failure_mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
    ++done_;
    return true;
  }
  return false;
}

void Team::share(int first, int count, const std::function<void(int, int)>& body) {
  if (first >= count) return;
  first_ = first;
  body_ = &body;
  done_ = 0;
  open_ = (open_.load() / kShared + 1) * kShared + static_cast<std::uint64_t>(count - first);
  if (asleep_.load() > 0) open_.notify_all();
  while (take_one(0)) {
  }
  while (done_.load() < count - first) std::this_thread::yield();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void Team::help(int worker) {
  for (Clock::time_point last = Clock::now(); !ended_.load();) {
    if (take_one(worker)) {
      while (take_one(worker)) {
      }
      last = Clock::now();
    }
    for (int look = 0; look < kLooks && left_of(open_.load()) == 0; ++look) std::this_thread::yield();
    if (Clock::now() - last < kStayAwake) continue;
    ++asleep_;
    if (const std::uint64_t open = open_.load(); left_of(open) == 0 && !ended_.load()) open_.wait(open);
    --asleep_;
    last = Clock::now();
  }
}

}  // namespace swivel::detail
