// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <chrono>
#include <optional>

namespace swivel {

/// Thrown by Budget::poll() where work is to end at once. plan() turns it into a status; it never reaches the caller of plan().
struct Stopped {};

/// How long work may go on: until a deadline, until another thread or a signal handler sets a flag, until the earlier of both, or
/// without an end. Every stage of a plan polls it, in strides of a millisecond or less.
class Budget {
 public:
  Budget() = default;
  /// The deadline is `seconds` from now. Every positive number holds; what no clock can measure never passes.
  explicit Budget(std::optional<double> seconds, const std::atomic<bool>* cancel = nullptr) : cancel_(cancel) {
    constexpr double kFar = 1e9;  // 30 years; the clock counts nanoseconds in 64 bits
    if (seconds && *seconds < kFar)
      deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(*seconds));
  }
  [[nodiscard]] bool cancelled() const { return cancel_ != nullptr && cancel_->load(std::memory_order_relaxed); }
  [[nodiscard]] bool spent() const { return cancelled() || (deadline_ && Clock::now() >= *deadline_); }
  /// Throws Stopped once it is spent.
  void poll() const {
    if (spent()) throw Stopped();
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> deadline_;
  const std::atomic<bool>* cancel_ = nullptr;
};

}  // namespace swivel
