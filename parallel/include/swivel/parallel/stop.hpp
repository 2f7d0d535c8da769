// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <chrono>
#include <optional>

namespace swivel {

/// When to give up: a deadline, a cancel flag set from another thread or a signal handler, or neither.
class Stop {
 public:
  enum class Reason { kNone, kTimeout, kCancelled };
  Stop() = default;
  Stop(std::optional<std::chrono::duration<double>> limit, const std::atomic<bool>* cancel) : cancel_(cancel) {
    if (limit) deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(*limit);
  }
  [[nodiscard]] Reason reason() const {
    if (cancel_ && cancel_->load(std::memory_order_relaxed)) return Reason::kCancelled;
    if (deadline_ && Clock::now() >= *deadline_) return Reason::kTimeout;
    return Reason::kNone;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> deadline_;
  const std::atomic<bool>* cancel_ = nullptr;
};

}  // namespace swivel
